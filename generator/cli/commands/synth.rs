//! `glint synth`: measures area and frequency of a core by synthesis, placement and routing. For a target without an open tool
//! that knows its delays, it measures only the area.

mod cache;
mod front;
mod show;

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::Args;
use rayon::ThreadPool;
use rayon::prelude::*;
use serde::Serialize;

use super::{Loaded, load};
use crate::choice;
use crate::own_file::OwnFile;
use crate::{Configs, OutputOptions, TimeLimit, progress, say};
use cache::Cache;
use glint_core::core::Core;
use glint_core::registry::Registry;
use glint_prove::synth::{
    Figures, Flow, RECORDED_TARGETS, Rate, SynthesisRecord, SynthesisSubject, TARGETS, Target,
};
use glint_prove::tune::{self, Cost};
use glint_rtl::area::Features;
use glint_show::evidence::comparison;
use glint_tools::gates::cells::LIBERTY;
use show::SynthesisReport;

/// Measure area and frequency by synthesis, placement and routing
///
/// Yosys and nextpnr measure iCE40 (UP5K and HX8K), ECP5, Nexus and GateMate with several seeds. Yosys measures Xilinx 7 and Gowin,
/// but only the area, because no open tool has the delays of all their cells. Yosys and OpenSTA measure 0.18 µm standard
/// cells, before layout; one gate is a NAND2X1. The command puts registers around the core, so the delays of pins do not
/// count; the delay of a DSP block always counts. The points per second are the median frequency divided by the clocks per
/// point. The critical path has the names of the description. Results are cached in `.glint/` next to the configuration
/// until the Verilog or the tools change.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint synth my_core.toml                            every target whose tools are installed; for a pipeline, its own target
  glint synth my_core.toml --target ecp5 --seeds 11   one target, more seeds
  glint synth my_core.toml --target gowin             area on a Tang Nano 20K
  glint synth my_core.toml --front --rate 30          all architectures; marks the smallest with this rate
  glint synth --json                                  everything in configs/, for scripts
  glint synth --out synthesis                         a record of each configuration in configs/")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
    /// The technology to measure for; may be repeated [default: the pipelines' targets, or those of iCE40, ECP5, Xilinx 7
    /// and standard cells whose tools are installed]
    #[arg(long = "target", value_name = "TARGET", value_parser = choice::target())]
    targets: Vec<Target>,
    /// The number of runs of place and route; the result is their median. 0 measures only the area
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(0..=1000))]
    seeds: u32,
    /// The number of tools to run at the same time [default: the number of threads]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Ignore results in the cache, `.glint/` next to each configuration, and measure again
    #[arg(long)]
    no_cache: bool,
    /// Write the results of each configuration, `<name>.json`, into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Measure one configuration in each architecture: the sequential core, and pipelines from the longest interval to a point
    /// every clock
    #[arg(long)]
    front: bool,
    /// With --front: mark the smallest architecture that has this rate, in million points a second
    #[arg(long, value_name = "M", requires = "front", value_parser = crate::number)]
    rate: Option<f64>,
    /// With --front: plot area over rate as SVG into this file
    #[arg(long, value_name = "FILE.svg", requires = "front")]
    plot: Option<PathBuf>,
    /// With --plot: replace an existing file
    #[arg(long, requires = "plot")]
    force: bool,
    /// The Liberty file of the standard cells
    #[arg(long, value_name = "FILE.lib", default_value = LIBERTY)]
    liberty: PathBuf,
    #[command(flatten)]
    time_limit: TimeLimit<3600>,
}

/// A configuration with its measurements on all targets.
struct Measurement<'a> {
    one: &'a Loaded,
    clocks_per_point: f64,
    figures: Vec<Figures>,
}

/// The measurement on a target, and the features of the netlist to which the estimates of `glint tune` are fitted.
#[derive(Serialize)]
struct FigureRecord<'a> {
    #[serde(flatten)]
    figures: &'a Figures,
    netlist: Features,
    /// The estimated clock frequency, in MHz.
    estimated_mhz: f64,
}

/// Runs the measurements and reports them.
///
/// # Errors
///
/// Fails if a configuration has problems, if the tools are missing or fail, or if a record cannot be written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let loaded = load(registry, &arguments.configs.paths)?;
    if arguments.front {
        return front::run(output, arguments, &loaded);
    }
    let (flows, notes) = flows(arguments, &loaded)?;
    let mut records: Vec<Option<OwnFile>> = Vec::new();
    for one in &loaded {
        records.push(OwnFile::record(arguments.out.as_deref(), &one.core.config().name)?);
    }
    let mut steps_of_each = 0;
    for flow in &flows {
        steps_of_each += Flow::steps(flow.target(), arguments.seeds);
    }
    let bar = progress::bar(output, steps_of_each * loaded.len() as u64, "synthesis");
    bar.tick();
    let tell = |one: &Loaded, figures: &Figures| {
        if output.is_for_people() {
            bar.suspend(|| say!("{}: {}", one.path, show::in_a_line(figures)));
        }
    };
    let results: Vec<Result<Measurement>> = arguments.threads()?.install(|| {
        let all = loaded.par_iter();
        all.map(|one| measure(one, &flows, arguments, &|steps| bar.inc(steps), &tell)).collect()
    });
    let measured: Vec<Measurement> = results.into_iter().collect::<Result<_>>()?;
    bar.finish_and_clear();
    let mut written = Vec::new();
    for (one, record) in measured.iter().zip(records) {
        if let Some(record) = record {
            written.push(record.write_json(&one.record())?);
        }
    }
    output.report(&SynthesisReport { measured, notes, written })?;
    Ok(true)
}

/// Returns the targets for which the pipelines are scheduled. The list is empty if a configuration is no pipeline, or its target
/// is unknown.
fn targets_of_pipelines(loaded: &[Loaded]) -> Vec<Target> {
    let mut targets = Vec::new();
    for one in loaded {
        let Some(pipeline) = &one.core.design.pipeline else { return Vec::new() };
        match TARGETS.into_iter().find(|target| target.name() == pipeline.target) {
            Some(target) => targets.push(target),
            None => return Vec::new(),
        }
    }
    targets
}

/// Returns the tools for each target that is measured, and a note about each target with missing tools. Fails if the user names
/// such a target, if no target can be measured, or if a record would lack a target.
fn flows(arguments: &Arguments, loaded: &[Loaded]) -> Result<(Vec<Flow>, Vec<String>)> {
    let search = std::env::var_os("PATH").unwrap_or_default();
    let find = |target: Target| {
        let flow = Flow::find(target, &search, &arguments.liberty);
        flow.with_context(|| format!("cannot measure for {}", target.title()))
    };
    let mut wanted = arguments.targets.clone();
    // A record must have all targets.
    if wanted.is_empty() && arguments.out.is_none() {
        wanted = targets_of_pipelines(loaded);
    }
    wanted.sort();
    wanted.dedup();
    if !wanted.is_empty() {
        let flows = wanted.into_iter().map(find).collect::<Result<_>>()?;
        return Ok((flows, Vec::new()));
    }
    let (mut flows, mut notes) = (Vec::new(), Vec::new());
    for target in RECORDED_TARGETS {
        match find(target) {
            Ok(flow) => flows.push(flow),
            Err(error) if arguments.out.is_some() => return Err(error),
            Err(error) => notes.push(format!("{error:#}")),
        }
    }
    if flows.is_empty() {
        bail!("{}", notes.join("\n"));
    }
    Ok((flows, notes))
}

/// Measures a configuration on all targets. Calls `done` with the number of finished steps, and `tell` with each target's
/// figures.
fn measure<'a>(
    one: &'a Loaded,
    flows: &[Flow],
    arguments: &Arguments,
    done: &(dyn Fn(u64) + Sync),
    tell: &(dyn Fn(&Loaded, &Figures) + Sync),
) -> Result<Measurement<'a>> {
    let core = &one.core;
    let clocks_per_point =
        comparison::clocks_per_point(&core.design, core.contract.as_ref(), comparison::EXPONENT)?;
    let figures = flows.par_iter().map(|flow| {
        let name = &core.config().name;
        let figures = figures(core, name, &one.path, flow, arguments, done)?;
        tell(one, &figures);
        Ok(figures)
    });
    Ok(Measurement { one, clocks_per_point, figures: figures.collect::<Result<_>>()? })
}

/// Returns the figures of a core on a target. They come from the cache next to the configuration `path`, if it has them under
/// `name` for the same Verilog and tools. Otherwise the core is measured.
fn figures(
    core: &Core,
    name: &str,
    path: &str,
    flow: &Flow,
    arguments: &Arguments,
    done: &(dyn Fn(u64) + Sync),
) -> Result<Figures> {
    let files = core.verilog_for(flow.target().name())?;
    let subject = SynthesisSubject {
        design: &core.design,
        files: &files,
        seeds: arguments.seeds,
        limit: arguments.time_limit.get(),
    };
    let digest = flow.digest(&subject);
    let cache = Cache::beside(path);
    if !arguments.no_cache
        && let Some(cache) = &cache
        && let Some(figures) = cache.find(name, flow.target(), &digest)
    {
        done(Flow::steps(flow.target(), arguments.seeds));
        return Ok(figures);
    }
    let measured = flow.measure(&subject, &|| done(1));
    let figures = measured.with_context(|| format!("`{path}`"))?;
    if let Some(cache) = &cache {
        cache.keep(name, &digest, &figures);
    }
    Ok(figures)
}

impl Arguments {
    /// Returns a pool with as many threads as `--jobs` states, or as many as Glint uses.
    fn threads(&self) -> Result<ThreadPool> {
        let threads = match self.jobs {
            Some(jobs) => usize::from(jobs),
            None => rayon::current_num_threads(),
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.context("cannot start threads")
    }
}

impl Measurement<'_> {
    fn record(&self) -> SynthesisRecord<FigureRecord<'_>> {
        let core = &self.one.core;
        SynthesisRecord {
            glint: env!("CARGO_PKG_VERSION").to_owned(),
            config: self.one.path.clone(),
            name: core.config().name.clone(),
            device: core.device().name.to_owned(),
            core: core.core_digest(),
            clocks_per_point: self.clocks_per_point,
            targets: self.figures.iter().map(|figures| self.recorded(figures)).collect(),
        }
    }

    fn recorded<'f>(&self, figures: &'f Figures) -> FigureRecord<'f> {
        let design = &self.one.core.design;
        FigureRecord {
            figures,
            netlist: Features::new(design, tune::family(figures.target)),
            estimated_mhz: Cost::new(design, figures.target).mhz,
        }
    }

    fn rate(&self, figures: &Figures) -> Option<Rate> {
        Rate::new(figures, self.clocks_per_point)
    }
}

//! `glint synth --front`: measures a configuration in each of its architectures, from the sequential core to a point every clock.

use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::{Arguments, Loaded, figures};
use crate::commands::plot_file::svg_file;
use crate::destination::Destination;
use crate::report::CommandReport;
use crate::{OutputOptions, progress, say, tables, wrong_usage};
use glint_prove::synth::{Figures, Flow, Target};
use glint_prove::tune;
use glint_prove::tune::architectures::{self, Architecture};
use glint_show::evidence::chart::{Chart, ChartAxis, Series};

struct MeasuredArchitecture {
    architecture: Architecture,
    figures: Figures,
    /// The rate in million points per second, at the median frequency. The rate is 0 if the core does not fit the chip.
    rate: f64,
    /// The area in look-up tables, in which DSP blocks and block RAMs also count as look-up tables.
    area: f64,
}

/// The measured architectures, in order from the slowest to the fastest.
struct ArchitectureFront<'a> {
    path: &'a str,
    target: Target,
    measured: Vec<MeasuredArchitecture>,
    /// The index of the architecture that is marked as chosen.
    chosen: usize,
}

/// Measures the architectures and marks one as chosen: the smallest that reaches `--rate`, or without `--rate` the
/// configuration's architecture.
///
/// # Errors
///
/// Fails if a tool fails, if the target has no frequency, if the device cannot be a pipeline, or if no architecture has the rate.
pub fn run(output: OutputOptions, arguments: &Arguments, loaded: &[Loaded]) -> Result<bool> {
    let [one] = loaded else {
        wrong_usage!("--front needs exactly one configuration; name one configuration");
    };
    if arguments.out.is_some() {
        wrong_usage!(
            "--front and --out cannot be used together: a record describes one architecture"
        );
    }
    if arguments.seeds == 0 {
        wrong_usage!("--front needs at least one seed, because it compares rates");
    }
    let target = target(arguments, one)?;
    let drawing = match &arguments.plot {
        Some(path) => Some(Destination::fresh(path, arguments.force)?),
        None => None,
    };
    let search = std::env::var_os("PATH").unwrap_or_default();
    let flow = Flow::find(target, &search, &arguments.liberty)?;
    let own = one.core.design.pipeline.as_ref().map(|pipeline| pipeline.interval as u32);
    let made = architectures::all(&one.core.opened, own, target)?;
    let steps = Flow::steps(target, arguments.seeds) * made.len() as u64;
    let bar = progress::bar(output, steps, "synthesis");
    bar.tick();
    let measured_one = |architecture: Architecture| {
        let words = architecture.words();
        let done = measure(architecture, &flow, arguments, &one.path, &|steps| bar.inc(steps));
        let done = done.with_context(|| format!("`{}` as {words}", one.path))?;
        if output.is_for_people() {
            bar.suspend(|| say!("{words}: {}", super::show::in_a_line(&done.figures)));
        }
        Ok(done)
    };
    let measured: Vec<Result<MeasuredArchitecture>> =
        arguments.threads()?.install(|| made.into_par_iter().map(measured_one).collect());
    let measured: Vec<MeasuredArchitecture> = measured.into_iter().collect::<Result<_>>()?;
    bar.finish_and_clear();
    let chosen = chosen(&measured, arguments.rate, own)?;
    let front = ArchitectureFront { path: &one.path, target, measured, chosen };
    if let Some(drawing) = drawing {
        drawing.write(front.plot()?)?;
    }
    output.report(&front)?;
    Ok(true)
}

/// Returns the target that the user names, or else the pipeline's target, or else ECP5. Fails with wrong usage if the user names
/// several targets, or a target without a frequency.
fn target(arguments: &Arguments, one: &Loaded) -> Result<Target> {
    let target = match arguments.targets[..] {
        [] => super::targets_of_pipelines(std::slice::from_ref(one)).first().copied(),
        [target] => Some(target),
        _ => wrong_usage!("--front needs exactly one target; give --target once"),
    };
    let target = target.unwrap_or(Target::Ecp5);
    if !target.is_timed_fpga() {
        wrong_usage!(
            "--target {target}: --front compares rates, but no frequency can be measured for {}; give ice40, ice40-hx, \
             ecp5, nexus or gatemate",
            target.title()
        );
    }
    Ok(target)
}

fn measure(
    architecture: Architecture,
    flow: &Flow,
    arguments: &Arguments,
    path: &str,
    done: &(dyn Fn(u64) + Sync),
) -> Result<MeasuredArchitecture> {
    let core = &architecture.core;
    let name = match architecture.interval {
        None => format!("{}.sequential", core.config().name),
        Some(interval) => format!("{}.interval{interval}", core.config().name),
    };
    let figures = figures(core, &name, path, flow, arguments, done)?;
    // A core that does not fit the chip has no frequency, and therefore no rate.
    let mhz = figures.frequency.map_or(0.0, |frequency| frequency.median);
    let usage = figures.area.usage().context("an FPGA counts its cells")?;
    let area = tune::area(flow.target(), usage.luts as f64, usage.dsps, usage.block_rams);
    Ok(MeasuredArchitecture {
        rate: mhz / architecture.clocks_per_point,
        area,
        architecture,
        figures,
    })
}

/// Returns the index of the smallest architecture that has the rate. Without a rate, returns the index of the architecture with
/// the interval `own`.
fn chosen(measured: &[MeasuredArchitecture], rate: Option<f64>, own: Option<u32>) -> Result<usize> {
    let Some(wanted) = rate else {
        let is_own = |it: &MeasuredArchitecture| it.architecture.interval == own;
        let place = measured.iter().position(is_own);
        return place.context("the configuration's own architecture was not measured");
    };
    let mut best: Option<usize> = None;
    for (at, it) in measured.iter().enumerate() {
        let is_smaller = best.is_none_or(|best| it.area < measured[best].area);
        if it.rate >= wanted && is_smaller {
            best = Some(at);
        }
    }
    match best {
        Some(best) => Ok(best),
        None => {
            let fastest = measured.iter().fold(0.0_f64, |fastest, it| fastest.max(it.rate));
            bail!(
                "no architecture reaches {wanted} million points a second; the fastest architecture reaches \
                 {fastest:.1}"
            )
        }
    }
}

impl ArchitectureFront<'_> {
    fn plot(&self) -> Result<String> {
        let name = &self.measured[0].architecture.core.config().name;
        let chosen = self.measured[self.chosen].architecture.interval;
        // An architecture that does not fit the chip has no rate, so the plot cannot show it.
        let mut shown: Vec<&MeasuredArchitecture> =
            self.measured.iter().filter(|it| it.rate > 0.0).collect();
        shown.sort_by(|one, other| one.rate.total_cmp(&other.rate));
        let [slowest, .., fastest] = shown[..] else {
            bail!("fewer than two architectures fit the chip, so there is no line to plot");
        };
        let (least_rate, most_rate) = (slowest.rate, fastest.rate);
        let mut places = Vec::new();
        let (mut areas, mut marked) = (Vec::new(), Vec::new());
        for it in shown {
            let is_chosen = it.architecture.interval == chosen;
            places.push(it.rate);
            areas.push(it.area);
            marked.push(if is_chosen { it.area } else { f64::NAN });
        }
        let most_area = areas.iter().copied().fold(0.0, f64::max);
        let chart = Chart {
            id: "front".to_owned(),
            title: format!("{name}: area over the rate"),
            caption:
                "Each corner is an architecture, from the sequential core to a point every clock."
                    .to_owned(),
            x: ChartAxis::logarithmic("million points a second", least_rate * 0.9, most_rate * 1.1),
            y: ChartAxis::linear(
                &format!("{name}: look-up tables of {}, including blocks", self.target.title()),
                0.0,
                most_area * 1.1,
            ),
            places,
            series: vec![
                Series { name: "architectures".to_owned(), values: areas },
                Series { name: "chosen".to_owned(), values: marked },
            ],
            marks: Vec::new(),
        };
        svg_file(&chart)
    }
}

impl CommandReport for ArchitectureFront<'_> {
    fn json(&self) -> Result<Value> {
        let mut all: Vec<Value> = Vec::new();
        for (at, it) in self.measured.iter().enumerate() {
            all.push(json!({
                "architecture": if it.architecture.interval.is_some() { "pipelined" } else { "sequential" },
                "interval": it.architecture.interval,
                "clocks_per_point": it.architecture.clocks_per_point,
                "million_points_per_second": it.rate,
                "area_in_luts": it.area,
                "estimate": it.architecture.cost,
                "figures": it.figures,
                "chosen": at == self.chosen,
            }));
        }
        Ok(json!({ "ok": true, "config": self.path, "target": self.target, "front": all }))
    }

    fn print(&self) -> Result<()> {
        let mut rows = Vec::new();
        for (at, it) in self.measured.iter().enumerate() {
            let area = it.figures.area.usage().context("an FPGA counts its cells")?;
            // A core that does not fit the chip has neither a frequency nor a rate.
            let (mhz, rate) = match it.figures.frequency {
                Some(frequency) => (format!("{:.1}", frequency.median), format!("{:.1}", it.rate)),
                None => ("–".to_owned(), "–".to_owned()),
            };
            rows.push(vec![
                it.architecture.words(),
                area.luts.to_string(),
                area.dsps.to_string(),
                area.block_rams.to_string(),
                area.flip_flops.to_string(),
                mhz,
                rate,
                format!("{:.0}", it.area),
                if at == self.chosen { "chosen".to_owned() } else { String::new() },
            ]);
        }
        tables::print(
            "architecture | LUT: | DSP: | RAM: | FF: | MHz: | M points/s: | area in LUT: | ",
            rows,
        );
        let figures = self.measured.iter().map(|it| &it.figures);
        let tools = glint_prove::synth::tools(figures);
        say!(
            "Measured for {} with {}.",
            self.measured[self.chosen].figures.device,
            Vec::from_iter(tools).join(", ")
        );
        Ok(())
    }
}

//! `glint compare`: compares all highlight devices, and the configurations that the user names, at one exponent n.

mod show;

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result};
use clap::Args;
use rayon::prelude::*;

use super::{load, yosys};
use crate::{OutputOptions, TimeLimit, progress, wrong_usage};
use glint_base::target::{COMPARED, Family};
use glint_config::{Config, Schema, Value};
use glint_core::core::Core;
use glint_core::registry::{Device, Registry};
use glint_golden::contract;
use glint_prove::synth::SynthesisRecord;
use glint_show::evidence::comparison::{self, Accuracy, MultiplierSize};
use glint_tools::Tool;
use glint_tools::synthesis::{self, Usage};
use show::ComparisonReport;

/// Compare all devices with cos^n gamma at one exponent, side by side
///
/// The command compares the default configurations of all devices. The options below set the widths of the devices that have
/// such a key. Configurations that you name are compared unchanged. The tables show the largest and the mean error of the
/// reflectance f over gamma = 0 to 90 degrees, in total and by cause: the source's formula, the quantised operands, the
/// fixed point. The LUTs, DSP blocks and block RAMs of iCE40, ECP5 and Xilinx 7, the frequencies and the points per second
/// come from records of `glint synth`. If there is no record and Yosys is on PATH, the command counts LUTs, DSP blocks and
/// block RAMs with Yosys, which takes a minute or more.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint compare --exponent 100                       errors, clocks, ROM and synthesis at n = 100
  glint compare --no-synthesis --bits 10             takes no time; ten-bit colours
  glint compare --exponent 20 my_core.toml --csv     your configuration beside the devices
  glint compare --cosine-fraction 16 --json          coarser cosines, for scripts")]
pub struct Arguments {
    /// Configurations to compare with the devices
    #[arg(value_name = "CONFIG")]
    configs: Vec<PathBuf>,
    /// The specular exponent n
    #[arg(long, short = 'n', value_name = "N", default_value_t = 35)]
    exponent: u32,
    /// Bits of colours and outputs: the key colour.bits
    #[arg(long, value_name = "B", value_parser = clap::value_parser!(i64).range(1..=64))]
    bits: Option<i64>,
    /// Fraction bits of cosines: the key cosine.fraction
    #[arg(long, value_name = "C", value_parser = clap::value_parser!(i64).range(1..=64))]
    cosine_fraction: Option<i64>,
    /// Fraction bits of f: the key intensity.fraction
    #[arg(long, value_name = "F", value_parser = clap::value_parser!(i64).range(1..=64))]
    intensity_fraction: Option<i64>,
    /// Print CSV, for spreadsheets
    #[arg(long)]
    csv: bool,
    /// The directory with the records of `synth --out`; a record is found by the digest of its configuration
    #[arg(long, value_name = "DIR", default_value = glint_prove::synth::DIRECTORY)]
    figures: PathBuf,
    /// Do not run Yosys to count LUTs, DSP blocks and block RAMs
    #[arg(long)]
    no_synthesis: bool,
    #[command(flatten)]
    time_limit: TimeLimit,
}

struct ComparisonEntry {
    /// The name of the device, or the path of the configuration.
    label: String,
    core: Core,
    figures: ModelFigures,
    /// The resources for each family in `COMPARED`, or the message of a failed synthesis. Empty if no record has them and Yosys
    /// did not count them.
    usage: Vec<Result<Usage, String>>,
    record: Option<SynthesisRecord>,
}

/// The figures that need no outside tool.
struct ModelFigures {
    /// The errors against cosⁿγ; `None` if the exponent is outside the device's domain.
    accuracy: Option<Accuracy>,
    clocks_per_point: f64,
    multipliers: Vec<MultiplierSize>,
}

/// Runs the command. Returns whether every synthesis run succeeded.
///
/// # Errors
///
/// Fails if a configuration has problems, if the exponent is outside the domains of all devices, or if a record cannot be
/// read.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    if arguments.csv && !output.is_for_people() {
        wrong_usage!("--csv and --json cannot be used together: give one of them");
    }
    let mut notes = Vec::new();
    let mut cores = Vec::new();
    let widths = [
        ("colour.bits", arguments.bits),
        ("cosine.fraction", arguments.cosine_fraction),
        ("intensity.fraction", arguments.intensity_fraction),
    ];
    for device in registry.devices() {
        let config = with_widths(device, &widths, &mut notes);
        let core = Core::new(*device, config)?;
        // A device that is no highlight has no colour to multiply, and no exponent.
        if core.contract.highlight().is_some() {
            cores.push((device.name.to_owned(), core));
        }
    }
    if !arguments.configs.is_empty() {
        let named = load(registry, &arguments.configs)?;
        cores.extend(named.into_iter().map(|one| (one.path, one.core)));
    }
    let n = f64::from(arguments.exponent);
    let domains: Vec<(f64, f64)> = cores.iter().filter_map(|(_, core)| domain(core)).collect();
    if !domains.is_empty() && !domains.iter().any(|(low, high)| (low..=high).contains(&&n)) {
        let most = domains.iter().fold(0.0, |most: f64, (_, high)| most.max(*high));
        wrong_usage!(
            "--exponent {n} is outside the domain of every device; the largest exponent is {most}"
        );
    }
    let mut records: Vec<Option<SynthesisRecord>> = Vec::new();
    for (_, core) in &cores {
        records.push(SynthesisRecord::find(&arguments.figures, &core.core_digest())?);
    }
    let mut usage: Vec<_> = records.iter().map(|it| recorded(it.as_ref())).collect();
    let missing = usage.iter().filter(|usage| usage.is_empty()).count();
    let yosys = match !arguments.no_synthesis && missing > 0 {
        true => yosys("no LUTs, DSP blocks and block RAMs are shown", &mut notes),
        false => None,
    };
    let families = if yosys.is_some() { COMPARED.len() } else { 0 };
    let steps = cores.len() + missing * families;
    let bar = progress::bar(output, steps as u64, "devices weighed");
    let figures: Vec<ModelFigures> = cores
        .par_iter()
        .map(|(label, core)| {
            let figures = figures(core, n);
            bar.inc(1);
            figures.with_context(|| format!("`{label}`"))
        })
        .collect::<Result<_>>()?;
    if let Some(yosys) = &yosys {
        let mut unknown = Vec::new();
        let mut places = Vec::new();
        for (core, place) in cores.iter().zip(&mut usage) {
            if place.is_empty() {
                unknown.push(core);
                places.push(place);
            }
        }
        let found = synthesise(&unknown, yosys, arguments.time_limit.get(), &|| bar.inc(1))?;
        for (place, found) in places.into_iter().zip(found) {
            *place = found;
        }
    }
    bar.finish_and_clear();
    let mut entries: Vec<ComparisonEntry> = Vec::new();
    let found = figures.into_iter().zip(usage).zip(records);
    for ((label, core), ((figures, usage), record)) in cores.into_iter().zip(found) {
        entries.push(ComparisonEntry { label, core, figures, usage, record });
    }
    let mut failures: Vec<String> = Vec::new();
    for entry in &entries {
        if entry.figures.accuracy.is_none() {
            notes.push(outside(entry, arguments.exponent));
        }
        for usage in &entry.usage {
            if let Err(error) = usage {
                failures.push(error.clone());
            }
        }
    }
    output.report(&ComparisonReport {
        arguments,
        entries: &entries,
        notes: &notes,
        failures: &failures,
    })?;
    Ok(failures.is_empty())
}

/// Returns the device's defaults with the values in `widths`, for keys that the device has. If the device refuses a value, the
/// key keeps its default, and `notes` gets a note about it.
fn with_widths(device: &Device, widths: &[(&str, Option<i64>)], notes: &mut Vec<String>) -> Config {
    let schema: Schema = (device.schema)();
    let name = schema.module();
    let mut accepted: Vec<(String, Value)> = Vec::new();
    let mut config = Config::defaults(&schema, &name);
    for &(key, value) in widths {
        let (Some(value), Some(_)) = (value, schema.key(key)) else { continue };
        let mut wanted = accepted.clone();
        wanted.push((key.to_owned(), Value::Integer(value)));
        match Config::from_values(&schema, &name, wanted.clone()) {
            Ok(found) => {
                config = found;
                accepted = wanted;
            }
            Err(problems) => {
                let why = match problems.iter().next() {
                    Some(problem) => {
                        format!(": {}; {}", problem.error.message, problem.error.remedy)
                    }
                    None => String::new(),
                };
                notes.push(format!(
                    "{}: {key} = {value} is not valid, so the comparison uses {}{why}",
                    device.name,
                    config.value(key).bare(),
                ));
            }
        }
    }
    config
}

fn figures(core: &Core, n: f64) -> Result<ModelFigures> {
    let contract = core.contract.as_ref();
    Ok(ModelFigures {
        accuracy: comparison::accuracy(contract, n),
        clocks_per_point: comparison::clocks_per_point(&core.design, contract, n)?,
        multipliers: comparison::multipliers(&core.design),
    })
}

/// Returns the resources in a record for every family in `COMPARED`, or an empty list if the record lacks a family.
fn recorded(record: Option<&SynthesisRecord>) -> Vec<Result<Usage, String>> {
    let Some(record) = record else { return Vec::new() };
    let mut usage = Vec::new();
    for family in &COMPARED {
        let Some(of_family) = usage_of_family(record, family) else { return Vec::new() };
        usage.push(Ok(of_family));
    }
    usage
}

fn usage_of_family(record: &SynthesisRecord, family: &Family) -> Option<Usage> {
    let mut targets = record.targets.iter();
    let figures = targets.find(|figures| figures.target.name() == family.name())?;
    figures.area.usage()
}

/// Returns, for each core and family in `COMPARED`, the resources or the failure's message. Calls `done` after each run of Yosys.
fn synthesise(
    cores: &[&(String, Core)],
    yosys: &Tool,
    limit: Duration,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Vec<Result<Usage, String>>>> {
    let mut files: Vec<Vec<(String, String)>> = Vec::new();
    for (label, core) in cores {
        files.push(core.verilog().with_context(|| format!("`{label}`"))?);
    }
    let runs: Vec<Result<Usage, String>> = (0..cores.len() * COMPARED.len())
        .into_par_iter()
        .map(|at| {
            let (one, family) = (at / COMPARED.len(), &COMPARED[at % COMPARED.len()]);
            let (label, core) = cores[one];
            let name = &core.config().name;
            let netlist = synthesis::synthesise(yosys, &files[one], name, family, limit);
            done();
            match netlist {
                Ok(netlist) => Ok(netlist.usage),
                Err(error) => Err(format!("{label}, {}: {error:#}", family.title)),
            }
        })
        .collect();
    Ok(runs.chunks(COMPARED.len()).map(<[_]>::to_vec).collect())
}

/// Says why no errors are shown. For example, `my_core.toml: n = 300 is outside the device's domain, n = 1 to 255`.
fn outside(entry: &ComparisonEntry, n: u32) -> String {
    let label = &entry.label;
    match domain(&entry.core) {
        None => format!(
            "{label}: no errors are shown, because the device has no operands for gamma and n = {n}"
        ),
        Some((low, high)) => {
            format!("{label}: n = {n} is outside the device's domain, n = {low} to {high}")
        }
    }
}

/// Returns the smallest and the largest exponent of a device, or `None` if it has no operand `exponent`.
fn domain(core: &Core) -> Option<(f64, f64)> {
    let operands = core.contract.operands();
    let exponent = operands.iter().find(|operand| operand.name == contract::EXPONENT)?;
    let (low, high) = exponent.domain;
    let format = exponent.format;
    Some((format.to_f64(i128::from(low)), format.to_f64(i128::from(high))))
}

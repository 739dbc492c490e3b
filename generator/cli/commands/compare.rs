//! `compare`.

mod show;

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use rayon::prelude::*;

use super::load;
use crate::cli::failure::Usage as WrongUsage;
use crate::cli::{Output, progress};
use crate::config::{Config, Schema, Value};
use crate::core::Core;
use crate::evidence::comparison::{self, Accuracy, Multiplier};
use crate::golden::contract;
use crate::registry::{Device, Registry};
use crate::synth::Record;
use crate::tools::Tool;
use crate::tools::synthesis::{self, FAMILIES, Family, Usage};

/// What `compare` was asked for.
pub struct CompareRequest {
    /// The exponent n.
    pub exponent: u32,
    /// Keys that replace a device's default, where it has them.
    pub widths: Vec<(&'static str, i64)>,
    /// Print CSV.
    pub csv: bool,
    /// Ask Yosys what the devices take of which there is no record.
    pub synthesis: bool,
    /// The directory with records of `synth`.
    pub figures: PathBuf,
    /// After which a run of Yosys is given up.
    pub time_limit: Duration,
}

/// One configuration in the comparison.
struct Entry {
    /// The name of the device, or the path of the configuration.
    label: String,
    core: Core,
    figures: Figures,
    /// By family; empty where nothing is known.
    usage: Vec<Result<Usage, String>>,
    /// What `synth` has measured of it.
    record: Option<Record>,
}

/// What is known of a configuration without a tool.
struct Figures {
    /// `None` when the exponent is outside the domain.
    accuracy: Option<Accuracy>,
    clocks_per_point: f64,
    multipliers: Vec<Multiplier>,
}

/// `glint compare`.
pub fn compare(
    registry: &Registry,
    output: Output,
    configs: &[PathBuf],
    request: &CompareRequest,
) -> Result<bool> {
    if request.csv && output.json {
        bail!(WrongUsage("--csv and --json are two ways to print the same: give one".to_owned()));
    }
    let mut notes = Vec::new();
    let mut cores = Vec::new();
    for device in registry.devices() {
        let config = with_widths(device, &request.widths, &mut notes);
        cores.push((device.name.to_owned(), Core::new(*device, config)?));
    }
    if !configs.is_empty() {
        let named = load(registry, configs)?;
        cores.extend(named.into_iter().map(|one| (one.path, one.core)));
    }
    let records: Vec<Option<Record>> = cores
        .iter()
        .map(|(_, core)| Record::find(&request.figures, &core.core_digest()))
        .collect::<Result<_>>()?;
    let mut usage: Vec<_> = records.iter().map(|it| recorded(it.as_ref())).collect();
    let missing = usage.iter().filter(|usage| usage.is_empty()).count();
    let yosys = match (request.synthesis && missing > 0).then(|| Tool::find("yosys")) {
        None => None,
        Some(Ok(yosys)) => Some(yosys),
        Some(Err(missing)) => {
            notes.push(format!("{missing}: no LUTs, DSP blocks and block RAMs"));
            None
        }
    };
    let families = if yosys.is_some() { FAMILIES.len() } else { 0 };
    let steps = cores.len() + missing * families;
    let bar = progress::bar(output, steps as u64, "devices weighed");
    let n = f64::from(request.exponent);
    let figures: Vec<Figures> = cores
        .par_iter()
        .map(|(label, core)| {
            let figures = figures(core, n);
            bar.inc(1);
            figures.with_context(|| format!("`{label}`"))
        })
        .collect::<Result<_>>()?;
    if let Some(yosys) = &yosys {
        let unknown = cores.iter().zip(&mut usage).filter(|(_, usage)| usage.is_empty());
        let (unknown, places): (Vec<_>, Vec<_>) = unknown.unzip();
        let found = synthesise(&unknown, yosys, request.time_limit, &|| bar.inc(1))?;
        places.into_iter().zip(found).for_each(|(place, found)| *place = found);
    }
    bar.finish_and_clear();
    let entries: Vec<Entry> = cores
        .into_iter()
        .zip(figures)
        .zip(usage.into_iter().zip(records))
        .map(|(((label, core), figures), (usage, record))| Entry {
            label,
            core,
            figures,
            usage,
            record,
        })
        .collect();
    for entry in &entries {
        if entry.figures.accuracy.is_none() {
            notes.push(outside(entry, request.exponent));
        }
    }
    let faults: Vec<String> = entries
        .iter()
        .flat_map(|entry| &entry.usage)
        .filter_map(|usage| usage.as_ref().err().cloned())
        .collect();
    show::show(output, request, &entries, &notes, &faults);
    Ok(faults.is_empty())
}

/// The device's defaults with these keys replaced, where it has them and accepts the value.
fn with_widths(device: &Device, widths: &[(&'static str, i64)], notes: &mut Vec<String>) -> Config {
    let schema: Schema = (device.schema)();
    let name = device.name.replace('-', "_");
    let mut accepted: Vec<(String, Value)> = Vec::new();
    let mut config = Config::defaults(&schema, &name);
    for &(key, value) in widths {
        if schema.key(key).is_none() {
            continue;
        }
        let mut wanted = accepted.clone();
        wanted.push((key.to_owned(), Value::Integer(value)));
        match Config::from_values(&schema, &name, wanted.clone()) {
            Ok(found) => {
                config = found;
                accepted = wanted;
            }
            Err(problems) => {
                let why = problems.iter().next().map_or_else(String::new, |problem| {
                    format!(": {}; {}", problem.message, problem.remedy)
                });
                notes.push(format!(
                    "{}: {key} = {value} is not accepted, {} is compared{why}",
                    device.name,
                    config.value(key).bare(),
                ));
            }
        }
    }
    config
}

fn figures(core: &Core, n: f64) -> Result<Figures> {
    let contract = core.contract.as_ref();
    Ok(Figures {
        accuracy: comparison::accuracy(contract, n),
        clocks_per_point: comparison::clocks_per_point(&core.design, contract, n)?,
        multipliers: comparison::multipliers(&core.design),
    })
}

/// What a record says of every family; nothing where it leaves one out.
fn recorded(record: Option<&Record>) -> Vec<Result<Usage, String>> {
    let usage = |family: &Family| {
        let mut targets = record?.targets.iter();
        targets.find(|figures| figures.target.name() == family.name)?.area.usage()
    };
    let all: Option<Vec<Usage>> = FAMILIES.iter().map(usage).collect();
    all.into_iter().flatten().map(Ok).collect()
}

/// What every core takes in every family: an outcome, or what went wrong.
fn synthesise(
    cores: &[&(String, Core)],
    yosys: &Tool,
    limit: Duration,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Vec<Result<Usage, String>>>> {
    let files: Vec<Vec<(String, String)>> = cores
        .iter()
        .map(|(label, core)| core.verilog().with_context(|| format!("`{label}`")))
        .collect::<Result<_>>()?;
    let runs: Vec<Result<Usage, String>> = (0..cores.len() * FAMILIES.len())
        .into_par_iter()
        .map(|at| {
            let (one, family) = (at / FAMILIES.len(), &FAMILIES[at % FAMILIES.len()]);
            let (label, core) = cores[one];
            let usage = synthesis::synthesise(yosys, &files[one], &core.config.name, family, limit);
            done();
            usage.map_err(|error| format!("{label}, {}: {error:#}", family.title))
        })
        .collect();
    Ok(runs.chunks(FAMILIES.len()).map(<[_]>::to_vec).collect())
}

/// Why a configuration has no errors to show.
fn outside(entry: &Entry, n: u32) -> String {
    let operands = entry.core.contract.operands();
    let exponent = operands.iter().find(|operand| operand.name == contract::EXPONENT);
    let label = &entry.label;
    match exponent {
        None => format!("{label}: none of its operands stand for gamma and n = {n}"),
        Some(operand) => {
            let value = |raw: i64| operand.format.to_f64(i128::from(raw));
            let (low, high) = (value(operand.domain.0), value(operand.domain.1));
            format!("{label}: n = {n} is not in its domain, n = {low} to {high}")
        }
    }
}

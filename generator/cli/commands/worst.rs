//! `glint worst`: searches for the operands with the largest error of an output.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::{Loaded, load};
use crate::own_file::OwnFile;
use crate::report::CommandReport;
use crate::{Configs, OutputOptions, count, progress, say};
use glint_base::program::Program;
use glint_base::{input, text};
use glint_core::cosim::search::{self, Reached};
use glint_core::package::Seal;
use glint_core::registry::Registry;

/// Search for the largest error of an output
///
/// Each climb starts at a point of the stimulus, and changes the operands as long as the error grows. Then the command tries
/// values around the points with the largest errors. The result is a lower limit of the largest error; the bound of the
/// contract is an upper limit. The same seed gives the same result. The exit code is 0 if the error found does not exceed
/// the bound.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint worst my_core.toml
  glint worst my_core.toml --starts 1e5 --seed 7      longer, from other points
  glint worst configs/rough.toml --out records/proofs/worst   writes a record, unless an old record has a larger error")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
    /// The number of climbs
    #[arg(long, value_name = "N", default_value = "1000", value_parser = count)]
    starts: u64,
    /// The seed of the points at which the climbs start
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Write the record of each configuration, `<name>.json`, into this directory; a record of a larger error is kept
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// The largest error that a search has found, in the form of a record.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct LargestError {
    /// The version of Glint, with which a record begins.
    glint: String,
    config: String,
    /// A digest of everything on which the contract depends.
    contract: String,
    /// The number of starts of the search that found the error.
    starts: u64,
    seed: u64,
    /// The error in output units.
    units: f64,
    output: String,
    /// The raw operands, by name.
    operands: BTreeMap<String, i64>,
    /// The raw output, and the value of the formula in the output's units.
    raw: i64,
    exact: f64,
}

#[derive(Serialize)]
struct WorstReport<'a> {
    #[serde(skip)]
    one: &'a Loaded,
    #[serde(flatten)]
    found: LargestError,
    /// The bound of the contract, in output units.
    bound: f64,
    holds: bool,
    /// The record on disk, if its error is at least as large, so that it stays.
    recorded: Option<LargestError>,
}

/// Searches for the largest errors. Returns whether all errors are within their bounds. If a contract states no bound, it is
/// enough that the error is finite.
///
/// # Errors
///
/// Fails if a configuration has problems or no output, or if a record cannot be read or written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let loaded = load(registry, &arguments.configs.paths)?;
    let records = loaded.iter().map(|one| record(one, arguments)).collect::<Result<Vec<_>>>()?;
    let total = search::steps(arguments.starts).saturating_mul(loaded.len() as u64);
    let bar = progress::bar(output, total, "climbs");
    let mut list = output.list();
    let mut all_hold = true;
    for (one, record) in loaded.iter().zip(records) {
        let contract = one.core.contract.as_ref();
        let found = search::worst(contract, arguments.starts, arguments.seed, &|| bar.inc(1));
        let found = found.with_context(|| format!("`{}` has no output", one.path))?;
        let bound = contract.bounds().outputs[found.output].units;
        let holds = found.units <= bound && found.units.is_finite();
        let (holds, found) = (holds, known(one, arguments, &found));
        let mut recorded = None;
        if let Some((file, before)) = record {
            match before.filter(|before| before.units >= found.units) {
                Some(before) => recorded = Some(before),
                None => file.write_json(&found).map(drop)?,
            }
        }
        let report = WorstReport { one, found, bound, holds, recorded };
        bar.suspend(|| list.add(&report))?;
        all_hold &= holds;
    }
    bar.finish_and_clear();
    list.conclude(all_hold)
}

impl CommandReport for WorstReport<'_> {
    fn json(&self) -> Result<Value> {
        Ok(json!(self))
    }

    fn print(&self) -> Result<()> {
        print(self);
        Ok(())
    }
}

fn known(one: &Loaded, arguments: &Arguments, found: &Reached) -> LargestError {
    let contract = one.core.contract.as_ref();
    let names = contract.operands().iter().map(|it| it.name.clone());
    LargestError {
        glint: env!("CARGO_PKG_VERSION").to_owned(),
        config: one.path.clone(),
        contract: one.core.contract_digest(),
        starts: arguments.starts,
        seed: arguments.seed,
        units: found.units,
        output: contract.outputs()[found.output].name.clone(),
        operands: names.zip(found.operands.iter().copied()).collect(),
        raw: found.raw,
        exact: found.exact,
    }
}

fn print(report: &WorstReport) {
    let WorstReport { one, found, bound, holds, recorded } = report;
    let verdict = match (bound.is_finite(), holds) {
        (false, _) => "and the contract states no bound".to_owned(),
        (true, true) => format!("within the bound of {bound:.4}"),
        (true, false) => format!("BEYOND the bound of {bound:.4}"),
    };
    say!(
        "{}: {:.4} units, {verdict}, found by {} from seed {}",
        found.config,
        found.units,
        climbs(found.starts),
        found.seed
    );
    let operands = one.core.contract.operands().iter();
    let operands: Vec<String> =
        operands.map(|it| format!("{}=#{}", it.name, found.operands[&it.name])).collect();
    say!("  {} is {} for {:.4} at {}", found.output, found.raw, found.exact, operands.join(" "));
    if let Some(recorded) = recorded {
        say!(
            "  the existing record is kept: {:.4} units, found by {} from seed {}",
            recorded.units,
            climbs(recorded.starts),
            recorded.seed
        );
    }
}

fn climbs(starts: u64) -> String {
    format!("{} climb{}", text::grouped(starts), if starts == 1 { "" } else { "s" })
}

/// Returns the record's file, such as `rough.json` for `configs/rough.toml`, and the record in it if it belongs to the same
/// contract. Returns `None` without `--out`. Fails if Glint did not write the file, or if the file was edited, cannot be written
/// or contains no such record.
fn record(one: &Loaded, arguments: &Arguments) -> Result<Option<(OwnFile, Option<LargestError>)>> {
    let Some(directory) = &arguments.out else { return Ok(None) };
    let name = format!("{}.json", one.core.config().name);
    let file = OwnFile::new(directory, &name, Seal::Json)?;
    let before = read(&directory.join(&name))?;
    Ok(Some((file, before.filter(|before| before.contract == one.core.contract_digest()))))
}

fn read(path: &Path) -> Result<Option<LargestError>> {
    let Some(text) = input::text(path)? else { return Ok(None) };
    let known: LargestError = serde_json::from_str(&text)
        .with_context(|| format!("`{}` is not a record of `{Program} worst`", path.display()))?;
    ensure!(known.units.is_finite(), "the error in `{}` is not a finite number", path.display());
    Ok(Some(known))
}

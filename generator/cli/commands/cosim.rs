//! `cosim`.

mod benches;
mod spread;

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::mismatch::{self, Reproducer};
use super::{Loaded, load, verdict};
use crate::base::text;
use crate::cli::failure::Usage;
use crate::cli::{Output, Simulator, progress, tables};
use crate::core::TEST_POINTS;
use crate::cosim::{Outcome, Worst};
use crate::golden::Bound;
use crate::registry::Registry;
use crate::tools;
use benches::benches;

/// What `cosim` was asked for.
pub struct CosimRequest {
    /// Results of each configuration.
    pub points: Option<u64>,
    /// Of the stimulus.
    pub seed: u64,
    /// What simulates.
    pub simulator: Simulator,
    /// Where the waveform goes.
    pub vcd: Option<PathBuf>,
    /// After which an external simulator is given up.
    pub time_limit: Duration,
}

/// `glint cosim`.
pub fn cosim(
    registry: &Registry,
    output: Output,
    configs: &[PathBuf],
    request: &CosimRequest,
) -> Result<bool> {
    let loaded = load(registry, configs)?;
    if request.vcd.is_some() && loaded.len() != 1 {
        bail!(Usage(format!("--vcd is for one configuration; here are {}", loaded.len())));
    }
    let which = match request.simulator {
        Simulator::RustHdl => return built_in(output, &loaded, request),
        Simulator::Icarus => tools::Simulator::Icarus,
        Simulator::Verilator => tools::Simulator::Verilator,
    };
    benches(output, &loaded, request, which)
}

fn built_in(output: Output, loaded: &[Loaded], request: &CosimRequest) -> Result<bool> {
    let points = request.points.unwrap_or(TEST_POINTS);
    let bar = progress::bar(output, points.saturating_mul(loaded.len() as u64), "points checked");
    let outcomes: Vec<Outcome> = loaded
        .par_iter()
        .map(|one| {
            let progress = |points: u64| bar.inc(points);
            run(one, points, request, &progress).with_context(|| format!("`{}`", one.path))
        })
        .collect::<Result<_>>()?;
    bar.finish_and_clear();
    let mut holds = true;
    let mut list = Vec::new();
    for (one, outcome) in loaded.iter().zip(&outcomes) {
        let bound = one.core.contract.bound();
        let faults = outcome.faults(&bound);
        holds &= faults.is_empty();
        if output.json {
            list.push(as_json(one, outcome, &bound, &faults)?);
            continue;
        }
        tables::print_line(&format!(
            "{}: {} points, {} clocks; {} registers and {} outputs equal the golden model on each: {}",
            one.path,
            text::grouped(outcome.points),
            text::grouped(outcome.clocks),
            outcome.registers,
            outcome.outputs,
            verdict(&bound, &faults),
        ));
        if let Some(worst) = &outcome.worst {
            tables::print_line(&format!(
                "  largest error {:.3} units (bound {:.3}) at {}",
                worst.units,
                bound.units,
                place(one, worst)
            ));
        }
        if one.core.contract.highlight().is_some() {
            spread::print(&outcome.histogram);
        }
        for fault in faults {
            tables::print_line(&format!("  FAILS: {fault}"));
        }
        if let Some(mismatch) = &outcome.mismatch {
            let reproducer = Reproducer::of_run(one, mismatch)?;
            tables::print_line(&format!("  {}", reproducer.text(mismatch)));
        }
    }
    if output.json {
        tables::print_json(&json!({ "ok": holds, "configurations": list }));
    }
    Ok(holds)
}

fn run(
    one: &Loaded,
    points: u64,
    request: &CosimRequest,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Outcome> {
    let lockstep = one.core.lockstep(request.seed)?;
    let Some(path) = &request.vcd else {
        return lockstep.run(points, progress);
    };
    mismatch::traced(&lockstep, path, points, 0)
}

/// The operands of the largest error, as values.
pub fn place(one: &Loaded, worst: &Worst) -> String {
    let operands = one.core.contract.operands();
    let values: Vec<String> = worst
        .operands
        .iter()
        .filter_map(|(name, raw)| {
            let operand = operands.iter().find(|operand| operand.name == *name)?;
            Some(format!("{name}={}", operand.format.to_f64(i128::from(*raw))))
        })
        .collect();
    format!("{} for {}", worst.output, values.join(" "))
}

/// An outcome for scripts. What differs leaves a waveform.
pub fn as_json(one: &Loaded, outcome: &Outcome, bound: &Bound, faults: &[String]) -> Result<Value> {
    let mismatch = outcome.mismatch.as_ref().map(|mismatch| {
        let reproducer = Reproducer::of_run(one, mismatch)?;
        anyhow::Ok(reproducer.json(mismatch))
    });
    let terms: Vec<Value> = bound
        .terms
        .iter()
        .map(|term| json!({ "key": term.key, "what": term.what, "units": term.units }))
        .collect();
    Ok(json!({
        "device": one.core.device.name,
        "config": one.path,
        "name": one.core.config.name,
        "points": outcome.points,
        "clocks": outcome.clocks,
        "registers": outcome.registers,
        "outputs": outcome.outputs,
        "bound": { "units": bound.units, "f": bound.f, "terms": terms },
        "largest_error": outcome.worst.as_ref().map(|worst| json!({
            "units": worst.units,
            "output": worst.output,
            "operands": worst.operands.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
        })),
        "f": one.core.contract.highlight().map(|_| spread::as_json(&outcome.histogram)),
        "rom_bits": one.core.design.rom_bits(),
        "holds": faults.is_empty(),
        "verdict": verdict(bound, faults),
        "faults": faults,
        "mismatch": mismatch.transpose()?,
    }))
}

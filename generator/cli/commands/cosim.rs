//! `cosim`.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::mismatch::{self, Reproducer};
use super::{Loaded, load};
use crate::cli::failure::Usage;
use crate::cli::{Output, Simulator, progress, tables};
use crate::cosim::external::{self, BenchOutcome};
use crate::cosim::{Outcome, Worst};
use crate::emit;
use crate::flow::TEST_POINTS;
use crate::golden::Bound;
use crate::registry::Registry;
use crate::words;

/// Points when an external simulator runs.
const EXTERNAL_POINTS: u64 = 200;

/// The most points for an external simulator, whose vectors are made in memory.
const EXTERNAL_LIMIT: u64 = 1_000_000;

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
        bail!(Usage(format!(
            "--vcd is for one configuration; here are {}",
            loaded.len()
        )));
    }
    let which = match request.simulator {
        Simulator::RustHdl => return built_in(output, &loaded, request),
        Simulator::Icarus => external::Simulator::Icarus,
        Simulator::Verilator => external::Simulator::Verilator,
    };
    if request.vcd.is_some() {
        bail!(Usage("--vcd is for the built-in simulator".to_owned()));
    }
    let points = request.points.unwrap_or(EXTERNAL_POINTS);
    if points > EXTERNAL_LIMIT {
        bail!(Usage(format!(
            "--points {points}: an external simulator takes at most {EXTERNAL_LIMIT}"
        )));
    }
    let bar = progress::bar(output, loaded.len() as u64, "benches run");
    let runs: Vec<(usize, BenchOutcome)> = loaded
        .par_iter()
        .map(|one| {
            let run = bench(one, which, points, request);
            bar.inc(1);
            run.with_context(|| format!("`{}`", one.path))
        })
        .collect::<Result<_>>()?;
    bar.finish_and_clear();
    let holds = runs.iter().all(|(_, run)| run.passed);
    if output.json {
        let list: Vec<Value> = loaded
            .iter()
            .zip(&runs)
            .map(|(one, (clocks, run))| {
                json!({
                    "config": one.path,
                    "simulator": format!("{:?}", request.simulator).to_lowercase(),
                    "points": points,
                    "clocks": clocks,
                    "passed": run.passed,
                    "transcript": run.transcript,
                })
            })
            .collect();
        tables::print_json(&json!({ "ok": holds, "configurations": list }));
        return Ok(holds);
    }
    for (one, (clocks, run)) in loaded.iter().zip(&runs) {
        let verdict = if run.passed { "holds" } else { "FAILS" };
        tables::print_line(&format!(
            "{}: {points} points, {clocks} clocks: {verdict}",
            one.path
        ));
        if !run.passed {
            tables::print_line(&run.transcript);
        }
    }
    Ok(holds)
}

/// The emitted bench in an external simulator. The expected values are those on which golden model
/// and built-in simulator agree.
fn bench(
    one: &Loaded,
    which: external::Simulator,
    points: u64,
    request: &CosimRequest,
) -> Result<(usize, BenchOutcome)> {
    let vectors = one.unit.vectors(points, request.seed)?;
    let clocks = vectors.inputs.len();
    let files = emit::sources(one.unit.files(&one.path, vectors)?);
    let top = format!("{}_tb", one.unit.config.name);
    let run = external::run_bench(which, &files, &top, request.time_limit)?;
    Ok((clocks, run))
}

fn built_in(output: Output, loaded: &[Loaded], request: &CosimRequest) -> Result<bool> {
    let points = request.points.unwrap_or(TEST_POINTS);
    let bar = progress::bar(
        output,
        points.saturating_mul(loaded.len() as u64),
        "points checked",
    );
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
        let bound = one.unit.contract.bound();
        let faults = outcome.faults(&bound);
        holds &= faults.is_empty();
        if output.json {
            list.push(as_json(one, outcome, &bound, &faults)?);
            continue;
        }
        tables::print_line(&format!(
            "{}: {} points, {} clocks; {} registers and {} outputs equal the golden model on each: {}",
            one.path,
            words::grouped(outcome.points),
            words::grouped(outcome.clocks),
            outcome.registers,
            outcome.outputs,
            if faults.is_empty() { "holds" } else { "FAILS" },
        ));
        if let Some(worst) = &outcome.worst {
            tables::print_line(&format!(
                "  largest error {:.3} units (bound {:.3}) at {}",
                worst.units,
                bound.units,
                place(one, worst)
            ));
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
    let lockstep = one.unit.lockstep(request.seed)?;
    let Some(path) = &request.vcd else {
        return lockstep.run(points, progress);
    };
    mismatch::traced(&lockstep, path, points, 0)
}

/// The operands of the largest error, as values.
pub fn place(one: &Loaded, worst: &Worst) -> String {
    let operands = one.unit.contract.operands();
    let values: Vec<String> = worst
        .operands
        .iter()
        .filter_map(|(name, raw)| {
            let operand = operands.iter().find(|operand| operand.name == *name)?;
            Some(format!(
                "{name}={}",
                operand.format.to_f64(i128::from(*raw))
            ))
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
        "device": one.unit.device.name,
        "config": one.path,
        "name": one.unit.config.name,
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
        "rom_bits": one.unit.design.rom_bits(),
        "holds": faults.is_empty(),
        "faults": faults,
        "mismatch": mismatch.transpose()?,
    }))
}

//! `cosim`.

use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::{Loaded, load};
use crate::cli::destination::Destination;
use crate::cli::failure::Usage;
use crate::cli::{Output, Simulator, progress, tables};
use crate::cosim::external::{self, BenchOutcome};
use crate::cosim::{Lockstep, Mismatch, Outcome, Worst};
use crate::flow::TEST_POINTS;
use crate::golden::Bound;
use crate::registry::Registry;

/// Points when an external simulator runs.
const EXTERNAL_POINTS: u64 = 200;

/// The most points for an external simulator, whose vectors are made in memory.
const EXTERNAL_LIMIT: u64 = 1_000_000;

/// Clocks in the waveform that ends with a difference.
const WINDOW: u64 = 64;

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
    let files = one.unit.files(&one.path, vectors)?;
    let files: Vec<(String, String)> = files
        .into_iter()
        .filter_map(|file| {
            let name = file.path.rsplit('/').next()?.to_owned();
            (name.ends_with(".v") || name.ends_with(".mem")).then_some((name, file.contents))
        })
        .collect();
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
        let faults = faults(outcome, &bound);
        holds &= faults.is_empty();
        if output.json {
            list.push(as_json(one, outcome, &bound, &faults));
            continue;
        }
        tables::print_line(&format!(
            "{}: {} points, {} clocks; {} registers and {} outputs equal the golden model on each: {}",
            one.path,
            tables::grouped(outcome.points),
            tables::grouped(outcome.clocks),
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
            tables::print_line(&format!("  {}", reproduce(one, mismatch)?));
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
    traced(&lockstep, path, points, 0)
}

/// Writes the waveform of the clocks before a difference into the working directory, and says how to see
/// all of it.
pub fn reproduce(one: &Loaded, mismatch: &Mismatch) -> Result<String> {
    let path = PathBuf::from(format!("{}_mismatch.vcd", one.unit.config.name));
    let lockstep = one.unit.lockstep(mismatch.seed)?;
    let (from, points) = window(&lockstep, &path, mismatch)?;
    Ok(format!(
        "`{}` shows clocks {from} to {}; all of them: glint cosim {} --seed {} --points {} --vcd FILE",
        path.display(),
        mismatch.clock,
        one.path,
        mismatch.seed,
        points + 1,
    ))
}

/// Writes the waveform of the clocks before a difference, which a lock-step of its seed shows again. The
/// first of the clocks, and the results seen before the difference.
pub fn window(lockstep: &Lockstep<'_>, path: &Path, mismatch: &Mismatch) -> Result<(u64, u64)> {
    let from = mismatch.clock.saturating_sub(WINDOW);
    let outcome = traced(lockstep, path, u64::MAX, from)?;
    Ok((from, outcome.points))
}

/// A run with a waveform from clock `from` on: written beside its place and moved there when it is whole.
fn traced(lockstep: &Lockstep<'_>, path: &Path, points: u64, from: u64) -> Result<Outcome> {
    let destination = Destination::open(path)?;
    let outcome = lockstep
        .trace(points, from, BufWriter::new(destination.file()?))
        .with_context(|| format!("cannot write the waveform `{}`", path.display()))?;
    destination.commit()?;
    Ok(outcome)
}

/// What does not hold.
pub fn faults(outcome: &Outcome, bound: &Bound) -> Vec<String> {
    let mut faults = Vec::new();
    if let Some(mismatch) = &outcome.mismatch {
        faults.push(difference(mismatch));
    }
    if let Some(worst) = &outcome.worst
        && worst.units > bound.units
    {
        faults.push(format!(
            "`{}` is off by {:.4} units, beyond the stated bound of {:.4}",
            worst.output, worst.units, bound.units
        ));
    }
    faults
}

/// Where and in what hardware and model differ.
pub fn difference(mismatch: &Mismatch) -> String {
    format!(
        "seed {}, after clock {}, word `{}`: `{}` is {:#x} in the simulated hardware and {:#x} in the golden model",
        mismatch.seed,
        mismatch.clock,
        mismatch.word,
        mismatch.signal,
        mismatch.simulated,
        mismatch.golden
    )
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

/// An outcome for scripts.
pub fn as_json(one: &Loaded, outcome: &Outcome, bound: &Bound, faults: &[String]) -> Value {
    let terms: Vec<Value> = bound
        .terms
        .iter()
        .map(|term| json!({ "key": term.key, "what": term.what, "units": term.units }))
        .collect();
    json!({
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
    })
}

//! `glint cosim --simulator`: runs the emitted test bench of a configuration in an external simulator.

use anyhow::{Context, Result};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::Arguments;
use crate::commands::Loaded;
use crate::commands::mismatch::{first_clock, waveform_of};
use crate::failure;
use crate::report::CommandReport;
use crate::{OutputOptions, destination, progress, say, tables, wrong_usage};
use glint_base::program::Program;
use glint_core::package::FileKind;
use glint_tools::{BenchDifference, BenchOutcome, VerilogSimulator, bench_waveform, run_bench};

/// The default number of results.
const POINTS: u64 = 200;

/// The largest number of results, because the vectors are made in memory.
const MOST_POINTS: u64 = 1_000_000;

struct BenchRun {
    clocks: usize,
    outcome: BenchOutcome,
    mismatch: Option<BenchMismatch>,
}

struct BenchMismatch {
    difference: BenchDifference,
    /// The path of the waveform; `None` if it could not be written.
    vcd: Option<String>,
    from: u64,
    command: String,
}

/// Runs the benches. Returns whether all pass.
///
/// # Errors
///
/// Fails for wrong usage, or if the simulator is missing, refuses a bench, or does not end within the time limit.
pub fn benches(
    output: OutputOptions,
    loaded: &[Loaded],
    arguments: &Arguments,
    which: VerilogSimulator,
) -> Result<bool> {
    if arguments.vcd.is_some() {
        wrong_usage!("--vcd works only with the built-in simulator: remove --vcd or --simulator");
    }
    let points = arguments.points.unwrap_or(POINTS);
    if points > MOST_POINTS {
        wrong_usage!("--points {points}: an external simulator takes at most {MOST_POINTS} points");
    }
    let bar = progress::bar(output, loaded.len() as u64, "benches run");
    let runs: Vec<BenchRun> = loaded
        .par_iter()
        .map(|one| {
            let run = bench(one, which, points, arguments);
            bar.inc(1);
            run.with_context(|| format!("`{}`", one.path))
        })
        .collect::<Result<_>>()?;
    bar.finish_and_clear();
    let holds = runs.iter().all(|run| run.outcome.passed);
    let mut list = output.list();
    for (one, run) in loaded.iter().zip(&runs) {
        list.add(&BenchReport { one, run, points, arguments, which })?;
    }
    list.conclude(holds)
}

struct BenchReport<'a> {
    one: &'a Loaded,
    run: &'a BenchRun,
    points: u64,
    arguments: &'a Arguments,
    which: VerilogSimulator,
}

impl CommandReport for BenchReport<'_> {
    fn json(&self) -> Result<Value> {
        Ok(as_json(self.one, self.run, self.points, self.arguments))
    }

    fn print(&self) -> Result<()> {
        print(self.one, self.run, self.points, self.arguments.seed, self.which);
        Ok(())
    }
}

/// Emits a bench with `points` results, and runs it in an external simulator. If the bench fails, also writes a waveform.
fn bench(
    one: &Loaded,
    which: VerilogSimulator,
    points: u64,
    arguments: &Arguments,
) -> Result<BenchRun> {
    let vectors = one.core.vectors(points, arguments.seed)?;
    let clocks = vectors.inputs.len();
    let emitted = one.files(vectors)?;
    let files = emitted.sources(FileKind::SIMULATED);
    let benches = emitted.modules(&[FileKind::Bench]);
    let top = benches.first().context("the core has no bench")?;
    let outcome = run_bench(which, &files, top, arguments.time_limit.get())?;
    let mismatch = BenchDifference::first(&outcome.transcript).map(|difference| {
        let from = first_clock(difference.clock);
        let clocks = (from, difference.clock);
        let path = waveform_of(one);
        let written = bench_waveform(which, &files, top, clocks, arguments.time_limit.get())
            .and_then(|waveform| destination::replace(&path, &waveform));
        if let Err(error) = &written {
            // The difference is more important than its waveform, so this is only a warning.
            failure::warn(&format!("{}: cannot write a waveform: {error:#}", one.path));
        }
        BenchMismatch {
            difference,
            vcd: written.is_ok().then(|| path.display().to_string()),
            from,
            command: format!(
                "{Program} cosim {} --simulator {} --seed {} --points {points}",
                one.path,
                name(arguments),
                arguments.seed
            ),
        }
    });
    Ok(BenchRun { clocks, outcome, mismatch })
}

fn name(arguments: &Arguments) -> String {
    format!("{:?}", arguments.simulator).to_lowercase()
}

fn print(one: &Loaded, run: &BenchRun, points: u64, seed: u64, which: VerilogSimulator) {
    let passed = run.outcome.passed;
    let verdict = if passed { "holds" } else { "FAILS" };
    say!("{}: {points} points, {} clocks: {verdict}", one.path, run.clocks);
    if !passed {
        tables::print_line(&run.outcome.transcript);
    }
    let Some(mismatch) = &run.mismatch else {
        return;
    };
    let BenchDifference { clock, during, signal, simulated, expected } = &mismatch.difference;
    let during = if during.is_empty() { String::new() } else { format!(", {during}") };
    say!(
        "  FAILS: seed {seed}, clock {clock}{during}: `{signal}` is {simulated} in {which} and {expected} in the golden model"
    );
    let window = mismatch.vcd.as_ref().map_or_else(String::new, |vcd| {
        format!("`{vcd}` shows clocks {} to {clock}; ", mismatch.from)
    });
    say!("  {window}to repeat: {}", mismatch.command);
}

fn as_json(one: &Loaded, run: &BenchRun, points: u64, arguments: &Arguments) -> Value {
    let mismatch = run.mismatch.as_ref().map(|mismatch| {
        let difference = &mismatch.difference;
        json!({
            "seed": arguments.seed,
            "clock": difference.clock,
            "during": difference.during,
            "signal": difference.signal,
            "golden": format!("0x{}", difference.expected),
            "simulated": format!("0x{}", difference.simulated),
            "vcd": mismatch.vcd,
            "reproduce": mismatch.command,
        })
    });
    json!({
        "config": one.path,
        "simulator": name(arguments),
        "points": points,
        "clocks": run.clocks,
        "passed": run.outcome.passed,
        "transcript": run.outcome.transcript,
        "mismatch": mismatch,
    })
}

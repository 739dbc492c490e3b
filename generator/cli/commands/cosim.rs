//! `glint cosim`: compares the golden model of a configuration with the simulated hardware at every clock. It compares every
//! output, and every architectural register or, in a pipeline, every checkpoint.

mod benches;
pub mod exhaustive;
mod spread;

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::mismatch::{self, Reproducer};
use super::{Loaded, load, verdict};
use crate::destination::Destination;
use crate::failure::Failure;
use crate::report::CommandReport;
use crate::{Configs, Force, OutputOptions, TimeLimit, count, progress, say, wrong_usage};
use benches::benches;
use glint_base::text;
use glint_core::core::{TEST_POINTS, TEST_SEED};
use glint_core::cosim::exhaustive::{AxisValues, Shard, axis};
use glint_core::cosim::{Outcome, Worst};
use glint_core::registry::Registry;
use glint_golden::{Bound, Bounds, Sweep, Term};
use glint_tools as tools;

/// Compare the golden model with the simulated hardware, every register on every clock
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint cosim                                             everything in configs/, built-in simulator
  glint cosim my_core.toml --points 1000000 --seed 7      more points, another stimulus
  glint cosim my_core.toml --simulator icarus --json      the emitted Verilog, result for scripts
  glint cosim my_core.toml --points 20 --vcd wave.vcd     a waveform for a viewer
  glint cosim my_core.toml --exhaustive                   the accuracy contract, all operands
  glint cosim configs/reduced/rough.toml --exhaustive     also every register on every clock")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
    /// Results to check for each configuration [default: 100000, or 200 with an external simulator]
    #[arg(long, value_name = "N", value_parser = count)]
    points: Option<u64>,
    /// Seed of the stimulus
    #[arg(long, value_name = "S", default_value_t = TEST_SEED)]
    seed: u64,
    /// The simulator of the hardware
    #[arg(long, value_enum, default_value_t = SimulatorChoice::RustHdl)]
    simulator: SimulatorChoice,
    /// Prove the accuracy contract instead: compute f for every combination of control operands, and the outputs for every f
    /// and every colour. If all operands together have at most 26 bits, also compare every register on every clock for every
    /// combination of operands
    #[arg(long, conflicts_with_all = ["points", "seed", "simulator", "vcd"])]
    exhaustive: bool,
    /// With --exhaustive: save progress in FILE, and continue from it
    #[arg(long, value_name = "FILE", requires = "exhaustive")]
    resume: Option<PathBuf>,
    /// With --exhaustive: compute only part I of N, for a job array; `glint merge` joins the parts
    #[arg(long, value_name = "I/N", requires = "exhaustive", requires = "resume")]
    shard: Option<Shard>,
    #[command(flatten)]
    sweep: SweepValues,
    /// Write a waveform (VCD) of one configuration (built-in simulator only), and next to it a view for GTKWave (.gtkw) and
    /// a view for Surfer (.sucl) unless these files exist
    #[arg(long, value_name = "FILE")]
    vcd: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    #[command(flatten)]
    time_limit: TimeLimit,
}

/// The values of an exhaustive check in place of the contract's.
#[derive(Args)]
pub struct SweepValues {
    /// Visit these raw values of an operand instead of the contract's values. For example, `cos_dgamma=1000,2000..3000/50`
    /// has 1000, and 2000 to 3000 in steps of 50; repeat the option for other operands
    #[arg(long = "values", value_name = "OPERAND=VALUES")]
    others: Vec<AxisValues>,
}

impl SweepValues {
    /// Returns the contract's sweep, in which the user's values replace the values of some operands.
    ///
    /// # Errors
    ///
    /// Fails with wrong usage if an operand is unknown or a value is not valid ([`axis::sweep`]).
    pub fn of(&self, one: &Loaded) -> Result<Sweep> {
        let sweep = axis::sweep(one.core.contract.as_ref(), &self.others);
        sweep.map_err(|error| {
            Failure::WrongUsage(format!("--values for `{}`: {error}", one.path)).into()
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SimulatorChoice {
    /// rust_hdl, the simulator that is built into this program
    RustHdl,
    /// Icarus Verilog, on the emitted files
    Icarus,
    /// Verilator, on the emitted files
    Verilator,
}

/// Runs the command. Returns whether all checks hold.
///
/// # Errors
///
/// Fails if a configuration has problems, if options contradict each other, if a tool is missing, or if a file cannot be
/// written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    if arguments.exhaustive {
        return exhaustive::run(registry, output, arguments);
    }
    if !arguments.sweep.others.is_empty() {
        wrong_usage!("--values works only with --exhaustive: add --exhaustive, or remove --values");
    }
    let loaded = load(registry, &arguments.configs.paths)?;
    if arguments.vcd.is_some() && loaded.len() != 1 {
        wrong_usage!(
            "--vcd needs exactly one configuration, and there are {}: name one configuration",
            loaded.len()
        );
    }
    if let Some(vcd) = &arguments.vcd
        && let Ok(there) = fs::canonicalize(vcd)
        && arguments.configs.paths.iter().any(|it| fs::canonicalize(it).is_ok_and(|it| it == there))
    {
        wrong_usage!("--vcd would overwrite the configuration `{}`", vcd.display());
    }
    let which = match arguments.simulator {
        SimulatorChoice::RustHdl => return built_in(output, &loaded, arguments),
        SimulatorChoice::Icarus => tools::VerilogSimulator::Icarus,
        SimulatorChoice::Verilator => tools::VerilogSimulator::Verilator,
    };
    benches(output, &loaded, arguments, which)
}

fn built_in(output: OutputOptions, loaded: &[Loaded], arguments: &Arguments) -> Result<bool> {
    let points = arguments.points.unwrap_or(TEST_POINTS);
    let bar = progress::bar(output, points.saturating_mul(loaded.len() as u64), "points checked");
    let outcomes: Vec<Outcome> = loaded
        .par_iter()
        .map(|one| {
            let progress = |points: u64| bar.inc(points);
            outcome(one, points, arguments, &progress).with_context(|| format!("`{}`", one.path))
        })
        .collect::<Result<_>>()?;
    bar.finish_and_clear();
    let mut holds = true;
    let mut list = output.list();
    for (one, outcome) in loaded.iter().zip(&outcomes) {
        let bounds = one.core.contract.bounds();
        let failures = outcome.failures(&bounds);
        holds &= failures.is_empty();
        list.add(&CheckedRun { one, outcome, bounds, failures })?;
    }
    list.conclude(holds)
}

struct CheckedRun<'a> {
    one: &'a Loaded,
    outcome: &'a Outcome,
    bounds: Bounds,
    failures: Vec<String>,
}

impl CommandReport for CheckedRun<'_> {
    fn json(&self) -> Result<Value> {
        as_json(self.one, self.outcome, &self.bounds, &self.failures)
    }

    fn print(&self) -> Result<()> {
        let Self { one, outcome, bounds, failures } = self;
        // A difference from the golden model ends the run. Other failures do not.
        let compared = if outcome.mismatch.is_none() { "equal" } else { "compared with" };
        say!(
            "{}: {} points, {} clocks; {} registers and {} outputs {compared} the golden model on each \
             clock: {}",
            one.path,
            text::grouped(outcome.points),
            text::grouped(outcome.clocks),
            outcome.registers,
            outcome.outputs,
            verdict(bounds, failures),
        );
        if let Some(worst) = &outcome.worst {
            let bound = bounds.of(&worst.output);
            say!(
                "  largest error {:.3} units (bound {}) at {}",
                worst.units,
                bound.map_or_else(|| bounds.words(), Bound::words),
                worst_operands(one, worst)
            );
        }
        if one.core.contract.highlight().is_some() {
            spread::print(&outcome.histogram);
        }
        for failure in failures {
            say!("  FAILS: {failure}");
        }
        if let Some(mismatch) = &outcome.mismatch {
            let reproducer = Reproducer::of_run(one, mismatch)?;
            say!("  {}", reproducer.text(mismatch));
        }
        Ok(())
    }
}

fn outcome(
    one: &Loaded,
    points: u64,
    arguments: &Arguments,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Outcome> {
    let lockstep = one.core.lockstep(arguments.seed)?;
    let Some(path) = &arguments.vcd else {
        return lockstep.run(points, progress);
    };
    let destination = Destination::fresh(path, arguments.force.force)?;
    mismatch::traced(one, &lockstep, destination, points, 0)
}

/// Returns the output and the largest error's operands, for example `red_out for cos_gamma=0.99 exponent=20`.
pub fn worst_operands(one: &Loaded, worst: &Worst) -> String {
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

pub(super) fn terms(bound: &Bound) -> Vec<Value> {
    let one = |term: &Term| json!({ "key": term.key, "what": term.what, "units": term.units });
    bound.terms.iter().map(one).collect()
}

/// Returns a run's result as JSON. If model and hardware differ, also writes a waveform into the working directory. `failed` has
/// the messages about requirements that the outcome does not meet.
///
/// # Errors
///
/// Fails if the waveform cannot be recorded or written.
pub fn as_json(
    one: &Loaded,
    outcome: &Outcome,
    bounds: &Bounds,
    failed: &[String],
) -> Result<Value> {
    let bound = bounds.governing();
    let mut outputs = serde_json::Map::new();
    for bound in &bounds.outputs {
        outputs.insert(
            bound.output.clone(),
            json!({ "units": bound.units, "limit": bound.limit, "terms": terms(bound) }),
        );
    }
    let mismatch = outcome.mismatch.as_ref().map(|mismatch| {
        let reproducer = Reproducer::of_run(one, mismatch)?;
        anyhow::Ok(reproducer.json(mismatch))
    });
    Ok(json!({
        "device": one.core.device().name,
        "config": one.path,
        "name": one.core.config().name,
        "points": outcome.points,
        "clocks": outcome.clocks,
        "registers": outcome.registers,
        "outputs": outcome.outputs,
        "bound": { "units": bound.units, "f": bounds.f, "terms": terms(bound), "outputs": outputs },
        "largest_error": outcome.worst.as_ref().map(|worst| json!({
            "units": worst.units,
            "output": worst.output,
            "operands": worst.operands.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
        })),
        "f": one.core.contract.highlight().map(|_| spread::as_json(&outcome.histogram)),
        "rom_bits": one.core.design.rom_bits(),
        "holds": failed.is_empty(),
        "verdict": verdict(bounds, failed),
        "faults": failed,
        "mismatch": mismatch.transpose()?,
    }))
}

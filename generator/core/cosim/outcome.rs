//! Defines the outcome of a co-simulation run: the number of results, the largest error, and the first signal on which golden
//! model and hardware differ.

use std::fmt;
use std::sync::Arc;

use super::histogram::Histogram;
use super::random::Random;
use super::recorded::Recording;
use glint_golden::{Bound, Bounds};

/// The rounding of the formulas' evaluation in f64, in units of the result's last bit. A measured error may exceed a proven
/// bound by this amount.
pub(super) const ROUNDING_OF_F64: f64 = 1e-6;

#[derive(Clone, Debug, Default)]
pub struct Outcome {
    pub points: u64,
    pub clocks: u64,
    /// The number of compared registers, or of a pipeline's checkpoints.
    pub registers: usize,
    pub outputs: usize,
    /// The largest error of an output against the formula in f64. `None` if no error was measured, for example for recorded
    /// inputs.
    pub worst: Option<Worst>,
    /// The number of results by the value of `f`. A device that is no highlight has only results outside the domain here.
    pub histogram: Histogram,
    /// The first difference between model and hardware, at which the run ended.
    pub mismatch: Option<Mismatch>,
}

impl Outcome {
    /// Joins the records of streams, up to and including the first stream that differs.
    pub(super) fn of(
        registers: usize,
        outputs: usize,
        streams: impl IntoIterator<Item = StreamRecord>,
    ) -> Self {
        let mut outcome = Self { registers, outputs, ..Self::default() };
        for seen in streams {
            outcome.points += seen.points;
            outcome.clocks += seen.clocks;
            outcome.histogram.merge(&seen.histogram);
            let weighted =
                |worst: &Option<Worst>| worst.as_ref().map_or(-1.0, |worst| worst.weighted);
            if weighted(&seen.worst) > weighted(&outcome.worst) {
                outcome.worst = seen.worst;
            }
            if seen.mismatch.is_some() {
                outcome.mismatch = seen.mismatch;
                break;
            }
        }
        outcome
    }

    /// Returns a sentence for each failure of the run: a difference between model and hardware, a formula without a finite
    /// value, or an error above the bound of its output by more than 10^−6 units, the rounding of the measurement.
    pub fn failures(&self, bounds: &Bounds) -> Vec<String> {
        let mut failures = Vec::new();
        if let Some(mismatch) = &self.mismatch {
            failures.push(format!(
                "seed {}, after clock {}, {mismatch}",
                mismatch.seed, mismatch.clock
            ));
        }
        if let Some(worst) = self.worst.as_ref().filter(|worst| worst.units.is_infinite()) {
            let operands = worst.operands.iter().map(|(name, raw)| format!("{name} = {raw}"));
            failures.push(format!(
                "the formula has no finite value for `{}` at the raw operands {}",
                worst.output,
                operands.collect::<Vec<_>>().join(", ")
            ));
        } else if let Some(worst) = &self.worst
            && let Some(Bound { units: own, .. }) = bounds.of(&worst.output)
            && worst.units > own + ROUNDING_OF_F64
        {
            failures.push(format!(
                "the error of `{}` is {:.6} units, above the stated bound of {own:.6}",
                worst.output, worst.units
            ));
        }
        failures
    }
}

/// The largest error of an output against the formula, and its operands.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// The error in output units; infinite if the formula has no value at the operands.
    pub units: f64,
    /// The error in units, multiplied by the weight of the output (`Bounds::weights`), by which errors of different outputs
    /// are compared.
    pub weighted: f64,
    pub output: String,
    /// The raw operands, each with its name.
    pub operands: Vec<(String, i64)>,
}

/// A signal on which golden model and hardware differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// The seed of the stream. An undivided run with this seed, such as [`Lockstep::trace`](super::Lockstep::trace), has the
    /// same inputs. In a run of all combinations, the number of the combination; in a run of recorded inputs, 0.
    pub seed: u64,
    /// The number of rising clock edges of the stream, from power-up to the difference.
    pub clock: u64,
    pub signal: String,
    /// The golden model's value, a bit pattern.
    pub golden: u64,
    /// The simulated hardware's value, a bit pattern.
    pub simulated: u64,
    /// For a core, the microinstruction that was executed at the edge: ``microinstruction `count` ``. For a pipeline, the
    /// stage of the signal: `stage 3`.
    pub during: String,
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: `{}` is {:#x} in the simulated hardware and {:#x} in the golden model",
            self.during, self.signal, self.simulated, self.golden
        )
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct StreamRecord {
    pub(super) points: u64,
    pub(super) clocks: u64,
    pub(super) worst: Option<Worst>,
    pub(super) histogram: Histogram,
    pub(super) mismatch: Option<Mismatch>,
    /// The control operands of the latest result, and the formula's values for it, kept to avoid new allocations.
    pub(super) point: Vec<i64>,
    pub(super) exact: Vec<[f64; 2]>,
}

/// Returns the seed of stream `number` of a run with the seed `seed`. Stream 0 has the seed of the run.
pub(super) fn stream_seed(seed: u64, number: u64) -> u64 {
    if number == 0 {
        seed
    } else {
        // The seeds are drawn, so that the streams are at distant positions in the generator's cycle.
        Random::new(seed ^ number.wrapping_mul(0xd134_2543_de82_ef95)).bits()
    }
}

/// Returns the number of points of stream `number`: 10 points in 4 streams are 3, 3, 2 and 2.
pub(super) fn share(points: u64, streams: u64, number: u64) -> u64 {
    points / streams + u64::from(number < points % streams)
}

#[derive(Clone, Debug)]
pub(super) enum Course {
    /// Random inputs, until `points` results were compared.
    Random { seed: u64, points: u64 },
    /// The combinations of operands at `count` places, from place `first` on.
    Combinations { first: u64, count: u64 },
    /// Recorded inputs, again and again, for `clocks` clocks.
    Recorded { recording: Arc<Recording>, clocks: u64 },
}

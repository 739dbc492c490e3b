//! Compares every signal that the golden model predicts at every clock, for every combination of operands. In a sequential
//! core, the signals are the outputs and all architectural registers; in a pipeline, the outputs and the checkpoints.
//!
//! This check is feasible only for devices whose operands have at most 26 bits in total; a device of full width is checked
//! through a narrow configuration. The combinations are divided into numbered blocks, and the result does not depend on the
//! order of the blocks. Each lane of a simulator runs 512 consecutive combinations from power-up on, and each computation
//! begins with the register values of the previous computation.

use std::fmt;
use std::io::Write;
use std::ops::Range;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::cosim::binding::Binding;
use crate::cosim::lockstep::LANES;
use crate::cosim::outcome::{Course, Mismatch};
use crate::cosim::runner::Runner;
use glint_base::program::Program;
use glint_golden::{Contract, Model};
use glint_rtl::netlist::Design;

/// The largest total number of operand bits for which all combinations are run. For more bits this would take too long.
pub const MOST_BITS: u32 = 26;

/// The number of combinations that one lane runs from power-up on.
const RUN: u64 = 512;

const BLOCK: u64 = RUN * LANES as u64;

/// The progress of a shard in the clock-by-clock comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Steps {
    /// The number of finished blocks, which are the first blocks of the shard.
    pub done: u64,
    /// The number of the first combination for which model and hardware differ; `None` if they agree so far. After a
    /// difference, the shard counts as done, and later combinations are not checked.
    pub differs: Option<u64>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The number of the combination, which is its position in the order of the check.
    pub place: u64,
    /// The number of clocks since `start`, which is 0 in the clock that takes `start`.
    pub clock: u64,
    /// The operands of the combination: each name with its bit pattern.
    pub operands: Vec<(String, u64)>,
    /// The signal that differs, with its value in the model and in the hardware. The clock in this field is counted from the
    /// power-up of the simulated instance.
    pub mismatch: Mismatch,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let operands = self.operands.iter();
        let operands: Vec<String> =
            operands.map(|(name, bits)| format!("{name}={bits:#x}")).collect();
        write!(
            f,
            "combination {} ({}), clock {} of the computation, {}",
            self.place,
            operands.join(" "),
            self.clock,
            self.mismatch
        )
    }
}

/// The comparison of a design with its golden model for every combination of operands. A core computes one combination after
/// another; a pipeline takes a combination in every clock in which it is ready.
pub struct Clocks<'a> {
    binding: Binding<'a>,
}

impl<'a> Clocks<'a> {
    /// Fails if model and design do not have the same signals, or if design and contract do not have the same operands and
    /// outputs.
    pub fn new(
        design: &'a Design,
        model: Box<dyn Model>,
        contract: &'a dyn Contract,
    ) -> Result<Self> {
        Ok(Self { binding: Binding::new(design, model, contract)? })
    }

    /// Fixes operands at raw values, so that the combinations vary only the operands that `held` does not name.
    #[must_use]
    pub fn holding(self, held: &[(String, i64)]) -> Self {
        Self { binding: self.binding.holding(held) }
    }

    pub fn bits(&self) -> u32 {
        self.binding.space.bits()
    }

    /// Returns the number of combinations, or 0 if there are too many to run all.
    pub fn count(&self) -> u64 {
        match self.bits() {
            bits @ ..=MOST_BITS => 1 << bits,
            _ => 0,
        }
    }

    /// Names the gaps of the check: why the combinations are not run, or which inputs only random tests cover.
    pub fn omits(&self) -> String {
        match self.count() {
            0 => format!(
                "registers at every clock: the operands have {} bits, and all combinations are gone through for up to {MOST_BITS}, of a narrower configuration of the device",
                self.bits()
            ),
            _ if self.binding.is_pipeline() => format!(
                "pauses between points, results that wait, resets with points on their way; `{Program} cosim` draws these at \
                 random"
            ),
            _ => format!(
                "idle gaps, operands written one by one, writes and starts while busy, resets within a computation, and other contents of the registers before it than those that one other computation leaves; `{Program} cosim` draws these at random"
            ),
        }
    }

    pub fn blocks(&self) -> u64 {
        self.count().div_ceil(BLOCK)
    }

    fn of_block(&self, block: u64) -> Range<u64> {
        block * BLOCK..((block + 1) * BLOCK).min(self.count())
    }

    pub(super) fn visits(&self, blocks: impl Iterator<Item = u64>) -> u64 {
        blocks.map(|block| self.of_block(block)).map(|places| places.end - places.start).sum()
    }

    /// Checks the blocks with the given numbers, which must ascend, on all threads of rayon's pool. Returns the number of the
    /// first combination for which model and hardware differ. Calls `progress` with the number of combinations in
    /// each finished block.
    ///
    /// # Errors
    /// Fails if the design cannot be simulated, if its signals do not settle in a clock, or if the golden model of a pipeline
    /// does not finish a computation.
    pub fn check(&self, blocks: Vec<u64>, progress: &(dyn Fn(u64) + Sync)) -> Result<Option<u64>> {
        let found = blocks.into_par_iter().find_map_first(|block| {
            let places = self.of_block(block);
            let count = places.end - places.start;
            let found = self.first(places);
            progress(count);
            found.transpose()
        });
        found.transpose()
    }

    fn first(&self, places: Range<u64>) -> Result<Option<u64>> {
        let runs =
            places.clone().step_by(RUN as usize).map(|first| (first, RUN.min(places.end - first)));
        self.first_of(runs)
    }

    fn first_of(&self, runs: impl Iterator<Item = (u64, u64)>) -> Result<Option<u64>> {
        let courses = runs.map(|(first, count)| Course::Combinations { first, count });
        let mut lanes = Runner::<LANES>::new(&self.binding, courses)?;
        while !lanes.ended() {
            lanes.run()?;
        }
        let mismatch = lanes.into_seen()?.into_iter().find_map(|seen| seen.mismatch);
        Ok(mismatch.map(|mismatch| mismatch.seed))
    }

    /// Runs combination number `place` again, for which [`Clocks::check`] found a difference, and returns the details. The run
    /// must begin with the first combination of the same lane, because registers keep values between computations.
    ///
    /// # Errors
    /// Fails if there is no combination `place`, if nothing differs for it, or if the design cannot be simulated.
    pub fn difference(&self, place: u64) -> Result<Difference> {
        let mut alone = self.alone(place)?;
        alone.go_on(u64::MAX)?;
        let found = alone.first();
        let mismatch = found.seen.mismatch.clone().filter(|mismatch| mismatch.seed == place);
        Ok(Difference {
            place,
            clock: found.since_start,
            operands: self.binding.space.named(place),
            mismatch: mismatch
                .with_context(|| format!("nothing differs at combination {place}"))?,
        })
    }

    /// Writes a waveform (VCD) that ends with the difference in combination number `place`, and begins with clock `from` after
    /// power-up.
    ///
    /// # Errors
    /// Fails if there is no combination `place`, if the design cannot be simulated, or if the file cannot be written. If nothing
    /// differs, the waveform ends after the combination.
    pub fn trace(&self, place: u64, from: u64, file: impl Write + Send + 'static) -> Result<()> {
        self.alone(place)?.trace(from, file)
    }

    /// Returns a runner of one instance for the combinations of the lane up to and including `place`.
    fn alone(&self, place: u64) -> Result<Runner<'_, 1>> {
        ensure!(place < self.count(), "there is no combination {place}");
        let first = place - place % RUN;
        let course = Course::Combinations { first, count: place - first + 1 };
        Runner::new(&self.binding, [course])
    }

    pub(super) fn pace(&self) -> Result<Duration> {
        let places = 0..self.count().min(BLOCK / 8);
        let count = places.end as u32;
        let runs = places.step_by(RUN as usize / 8).map(|first| (first, RUN / 8));
        let begin = Instant::now();
        self.first_of(runs)?;
        Ok(begin.elapsed() / count)
    }
}

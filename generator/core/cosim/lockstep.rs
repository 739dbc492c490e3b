//! Simulates a design and its golden model side by side, and compares every predicted signal at every clock.
//!
//! A run is divided into *streams*, each with its own seed for random inputs and its share of the compared results. Each stream
//! starts at power-up. The division depends on the design, the seed of the run and the number of results, but not on the number
//! of threads. The outcome joins the streams in order, up to the first stream in which model and hardware differ.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use anyhow::{Result, bail, ensure};
use rayon::prelude::*;

use super::binding::Binding;
use super::outcome::{Course, Outcome, StreamRecord, share, stream_seed};
use super::recorded::Recording;
use super::runner::Runner;
use crate::observation::Vectors;
use glint_golden::{Contract, Model};
use glint_rtl::netlist::Design;
use glint_rtl::sim::Simulator;

/// The largest number of streams that share a simulator.
pub(super) const LANES: usize = 32;

/// The number of streams of a run of middle length, enough for two threads. A longer run has a multiple of this number.
const STREAMS: u64 = 2 * LANES as u64;

/// The smallest number of results in a stream of a sequential core.
const FEWEST_POINTS: u64 = 64;

/// The smallest length of a stream, in computations with the largest number of results. For example, a stream has at least 2000
/// results if a line has up to 1000 points.
const COMPUTATIONS: u64 = 2;

/// The smallest number of results in a stream, in a run with more than [`STREAMS`] streams.
const MANY_POINTS: u64 = 1024;

/// The smallest number of streams of a divided run. A run with too few results for this number has only one stream.
const FEWEST_STREAMS: u64 = 8;

/// The largest number of results in a stream of a pipeline, and the smallest number of streams of a divided run.
const PIPELINE_POINTS: u64 = 2048;
const FEWEST_PIPELINES: u64 = 4;

/// The number of results after which the progress is reported.
const TOLD: u64 = 1024;

/// The comparison of a design with its golden model, which run side by side on the same inputs.
pub struct Lockstep<'a> {
    binding: Binding<'a>,
    seed: u64,
}

impl<'a> Lockstep<'a> {
    /// Matches the signals of the golden model with the ports and registers of `design` by name. `seed` determines the random
    /// inputs of all runs.
    ///
    /// # Errors
    /// Fails if model and design do not have the same signals, or if design and contract do not have the same operands and
    /// outputs.
    pub fn new(
        design: &'a Design,
        model: Box<dyn Model>,
        contract: &'a dyn Contract,
        seed: u64,
    ) -> Result<Self> {
        Ok(Self { binding: Binding::new(design, model, contract)?, seed })
    }

    /// Fixes operands at raw values. Random inputs still have other values for these operands now and then.
    #[must_use]
    pub fn holding(self, held: &[(String, i64)]) -> Self {
        Self { binding: self.binding.holding(held), ..self }
    }

    /// Limits the randomly drawn lines to at most `results` results for one `start`.
    #[must_use]
    pub fn with_lines_of(mut self, results: i64) -> Self {
        self.binding.shorten(results);
        self
    }

    /// Compares random computations until `points` results were compared, or until model and hardware differ. A run of few
    /// results is one stream on one thread; a longer run has several streams, on all threads of rayon's pool. The function
    /// calls `progress` now and then with the number of results since the last call.
    ///
    /// # Errors
    /// Fails if the design cannot be simulated, or if its signals do not settle in a clock. A difference between model and
    /// hardware is part of the outcome, not an error.
    pub fn run(&self, points: u64, progress: &(dyn Fn(u64) + Sync)) -> Result<Outcome> {
        let streams = self.streams(points);
        // The number of the first stream that is known to differ. Streams after it are not needed.
        let differs = AtomicU64::new(u64::MAX);
        if streams == 1 {
            let course = self.course(points, 1, 0);
            return Ok(self.outcome(self.group::<1>([course], 0, &differs, progress)?));
        }
        let together = streams.div_ceil(2).min(LANES as u64);
        let groups = (0..streams.div_ceil(together)).into_par_iter().map(|group| {
            let first = group * together;
            let numbers = first..streams.min(first + together);
            let courses = numbers.map(|number| self.course(points, streams, number));
            self.group::<LANES>(courses, first, &differs, progress)
        });
        let records: Vec<Vec<StreamRecord>> = groups.collect::<Result<_>>()?;
        Ok(self.outcome(records.into_iter().flatten()))
    }

    /// Runs streams in one simulator; the first of them has number `first` in the run. The function stops early if an earlier
    /// stream differs, because the outcome then does not need these streams.
    fn group<const L: usize>(
        &self,
        courses: impl IntoIterator<Item = Course>,
        first: u64,
        differs: &AtomicU64,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Vec<StreamRecord>> {
        if differs.load(Ordering::Relaxed) < first {
            return Ok(Vec::new());
        }
        let mut group = Runner::<L>::new(&self.binding, courses)?;
        let mut points = 0;
        while !group.ended() && differs.load(Ordering::Relaxed) >= first {
            points += group.run()?;
            if points >= TOLD {
                progress(std::mem::take(&mut points));
            }
        }
        progress(points);
        if let Some(at) = group.first_that_differs() {
            differs.fetch_min(first + at as u64, Ordering::Relaxed);
        }
        group.into_seen()
    }

    /// Does the same as [`Lockstep::run`] in one stream, from a single power-up.
    ///
    /// # Errors
    /// Fails if the design cannot be simulated.
    pub fn run_alone(&self, points: u64) -> Result<Outcome> {
        let mut alone = self.alone(points)?;
        alone.go_on(u64::MAX)?;
        Ok(self.outcome(alone.into_seen()?))
    }

    /// Runs the streams of a run of `points` results in simulators of their own, which the caller observes. `begin` makes an
    /// observer from the seed of a stream. After each clock, `note` gets the observer, the number of results of the stream so
    /// far, and the simulator. Returns the observers in the order of the streams.
    ///
    /// # Errors
    /// Fails if the design cannot be simulated. A difference between model and hardware is not reported.
    pub fn watch<W: Send>(
        &self,
        points: u64,
        begin: impl Fn(u64) -> W + Sync,
        note: impl Fn(&mut W, u64, &Simulator) + Sync,
    ) -> Result<Vec<W>> {
        let streams = self.streams(points);
        (0..streams)
            .into_par_iter()
            .map(|number| {
                let mut watch = begin(stream_seed(self.seed, number));
                let mut alone =
                    Runner::<1>::new(&self.binding, [self.course(points, streams, number)])?;
                while !alone.ended() {
                    alone.run()?;
                    let points = alone.first().seen.points;
                    note(&mut watch, points, &alone.simulator);
                }
                Ok(watch)
            })
            .collect()
    }

    /// Records the inputs of every clock of a test bench, and the outputs just before the clock's edge. The record begins with
    /// random computations that have `points` results in all. The given `computations` follow: raw operands, in the order of
    /// `Contract::operands`.
    ///
    /// # Errors
    /// Fails if golden model and simulation differ, or if the design cannot be simulated.
    pub fn record(&self, points: u64, computations: &[Vec<i64>]) -> Result<Vectors> {
        let mut alone = self.alone(points)?;
        let mut vectors = Vectors::default();
        self.add(&mut vectors, &mut alone)?;
        // A pipeline runs on until no point is inside it.
        if self.binding.is_pipeline() || !computations.is_empty() {
            alone.first().follow(&self.binding, computations);
            self.add(&mut vectors, &mut alone)?;
        }
        Ok(vectors)
    }

    fn add(&self, vectors: &mut Vectors, alone: &mut Runner<'_, 1>) -> Result<()> {
        let valid = self.binding.ports.valid;
        while !alone.ended() {
            alone.prepare()?;
            alone.simulator.settle()?;
            let before = alone.simulator.value(valid) == 1;
            let outputs = self.binding.outputs.iter();
            vectors.expected.push(outputs.map(|&net| alone.simulator.value(net)).collect());
            vectors.inputs.push(alone.first().inputs().to_vec());
            alone.simulate()?;
            // From here on, the outputs do not depend on the state at power-up. In a core this holds from the first result on,
            // and in a pipeline from the clock after it.
            let after = alone.simulator.value(valid) == 1;
            let shown = if self.binding.is_pipeline() { before } else { after };
            if vectors.known_from == 0 && shown {
                vectors.known_from = vectors.expected.len();
            }
        }
        if let Some(mismatch) = &alone.first().seen.mismatch {
            bail!(
                "golden model and simulation differ (seed {}, after clock {}): {mismatch}",
                mismatch.seed,
                mismatch.clock
            );
        }
        Ok(())
    }

    /// Runs golden model and simulation from power-up on with recorded inputs, for example from [`Lockstep::record`].
    /// `streams` has the inputs by stream, clock and input port. Each stream runs for `clocks` clocks, and repeats its
    /// recording. Results are not compared with the formula.
    ///
    /// # Errors
    /// Fails if the design cannot be simulated, if a stream has no clock, or if a clock has more or fewer inputs than the
    /// design.
    pub fn replay(&self, streams: &[Vec<Vec<u64>>], clocks: u64) -> Result<Outcome> {
        let inputs = self.binding.ports.inputs;
        for (number, stream) in streams.iter().enumerate() {
            ensure!(!stream.is_empty(), "recorded stream {number} has no clock");
            let wrong = stream.iter().position(|clock| clock.len() != inputs);
            if let Some(clock) = wrong {
                let found = stream[clock].len();
                bail!("clock {clock} of recorded stream {number} has {found} inputs, not {inputs}");
            }
        }
        let nowhere = AtomicU64::new(u64::MAX);
        let groups = streams.par_chunks(LANES).map(|streams| {
            let courses = streams.iter().map(|inputs| Course::Recorded {
                recording: Arc::new(Recording::new(inputs)),
                clocks,
            });
            self.group::<LANES>(courses, 0, &nowhere, &|_| ())
        });
        let records: Vec<Vec<StreamRecord>> = groups.collect::<Result<_>>()?;
        Ok(self.outcome(records.into_iter().flatten()))
    }

    /// Does the same as [`Lockstep::run`] in one stream, and writes its waveform (VCD) to `file`, from clock `from` on.
    ///
    /// # Errors
    /// Fails if the design cannot be simulated, or if the file cannot be written.
    pub fn trace(
        &self,
        points: u64,
        from: u64,
        file: impl Write + Send + 'static,
    ) -> Result<Outcome> {
        let mut alone = self.alone(points)?;
        alone.trace(from, file)?;
        Ok(self.outcome(alone.into_seen()?))
    }

    fn alone(&self, points: u64) -> Result<Runner<'_, 1>> {
        Runner::new(&self.binding, [self.course(points, 1, 0)])
    }

    /// Returns the random inputs of stream `number`: its seed and its share of the `points` results.
    fn course(&self, points: u64, streams: u64, number: u64) -> Course {
        Course::Random {
            seed: stream_seed(self.seed, number),
            points: share(points, streams, number),
        }
    }

    fn outcome(&self, streams: impl IntoIterator<Item = StreamRecord>) -> Outcome {
        Outcome::of(self.binding.registers, self.binding.outputs.len(), streams)
    }

    /// Returns the number of streams of a run of `points` results.
    fn streams(&self, points: u64) -> u64 {
        if self.binding.is_pipeline() {
            let streams = points.div_ceil(PIPELINE_POINTS);
            return if streams < FEWEST_PIPELINES { 1 } else { streams };
        }
        let fewest = FEWEST_POINTS.max(self.binding.longest().saturating_mul(COMPUTATIONS));
        match points / fewest {
            ..FEWEST_STREAMS => 1,
            most @ ..STREAMS => most,
            _ => STREAMS * (points / (STREAMS * MANY_POINTS.max(fewest))).max(1),
        }
    }
}

//! Golden model and simulated hardware side by side, every signal compared on every clock.
//!
//! A run is divided into *streams*: each starts at power-up, with a stimulus of its own. How many there
//! are, their seeds and their points depend on the seed and the points of the run alone. Up to [`LANES`] of
//! them go through one simulator together, and as many simulators run as there are threads; neither
//! has any influence on what is found. What counts is what streams showed in their order up to the
//! first that differs.

use std::io::Write;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use anyhow::{Result, bail, ensure};
use rayon::prelude::*;

use super::alone::Alone;
use super::binding::Binding;
use super::outcome::{Course, Outcome, Seen, share, stream_seed};
use super::recorded::Recording;
use super::together::Together;
use crate::golden::{Contract, Model};
use crate::hdl::netlist::Design;
use crate::hdl::sim::Simulator;
use crate::package::Vectors;

/// Streams that share a simulator.
pub(super) const LANES: usize = 32;

/// The number of streams that keeps two threads busy. A longer run has a multiple of it.
const STREAMS: u64 = 2 * LANES as u64;

/// The fewest points of a stream.
const FEWEST_POINTS: u64 = 64;

/// A stream has at least as many points as this number of the longest computations has results.
const COMPUTATIONS: u64 = 2;

/// The fewest points of a stream where there are more than [`STREAMS`].
const MANY_POINTS: u64 = 1024;

/// A run of fewer streams is not divided.
const FEWEST_STREAMS: u64 = 8;

/// Golden model and simulator of a design with a microprogram.
pub(super) struct Sequential<'a> {
    binding: Binding<'a>,
    seed: u64,
}

impl<'a> Sequential<'a> {
    /// Model and simulator of a design, paired by the names of ports and registers.
    ///
    /// # Errors
    /// A name of one side that the other does not have.
    pub fn new(
        design: &'a Design,
        model: Box<dyn Model>,
        contract: &'a dyn Contract,
        seed: u64,
    ) -> Result<Self> {
        let binding = Binding::new(design, model, contract)?;
        Ok(Self { binding, seed })
    }

    /// Holds some operands mostly at these raw values: the stimulus seldom draws others for them.
    #[must_use]
    pub fn holding(self, held: &[(String, i64)]) -> Self {
        Self { binding: self.binding.holding(held), ..self }
    }

    /// Runs until `points` results were seen or something differs, on all threads of rayon's pool.
    ///
    /// `progress` is called now and then with the number of points since its last call.
    ///
    /// # Errors
    /// A design that cannot be simulated, or does not settle.
    pub fn run(&self, points: u64, progress: &(dyn Fn(u64) + Sync)) -> Result<Outcome> {
        let streams = streams(points, self.binding.longest());
        if streams == 1 {
            let alone = self.alone(points)?;
            return Ok(self.outcome([alone.run(progress)?]));
        }
        // The first stream known to differ: those after it are of no interest.
        let differs = AtomicU64::new(u64::MAX);
        let together = streams.div_ceil(2).min(LANES as u64);
        let groups: Vec<Vec<Seen>> = (0..streams.div_ceil(together))
            .into_par_iter()
            .map(|group| {
                let first = group * together;
                let group = first..streams.min(first + together);
                self.group(points, group, streams, &differs, progress)
            })
            .collect::<Result<_>>()?;
        Ok(self.outcome(groups.into_iter().flatten()))
    }

    /// The streams of these numbers; cut short when one before them differs.
    fn group(
        &self,
        points: u64,
        numbers: Range<u64>,
        streams: u64,
        differs: &AtomicU64,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Vec<Seen>> {
        let first = numbers.start;
        if differs.load(Ordering::Relaxed) < first {
            return Ok(Vec::new());
        }
        let courses = numbers.map(|number| self.stream(points, streams, number));
        let mut group = Together::<LANES>::new(&self.binding, courses)?;
        while !group.ended() && differs.load(Ordering::Relaxed) >= first {
            progress(group.run()?);
        }
        if let Some(at) = group.first_that_differs() {
            differs.fetch_min(first + at as u64, Ordering::Relaxed);
        }
        group.into_seen()
    }

    /// See [`Lockstep::replay`](super::Lockstep::replay).
    ///
    /// # Errors
    /// As of [`Sequential::run`]; a stream without a clock, or a clock with more or fewer inputs than the design.
    pub fn replay(&self, streams: &[Vec<Vec<u64>>], clocks: u64) -> Result<Outcome> {
        let inputs = self.binding.design.inputs().count();
        for (number, stream) in streams.iter().enumerate() {
            ensure!(!stream.is_empty(), "recorded stream {number} has no clock");
            let wrong = stream.iter().position(|clock| clock.len() != inputs);
            if let Some(clock) = wrong {
                let found = stream[clock].len();
                bail!(
                    "clock {clock} of recorded stream {number} has {found} inputs and not {inputs}"
                );
            }
        }
        let course = |inputs: &Vec<Vec<u64>>| Course::Recorded {
            recording: Arc::new(Recording::new(inputs)),
            clocks,
        };
        let groups: Vec<Vec<Seen>> = streams
            .par_chunks(LANES)
            .map(|streams| {
                let mut group = Together::<LANES>::new(&self.binding, streams.iter().map(course))?;
                while !group.ended() {
                    group.run()?;
                }
                group.into_seen()
            })
            .collect::<Result<_>>()?;
        Ok(self.outcome(groups.into_iter().flatten()))
    }

    /// One stream of `points` points under the seed of the run.
    fn alone(&self, points: u64) -> Result<Alone<'_>> {
        let seed = self.seed;
        Alone::new(&self.binding, Course::Random { seed, points })
    }

    /// One of the streams of a run.
    fn stream(&self, points: u64, streams: u64, number: u64) -> Course {
        Course::Random {
            seed: stream_seed(self.seed, number),
            points: share(points, streams, number),
        }
    }

    fn outcome(&self, streams: impl IntoIterator<Item = Seen>) -> Outcome {
        Outcome::of(self.binding.registers(), self.binding.outputs.len(), streams)
    }

    /// As [`Sequential::run`], in one stream.
    ///
    /// # Errors
    /// As of [`Sequential::run`].
    pub fn run_alone(&self, points: u64) -> Result<Outcome> {
        Ok(self.outcome([self.alone(points)?.run(&|_| ())?]))
    }

    /// Goes through the streams of a run of `points` results, each alone. `begin` makes what watches a stream,
    /// of its seed; after each clock `note` shows it the results so far and the simulator. They come back
    /// in the order of the streams.
    ///
    /// # Errors
    /// As of [`Sequential::run`].
    pub fn watch<W: Send>(
        &self,
        points: u64,
        begin: impl Fn(u64) -> W + Sync,
        note: impl Fn(&mut W, u64, &Simulator) + Sync,
    ) -> Result<Vec<W>> {
        let streams = streams(points, self.binding.longest());
        (0..streams)
            .into_par_iter()
            .map(|number| {
                let mut watch = begin(stream_seed(self.seed, number));
                let course = self.stream(points, streams, number);
                let mut alone = Alone::new(&self.binding, course)?;
                while !alone.ended() {
                    alone.clock()?;
                    note(&mut watch, alone.seen().points, &alone.simulator);
                }
                Ok(watch)
            })
            .collect()
    }

    /// See [`Lockstep::record`](super::Lockstep::record).
    ///
    /// # Errors
    /// Golden model and simulation differ; a design that cannot be simulated, or does not settle.
    pub fn record(&self, points: u64, computations: &[Vec<i64>]) -> Result<Vectors> {
        let mut alone = self.alone(points)?;
        let mut vectors = Vectors::default();
        self.add(&mut vectors, &mut alone)?;
        if !computations.is_empty() {
            alone.follow(self.binding.listed(computations));
            self.add(&mut vectors, &mut alone)?;
        }
        Ok(vectors)
    }

    /// Limits lines to at most `results` results.
    #[must_use]
    pub fn with_lines_of(mut self, results: i64) -> Self {
        self.binding.shorten(results);
        self
    }

    /// The clocks of a stream to its end.
    fn add(&self, vectors: &mut Vectors, alone: &mut Alone<'_>) -> Result<()> {
        while !alone.ended() {
            let outputs = self.binding.outputs.iter();
            let outputs = outputs.map(|&net| alone.simulator.value(net)).collect();
            vectors.expected.push(outputs);
            let before = alone.seen().points;
            vectors.inputs.push(alone.clock()?);
            if before == 0 && alone.seen().points == 1 {
                vectors.known_from = vectors.expected.len();
            }
        }
        if let Some(mismatch) = &alone.seen().mismatch {
            bail!(
                "golden model and simulation differ (seed {}, after clock {}): {mismatch}",
                mismatch.seed,
                mismatch.clock
            );
        }
        Ok(())
    }

    /// As [`Sequential::run`], in one stream, of which `file` takes the waveform from clock `from` on.
    ///
    /// # Errors
    /// As of [`Sequential::run`]; the file cannot be written.
    pub fn trace(
        &self,
        points: u64,
        from: u64,
        file: impl Write + Send + 'static,
    ) -> Result<Outcome> {
        let mut alone = self.alone(points)?;
        while !alone.ended() && alone.seen().clocks < from {
            alone.clock()?;
        }
        alone.simulator.trace(file)?;
        while !alone.ended() {
            alone.clock()?;
        }
        alone.simulator.end_trace()?;
        Ok(self.outcome([alone.seen().clone()]))
    }
}

/// Into how many streams a run is divided, when a computation has up to `longest` results.
fn streams(points: u64, longest: u64) -> u64 {
    let fewest = FEWEST_POINTS.max(longest.saturating_mul(COMPUTATIONS));
    match points / fewest {
        ..FEWEST_STREAMS => 1,
        most @ ..STREAMS => most,
        _ => STREAMS * (points / (STREAMS * MANY_POINTS.max(fewest))).max(1),
    }
}

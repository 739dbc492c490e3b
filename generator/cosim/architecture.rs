//! Golden model and simulated hardware side by side, whatever the architecture.

use std::io::Write;

use anyhow::{Result, bail};

use super::lockstep::Sequential;
use super::outcome::Outcome;
use super::pipelined::Pipelined;
use crate::golden::{Contract, Model};
use crate::hdl::netlist::Design;
use crate::hdl::sim::Simulator;
use crate::package::Vectors;

/// Golden model and simulator of one design.
pub struct Lockstep<'a>(Architecture<'a>);

enum Architecture<'a> {
    Sequential(Sequential<'a>),
    Pipelined(Pipelined<'a>),
}

use Architecture::{Pipelined as Pipe, Sequential as Core};

impl<'a> Lockstep<'a> {
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
        Ok(Self(match &design.pipeline {
            None => Core(Sequential::new(design, model, contract, seed)?),
            Some(pipeline) => Pipe(Pipelined::new(design, pipeline, model, contract, seed)?),
        }))
    }

    /// Holds some operands at raw values: the stimulus seldom draws others for them.
    #[must_use]
    pub fn holding(self, held: &[(String, i64)]) -> Self {
        Self(match self.0 {
            Core(core) => Core(core.holding(held)),
            Pipe(pipe) => Pipe(pipe.holding(held)),
        })
    }

    /// Limits lines to at most `results` results.
    #[must_use]
    pub fn with_lines_of(self, results: i64) -> Self {
        Self(match self.0 {
            Core(core) => Core(core.with_lines_of(results)),
            pipeline @ Pipe(_) => pipeline,
        })
    }

    /// Runs until `points` results were seen or something differs, on all threads of rayon's pool.
    ///
    /// `progress` is called now and then with the number of points since its last call.
    ///
    /// # Errors
    /// A design that cannot be simulated, or does not settle.
    pub fn run(&self, points: u64, progress: &(dyn Fn(u64) + Sync)) -> Result<Outcome> {
        match &self.0 {
            Core(core) => core.run(points, progress),
            Pipe(pipe) => pipe.run(points, progress),
        }
    }

    /// As [`Lockstep::run`], in one stream.
    ///
    /// # Errors
    /// As of [`Lockstep::run`].
    pub fn run_alone(&self, points: u64) -> Result<Outcome> {
        match &self.0 {
            Core(core) => core.run_alone(points),
            Pipe(pipe) => pipe.run_alone(points),
        }
    }

    /// Goes through the streams of a run of `points` results, each alone. `begin` makes what watches a stream,
    /// of its seed; after each clock `note` shows it the results so far and the simulator. They come back
    /// in the order of the streams.
    ///
    /// # Errors
    /// As of [`Lockstep::run`].
    pub fn watch<W: Send>(
        &self,
        points: u64,
        begin: impl Fn(u64) -> W + Sync,
        note: impl Fn(&mut W, u64, &Simulator) + Sync,
    ) -> Result<Vec<W>> {
        match &self.0 {
            Core(core) => core.watch(points, begin, note),
            Pipe(pipe) => pipe.watch(points, begin, note),
        }
    }

    /// Stimulus and expected outputs for a bench: the inputs of every clock of one stream of `points`
    /// results, and the outputs before its edge; then those of computations with these raw operands, in the order of
    /// the contract, one after another.
    ///
    /// # Errors
    /// Golden model and simulation differ; a design that cannot be simulated, or does not settle.
    pub fn record(&self, points: u64, computations: &[Vec<i64>]) -> Result<Vectors> {
        match &self.0 {
            Core(core) => core.record(points, computations),
            Pipe(pipe) => pipe.record(points, computations),
        }
    }

    /// Golden model and simulation from power-up on under recorded inputs, those of [`Lockstep::record`] say: by stream,
    /// then by clock, then by input. Each stream is gone through for `clocks` clocks, again from its beginning after its
    /// end. Results are compared with the golden model, and not with the formula.
    ///
    /// # Errors
    /// As of [`Lockstep::run`]; a stream without a clock, or a clock with more or fewer inputs than the design; a
    /// pipeline, whose golden model speaks of points and not of inputs.
    pub fn replay(&self, streams: &[Vec<Vec<u64>>], clocks: u64) -> Result<Outcome> {
        match &self.0 {
            Core(core) => core.replay(streams, clocks),
            Pipe(_) => bail!("recorded inputs of a pipeline cannot be replayed"),
        }
    }

    /// As [`Lockstep::run`], in one stream, of which `file` takes the waveform from clock `from` on.
    ///
    /// # Errors
    /// As of [`Lockstep::run`]; the file cannot be written.
    pub fn trace(
        &self,
        points: u64,
        from: u64,
        file: impl Write + Send + 'static,
    ) -> Result<Outcome> {
        match &self.0 {
            Core(core) => core.trace(points, from, file),
            Pipe(pipe) => pipe.trace(points, from, file),
        }
    }
}

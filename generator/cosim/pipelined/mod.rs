//! Golden model and simulated pipeline side by side.
//!
//! Points come with bubbles between them, results are held back, and resets drop what is on its way. After
//! every clock the handshake is compared, the results and the side channel where there are any, and, for
//! the point in each stage, every value that a register of the sequential core has: with what the golden
//! model's register holds in that microinstruction.

pub(super) mod combinations;
mod lane;
mod reference;
#[cfg(test)]
mod tests;

use std::io::Write;

use anyhow::{Context, Result, ensure};
use rayon::prelude::*;

use super::lockstep::LANES;
use super::outcome::{Mismatch, Outcome, Seen, share, stream_seed};
use super::points::Points;
use crate::golden::{Contract, Model, Operand};
use crate::hdl::netlist::{Design, NetId, Pipeline, Role};
use crate::hdl::sim::Simulator;
use crate::package::Vectors;
use lane::{Lane, Point};
use reference::{Formula, Reference};

/// The points of a stream.
const POINTS: u64 = 2048;

/// A pipeline with its golden model.
pub(super) struct Pipelined<'a> {
    setup: Setup<'a>,
    seed: u64,
}

/// What all streams share.
pub(super) struct Setup<'a> {
    pub design: &'a Design,
    pipeline: &'a Pipeline,
    model: Box<dyn Model>,
    formula: Formula<'a>,
    latency: usize,
    stall: bool,
    side: u32,
    /// How many inputs there are, and where each stands among them.
    inputs: usize,
    reset: usize,
    in_valid: usize,
    out_ready: Option<usize>,
    side_in: Option<usize>,
    positions: Vec<usize>,
    /// The operands, with the domains that are drawn from.
    operands: Vec<Operand>,
    points: Points<'a>,
    results: Vec<NetId>,
    out_valid: NetId,
    in_ready: Option<NetId>,
    side_out: Option<NetId>,
    outputs: Vec<NetId>,
}

impl Setup<'_> {
    fn reference(&self) -> Result<Reference> {
        Reference::new(self.design, self.pipeline, self.model.as_ref(), &self.results)
    }
}

impl<'a> Pipelined<'a> {
    /// # Errors
    /// A name of one side that the other does not have.
    pub(super) fn new(
        design: &'a Design,
        pipeline: &'a Pipeline,
        model: Box<dyn Model>,
        contract: &'a dyn Contract,
        seed: u64,
    ) -> Result<Self> {
        let inputs: Vec<_> = design.inputs().collect();
        let at = |role: Role| inputs.iter().position(|port| port.role == role);
        let out = |role: Role| design.port(|it| it == role).map(|port| port.net);
        let points: Vec<NetId> =
            inputs.iter().filter(|it| it.role == Role::Point).map(|it| it.net).collect();
        let positions = (0..inputs.len()).filter(|&at| inputs[at].role == Role::Point).collect();
        let operands = points.iter().map(|&net| {
            let net = design.net(net);
            let known = contract.operands().iter().find(|operand| operand.name == net.name);
            known.cloned().unwrap_or_else(|| Operand {
                name: net.name.clone(),
                format: net.format,
                domain: (net.format.min_raw() as i64, net.format.max_raw() as i64),
                colour: false,
                doc: String::new(),
            })
        });
        let operands = operands.collect();
        let results: Vec<NetId> = design
            .ports
            .iter()
            .filter(|port| matches!(port.role, Role::Result | Role::Status))
            .map(|port| port.net)
            .collect();
        let setup = Setup {
            formula: Formula::new(design, contract, &results)?,
            design,
            pipeline,
            model,
            latency: pipeline.stages.len(),
            stall: pipeline.stall,
            side: pipeline.side,
            inputs: inputs.len(),
            reset: at(Role::Reset).context("the pipeline has no reset")?,
            in_valid: at(Role::InValid).context("the pipeline has no input `in_valid`")?,
            out_ready: at(Role::OutReady),
            side_in: at(Role::SideIn),
            positions,
            operands,
            points: Points::new(contract),
            results,
            out_valid: out(Role::Valid).context("the pipeline has no output `out_valid`")?,
            in_ready: out(Role::InReady),
            side_out: out(Role::SideOut),
            outputs: design.outputs().map(|port| port.net).collect(),
        };
        setup.reference()?;
        Ok(Self { setup, seed })
    }

    pub(super) fn design(&self) -> &'a Design {
        self.setup.design
    }

    /// The same with some operands held at raw values.
    pub(super) fn holding(mut self, held: &[(String, i64)]) -> Self {
        for (name, raw) in held {
            let drawn = self.setup.operands.iter_mut().filter(|it| it.name == *name);
            drawn.for_each(|operand| operand.domain = (*raw, *raw));
            self.setup.points.hold(name, *raw);
        }
        self
    }

    /// Runs until `points` results were taken or something differs.
    ///
    /// # Errors
    /// A design that cannot be simulated, or does not settle.
    pub(super) fn run(&self, points: u64, progress: &(dyn Fn(u64) + Sync)) -> Result<Outcome> {
        let streams = points.div_ceil(POINTS).max(1);
        if streams < 4 {
            return self.run_alone(points);
        }
        let groups: Vec<Vec<Seen>> = (0..streams.div_ceil(LANES as u64))
            .into_par_iter()
            .map(|group| {
                let first = group * LANES as u64;
                let shares: Vec<(u64, u64)> = (first..streams.min(first + LANES as u64))
                    .map(|number| (stream_seed(self.seed, number), share(points, streams, number)))
                    .collect();
                let seen = self.group(&shares)?;
                progress(seen.iter().map(|seen| seen.points).sum());
                Ok(seen)
            })
            .collect::<Result<_>>()?;
        Ok(self.outcome(groups.into_iter().flatten()))
    }

    /// As [`Pipelined::run`], in one stream.
    ///
    /// # Errors
    /// Those of [`Pipelined::run`].
    pub(super) fn run_alone(&self, points: u64) -> Result<Outcome> {
        let mut alone = self.alone()?;
        while !alone.ended(points) {
            alone.clock(&self.setup)?;
        }
        Ok(self.outcome(alone.seen()))
    }

    /// Inputs and outputs of every clock of one stream, for a bench: of so many points, and then of those with these raw
    /// operands, in the order of the contract.
    ///
    /// # Errors
    /// Golden model and simulation differ; a design that cannot be simulated.
    pub(super) fn record(&self, points: u64, listed: &[Vec<i64>]) -> Result<Vectors> {
        let mut alone = self.alone()?;
        let mut vectors = Vectors::default();
        self.add(&mut vectors, &mut alone, |alone| alone.ended(points))?;
        alone.lanes[0].follow(&self.setup, listed);
        self.add(&mut vectors, &mut alone, |alone| alone.lanes[0].is_idle())?;
        let mismatch = &alone.mismatches[0];
        ensure!(mismatch.is_none(), "golden model and simulation differ: {mismatch:?}");
        Ok(vectors)
    }

    /// The clocks of a stream until it is at an end, or something differs.
    fn add(
        &self,
        vectors: &mut Vectors,
        alone: &mut Group<1>,
        ended: impl Fn(&Group<1>) -> bool,
    ) -> Result<()> {
        while !ended(alone) && alone.mismatches[0].is_none() {
            alone.prepare(&self.setup)?;
            alone.simulator.settle()?;
            let outputs = self.setup.outputs.iter();
            vectors.expected.push(outputs.map(|&net| alone.simulator.value(net)).collect());
            vectors.inputs.push(alone.lanes[0].inputs.clone());
            // From the first result on nothing is left of the power-up.
            if vectors.known_from == 0 && alone.simulator.value(self.setup.out_valid) == 1 {
                vectors.known_from = vectors.expected.len();
            }
            alone.edge(&self.setup)?;
        }
        Ok(())
    }

    /// As [`Pipelined::run`], in one stream, of which `file` takes the waveform from clock `from` on.
    ///
    /// # Errors
    /// Those of [`Pipelined::run`]; the file cannot be written.
    pub(super) fn trace(
        &self,
        points: u64,
        from: u64,
        file: impl Write + Send + 'static,
    ) -> Result<Outcome> {
        let mut alone = self.alone()?;
        while !alone.ended(points) && alone.lanes[0].clocks < from {
            alone.clock(&self.setup)?;
        }
        alone.simulator.trace(file)?;
        while !alone.ended(points) {
            alone.clock(&self.setup)?;
        }
        alone.simulator.end_trace()?;
        Ok(self.outcome(alone.seen()))
    }

    /// See [`Lockstep::watch`](super::Lockstep::watch).
    ///
    /// # Errors
    /// Those of [`Pipelined::run`].
    pub(super) fn watch<W: Send>(
        &self,
        points: u64,
        begin: impl Fn(u64) -> W + Sync,
        note: impl Fn(&mut W, u64, &Simulator) + Sync,
    ) -> Result<Vec<W>> {
        let streams = points.div_ceil(POINTS).max(1);
        (0..streams)
            .into_par_iter()
            .map(|number| {
                let seed = stream_seed(self.seed, number);
                let mut watch = begin(seed);
                let mut alone = Group::<1>::new(&self.setup, &[seed])?;
                while !alone.ended(share(points, streams, number)) {
                    alone.clock(&self.setup)?;
                    note(&mut watch, alone.lanes[0].points, &alone.simulator);
                }
                Ok(watch)
            })
            .collect()
    }

    fn alone(&self) -> Result<Group<1>> {
        Group::new(&self.setup, &[self.seed])
    }

    fn group(&self, shares: &[(u64, u64)]) -> Result<Vec<Seen>> {
        let seeds: Vec<u64> = shares.iter().map(|&(seed, _)| seed).collect();
        let points = shares.iter().map(|&(_, points)| points).max().unwrap_or(0);
        let mut group = Group::<LANES>::new(&self.setup, &seeds)?;
        while !group.ended(points) {
            group.clock(&self.setup)?;
        }
        Ok(group.seen())
    }

    fn outcome(&self, streams: impl IntoIterator<Item = Seen>) -> Outcome {
        Outcome::of(self.setup.pipeline.checkpoints.len(), self.setup.outputs.len(), streams)
    }
}

/// Streams in one simulator.
struct Group<const L: usize> {
    simulator: Simulator<L>,
    lanes: Vec<Lane>,
    mismatches: Vec<Option<Mismatch>>,
}

impl<const L: usize> Group<L> {
    fn new(setup: &Setup<'_>, seeds: &[u64]) -> Result<Self> {
        Ok(Self {
            simulator: Simulator::new(setup.design)?,
            lanes: seeds.iter().map(|&seed| Lane::new(setup, seed)).collect::<Result<_>>()?,
            mismatches: vec![None; seeds.len()],
        })
    }

    fn ended(&self, points: u64) -> bool {
        let lanes = self.lanes.iter().zip(&self.mismatches);
        lanes.into_iter().all(|(lane, mismatch)| lane.points >= points || mismatch.is_some())
    }

    fn clock(&mut self, setup: &Setup<'_>) -> Result<()> {
        self.prepare(setup)?;
        self.edge(setup)
    }

    /// Draws the inputs of the next clock.
    fn prepare(&mut self, setup: &Setup<'_>) -> Result<()> {
        for (number, lane) in self.lanes.iter_mut().enumerate() {
            lane.clock(setup)?;
            for (input, &bits) in self.simulator.inputs_mut().iter_mut().zip(&lane.inputs) {
                input[number] = bits;
            }
        }
        Ok(())
    }

    /// The clock, and everything that can be compared after it.
    fn edge(&mut self, setup: &Setup<'_>) -> Result<()> {
        self.simulator.clock()?;
        self.compare(setup, setup.out_valid, |lane| Some(u64::from(lane.stages.last().is_some())));
        if let Some(net) = setup.in_ready {
            self.compare(setup, net, |lane| Some(u64::from(lane.stages.moves(lane.out_ready))));
        }
        if let Some(net) = setup.side_out {
            self.compare(setup, net, |lane| lane.stages.last().map(|point| point.side));
        }
        for (at, &net) in setup.results.iter().enumerate() {
            self.compare(setup, net, |lane| {
                lane.stages.last().map(|point| point.expected.results[at])
            });
        }
        for (at, checkpoint) in setup.pipeline.checkpoints.iter().enumerate() {
            let stage = setup.pipeline.stage_of[checkpoint.net.index()];
            self.compare(setup, checkpoint.net, |lane| {
                let in_stage = |point: &Point| point.expected.registers[at];
                lane.stages.stage(stage).and_then(in_stage)
            });
        }
        Ok(())
    }

    fn compare(&mut self, setup: &Setup<'_>, net: NetId, expected: impl Fn(&Lane) -> Option<u64>) {
        let simulated = self.simulator.lanes(net);
        for (number, lane) in self.lanes.iter().enumerate() {
            let Some(golden) = expected(lane) else { continue };
            if golden != simulated[number] && self.mismatches[number].is_none() {
                self.mismatches[number] = Some(Mismatch {
                    seed: lane.seed(),
                    clock: lane.clocks,
                    signal: setup.design.net(net).name.clone(),
                    golden,
                    simulated: simulated[number],
                    during: format!("stage {}", setup.pipeline.stage_of[net.index()]),
                });
            }
        }
    }

    fn seen(&mut self) -> Vec<Seen> {
        let lanes = self.lanes.iter_mut().zip(self.mismatches.iter_mut());
        lanes
            .map(|(lane, mismatch)| Seen {
                points: lane.points,
                clocks: lane.clocks,
                worst: lane.worst.take(),
                histogram: std::mem::take(&mut lane.histogram),
                mismatch: mismatch.take(),
                exact: Vec::new(),
            })
            .collect()
    }
}

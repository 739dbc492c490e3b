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
use super::measure::Measure;
use super::outcome::{Mismatch, Outcome, Seen, share, stream_seed};
use super::points::Points;
use crate::golden::{Contract, Model, Operand};
use crate::hdl::netlist::{Design, NetId, Pipeline, Role};
use crate::hdl::sim::Simulator;
use crate::package::Vectors;
use lane::Lane;
use reference::Reference;

/// The points of a stream.
const POINTS: u64 = 2048;

/// A pipeline with its golden model.
pub(super) struct Pipelined<'a> {
    setup: Setup<'a>,
    seed: u64,
}

/// The shared state of all streams.
pub(super) struct Setup<'a> {
    pub design: &'a Design,
    pipeline: &'a Pipeline,
    model: Box<dyn Model>,
    measure: Measure<'a>,
    /// For each operand of the contract its position among those of the pipeline, and the other way round.
    of_contract: Vec<usize>,
    in_contract: Vec<Option<usize>>,
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
    side_out: Option<NetId>,
    outputs: Vec<NetId>,
    /// The nets that are compared after a clock, the first to be told first: `out_valid`, and then those of [`Columns`].
    compared: Vec<NetId>,
    columns: Columns,
}

/// Where in a comparison what is expected of a point has its place.
struct Columns {
    in_ready: Option<usize>,
    side: Option<usize>,
    /// That of the first result; the others follow.
    results: usize,
    /// For each stage the checkpoints in it, by their numbers, with their columns.
    checkpoints: Vec<Vec<(usize, usize)>>,
}

/// The column of `out_valid`.
const OUT_VALID: usize = 0;

impl Columns {
    /// The nets that are compared, with the columns that they make.
    fn new(
        pipeline: &Pipeline,
        out_valid: NetId,
        in_ready: Option<NetId>,
        side_out: Option<NetId>,
        results: &[NetId],
    ) -> (Vec<NetId>, Self) {
        let mut nets = vec![out_valid];
        let mut column = |net: NetId| {
            nets.push(net);
            nets.len() - 1
        };
        let (in_ready, side) = (in_ready.map(&mut column), side_out.map(&mut column));
        let result_columns: Vec<usize> = results.iter().map(|&net| column(net)).collect();
        let mut checkpoints = vec![Vec::new(); pipeline.stages.len() + 1];
        for (at, checkpoint) in pipeline.checkpoints.iter().enumerate() {
            let stage = pipeline.stage_of[checkpoint.net.index()];
            checkpoints[stage].push((at, column(checkpoint.net)));
        }
        let results = result_columns.first().copied().unwrap_or_default();
        (nets, Self { in_ready, side, results, checkpoints })
    }
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
        let operands: Vec<Operand> = operands.collect();
        let of_contract = contract.operands().iter().map(|operand| {
            let at = operands.iter().position(|other| other.name == operand.name);
            at.with_context(|| format!("the contract speaks of operand `{}`", operand.name))
        });
        let of_contract = of_contract.collect::<Result<Vec<usize>>>()?;
        let in_contract = (0..operands.len())
            .map(|port| of_contract.iter().position(|&operand| operand == port))
            .collect();
        let results: Vec<NetId> = design
            .ports
            .iter()
            .filter(|port| matches!(port.role, Role::Result | Role::Status))
            .map(|port| port.net)
            .collect();
        let out_valid = out(Role::Valid).context("the pipeline has no output `out_valid`")?;
        let (in_ready, side_out) = (out(Role::InReady), out(Role::SideOut));
        let (compared, columns) = Columns::new(pipeline, out_valid, in_ready, side_out, &results);
        let setup = Setup {
            measure: Measure::new(design, contract, |name| {
                results.iter().position(|&net| design.net(net).name == name)
            })?,
            of_contract,
            in_contract,
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
            out_valid,
            side_out,
            outputs: design.outputs().map(|port| port.net).collect(),
            compared,
            columns,
        };
        setup.reference()?;
        Ok(Self { setup, seed })
    }

    /// Holds some operands at raw values.
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
    /// As of [`Pipelined::run`].
    pub(super) fn run_alone(&self, points: u64) -> Result<Outcome> {
        let mut alone = self.alone(points)?;
        while !alone.ended() {
            alone.clock(&self.setup)?;
        }
        Ok(self.outcome(alone.into_seen()))
    }

    /// Inputs and outputs of every clock of one stream, for a bench: of so many points, and then of those with these raw
    /// operands, in the order of the contract.
    ///
    /// # Errors
    /// Golden model and simulation differ; a design that cannot be simulated.
    pub(super) fn record(&self, points: u64, listed: &[Vec<i64>]) -> Result<Vectors> {
        let mut alone = self.alone(u64::MAX)?;
        let mut vectors = Vectors::default();
        self.add(&mut vectors, &mut alone, |alone| alone.lanes[0].seen.points >= points)?;
        alone.lanes[0].follow(&self.setup, listed);
        self.add(&mut vectors, &mut alone, |alone| alone.lanes[0].is_idle())?;
        let mismatch = &alone.lanes[0].seen.mismatch;
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
        while !ended(alone) && alone.lanes[0].seen.mismatch.is_none() {
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
    /// As of [`Pipelined::run`]; the file cannot be written.
    pub(super) fn trace(
        &self,
        points: u64,
        from: u64,
        file: impl Write + Send + 'static,
    ) -> Result<Outcome> {
        let mut alone = self.alone(points)?;
        while !alone.ended() && alone.lanes[0].seen.clocks < from {
            alone.clock(&self.setup)?;
        }
        alone.simulator.trace(file)?;
        while !alone.ended() {
            alone.clock(&self.setup)?;
        }
        alone.simulator.end_trace()?;
        Ok(self.outcome(alone.into_seen()))
    }

    /// See [`Lockstep::watch`](super::Lockstep::watch).
    ///
    /// # Errors
    /// As of [`Pipelined::run`].
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
                let share = share(points, streams, number);
                let mut alone = Group::<1>::new(&self.setup, &[(seed, share)])?;
                while !alone.ended() {
                    alone.clock(&self.setup)?;
                    note(&mut watch, alone.lanes[0].seen.points, &alone.simulator);
                }
                Ok(watch)
            })
            .collect()
    }

    fn alone(&self, points: u64) -> Result<Group<1>> {
        Group::new(&self.setup, &[(self.seed, points)])
    }

    fn group(&self, shares: &[(u64, u64)]) -> Result<Vec<Seen>> {
        let mut group = Group::<LANES>::new(&self.setup, shares)?;
        while !group.ended() {
            group.clock(&self.setup)?;
        }
        Ok(group.into_seen().collect())
    }

    fn outcome(&self, streams: impl IntoIterator<Item = Seen>) -> Outcome {
        Outcome::of(self.setup.pipeline.checkpoints.len(), self.setup.outputs.len(), streams)
    }
}

/// Streams in one simulator.
struct Group<const L: usize> {
    simulator: Simulator<L>,
    /// The first are in the first lanes.
    lanes: Vec<Lane>,
    predicted: Predicted<L>,
}

/// For each net that is compared and each lane.
struct Predicted<const L: usize> {
    /// The expected values after the latest clock.
    expected: Vec<[u64; L]>,
    /// All ones where something is.
    known: Vec<[u64; L]>,
}

impl<const L: usize> Predicted<L> {
    /// Takes what is expected of a lane after its latest clock.
    fn take(&mut self, setup: &Setup<'_>, lane: &Lane, number: usize) {
        let columns = &setup.columns;
        let mut set = |column: usize, expected: Option<u64>| {
            self.expected[column][number] = expected.unwrap_or(0);
            self.known[column][number] = if expected.is_some() { u64::MAX } else { 0 };
        };
        if let Some(column) = columns.in_ready {
            set(column, Some(lane.stages.moves(lane.out_ready).into()));
        }
        // Of points that stay where they are the same is expected as before.
        if !lane.moved {
            return;
        }
        let last = lane.stages.last();
        set(OUT_VALID, Some(last.is_some().into()));
        if let Some(column) = columns.side {
            set(column, last.map(|point| point.side));
        }
        for at in 0..setup.results.len() {
            set(columns.results + at, last.map(|point| point.expected.results[at]));
        }
        for (stage, checkpoints) in columns.checkpoints.iter().enumerate() {
            let point = lane.stages.stage(stage);
            for &(at, column) in checkpoints {
                set(column, point.and_then(|point| point.expected.registers[at]));
            }
        }
    }
}

impl<const L: usize> Group<L> {
    /// Streams by their seeds and points.
    fn new(setup: &Setup<'_>, streams: &[(u64, u64)]) -> Result<Self> {
        let nothing = vec![[0; L]; setup.compared.len()];
        let lanes = streams.iter().map(|&(seed, points)| Lane::new(setup, seed, points));
        Ok(Self {
            simulator: Simulator::new(setup.design)?,
            lanes: lanes.collect::<Result<_>>()?,
            predicted: Predicted { expected: nothing.clone(), known: nothing },
        })
    }

    fn ended(&self) -> bool {
        self.lanes.iter().all(Lane::ended)
    }

    fn clock(&mut self, setup: &Setup<'_>) -> Result<()> {
        self.prepare(setup)?;
        self.edge(setup)
    }

    /// Draws the inputs of the next clock, and says what is expected after it; of streams that have ended nothing is.
    fn prepare(&mut self, setup: &Setup<'_>) -> Result<()> {
        for (number, lane) in (0..L).zip(&mut self.lanes) {
            if lane.ended() {
                self.predicted.known.iter_mut().for_each(|known| known[number] = 0);
                continue;
            }
            lane.clock(setup)?;
            for (input, &bits) in self.simulator.inputs_mut().iter_mut().zip(&lane.inputs) {
                input[number] = bits;
            }
            self.predicted.take(setup, lane, number);
        }
        Ok(())
    }

    /// The clock, and everything that can be compared after it.
    fn edge(&mut self, setup: &Setup<'_>) -> Result<()> {
        self.simulator.clock()?;
        let Predicted { expected, known } = &self.predicted;
        let differences = self.simulator.differences(&setup.compared, expected, Some(known));
        for (number, _) in differences.iter().enumerate().filter(|(_, it)| **it != 0) {
            self.lanes[number].seen.mismatch = self.mismatch(setup, number);
        }
        Ok(())
    }

    /// The first difference in a lane.
    fn mismatch(&self, setup: &Setup<'_>, number: usize) -> Option<Mismatch> {
        let Predicted { expected, known } = &self.predicted;
        let simulated = |net: NetId| self.simulator.lane(net, number);
        let (at, net) =
            setup.compared.iter().copied().enumerate().find(|&(at, net)| {
                (simulated(net) ^ expected[at][number]) & known[at][number] != 0
            })?;
        let lane = &self.lanes[number];
        Some(Mismatch {
            seed: lane.seed(),
            clock: lane.seen.clocks,
            signal: setup.design.net(net).name.clone(),
            golden: expected[at][number],
            simulated: simulated(net),
            during: format!("stage {}", setup.pipeline.stage_of[net.index()]),
        })
    }

    fn into_seen(self) -> impl Iterator<Item = Seen> {
        self.lanes.into_iter().map(|lane| lane.seen)
    }
}

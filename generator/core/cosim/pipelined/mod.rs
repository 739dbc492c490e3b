//! Predicts the signals of a pipelined core at every clock, from the golden model of the sequential core.
//!
//! The model computes each point on its own. This module tracks in which stage each point is, and predicts the handshake, the
//! results and the side channel (user data along with each point). The module also predicts *checkpoints*: a net in a stage
//! that must have the value of a register of the sequential core after some microinstruction, for the point in this stage.

mod reference;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use anyhow::Result;

use super::measure::Measure;
use super::outcome::StreamRecord;
use super::ports::Ports;
use glint_golden::Model;
use glint_golden::pipeline::Occupancy;
use glint_rtl::netlist::{Design, NetId, Pipeline, Role};
use reference::{Expected, Reference};

/// A point that the pipeline has taken and whose results were not read.
#[derive(Clone, Debug)]
struct PipelinedPoint {
    /// Raw operands, in the order of `Contract::operands`.
    operands: Vec<i64>,
    side: u64,
    expected: Expected,
    /// The number that the caller gave to the point, and the clock that took it.
    place: u64,
    taken: u64,
}

/// The points that are in a pipeline, and the signals that are predicted from them.
#[derive(Clone)]
pub(super) struct Pipe {
    columns: Arc<Vec<(ComparedValue, usize)>>,
    reference: Reference,
    stages: Occupancy<PipelinedPoint>,
    out_ready: bool,
    /// Whether the environment offers a point in the latest clock.
    offered: bool,
    /// Whether the pipeline took a point in the latest clock.
    pub(super) taken: bool,
}

/// Results are numbered in the order of the ports, and checkpoints in the order of the pipeline.
#[derive(Clone, Copy)]
enum ComparedValue {
    OutValid,
    InReady,
    TableReady,
    Side,
    Result(usize),
    Checkpoint(usize),
}

impl Pipe {
    /// Returns a pipeline without points, the nets that are compared after each clock, and the nets of the results among them.
    /// The nets are in the order in which differences are reported.
    ///
    /// # Errors
    /// Fails if the model lacks a result, a checkpoint's register, `word_address`, `busy`, `valid`, or an input of the operands
    /// or of the handshake.
    pub(super) fn new(
        design: &Design,
        pipeline: &Pipeline,
        model: Box<dyn Model>,
        ports: &Ports,
    ) -> Result<(Self, Vec<NetId>, Vec<NetId>)> {
        let in_ready = design.port(|role| role == Role::InReady).map(|port| port.net);
        let latency = pipeline.stages.len();
        let mut nets = vec![ports.valid];
        let mut columns = vec![(ComparedValue::OutValid, latency)];
        if let Some(in_ready) = in_ready {
            nets.push(in_ready);
            columns.push((ComparedValue::InReady, latency));
        }
        if let Some(table_ready) = design.port(|role| role == Role::TableReady) {
            nets.push(table_ready.net);
            columns.push((ComparedValue::TableReady, latency));
        }
        if let Some(side_out) = ports.side_out {
            nets.push(side_out);
            columns.push((ComparedValue::Side, latency));
        }
        let mut results: Vec<NetId> = Vec::new();
        for port in &design.ports {
            if matches!(port.role, Role::Result | Role::Status) {
                nets.push(port.net);
                columns.push((ComparedValue::Result(results.len()), latency));
                results.push(port.net);
            }
        }
        for (at, checkpoint) in pipeline.checkpoints.iter().enumerate() {
            let stage = pipeline.stage_of[checkpoint.net.index()];
            nets.push(checkpoint.net);
            columns.push((ComparedValue::Checkpoint(at), stage));
        }
        let pipe = Self {
            columns: Arc::new(columns),
            reference: Reference::new(design, pipeline, model, ports, &results)?,
            stages: Occupancy::empty(latency, pipeline.interval),
            out_ready: true,
            offered: false,
            taken: true,
        };
        Ok((pipe, nets, results))
    }

    /// Advances the points by one clock with the given inputs, and counts a result in `seen` if the receiver takes one. A point
    /// that enters in this clock gets the number `place`. `measure` measures the error of the result.
    pub(super) fn clock(
        &mut self,
        ports: &Ports,
        inputs: &[u64],
        place: u64,
        measure: Option<&Measure>,
        seen: &mut StreamRecord,
    ) -> Result<()> {
        let rst_n = inputs[ports.reset] == 1;
        self.out_ready = ports.out_ready.is_none_or(|at| inputs[at] == 1);
        self.offered = inputs[ports.start] == 1;
        self.taken = self.stages.takes(self.out_ready);
        let mut point = None;
        if self.taken && rst_n && self.offered {
            let mut operands = vec![0; ports.operands.len()];
            ports.operands.iter().for_each(|port| operands[port.at] = port.raw(inputs));
            let patterns = ports.operands.iter().map(|port| inputs[port.data]);
            let expected = self.reference.point(patterns)?;
            let side = ports.side_in.map_or(0, |(at, _)| inputs[at]);
            point = Some(PipelinedPoint { operands, side, expected, place, taken: seen.clocks });
        }
        let Some(point) = self.stages.clock(rst_n, point, self.out_ready) else { return Ok(()) };
        seen.points += 1;
        let Some(measure) = measure else { return Ok(()) };
        if measure.inside(&point.operands) {
            measure.note(seen, &point.operands, 0, &point.expected.results);
        } else {
            seen.histogram.add_outside();
        }
        Ok(())
    }

    /// Returns the predicted value of the compared net number `at` after the latest clock. There is no prediction if no point
    /// is in the net's stage, or if the computation of the point does not reach the checkpoint.
    #[inline]
    pub(super) fn expected(&self, at: usize) -> Option<u64> {
        let (column, stage) = self.columns[at];
        let point = self.stages.stage(stage);
        match column {
            ComparedValue::OutValid => Some(point.is_some().into()),
            ComparedValue::InReady => Some(self.stages.takes(self.out_ready).into()),
            ComparedValue::TableReady => Some((!self.offered && self.stages.is_empty()).into()),
            ComparedValue::Side => point.map(|point| point.side),
            ComparedValue::Result(at) => point.map(|point| point.expected.results[at]),
            ComparedValue::Checkpoint(at) => point.and_then(|point| point.expected.registers[at]),
        }
    }

    /// Returns the number of the point in the stage of the compared net number `at`, and the clock in which this point was
    /// taken.
    pub(super) fn point(&self, at: usize) -> Option<(u64, u64)> {
        self.stages.stage(self.columns[at].1).map(|point| (point.place, point.taken))
    }

    /// Returns whether the pipeline takes a point in the next clock if the receiver takes the results.
    pub(super) fn is_ready(&self) -> bool {
        self.stages.takes(true)
    }

    pub(super) fn has_before(&self, place: u64) -> bool {
        self.stages.points().any(|(_, point)| point.place < place)
    }
}

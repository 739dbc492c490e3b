//! Every combination of operands through a pipeline, one behind the other, a point every clock.

use std::sync::Arc;

use anyhow::Result;

use super::reference::{Expected, Reference};
use super::{Pipelined, Setup};
use crate::base::fixed::mask;
use crate::cosim::combinations::Ports;
use crate::cosim::outcome::Mismatch;
use crate::golden::pipeline::Occupancy;
use crate::hdl::netlist::NetId;
use crate::hdl::sim::Simulator;

/// A combination on its way.
struct Point {
    place: u64,
    /// The clock that took it.
    taken: u64,
    side: u64,
    expected: Expected,
}

/// A run of combinations in a lane.
struct Run {
    reference: Reference,
    next: u64,
    end: u64,
    stages: Occupancy<Point>,
    /// The mismatch at the first place where there is one, and its clocks since the point was taken.
    differs: Option<(Mismatch, u64)>,
}

impl Run {
    fn new(setup: &Setup<'_>, (first, count): (u64, u64)) -> Result<Self> {
        Ok(Self {
            reference: setup.reference()?,
            next: first,
            end: first + count,
            stages: Occupancy::empty(setup.latency),
            differs: None,
        })
    }

    fn ended(&self) -> bool {
        self.next >= self.end && self.stages.points().all(|(_, point)| point.place >= self.end)
    }

    /// The next combination, if there is one.
    fn point(&mut self, ports: &Ports, clock: u64, side: u32) -> Result<Option<(Vec<u64>, Point)>> {
        if self.next >= self.end {
            return Ok(None);
        }
        let place = self.next;
        self.next += 1;
        let operands = ports.patterns(place);
        let expected = self.reference.point(&operands)?;
        let side = if side == 0 { 0 } else { place & mask(side) };
        Ok(Some((operands, Point { place, taken: clock, side, expected })))
    }

    /// From now on only what comes before that place is of interest.
    fn differs_at(&mut self, mismatch: Mismatch, since: u64) {
        if self.differs.as_ref().is_none_or(|(first, _)| mismatch.seed < first.seed) {
            self.end = self.end.min(mismatch.seed);
            self.differs = Some((mismatch, since));
        }
    }
}

/// Runs of combinations in the lanes of one simulator.
pub(in crate::cosim) struct Walk<'p, 'a, const L: usize> {
    setup: &'p Setup<'a>,
    ports: Arc<Ports>,
    pub(in crate::cosim) simulator: Simulator<L>,
    runs: Vec<Run>,
    pub(in crate::cosim) clocks: u64,
}

impl<'a> Pipelined<'a> {
    /// Runs of combinations, each by its first place and how many there are, at power-up.
    ///
    /// # Errors
    /// A design that cannot be simulated.
    pub(in crate::cosim) fn walk<const L: usize>(
        &self,
        ports: &Arc<Ports>,
        runs: impl IntoIterator<Item = (u64, u64)>,
    ) -> Result<Walk<'_, 'a, L>> {
        let setup = &self.setup;
        Ok(Walk {
            setup,
            ports: Arc::clone(ports),
            simulator: Simulator::new(setup.design)?,
            runs: runs.into_iter().map(|run| Run::new(setup, run)).collect::<Result<_>>()?,
            clocks: 0,
        })
    }
}

impl<const L: usize> Walk<'_, '_, L> {
    /// Whether every combination has gone through, up to the first in its lane that differs.
    pub(in crate::cosim) fn ended(&self) -> bool {
        self.runs.iter().all(Run::ended)
    }

    /// The first place at which something differs; clocks since its combination was taken; and what.
    pub(in crate::cosim) fn first(&self) -> Option<(&Mismatch, u64)> {
        let differs = self.runs.iter().filter_map(|run| run.differs.as_ref());
        differs
            .map(|(mismatch, since)| (mismatch, *since))
            .min_by_key(|(mismatch, _)| mismatch.seed)
    }

    /// One clock, and everything that can be compared after it.
    ///
    /// # Errors
    /// A simulation that does not settle, or a VCD that cannot be written.
    pub(in crate::cosim) fn clock(&mut self) -> Result<()> {
        let setup = self.setup;
        self.clocks += 1;
        // The first clock is one of reset.
        let rst_n = self.clocks > 1;
        let inputs = self.simulator.inputs_mut();
        for (lane, run) in self.runs.iter_mut().enumerate() {
            let offered =
                if rst_n { run.point(&self.ports, self.clocks, setup.side)? } else { None };
            inputs[setup.reset][lane] = u64::from(rst_n);
            inputs[setup.in_valid][lane] = u64::from(offered.is_some());
            if let Some(at) = setup.out_ready {
                inputs[at][lane] = 1;
            }
            if let Some((operands, point)) = &offered {
                for (&position, &bits) in setup.positions.iter().zip(operands) {
                    inputs[position][lane] = bits;
                }
                if let Some(at) = setup.side_in {
                    inputs[at][lane] = point.side;
                }
            }
            run.stages.clock(rst_n, offered.map(|(_, point)| point), true);
        }
        self.simulator.clock()?;
        for lane in 0..self.runs.len() {
            self.compare(lane);
        }
        Ok(())
    }

    fn compare(&mut self, lane: usize) {
        let setup = self.setup;
        let run = &self.runs[lane];
        let mut differ: Vec<(Mismatch, u64)> = Vec::new();
        let mut check = |point: &Point, net: NetId, golden: u64| {
            let simulated = self.simulator.lane(net, lane);
            if simulated != golden && point.place < run.end {
                let mismatch = Mismatch {
                    seed: point.place,
                    clock: self.clocks,
                    signal: setup.design.net(net).name.clone(),
                    golden,
                    simulated,
                    during: format!("stage {}", setup.pipeline.stage_of[net.index()]),
                };
                differ.push((mismatch, self.clocks - point.taken));
            }
        };
        if let Some(last) = run.stages.last() {
            check(last, setup.out_valid, 1);
            for (&net, &golden) in setup.results.iter().zip(&last.expected.results) {
                check(last, net, golden);
            }
            if let Some(net) = setup.side_out {
                check(last, net, last.side);
            }
        }
        for (at, checkpoint) in setup.pipeline.checkpoints.iter().enumerate() {
            let stage = setup.pipeline.stage_of[checkpoint.net.index()];
            if let Some(point) = run.stages.stage(stage)
                && let Some(golden) = point.expected.registers[at]
            {
                check(point, checkpoint.net, golden);
            }
        }
        for (mismatch, since) in differ {
            self.runs[lane].differs_at(mismatch, since);
        }
    }
}

//! One stream of points through a pipeline: what is offered and taken, and what is expected where.

use std::collections::VecDeque;

use anyhow::Result;

use super::Setup;
use super::reference::{Expected, Reference};
use crate::base::fixed::mask;
use crate::cosim::outcome::Seen;
use crate::cosim::random::Random;
use crate::golden::pipeline::Occupancy;

/// How eager a side of the handshake is: it is ready once in this number of clocks.
const PACES: [u64; 4] = [1, 1, 2, 5];

/// Clocks for which a pace is kept.
const PACE_CLOCKS: u64 = 24;

/// A reset comes once in this number of clocks.
const RESET_CLOCKS: u64 = 1024;

/// A point on its way.
#[derive(Debug)]
pub(super) struct Point {
    /// Bit patterns.
    pub operands: Vec<u64>,
    pub side: u64,
    pub expected: Expected,
}

/// A stream.
pub(super) struct Lane {
    seed: u64,
    /// How many points it takes.
    points: u64,
    random: Random,
    reference: Reference,
    /// The point that is offered until it is taken.
    offered: Option<Point>,
    /// The remaining points of a stream that goes on with a list, bit patterns: it draws no others, withdraws
    /// none, and is not reset.
    listed: Option<VecDeque<Vec<u64>>>,
    pub(super) stages: Occupancy<Point>,
    reset_left: u64,
    pace: (u64, u64),
    pace_left: u64,
    /// The inputs of the latest clock.
    pub(super) inputs: Vec<u64>,
    pub(super) seen: Seen,
    pub(super) out_ready: bool,
    /// The latest clock changed what the stages hold.
    pub(super) moved: bool,
    /// Raw operands, in the order of the contract.
    raw: Vec<i64>,
}

impl Lane {
    pub(super) fn new(setup: &Setup<'_>, seed: u64, points: u64) -> Result<Self> {
        Ok(Self {
            seed,
            points,
            random: Random::new(seed),
            reference: setup.reference()?,
            offered: None,
            listed: None,
            stages: Occupancy::empty(setup.latency),
            // Resets are there from power-up on.
            reset_left: 2,
            pace: (1, 1),
            pace_left: 0,
            inputs: vec![0; setup.inputs],
            seen: Seen::default(),
            out_ready: true,
            moved: false,
            raw: Vec::new(),
        })
    }

    /// Whether all its points were taken, or something differs.
    pub(super) fn ended(&self) -> bool {
        self.seen.points >= self.points || self.seen.mismatch.is_some()
    }

    pub(super) fn seed(&self) -> u64 {
        self.seed
    }

    /// Goes on with these points, raw operands in the order of the contract, and then with none.
    pub(super) fn follow(&mut self, setup: &Setup<'_>, points: &[Vec<i64>]) {
        let listed = points.iter().map(|raw| self.bits(setup, raw)).collect();
        self.listed = Some(listed);
    }

    /// Whether no point is on its way or to be offered.
    pub(super) fn is_idle(&self) -> bool {
        let listed = self.listed.as_ref().is_none_or(VecDeque::is_empty);
        listed && self.offered.is_none() && self.stages.points().next().is_none()
    }

    /// The inputs of the next clock, and what they make of the points.
    pub(super) fn clock(&mut self, setup: &Setup<'_>) -> Result<()> {
        self.seen.clocks += 1;
        if self.pace_left == 0 {
            let mut pace = || PACES[self.random.below(PACES.len() as u64) as usize];
            self.pace = (pace(), pace());
            self.pace_left = PACE_CLOCKS;
        }
        self.pace_left -= 1;
        let drawn = self.listed.is_none();
        if drawn && self.reset_left == 0 && self.random.once_in(RESET_CLOCKS) {
            self.reset_left = 1 + self.random.below(3);
        }
        let rst_n = self.reset_left == 0;
        self.reset_left = self.reset_left.saturating_sub(1);
        // What is offered stays until it is taken; now and then it is withdrawn.
        if drawn && self.offered.is_some() && self.random.once_in(64) {
            self.offered = None;
        }
        // Of a list nothing is lost to the end of a reset.
        if self.offered.is_none()
            && (drawn || rst_n)
            && self.random.once_in(self.pace.0)
            && let Some(operands) = self.draw(setup)
        {
            let expected = self.reference.point(&operands)?;
            let side = self.random.bits() & mask(setup.side.max(1));
            self.offered = Some(Point { operands, side, expected });
        }
        let out_ready = !setup.stall || self.random.once_in(self.pace.1);
        self.out_ready = out_ready;
        self.inputs[setup.reset] = u64::from(rst_n);
        self.inputs[setup.in_valid] = u64::from(self.offered.is_some());
        for (at, &position) in setup.positions.iter().enumerate() {
            self.inputs[position] = match &self.offered {
                Some(point) => point.operands[at],
                None => self.random.pattern(&setup.operands[at]),
            };
        }
        if let Some(at) = setup.side_in {
            let noise = self.random.bits() & mask(setup.side);
            self.inputs[at] = self.offered.as_ref().map_or(noise, |point| point.side);
        }
        if let Some(at) = setup.out_ready {
            self.inputs[at] = u64::from(out_ready);
        }
        let moves = self.stages.moves(out_ready);
        self.moved = moves || !rst_n;
        // Nothing is taken while the points do not move.
        let offered = if moves { self.offered.take() } else { None };
        if let Some(point) = self.stages.clock(rst_n, offered, out_ready) {
            self.seen.points += 1;
            let results = &point.expected.results;
            let operands = setup.measure.contract.operands().iter().zip(&setup.of_contract);
            self.raw.clear();
            self.raw.extend(operands.map(|(it, &at)| it.format.raw(point.operands[at]) as i64));
            if setup.measure.inside(&self.raw) {
                setup.measure.note(&mut self.seen, &self.raw, 0, results);
            } else {
                self.seen.histogram.add_outside();
            }
        }
        Ok(())
    }

    /// Bit patterns for the operands of the next point.
    fn draw(&mut self, setup: &Setup<'_>) -> Option<Vec<u64>> {
        if let Some(listed) = &mut self.listed {
            return listed.pop_front();
        }
        let mut raw = std::mem::take(&mut self.raw);
        raw.clear();
        raw.resize(setup.points.operands().len(), 0);
        setup.points.draw(&mut self.random, &mut raw, u64::MAX);
        let bits = self.bits(setup, &raw);
        self.raw = raw;
        Some(bits)
    }

    /// Raw operands in the order of the contract as bit patterns at the ports. Operands that it does not have are drawn.
    fn bits(&mut self, setup: &Setup<'_>, raw: &[i64]) -> Vec<u64> {
        let operands = setup.operands.iter().zip(&setup.in_contract);
        operands
            .map(|(operand, known)| match known {
                Some(at) => raw[*at] as u64 & mask(operand.format.width()),
                None => self.random.pattern(operand),
            })
            .collect()
    }
}

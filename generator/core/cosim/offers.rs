//! Drives the inputs of a pipeline with random points and a random valid/ready handshake, clock by clock.
//!
//! [`Offers`] raises `in_valid` with the operands of a point, keeps both until the pipeline takes the point, and pauses at
//! random between points. Now and then it withdraws a point, lowers `out_ready`, so that results must wait, or applies a
//! reset, which drops every point in the pipeline. Every 24 clocks it draws new probabilities: for example, `out_ready` is
//! high in every clock for a while, and later in one clock of five.

use std::collections::VecDeque;
use std::sync::Arc;

use super::points::PointSource;
use super::ports::Ports;
use super::random::Random;

/// The average numbers of clocks until a new point is offered, and until `out_ready` is high, are drawn from these values.
const PACES: [u64; 4] = [1, 1, 2, 5];

/// The number of clocks after which new paces are drawn.
const PACE_CLOCKS: u64 = 24;

/// The average number of clocks between resets.
const RESET_CLOCKS: u64 = 1024;

pub(super) struct Offers {
    ports: Arc<Ports>,
    random: Random,
    /// The point that is offered and not yet taken: the bit patterns of its operands in the order of the ports, and its side
    /// value.
    offered: Option<(Vec<u64>, u64)>,
    /// The points of a list that must still be offered, as raw operands in the order of the contract. While there is a list,
    /// no point is drawn or withdrawn, and no reset begins.
    listed: Option<VecDeque<Vec<i64>>>,
    reset_left: u64,
    pace: (u64, u64),
    pace_left: u64,
    inputs: Vec<u64>,
}

impl Offers {
    /// Begins with two clocks of reset after power-up.
    pub(super) fn new(ports: &Arc<Ports>, seed: u64) -> Self {
        Self {
            random: Random::new(seed),
            offered: None,
            listed: None,
            reset_left: 2,
            pace: (1, 1),
            pace_left: 0,
            inputs: vec![0; ports.inputs],
            ports: ports.clone(),
        }
    }

    /// Offers only the given points from now on: raw operands in the order of `Contract::operands`. A point that is already
    /// offered stays first.
    pub(super) fn follow(&mut self, points: &[Vec<i64>]) {
        self.listed = Some(points.iter().cloned().collect());
    }

    /// Returns whether the pipeline has taken all points of [`Offers::follow`].
    pub(super) fn is_over(&self) -> bool {
        self.offered.is_none() && self.listed.as_ref().is_some_and(VecDeque::is_empty)
    }

    pub(super) fn inputs(&self) -> &[u64] {
        &self.inputs
    }

    /// Returns the bit patterns of all inputs in the next clock, in the order of the design's input ports. `taken` must say
    /// whether the pipeline took the point that was offered in the latest clock.
    pub(super) fn next(&mut self, taken: bool, points: &PointSource<'_>) -> &[u64] {
        let Self { ports, random, offered, listed, inputs, .. } = self;
        if taken {
            *offered = None;
        }
        if self.pace_left == 0 {
            let mut pace = || PACES[random.below(PACES.len() as u64) as usize];
            self.pace = (pace(), pace());
            self.pace_left = PACE_CLOCKS;
        }
        self.pace_left -= 1;
        let drawn = listed.is_none();
        if drawn && self.reset_left == 0 && random.once_in(RESET_CLOCKS) {
            self.reset_left = 1 + random.below(3);
        }
        let rst_n = self.reset_left == 0;
        self.reset_left = self.reset_left.saturating_sub(1);
        // An offered point stays until it is taken, but in one clock of 64 it is withdrawn.
        if drawn && offered.is_some() && random.once_in(64) {
            *offered = None;
        }
        // A point of a list must not be lost, so it is not offered during a reset.
        if offered.is_none() && (drawn || rst_n) && random.once_in(self.pace.0) {
            let next = match listed {
                Some(listed) => listed.pop_front(),
                None => {
                    let mut raw = vec![0; points.operands().len()];
                    points.draw(random, &mut raw, u64::MAX);
                    Some(raw)
                }
            };
            *offered = next.map(|raw| {
                let patterns = ports.operands.iter().map(|port| port.pattern(&raw)).collect();
                (patterns, random.bits() & ports.side_in.map_or(0, |(_, mask)| mask))
            });
        }
        if let Some(at) = ports.out_ready {
            inputs[at] = u64::from(random.once_in(self.pace.1));
        }
        inputs[ports.reset] = u64::from(rst_n);
        inputs[ports.start] = u64::from(offered.is_some());
        for (at, port) in ports.operands.iter().enumerate() {
            inputs[port.data] = match offered {
                Some((patterns, _)) => patterns[at],
                None => random.pattern(&points.operands()[port.at]),
            };
        }
        if let Some((at, mask)) = ports.side_in {
            let noise = random.bits() & mask;
            inputs[at] = offered.as_ref().map_or(noise, |(_, side)| *side);
        }
        inputs
    }
}

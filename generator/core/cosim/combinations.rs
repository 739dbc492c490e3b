//! Drives a device with every combination of the bit patterns of its operands, one computation after another. A caller may also
//! give a list of operands for the first computations.
//!
//! A combination is a number: the bits of all operands side by side, without operands that the caller fixed at a value. The
//! combinations are shuffled: computation number p has the combination p·k mod 2^bits, for an odd constant k. Consecutive
//! computations thus have little in common, and a register that failed to load seldom contains the right value by chance.

use std::sync::Arc;

use super::ports::{OperandPort, Ports};
use glint_base::fixed::mask;

/// The constant k of the shuffling: odd, and with bits that look random: 2^64 divided by the golden ratio.
const SCATTER: u64 = 0x9e37_79b9_7f4a_7c15;

/// The combinations of operands. Each combination has a number, its *place*.
#[derive(Clone)]
pub(super) struct Space {
    ports: Arc<Ports>,
    /// For each operand port, the bit pattern at which the caller fixed the operand.
    held: Vec<Option<u64>>,
    /// The raw operands at the first places. For every later place, the operands are computed from the place. May be empty.
    listed: Vec<Vec<i64>>,
}

impl Space {
    pub(super) fn new(ports: &Arc<Ports>) -> Self {
        Self { held: vec![None; ports.operands.len()], listed: Vec::new(), ports: ports.clone() }
    }

    /// Makes the space of all combinations, but the first places have the raw operands in `list`.
    pub(super) fn listed(ports: &Arc<Ports>, list: &[Vec<i64>]) -> Self {
        Self { listed: list.to_vec(), ..Self::new(ports) }
    }

    /// Fixes operands at raw values, so that the combinations vary only the operands that `held` does not name. Ignores a name
    /// that no operand has.
    pub(super) fn hold(&mut self, held: &[(String, i64)]) {
        for (name, raw) in held {
            let operands = self.ports.operands.iter().zip(&mut self.held);
            for (port, held) in operands.filter(|(port, _)| port.name == *name) {
                *held = Some(*raw as u64 & mask(port.format.width()));
            }
        }
    }

    /// Returns the total number of bits of the operands that vary.
    pub(super) fn bits(&self) -> u32 {
        let operands = self.ports.operands.iter().zip(&self.held);
        let free = operands.filter(|(_, held)| held.is_none());
        free.map(|(port, _)| port.format.width()).sum()
    }

    /// Returns the operand ports, each with its bit pattern at a place: from the list, the fixed value, or the bits of the
    /// combination.
    fn at(&self, place: u64) -> impl Iterator<Item = (&OperandPort, u64)> {
        let mut bits = place.wrapping_mul(SCATTER);
        let listed = usize::try_from(place).ok().and_then(|place| self.listed.get(place));
        self.ports.operands.iter().zip(&self.held).map(move |(port, held)| {
            if let Some(raw) = listed {
                return (port, port.pattern(raw));
            }
            if let Some(pattern) = held {
                return (port, *pattern);
            }
            let width = port.format.width();
            let pattern = bits & mask(width);
            bits = bits.checked_shr(width).unwrap_or(0);
            (port, pattern)
        })
    }

    pub(super) fn named(&self, place: u64) -> Vec<(String, u64)> {
        let operands = self.at(place);
        operands.map(|(port, pattern)| (port.name.clone(), pattern)).collect()
    }
}

/// The inputs of a device that computes one combination after another, clock by clock. After one clock of reset, all operands
/// are written in the clock of `start`. Until the next `start`, the data ports have the complement of the written values. A
/// core that reads them too late therefore gives wrong results.
pub(super) struct Combinations {
    space: Arc<Space>,
    first: u64,
    count: u64,
    started: u64,
    since_start: u64,
    reset: bool,
    inputs: Vec<u64>,
}

impl Combinations {
    pub(super) fn new(space: Arc<Space>, first: u64, count: u64) -> Self {
        let mut inputs = vec![0; space.ports.inputs];
        space.ports.out_ready.into_iter().for_each(|at| inputs[at] = 1);
        Self { space, first, count, started: 0, since_start: 0, reset: false, inputs }
    }

    pub(super) fn all_started(&self) -> bool {
        self.started == self.count
    }

    /// The place of the computation that runs, or that ran last.
    pub(super) fn place(&self) -> u64 {
        self.first + self.started.saturating_sub(1)
    }

    /// Counts clocks; the clock that takes `start` is number 0.
    pub(super) fn since_start(&self) -> u64 {
        self.since_start
    }

    /// Returns the bit patterns of all inputs in the next clock, in the order of the design's input ports. `ready` says that
    /// the device can take a computation in this clock.
    pub(super) fn next(&mut self, ready: bool) -> &[u64] {
        let ports = &*self.space.ports;
        let starting = ready && self.reset && self.started < self.count;
        self.inputs[ports.reset] = u64::from(self.reset);
        if starting {
            let place = self.first + self.started;
            for (port, pattern) in self.space.at(place) {
                self.inputs[port.data] = pattern;
                self.inputs[port.strobe] = 1;
            }
            if let Some((at, mask)) = ports.side_in {
                self.inputs[at] = place & mask;
            }
            self.started += 1;
            self.since_start = 0;
        } else {
            self.since_start += 1;
            if self.since_start == 1 {
                for port in &ports.operands {
                    self.inputs[port.data] ^= mask(port.format.width());
                    self.inputs[port.strobe] = 0;
                }
            }
        }
        self.inputs[ports.start] = u64::from(starting);
        self.reset = true;
        &self.inputs
    }

    pub(super) fn inputs(&self) -> &[u64] {
        &self.inputs
    }
}

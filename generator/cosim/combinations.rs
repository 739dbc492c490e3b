//! Every combination of the bit patterns of all operands, one computation after another.
//!
//! A combination is the bits of all operands side by side. They come in an order in which one has little in
//! common with the one before it, so that a register that should have been loaded and was not seldom holds
//! what was wanted by chance: *place* p has the combination p·k mod 2^bits for an odd constant k. Operands
//! that are held are no part of it.

use std::sync::Arc;

use anyhow::{Context, Result};

use super::outcome::Course;
use crate::base::fixed::mask;
use crate::hdl::netlist::{Design, Role};

/// Odd, and without a pattern in its bits: 2^64 by the golden ratio.
const SCATTER: u64 = 0x9e37_79b9_7f4a_7c15;

/// Where a device takes what.
#[derive(Clone, Debug)]
pub(super) struct Ports {
    reset: usize,
    start: usize,
    inputs: usize,
    operands: Vec<Port>,
    /// The bit patterns at the first places, where they are given; those of the others are made of the place.
    listed: Vec<Vec<u64>>,
}

/// An operand among the inputs.
#[derive(Clone, Debug)]
struct Port {
    name: String,
    data: usize,
    /// None where a point is offered as a whole.
    strobe: Option<usize>,
    width: u32,
    /// Its bit pattern, where it is the same in all combinations.
    held: Option<u64>,
}

impl Ports {
    /// The ports of a design, in its order.
    ///
    /// # Errors
    /// The design has no reset, nothing that begins a computation, or an operand whose strobe is no input.
    pub(super) fn new(design: &Design) -> Result<Self> {
        let named = |name: &str, wanted: fn(Role) -> bool| {
            let at = design.inputs().position(|port| wanted(port.role));
            at.with_context(|| format!("`{}` has no input `{name}`", design.name))
        };
        let mut operands = Vec::new();
        for (data, port) in design.inputs().enumerate() {
            let strobe = match port.role {
                Role::Operand { strobe } => Some(design.input_position(strobe)?),
                Role::Point => None,
                _ => continue,
            };
            let net = design.net(port.net);
            let (name, width) = (net.name.clone(), net.format.width());
            operands.push(Port { name, data, strobe, width, held: None });
        }
        Ok(Self {
            reset: named("rst_n", |role| role == Role::Reset)?,
            start: named("start", |role| matches!(role, Role::Start | Role::InValid))?,
            inputs: design.inputs().count(),
            operands,
            listed: Vec::new(),
        })
    }

    /// Gives the places raw values of operands, in the order of these names.
    pub(super) fn list<'n>(&mut self, names: impl Iterator<Item = &'n str>, list: &[Vec<i64>]) {
        let names: Vec<&str> = names.collect();
        let pattern = |port: &Port, values: &Vec<i64>| {
            let at = names.iter().position(|name| *name == port.name);
            at.map_or(0, |at| values[at] as u64 & mask(port.width))
        };
        let patterns = |values| self.operands.iter().map(|port| pattern(port, values)).collect();
        self.listed = list.iter().map(patterns).collect();
    }

    /// Holds operands at raw values: all combinations are of the others alone.
    pub(super) fn hold(&mut self, held: &[(String, i64)]) {
        for (name, raw) in held {
            let operands = self.operands.iter_mut();
            for port in operands.filter(|port| port.name == *name) {
                port.held = Some(*raw as u64 & mask(port.width));
            }
        }
    }

    /// The bits of all operands together that are not held.
    pub(super) fn bits(&self) -> u32 {
        let free = self.operands.iter().filter(|port| port.held.is_none());
        free.map(|port| port.width).sum()
    }

    /// The bit patterns of the operands at a place, in the order of the ports.
    fn at(&self, place: u64) -> impl Iterator<Item = (&Port, u64)> {
        let mut bits = place.wrapping_mul(SCATTER);
        let listed = usize::try_from(place).ok().and_then(|place| self.listed.get(place));
        self.operands.iter().enumerate().map(move |(number, port)| {
            if let Some(listed) = listed {
                return (port, listed[number]);
            }
            if let Some(pattern) = port.held {
                return (port, pattern);
            }
            let pattern = bits & mask(port.width);
            bits = bits.checked_shr(port.width).unwrap_or(0);
            (port, pattern)
        })
    }

    /// The bit patterns of the operands at a place, in the order of the ports.
    pub(super) fn patterns(&self, place: u64) -> Vec<u64> {
        self.at(place).map(|(_, pattern)| pattern).collect()
    }

    /// The bit patterns of the operands at a place, by name.
    pub(super) fn named(&self, place: u64) -> Vec<(String, u64)> {
        let operands = self.at(place);
        operands.map(|(port, pattern)| (port.name.clone(), pattern)).collect()
    }
}

/// The inputs of a device that goes through combinations, clock by clock: one clock of reset; then all
/// operands are written in the clock of `start`, and the next computation starts in the first clock in
/// which the device is not busy. While it is, the data show the complement of what was written.
pub(super) struct Combinations {
    ports: Arc<Ports>,
    first: u64,
    count: u64,
    started: u64,
    since_start: u64,
    reset: bool,
    inputs: Vec<u64>,
}

impl Combinations {
    /// The combinations at `count` places, from the first on.
    pub(super) fn new(ports: Arc<Ports>, first: u64, count: u64) -> Self {
        Self {
            inputs: vec![0; ports.inputs],
            ports,
            first,
            count,
            started: 0,
            since_start: 0,
            reset: false,
        }
    }

    pub(super) fn course(&self) -> Course {
        Course::Combinations { first: self.first, count: self.count }
    }

    /// Whether no computation is left to start.
    pub(super) fn all_started(&self) -> bool {
        self.started == self.count
    }

    /// The place of the computation that runs, or ran last.
    pub(super) fn place(&self) -> u64 {
        self.first + self.started.saturating_sub(1)
    }

    /// Clocks since `start`: 0 for the one that takes it.
    pub(super) fn since_start(&self) -> u64 {
        self.since_start
    }

    /// The inputs of the next clock, given `busy` as it stands before the edge.
    pub(super) fn next(&mut self, busy: bool) -> &[u64] {
        let starting = !busy && self.reset && self.started < self.count;
        self.inputs[self.ports.reset] = u64::from(self.reset);
        self.inputs[self.ports.start] = u64::from(starting);
        if starting {
            let place = self.first + self.started;
            for (port, pattern) in self.ports.at(place) {
                self.inputs[port.data] = pattern;
                port.strobe.into_iter().for_each(|strobe| self.inputs[strobe] = 1);
            }
            self.started += 1;
            self.since_start = 0;
        } else {
            self.since_start += 1;
            if self.since_start == 1 {
                for port in &self.ports.operands {
                    self.inputs[port.data] ^= mask(port.width);
                    port.strobe.into_iter().for_each(|strobe| self.inputs[strobe] = 0);
                }
            }
        }
        self.reset = true;
        &self.inputs
    }

    /// The latest inputs.
    pub(super) fn inputs(&self) -> &[u64] {
        &self.inputs
    }
}

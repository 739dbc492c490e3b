//! Simulates up to 32 computations at once, one in each lane of the built-in simulator.
//!
//! The module records the outputs of each computation and the clocks in which they appear. A comparison of two records decides
//! whether a fault changes anything that a user can see.

use anyhow::{Context, Result, bail};

use super::memories::Memories;
use crate::cosim::ports::Ports;
use glint_base::fixed::mask;
use glint_golden::Contract;
use glint_rtl::netlist::{Design, NetId};
use glint_rtl::sim::Machine;

/// The number of computations that are simulated at once.
pub const LANES: usize = 32;

/// A computation that takes more clocks counts as endless.
const LIMIT: u32 = 1 << 16;

/// A set of lanes as a bit mask: bit i is 1 if lane i is in the set.
pub type Lanes = u32;

/// The outputs of one computation, with the clocks in which they appeared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutputTrace {
    /// The number of clocks from the computation's `start` to the first clock in which the core is not busy.
    pub clocks: u32,
    /// For each clock in which `valid` is high: the number of clocks since `start`, and the bit patterns of the result
    /// outputs.
    pub results: Vec<(u32, Vec<u64>)>,
}

impl OutputTrace {
    /// Returns the sum of the absolute differences between the bit patterns of `self` and `from`. Returns the largest `u64` if
    /// the traces differ in the number of clocks or of results.
    pub fn differs(&self, from: &Self) -> u64 {
        if self.results.len() != from.results.len() || self.clocks != from.clocks {
            return u64::MAX;
        }
        let mut sum: u64 = 0;
        let own = self.results.iter().flat_map(|(_, outputs)| outputs);
        let other = from.results.iter().flat_map(|(_, outputs)| outputs);
        for (a, b) in own.zip(other) {
            sum = sum.saturating_add(a.abs_diff(*b));
        }
        sum
    }
}

/// A simulated core whose lanes run one computation each. After the clock of `start`, the operand ports carry the complemented
/// bits. A core that reads an operand too late therefore computes a wrong result.
pub struct SideBySide {
    pub machine: Machine<LANES>,
    ports: Ports,
    busy: NetId,
    inputs: Vec<[u64; LANES]>,
    copies: Option<Memories>,
}

impl SideBySide {
    /// Resets the simulator `machine`, which must have been compiled from `design`.
    ///
    /// # Errors
    /// Fails if the design is a pipeline or lacks a port of the handshake. Fails also if design and contract do not have the
    /// same operands, if the strobe of an operand is not an input, or if the design lacks an output of the contract.
    pub fn new(
        design: &Design,
        contract: &dyn Contract,
        mut machine: Machine<LANES>,
    ) -> Result<Self> {
        let ports = Ports::new(design, contract)?;
        let mut inputs = vec![[0; LANES]; ports.inputs];
        machine.update(false, Some(&inputs));
        machine.update(true, None);
        inputs[ports.reset] = [1; LANES];
        let busy = ports.busy.context("a pipeline runs no computations one by one")?;
        Ok(Self { machine, ports, busy, inputs, copies: None })
    }

    /// Gives each lane its own copy of the ROMs, so that [`SideBySide::run_with`] can invert different bits in each lane.
    /// `copies` is the result of [`Memories::copied`], which added the copies to `design`. Without this call, `run_with`
    /// inverts no bits.
    ///
    /// # Errors
    /// Fails if the design does not have the input port of the copies.
    pub fn with_copies(mut self, design: &Design, copies: Memories) -> Result<Self> {
        let port = design.input_position(copies.lane)?;
        (0..LANES).for_each(|lane| self.inputs[port][lane] = lane as u64);
        self.copies = Some(copies);
        Ok(self)
    }

    /// Runs computations as [`SideBySide::run`] does, but inverts the bits `faults[i]` of one ROM word in lane i. `word` is the
    /// number of the word through all ROMs. The word is restored afterwards.
    ///
    /// # Errors
    /// Fails if a computation does not end within 65536 clocks.
    pub fn run_with(
        &mut self,
        computations: &[&[i64]],
        word: u32,
        faults: &[u64],
    ) -> Result<Vec<OutputTrace>> {
        self.invert(word, faults);
        let shown = self.run(computations.iter().copied(), |_, _| ());
        self.invert(word, faults);
        shown
    }

    fn invert(&mut self, word: u32, faults: &[u64]) {
        let Some(copies) = &self.copies else { return };
        for (lane, &bits) in faults.iter().enumerate() {
            copies.invert(&mut self.machine, lane, word, bits);
        }
    }

    /// Runs at most [`LANES`] computations to their ends, from raw operands in the order of `Contract::operands`, and returns
    /// their outputs. Calls `see` before each clock edge with the simulator and the set of busy lanes.
    ///
    /// # Errors
    /// Fails if a computation does not end within 65536 clocks.
    pub fn run<'c>(
        &mut self,
        computations: impl IntoIterator<Item = &'c [i64]>,
        mut see: impl FnMut(&Machine<LANES>, Lanes),
    ) -> Result<Vec<OutputTrace>> {
        let mut shown = Vec::new();
        for (lane, computation) in computations.into_iter().enumerate() {
            for port in &self.ports.operands {
                self.inputs[port.data][lane] = port.pattern(computation);
                self.inputs[port.strobe][lane] = 1;
            }
            self.inputs[self.ports.start][lane] = 1;
            shown.push(OutputTrace::default());
        }
        self.clock();
        for port in &self.ports.operands {
            let mask = mask(port.format.width());
            self.inputs[port.data].iter_mut().for_each(|bits| *bits ^= mask);
            self.inputs[port.strobe] = [0; LANES];
        }
        self.inputs[self.ports.start] = [0; LANES];
        for clock in 1..LIMIT {
            self.machine.update(false, Some(&self.inputs));
            let bits = |net| lanes(self.machine.lanes(net));
            let (busy, valid) = (bits(self.busy), bits(self.ports.valid));
            for (lane, shown) in shown.iter_mut().enumerate() {
                if shown.clocks > 0 {
                    continue;
                }
                if busy >> lane & 1 == 0 {
                    shown.clocks = clock;
                } else if valid >> lane & 1 == 1 {
                    let results = self.ports.results.iter();
                    let outputs = results.map(|&(net, _)| self.machine.lane(net, lane));
                    shown.results.push((clock, outputs.collect()));
                }
            }
            if shown.iter().all(|shown| shown.clocks > 0) {
                return Ok(shown);
            }
            see(&self.machine, busy);
            self.machine.update(true, None);
        }
        bail!("a computation does not end within {LIMIT} clocks")
    }

    fn clock(&mut self) {
        self.machine.update(false, Some(&self.inputs));
        self.machine.update(true, None);
    }
}

fn lanes(bits: [u64; LANES]) -> Lanes {
    bits.iter().enumerate().fold(0, |set, (lane, &bit)| set | (bit as Lanes & 1) << lane)
}

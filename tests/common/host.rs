//! Drives a core in the built-in simulator as a host does, by the names of the ports.

use glint::hdl::netlist::{Design, NetId};
use glint::hdl::sim::Simulator;

/// A core in the simulator.
pub struct Host<'a> {
    design: &'a Design,
    simulator: Simulator,
}

impl<'a> Host<'a> {
    /// The core after a clock of reset.
    pub fn new(design: &'a Design) -> Self {
        let mut host = Self { design, simulator: Simulator::new(design).expect("a simulator") };
        host.clock();
        host.set("rst_n", 1);
        host
    }

    pub fn clock(&mut self) {
        self.simulator.clock().expect("a clock");
    }

    /// Sets the bits of an input.
    pub fn set(&mut self, name: &str, bits: u64) {
        let at = self.simulator.input(name).unwrap_or_else(|| panic!("no input {name}"));
        self.simulator.set(at, bits);
    }

    fn net(&self, name: &str) -> NetId {
        self.design.find(name).unwrap_or_else(|| panic!("no {name}"))
    }

    /// Returns the bits of a signal.
    pub fn value(&self, name: &str) -> u64 {
        self.simulator.value(self.net(name))
    }

    /// Returns the number that a signal holds, in its last places.
    pub fn raw(&self, name: &str) -> i64 {
        self.design.net(self.net(name)).format.raw(self.value(name)) as i64
    }

    /// Puts a number on an operand's port, and raises its strobe.
    pub fn write(&mut self, operand: &str, raw: i64) {
        let format = self.design.net(self.net(operand)).format;
        self.set(operand, format.bits(raw.into()));
        self.set(&format!("{operand}_write"), 1);
    }

    /// Clears an operand's port, and lowers its strobe.
    pub fn release(&mut self, operand: &str) {
        self.set(operand, 0);
        self.set(&format!("{operand}_write"), 0);
    }

    /// Writes operands together with `start`, which a clock takes.
    pub fn start(&mut self, operands: &[(&str, i64)]) {
        operands.iter().for_each(|&(name, raw)| self.write(name, raw));
        self.set("start", 1);
        self.clock();
        self.set("start", 0);
        operands.iter().for_each(|(name, _)| self.release(name));
    }

    /// Goes on to the first clock in which `valid` is high, and returns its number after `start`.
    pub fn until_valid(&mut self) -> u32 {
        for clock in 1..100 {
            if self.value("valid") == 1 {
                return clock;
            }
            self.clock();
        }
        panic!("never valid");
    }
}

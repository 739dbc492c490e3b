//! Runs instances of one design side by side in the lanes of one simulator, which is faster than one simulator for each
//! instance.

use anyhow::{Context, Result, ensure};

use super::ports::Ports;
use glint_golden::Contract;
use glint_rtl::netlist::{Design, Role};
use glint_rtl::sim::Simulator;

/// A simulator with an instance of the design in each lane, after reset. `out_ready` of a pipeline is always high, so that
/// results never wait.
pub(super) struct Instances<const LANES: usize> {
    pub(super) simulator: Simulator<LANES>,
    pub(super) ports: Ports,
}

impl<const LANES: usize> Instances<LANES> {
    pub(super) fn new(design: &Design, contract: &dyn Contract) -> Result<Self> {
        let ports = Ports::new(design, contract)?;
        let mut simulator = Simulator::<LANES>::new(design)?;
        simulator.clock()?;
        for at in ports.out_ready.into_iter().chain([ports.reset]) {
            simulator.set_lanes(at, [1; LANES]);
        }
        Ok(Self { simulator, ports })
    }

    /// Writes the same words into the writable table of every lane. No instance may compute.
    ///
    /// # Errors
    /// Fails if the design has no writable table, if a word has another number of parts, or if the core is not ready to load a
    /// word.
    pub(super) fn load_table(&mut self, design: &Design, words: &[Vec<i64>]) -> Result<()> {
        let input = |role: Role| design.inputs().position(|port| port.role == role);
        let lacks = || format!("`{}` has no table that can be written", design.name);
        let write = input(Role::TableWrite).with_context(lacks)?;
        let address = input(Role::TableAddress).with_context(lacks)?;
        let ready = design.port(|role| role == Role::TableReady).with_context(lacks)?.net;
        let inputs = design.inputs().enumerate();
        let parts: Vec<usize> =
            inputs.filter(|(_, port)| port.role == Role::TableWord).map(|(at, _)| at).collect();
        for (number, word) in (0..).zip(words) {
            ensure!(word.len() == parts.len(), "a word has {} parts", parts.len());
            self.simulator.set_lanes(write, [1; LANES]);
            self.simulator.set_lanes(address, [number; LANES]);
            for (&part, &raw) in parts.iter().zip(word) {
                self.simulator.set_lanes(part, [raw as u64; LANES]);
            }
            self.simulator.settle()?;
            ensure!(self.simulator.lane(ready, 0) == 1, "the core is not ready to load a word");
            self.simulator.clock()?;
        }
        self.simulator.set_lanes(write, [0; LANES]);
        Ok(())
    }

    /// Starts computations in the next clock. Entry i of `computations` has the raw operands for lane i, in the order of
    /// `Contract::operands`; a lane without an entry starts nothing.
    pub(super) fn offer(&mut self, computations: [Option<&[i64]>; LANES]) {
        let taking = computations.map(|raw| u64::from(raw.is_some()));
        for port in &self.ports.operands {
            // The data of lanes that take no computation do not matter, because their strobe is low.
            let bits = computations.map(|raw| raw.map_or(0, |raw| port.pattern(raw)));
            self.simulator.set_lanes(port.data, bits);
            self.simulator.set_lanes(port.strobe, taking);
        }
        self.simulator.set_lanes(self.ports.start, taking);
    }

    /// Lowers `start` and all write strobes. The operand values stay on the ports.
    pub(super) fn release(&mut self) {
        for at in self.ports.operands.iter().map(|port| port.strobe).chain([self.ports.start]) {
            self.simulator.set_lanes(at, [0; LANES]);
        }
    }

    /// Returns the raw results that `lane` shows in this clock, in the order of `Contract::outputs`.
    pub(super) fn results(&self, lane: usize) -> impl Iterator<Item = i64> {
        let results = self.ports.results.iter();
        results.map(move |&(net, format)| format.raw(self.simulator.lane(net, lane)) as i64)
    }
}

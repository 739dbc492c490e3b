//! Applies the vectors of a test bench to a design in the built-in simulator, and compares only outputs, as the emitted bench
//! does.
//!
//! Mutation testing does this once for each planted fault. The code is in this crate because the release profile optimises this
//! crate for inner loops, but not the crate of mutation testing.

use anyhow::Result;
use glint_rtl::netlist::{Design, Role};
use glint_rtl::sim::Simulator;

use crate::observation::Vectors;

impl Vectors {
    /// Returns whether the bench notices a fault in the design: in some clock, a compared output has another value than the
    /// vectors expect.
    ///
    /// # Errors
    /// Fails if the design cannot be simulated.
    pub fn notice_a_fault_in(&self, design: &Design) -> Result<bool> {
        let mut simulator: Simulator = Simulator::new(design)?;
        let outputs: Vec<_> = design.outputs().collect();
        let reset = design.inputs().position(|port| port.role == Role::Reset);
        // In a pipeline, this output says that the results belong to a point.
        let valid = outputs.iter().position(|port| port.role == Role::Valid);
        let shown = valid.filter(|_| design.pipeline.is_some());
        let mut was_reset = false;
        for (clock, (inputs, row)) in self.inputs.iter().zip(&self.expected).enumerate() {
            for (at, &bits) in inputs.iter().enumerate() {
                simulator.set(at, bits);
            }
            // Outputs of a sequential core depend on registers alone, and have had their values since the edge
            // before. The `in_ready` of a pipeline depends on `out_ready`.
            if shown.is_some() {
                simulator.settle()?;
            }
            for (port, &expected) in outputs.iter().zip(row) {
                let compared = match port.role {
                    role if role.is_status() => was_reset,
                    _ => clock >= self.known_from && shown.is_none_or(|at| row[at] == 1),
                };
                if compared && simulator.value(port.net) != expected {
                    return Ok(true);
                }
            }
            was_reset |= reset.is_none_or(|reset| inputs[reset] == 0);
            simulator.clock()?;
        }
        Ok(false)
    }
}

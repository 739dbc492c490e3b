//! Applies the vectors of the test bench that Glint ships with a core to a mutant, a design with one fault. The built-in
//! simulator runs the mutant. Only outputs are compared, as in the shipped bench.

use anyhow::Result;

use glint_core::core::Core;
use glint_core::package::Vectors;
use glint_rtl::netlist::{Design, Role};
use glint_rtl::sim::Simulator;

/// The vectors of the test bench that is shipped with a core. The built-in simulator applies them.
pub(super) struct Shipped(Vectors);

impl Shipped {
    /// Makes the vectors of a configuration's shipped bench.
    ///
    /// # Errors
    /// Fails if golden model and simulation do not agree.
    pub(super) fn of(core: &Core) -> Result<Self> {
        core.shipped_vectors().map(Self)
    }

    /// Returns whether a mutant differs in an output that the bench compares. The bench does not compare registers.
    ///
    /// # Errors
    /// Fails if the mutant cannot be simulated.
    pub(super) fn notices(&self, mutant: &Design) -> Result<bool> {
        let mut simulator: Simulator = Simulator::new(mutant)?;
        let Self(vectors) = self;
        let outputs: Vec<_> = mutant.outputs().collect();
        let reset = mutant.inputs().position(|port| port.role == Role::Reset);
        // In a pipeline, this output says that the results belong to a point.
        let valid = outputs.iter().position(|port| port.role == Role::Valid);
        let shown = valid.filter(|_| mutant.pipeline.is_some());
        let mut was_reset = false;
        for (clock, (inputs, row)) in vectors.inputs.iter().zip(&vectors.expected).enumerate() {
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
                    _ => clock >= vectors.known_from && shown.is_none_or(|at| row[at] == 1),
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

//! The inputs of emission in addition to the design: clocks, contract, stimulus and surroundings.

use super::surroundings::Surroundings;
use crate::observation::{Computation, ContractFacts, Vectors, WorkedExample};
use glint_rtl::netlist::{Design, HandshakeTiming};
use glint_rtl::verilog::header::Origin;

/// The inputs of the files beyond the design.
#[derive(Clone, Debug, Default)]
pub struct EmitInputs {
    /// The command that makes the files again, with the configuration by its [`glint_base::input::label`].
    pub regenerate: String,
    /// Tells the configuration from others: SHA-256 in hexadecimal.
    pub configuration: String,
    /// Clocks, for header and manifest.
    pub timing: HandshakeTiming,
    /// One computation with all its numbers, for the manifest.
    pub example: Option<WorkedExample>,
    /// The contract of the results, for the manifest.
    pub accuracy: Option<ContractFacts>,
    /// Computations with all that they show, for the manifest.
    pub computations: Vec<Computation>,
    /// Stimulus and expected outputs; without them there is no bench.
    pub vectors: Option<Vectors>,
    /// The surroundings of the core.
    pub around: Surroundings,
    /// The design with the microprogram from which a pipeline is made: the model in C is made of it.
    pub sequential: Option<Design>,
}

impl EmitInputs {
    /// Returns the part of each Verilog file's header that says how the file was made.
    pub(super) fn origin(&self) -> Origin<'_> {
        Origin { regenerate: &self.regenerate, timing: &self.timing }
    }
}

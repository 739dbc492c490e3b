//! Defines the data that emission needs in addition to the netlist: timing, contract, bench vectors, and the wrappers and
//! packages that the configuration asks for.

use super::surroundings::Surroundings;
use crate::observation::{Computation, ContractFacts, Vectors, WorkedExample};
use glint_rtl::netlist::{Design, HandshakeTiming};
use glint_rtl::verilog::header::Origin;

/// The data that Glint needs in addition to the netlist to generate the files of a core.
#[derive(Clone, Debug, Default)]
pub struct EmitInputs {
    /// The command that generates the files again. The command names the configuration by its [`glint_base::input::label`].
    pub regenerate: String,
    /// A digest that identifies the configuration: SHA-256 in hexadecimal.
    pub configuration: String,
    /// The number of clocks between the events of the handshake, for the heads of files and the manifest.
    pub timing: HandshakeTiming,
    /// A computation with the values of all operands and outputs, for the manifest.
    pub example: Option<WorkedExample>,
    /// The accuracy contract, the promised bound of the error, for the manifest.
    pub accuracy: Option<ContractFacts>,
    /// Example computations with their results and numbers of clocks, for the manifest.
    pub computations: Vec<Computation>,
    /// The vectors of the test bench. Without vectors, no test bench is emitted.
    pub vectors: Option<Vectors>,
    /// The wrappers and packages that the configuration asks for.
    pub around: Surroundings,
    /// For a pipeline, the sequential design from which Glint made it. Glint generates the model in C from that design.
    pub sequential: Option<Design>,
}

impl EmitInputs {
    /// Returns the part of each Verilog file's header that says how the file was made.
    pub(super) fn origin(&self) -> Origin<'_> {
        Origin { regenerate: &self.regenerate, timing: &self.timing }
    }
}

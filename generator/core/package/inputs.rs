//! Defines the data that Glint needs besides the netlist to generate the files of a core.

use super::surroundings::Surroundings;
use super::table_image::TableImage;
use crate::observation::{Computation, ContractFacts, Vectors, WorkedExample};
use glint_rtl::netlist::{Design, HandshakeTiming};
use glint_rtl::verilog::header::Origin;

#[derive(Clone, Debug, Default)]
pub struct EmitInputs {
    /// The command that generates the files again. The command names the configuration by its [`glint_base::input::label`].
    pub regenerate: String,
    /// The SHA-256 of the configuration, in hexadecimal.
    pub configuration: String,
    pub timing: HandshakeTiming,
    pub example: Option<WorkedExample>,
    pub accuracy: Option<ContractFacts>,
    pub computations: Vec<Computation>,
    pub vectors: Option<Vectors>,
    pub around: Surroundings,
    /// For a pipeline, the sequential design from which Glint made it, and from which it generates the model in C.
    pub sequential: Option<Design>,
    /// The further functions for which the table of the core is planned.
    pub images: Vec<TableImage>,
}

impl EmitInputs {
    pub(super) fn origin(&self) -> Origin<'_> {
        Origin { regenerate: &self.regenerate, timing: &self.timing }
    }
}

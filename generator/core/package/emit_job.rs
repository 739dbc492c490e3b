//! Collects the data that the generators of a core's files read: the netlist, facts such as the clocks of a computation, the
//! names of modules and memories in the Verilog, and the registers on a bus. For example, the test bench takes the ports from
//! `design`, and the name of the control unit's instance from `naming`.

use super::bus::Bus;
use super::inputs::EmitInputs;
use super::map::Map;
use glint_rtl::netlist::Design;
use glint_rtl::verilog::naming::Naming;

/// A core to emit: its netlist, and everything else that its files are generated from.
pub struct EmitJob<'a> {
    pub design: &'a Design,
    pub inputs: &'a EmitInputs,
    pub naming: &'a Naming,
    /// The bus that the configuration asks for, and the registers on it.
    pub registers: Option<(&'static Bus, Map)>,
}

impl<'a> EmitJob<'a> {
    /// Returns the name of the core.
    pub fn name(&self) -> &'a str {
        &self.design.name
    }

    /// Returns the command that makes the files again.
    pub fn regenerate(&self) -> &'a str {
        &self.inputs.regenerate
    }

    /// Returns whether the core computes lines of points.
    pub fn is_line(&self) -> bool {
        self.inputs.accuracy.as_ref().is_some_and(|accuracy| accuracy.length.is_some())
    }
}

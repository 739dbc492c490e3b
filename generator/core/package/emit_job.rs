//! Collects the data of one core that the generators of its files read.
//!
//! An [`EmitJob`] has the netlist, facts such as the clocks of a computation, the names of modules and memories in the emitted
//! Verilog, and the core's registers on a bus.

use anyhow::Result;

use super::bus::Bus;
use super::inputs::EmitInputs;
use super::instructions::Instructions;
use super::map::Map;
use super::processor::ProcessorInterface;
use glint_rtl::netlist::Design;
use glint_rtl::verilog::naming::Naming;

/// A core to emit: its netlist, and everything else that its files are generated from.
pub struct EmitJob<'a> {
    pub design: &'a Design,
    pub inputs: &'a EmitInputs,
    pub naming: &'a Naming,
    /// The bus that the configuration asks for, and the map of the core's registers on it.
    pub registers: Option<(&'static Bus, Map)>,
    /// The interface of a processor that the configuration asks for, and the instructions of the core on it.
    pub instructions: Option<(&'static ProcessorInterface, Instructions)>,
}

impl<'a> EmitJob<'a> {
    /// Returns the job for a core, with the registers and the instructions that its configuration asks for.
    ///
    /// # Errors
    /// Fails if the core cannot have these registers or instructions.
    pub fn new(design: &'a Design, inputs: &'a EmitInputs, naming: &'a Naming) -> Result<Self> {
        let registers = match inputs.around.registers {
            Some(bus) => Some((bus, Map::new(design, inputs)?)),
            None => None,
        };
        let instructions = match inputs.around.processor {
            Some(processor) => Some((processor, Instructions::new(design, inputs)?)),
            None => None,
        };
        Ok(Self { design, inputs, naming, registers, instructions })
    }

    /// Returns the number of results of a pipeline that can wait behind bus registers, or `None` if the core has no such queue.
    pub fn queue(&self) -> Option<u32> {
        self.registers.as_ref()?;
        self.inputs.around.queue_of(self.design)
    }

    pub fn name(&self) -> &'a str {
        &self.design.name
    }

    /// Returns the command that generates the core's files again, which their heads quote.
    pub fn regenerate(&self) -> &'a str {
        &self.inputs.regenerate
    }

    pub fn is_line(&self) -> bool {
        self.inputs.accuracy.as_ref().is_some_and(|accuracy| accuracy.length.is_some())
    }
}

//! Describes the functions of a core that computes several of them, such as a unit.

use glint_base::fixed::Format;

use super::Design;
use super::termination::done_after_dispatch;

/// One of several functions that a core computes. The operand [`OPCODE`] selects the function.
///
/// A function has names and formats of its own for the bits at the ports. For example, the function `atan2` of a unit reads its
/// operand `y` in the low 16 bits of the port `b`.
#[derive(Clone, Debug, PartialEq)]
pub struct CoreFunction {
    /// A legal Verilog identifier. The emitted files define a constant `FUNCTION_<NAME>` with the opcode.
    pub name: String,
    /// The formulas on one line.
    pub doc: String,
    pub operands: Vec<FunctionPort>,
    pub results: Vec<FunctionPort>,
}

impl CoreFunction {
    /// Returns the name of the constant with the opcode, for example `FUNCTION_RCP`.
    pub fn constant(&self) -> String {
        format!("FUNCTION_{}", self.name.to_uppercase())
    }
}

/// The operand whose value is the number of a function in [`Design::functions`].
pub const OPCODE: &str = "opcode";

/// An operand or a result of a function, in the low bits of a port.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionPort {
    /// The name of the port of the core.
    pub port: String,
    /// The name of the value in the function.
    pub name: String,
    /// The format of the value, which has at most as many bits as the port.
    pub format: Format,
    /// A remark on one line, such as the error of a result; may be empty.
    pub doc: String,
}

impl Design {
    /// Returns the clock after `start` in which `done` is high for the function with this opcode. Returns `None` for a pipeline,
    /// whose latency is the same for all functions, and if other operands than the opcode influence the clock.
    pub fn clocks_of_function(&self, opcode: usize) -> Option<u32> {
        done_after_dispatch(self, opcode)
    }

    /// Returns the number of bits of an opcode; `None` if the core computes a single function.
    pub fn opcode_bits(&self) -> Option<u32> {
        let last = self.functions.len().checked_sub(1)?;
        let needed = (usize::BITS - last.leading_zeros()).max(1);
        Some(self.find(OPCODE).map_or(needed, |opcode| self.width(opcode)))
    }
}

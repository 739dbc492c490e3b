//! Inserts registers into a sequential design where an operand has several clocks to reach its first reader.
//!
//! No result comes later. For example, a product of two operands that is first used in the third clock may have a register
//! behind it.

mod first_use;
mod operands;

pub use operands::register_held;

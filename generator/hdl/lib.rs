//! Hardware: descriptions of it, the netlist that they become, its simulation and its Verilog.

pub mod blocks;
pub mod dsl;
pub mod netlist;
pub mod pipeline;
pub mod sim;
pub mod verilog;

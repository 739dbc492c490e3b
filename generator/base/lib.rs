//! Provides the basis of most other crates, such as fixed-point formats, intervals, diagnostics, key errors, FPGA targets, names,
//! text and input.

pub mod codes;
pub mod cone;
pub mod config_error;
pub mod diagnostic;
pub mod fixed;
pub mod identifier;
pub mod input;
pub mod interval;
pub mod keywords;
pub mod program;
pub mod target;
pub mod template;
pub mod text;

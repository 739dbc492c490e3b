//! Fixed-point formats, intervals, diagnostics, names, text and input: what all other modules use.

pub mod codes;
pub mod cone;
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

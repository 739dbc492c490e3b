//! Provides the basis of all other crates: fixed-point formats, intervals, diagnostics, targets, names, text and input.

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

//! Glint: specular-shading hardware from Rust descriptions.

pub mod config;
pub mod fixed;
pub mod golden;
pub mod netlist;
pub mod reference;

//! Glint: specular-shading hardware from Rust descriptions.

pub mod config;
pub mod cosim;
pub mod fixed;
pub mod golden;
pub mod netlist;

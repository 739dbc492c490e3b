//! Glint: specular-shading hardware from Rust descriptions.

pub mod check;
pub mod config;
pub mod devices;
pub mod dsl;
pub mod emit;
pub mod cosim;
pub mod fixed;
pub mod golden;
pub mod identifier;
pub mod microcode;
pub mod netlist;
pub mod reference;
pub mod sim;

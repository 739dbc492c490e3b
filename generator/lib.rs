//! Glint: specular-shading hardware from Rust descriptions.

pub mod check;
pub mod cli;
pub mod config;
pub mod cosim;
pub mod devices;
pub mod dsl;
pub mod emit;
pub mod fixed;
pub mod flow;
pub mod golden;
pub mod identifier;
pub mod microcode;
pub mod netlist;
pub mod reference;
pub mod registry;
pub mod sim;

//! Glint: specular-shading hardware from Rust descriptions.
//!
//! A device is a [`registry::Device`]: keys ([`config::Schema`]), a description ([`dsl`]), a golden model
//! ([`golden::Model`]) and a contract ([`golden::Contract`]). [`cli::run`] makes a command line of a
//! registry, whether its devices are the catalogue's or your own: `examples/fresnel.rs` is a complete
//! one, to be read from top to bottom.

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
pub mod mutate;
pub mod netlist;
pub mod reference;
pub mod registry;
pub mod report;
pub mod setup;
pub mod sim;
pub mod verify;
mod words;

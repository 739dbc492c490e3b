//! Glint: specular-shading hardware from Rust descriptions.
//!
//! A device is a [`registry::Device`]: keys ([`config::Schema`]), a description ([`dsl`]), a golden model
//! ([`golden::Model`]) and a contract ([`golden::Contract`]). [`cli::run`] makes a command line of a
//! registry, whether its devices are the catalogue's or your own: `examples/fresnel` is a complete
//! one, to be read from top to bottom.

pub mod base;
#[cfg(feature = "cli")]
pub mod cli;
pub mod config;
pub mod core;
pub mod cosim;
pub mod devices;
#[cfg(feature = "cli")]
pub mod evidence;
pub mod golden;
pub mod hdl;
#[cfg(feature = "cli")]
pub mod mutate;
pub mod observation;
pub mod package;
#[cfg(feature = "cli")]
pub mod pages;
pub mod registry;
#[cfg(feature = "cli")]
pub mod render;
#[cfg(feature = "cli")]
pub mod synth;
pub mod tools;
#[cfg(feature = "cli")]
pub mod tune;
#[cfg(feature = "cli")]
pub mod verify;

pub use base::fixed;
pub use hdl::dsl;

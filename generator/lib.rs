//! Glint: specular-shading hardware from Rust descriptions.
//!
//! A device ([`registry::Device`]) has four parts:
//!
//! - its keys ([`config::Schema`]): the settings in its configuration files, such as the widths of operands,
//! - its description ([`dsl`]): a Rust function that builds the hardware,
//! - its golden model ([`golden::Model`]), which predicts the architectural registers and the outputs in every clock,
//! - its contract ([`golden::Contract`]): the exact formula of each output, and a bound on the error if the author states one.
//!
//! A registry ([`registry::Registry`]) is a list of devices, from the catalogue or your own. `cli::run` runs the whole
//! command line of Glint for the devices of a registry.
//!
//! Two examples are complete devices outside the library. Read them from top to bottom: `examples/fresnel`
//! multiplies colours, and `examples/smoothstep` computes a function of one operand.
//!
//! | to | see |
//! |---|---|
//! | describe a datapath and its microprogram | [`dsl`], [`hdl::blocks`] |
//! | build a device from other devices | [`dsl::Designer::instance`], [`golden::frame::Frame::part`] |
//! | predict a device, clock by clock and by its formula | [`golden::device`], [`golden::highlight`] |
//! | state the keys of a device, and read a configuration | [`config`] |
//! | simulate a design in the program | [`hdl::sim::Simulator`] |
//! | get everything for a configuration: model, contract, files, co-simulation | [`core::Core`] |
//!
//! Items without documentation here are public only for the tests of this crate, and may change in any version.
//!
//! ```
//! use glint::config::Config;
//! use glint::core::Core;
//! use glint::registry::Registry;
//!
//! let registry = Registry::catalogue();
//! let device = *registry.devices().iter().find(|it| it.name == "cosine-power").unwrap();
//! let core = Core::new(device, Config::defaults(&(device.schema)(), "highlight")).unwrap();
//! assert!(core.contract.bounds().governing().units < 1.0);
//! // Golden model and simulation on every clock of a hundred points.
//! let outcome = core.lockstep(1).unwrap().run(100, &|_| ()).unwrap();
//! assert!(outcome.mismatch.is_none());
//! ```

#[cfg(feature = "cli")]
pub use glint_cli as cli;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub use glint_prove::{batch, certify, equality, mutate, synth, tune, verify};
#[cfg(feature = "cli")]
#[doc(hidden)]
pub use glint_show::{evidence, pages, render};
#[cfg(feature = "cli")]
#[doc(hidden)]
pub use glint_tools as tools;

pub use glint_approximate as approximate;
pub use glint_base as base;
pub use glint_base::{fixed, target};
pub use glint_catalogue as devices;
pub use glint_config as config;
pub use glint_config::{choices, keys};
pub use glint_core::{core, cosim, observation, package, registry};
pub use glint_formula as formula;
pub use glint_golden as golden;
pub use glint_keys as keys;
pub use glint_rtl as hdl;
pub use glint_rtl::dsl;

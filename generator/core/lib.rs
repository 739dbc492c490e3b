//! Builds a core from a configuration, emits its files, and co-simulates it with the golden model.
//!
//! This crate and the crates of Glint on which it depends start no processes and handle no signals. The only threads of these
//! crates belong to the library rayon. A test (`tests/quick/rooms.rs`) checks that the sources do not use `std::thread`,
//! `std::process::Command` or signals.

pub mod core;
pub mod cosim;
pub mod observation;
pub mod package;
pub mod registry;

//! Builds a core from a configuration, emits its files, and co-simulates it with the golden model.
//!
//! This crate and the crates below it start no processes, no threads of their own, and handle no signals. A test
//! (`tests/quick/rooms.rs`) checks this.

pub mod core;
pub mod cosim;
pub mod observation;
pub mod package;
pub mod registry;

//! Builds a core from a configuration, emits its files, and co-simulates it with the golden model.
//!
//! This crate and the crates on which it depends start no processes and no threads of their own, and handle no signals. A test
//! (`tests/quick/rooms.rs`) checks these restrictions.

pub mod core;
pub mod cosim;
pub mod observation;
pub mod package;
pub mod registry;

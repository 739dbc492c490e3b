//! Makes everything that follows from a configuration: its files, and the checks that its core is correct.
//!
//! This crate and the crates below it start no process, no thread of their own and no signal handler
//! (`tests/quick/rooms.rs`).

pub mod core;
pub mod cosim;
pub mod observation;
pub mod package;
pub mod registry;

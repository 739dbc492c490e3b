//! Makes everything that follows from a configuration: its files, and the checks whether they do what they should.
//!
//! No process, thread of its own or signal is in this crate or below it (`tests/quick/rooms.rs`).

pub mod core;
pub mod cosim;
pub mod observation;
pub mod package;
pub mod registry;

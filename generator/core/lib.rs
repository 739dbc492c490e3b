//! From a configuration to everything that is made of it: its files, and whether they do what they should.
//!
//! No process, thread of its own or signal is in this crate or below it (`tests/quick/rooms.rs`).

pub mod core;
pub mod cosim;
pub mod observation;
pub mod package;
pub mod registry;

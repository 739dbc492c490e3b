//! Makes pages, datasheets, charts and pictures of a core, and keeps the measurements that they show.
//!
//! No process, thread of its own or signal is in this crate or below it (`tests/quick/rooms.rs`).

pub mod evidence;
pub mod figures;
pub mod pages;
pub mod render;

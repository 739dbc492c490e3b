//! Makes documentation pages, datasheets, charts and rendered pictures of a core, and keeps the measurements that they show.
//!
//! This crate and the crates below it start no processes, no threads of their own and no signal handlers.

pub mod evidence;
pub mod figures;
pub mod pages;
pub mod render;

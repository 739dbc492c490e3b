//! What Glint shows of a core: pages, datasheets, charts, pictures, and what is measured for them.
//!
//! No process, thread of its own or signal is in this crate or below it: it works where there is no operating system.

pub mod evidence;
pub mod figures;
pub mod pages;
pub mod render;

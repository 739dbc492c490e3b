//! What everything else is written with.

pub mod fixed;
pub mod identifier;
pub mod keywords;
pub mod text;

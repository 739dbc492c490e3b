//! What everything else is written with.

pub mod diagnostic;
pub mod fixed;
pub mod identifier;
pub mod input;
pub mod keywords;
pub mod text;
pub mod transient;

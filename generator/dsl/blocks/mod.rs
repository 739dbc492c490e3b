//! Blocks that several devices share, and that a device of your own can take too.

pub mod colour;
pub mod segmented;
pub mod squaring;

//! Blocks that several devices share, and that a device of your own can take too.

pub mod angle;
pub mod colour;
pub mod divider;
pub mod exponential;
pub mod line;
pub mod quadrant;
pub mod segmented;
pub mod shift;
pub mod squaring;

//! Hardware blocks for descriptions: several devices share them, and a device of your own can take them too.

pub mod angle;
pub mod colour;
pub mod divider;
pub mod exponential;
pub mod line;
pub mod quadrant;
pub mod segmented;
pub mod shift;
pub mod squaring;

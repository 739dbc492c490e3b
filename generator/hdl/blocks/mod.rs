//! Hardware blocks that several devices share, such as a divider, shifters and tables. Devices outside the library can also use
//! these blocks.

pub mod angle;
pub mod colour;
pub mod divider;
pub mod exponential;
pub mod line;
pub mod quadrant;
pub mod segmented;
pub mod shift;
pub mod squaring;

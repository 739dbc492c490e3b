<<<<<<< HEAD
//! Co-simulation: stimulus, golden model against built-in simulator, external simulators.

pub mod external;
mod lockstep;
mod stimulus;
pub mod trial;

pub use lockstep::{Lockstep, Mismatch, Outcome, Worst};
pub use stimulus::{Random, Stimulus};
=======
//! Co-simulation: the same stimulus through independent simulators, compared clock by clock.

pub mod external;
>>>>>>> e7862cb71420f0ee6a9fb655dfb72da28a1d87c3

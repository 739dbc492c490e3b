//! Co-simulation: stimulus, golden model against built-in simulator, external simulators,
//! synthesis.

pub mod batch;
pub mod exhaustive;
pub mod external;
mod lockstep;
mod pairing;
mod stimulus;
mod streams;
pub mod synthesis;
pub mod trial;

pub use lockstep::{Lockstep, Mismatch, Outcome, Worst};
pub use stimulus::{Random, Stimulus};

//! Co-simulation: stimulus, golden model against built-in simulator, external simulators,
//! synthesis.

mod alone;
pub mod batch;
mod combinations;
pub mod exhaustive;
mod lockstep;
mod pairing;
mod stimulus;
mod stream;
mod together;
pub mod trial;

pub use lockstep::{Lockstep, Mismatch, Outcome, Worst};
pub use stimulus::{Random, Stimulus};

//! Co-simulation: stimulus, golden model against built-in simulator, external simulators,
//! synthesis.

mod alone;
pub mod batch;
mod combinations;
pub mod exhaustive;
pub mod external;
mod lockstep;
mod pairing;
mod stimulus;
mod stream;
pub mod synthesis;
mod together;
pub mod trial;

pub use lockstep::{Lockstep, Mismatch, Outcome, Worst};
pub use stimulus::{Random, Stimulus};

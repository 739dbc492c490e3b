//! Co-simulation: stimulus, golden model against built-in simulator, external simulators,
//! synthesis.

mod alone;
mod architecture;
pub mod batch;
mod combinations;
pub mod exhaustive;
mod lockstep;
mod pairing;
mod pipelined;
mod stimulus;
mod stream;
mod together;
pub mod trial;

pub use architecture::Lockstep;
pub use lockstep::{Mismatch, Outcome, Worst};
pub use stimulus::{Random, Stimulus};

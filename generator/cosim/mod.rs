//! Co-simulation: stimulus, and golden model against built-in simulator, clock by clock and exhaustively.

mod alone;
mod architecture;
pub mod batch;
mod binding;
mod combinations;
pub mod directed;
pub mod exhaustive;
mod histogram;
mod lockstep;
mod measure;
mod outcome;
mod pipelined;
mod points;
mod random;
mod recorded;
pub mod search;
mod stimulus;
mod stream;
mod through;
mod together;
pub mod trial;

pub use architecture::Lockstep;
pub use histogram::{CLASSES, Histogram};
pub use outcome::{Mismatch, Outcome, Worst};
pub use points::Points;
pub use random::Random;
pub use stimulus::Stimulus;

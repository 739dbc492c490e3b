//! Co-simulates designs: draws stimulus, and compares the golden model with the built-in simulator, clock by clock and
//! exhaustively.

pub mod batch;
mod binding;
mod combinations;
pub mod directed;
mod driven;
pub mod exhaustive;
mod histogram;
mod instances;
mod lockstep;
mod measure;
mod offers;
mod outcome;
mod pipelined;
mod points;
mod ports;
mod random;
mod recorded;
mod runner;
pub mod search;
mod sequential;
mod stimulus;
mod stream;
mod through;
pub mod trial;

pub use driven::Driven;
pub use histogram::{CLASSES, Histogram};
pub use lockstep::Lockstep;
pub use outcome::{Mismatch, Outcome, Worst};
pub use points::PointSource;
pub use random::Random;

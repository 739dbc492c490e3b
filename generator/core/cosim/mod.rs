//! Co-simulates a design with its golden model.
//!
//! The modules draw random inputs, compare model and simulated hardware at every clock, measure the error of the results, and
//! check all operand combinations of small devices.

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

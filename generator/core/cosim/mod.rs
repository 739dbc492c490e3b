//! Co-simulates a design with its golden model.
//!
//! A *point* is one set of operands, for which a device computes one set of results. A device such as `quad-cosine` computes a
//! line of many points after one `start`. The modules draw random inputs, compare model and simulated hardware at every clock,
//! measure errors, and check all operand combinations of small devices.

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
mod vectors;

pub use driven::Driven;
pub use histogram::{CLASSES, Histogram};
pub use lockstep::Lockstep;
pub use outcome::{Mismatch, Outcome, Worst};
pub use points::PointSource;
pub use random::Random;

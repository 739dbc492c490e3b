//! Proofs and searches about a core, mostly with outside tools.
//!
//! The modules inject faults to test the tests. They prove error bounds and the equality of pipeline and core, measure area and
//! frequency. They search for cheaper configurations, and define the checks of `glint verify`.

pub mod batch;
pub mod certify;
pub mod equality;
pub mod mutate;
pub mod synth;
pub mod tune;
pub mod verify;

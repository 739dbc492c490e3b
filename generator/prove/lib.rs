//! Proofs and searches about a core, mostly by outside tools: faults, error bounds, equality, area and frequency,
//! the smallest widths.

pub mod batch;
pub mod certify;
pub mod equality;
pub mod mutate;
pub mod synth;
pub mod tune;
pub mod verify;

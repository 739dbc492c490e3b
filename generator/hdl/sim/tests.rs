//! Tests of the simulator on netlists built by hand.

mod build;
mod errors;
mod ops;
mod random;
mod state;
mod waveform;

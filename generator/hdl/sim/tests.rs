//! Tests of the simulator on netlists built by hand.

mod build;
mod errors;
mod ops;
mod state;
mod waveform;

//! Defines the error for a pipeline that cannot be made as requested. It states the nearest request that can be satisfied.

use std::fmt;

use crate::netlist::Design;
use glint_base::codes;
use glint_base::diagnostic::{Diagnostic, SourceLocation};

/// The reason why a design has no pipeline with the given [`Options`](super::Options).
///
/// A variant states the nearest possible value. For example, a request for 900 MHz may fail with `Clock { nearest: 130.0, .. }`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PipelineErrorKind {
    /// The microprogram cannot be unrolled into a computation without loops.
    Microprogram,
    /// A single operation takes longer than the clock period.
    Clock {
        /// The highest clock frequency that can be reached, in MHz.
        nearest: f64,
        /// Whether the clock could be reached if multipliers had output registers.
        needs_registered: bool,
    },
    /// The pipeline would have more stages than make it faster.
    TooManyStages {
        /// The largest number of stages that is of use.
        most: usize,
    },
    /// The memories and the registers of multipliers need more stages than requested.
    TooFewStages {
        /// The smallest number of stages.
        least: usize,
    },
    /// The interval exceeds the number of clocks that the sequential core takes for a point.
    Interval {
        /// The largest interval, in clocks.
        most: usize,
    },
    /// The request has a rate but a number of stages instead of a clock frequency.
    RateWithoutClock,
    /// The rate exceeds one point a clock.
    Rate {
        /// The highest rate, in million points a second.
        most: f64,
    },
    /// Every interval needs more multipliers than requested.
    Multipliers {
        /// The smallest number of multipliers that is possible.
        fewest: usize,
    },
    /// The solver found no schedule although one exists, which is a bug of Glint.
    Unsolved,
}

/// The error for a pipeline that cannot be made as requested.
#[derive(Clone, Debug)]
pub struct PipelineError {
    /// The reason why the pipeline cannot be made, with the nearest possible value.
    pub kind: PipelineErrorKind,
    /// The reason as a message, with the line of the Rust source.
    pub diagnostic: Diagnostic,
}

impl PipelineError {
    /// Makes the error of a microprogram that cannot be unrolled.
    pub(super) fn of_microprogram(diagnostic: Diagnostic) -> Self {
        Self { kind: PipelineErrorKind::Microprogram, diagnostic }
    }

    /// Makes the error of an option that concerns the design as a whole.
    pub(super) fn of_design(design: &Design, kind: PipelineErrorKind, message: String) -> Self {
        Self::at(design.nets[0].location, kind, message)
    }

    /// Makes the error of an option that concerns the operation at a line of the Rust source.
    pub(super) fn at(location: SourceLocation, kind: PipelineErrorKind, message: String) -> Self {
        Self { kind, diagnostic: Diagnostic::new(codes::SCHEDULE, message, location) }
    }
}

impl fmt::Display for PipelineError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.diagnostic.fmt(f)
    }
}

impl std::error::Error for PipelineError {}

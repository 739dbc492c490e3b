//! Defines the error for a pipeline that cannot be made as requested.

use std::fmt;

use crate::netlist::Design;
use glint_base::codes;
use glint_base::diagnostic::{Diagnostic, SourceLocation};

/// The reason why Glint cannot turn a sequential design into the requested pipeline. Most variants state the nearest possible
/// value: a request for 900 MHz may fail with `Clock { nearest: 130.0, .. }`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PipelineErrorKind {
    /// The microprogram cannot be unrolled into a computation without loops.
    Microprogram,
    /// A single operation takes longer than the clock period.
    Clock {
        /// The highest clock frequency that can be reached, in MHz.
        nearest: f64,
        /// The highest clock frequency, in MHz, if products use the output registers of multipliers. `None` if it is not higher,
        /// or if the options request these registers already.
        registered: Option<f64>,
    },
    /// More stages are requested than make the pipeline faster.
    TooManyStages {
        /// The largest useful number of stages.
        most: usize,
    },
    /// Block memories and the registers of multipliers need more stages than requested.
    TooFewStages {
        /// The smallest possible number of stages.
        least: usize,
    },
    /// The requested interval exceeds the number of clocks that the sequential core takes for a point.
    Interval {
        /// The number of clocks that the sequential core takes for a point.
        most: usize,
    },
    /// The user requested a rate in points per second together with a number of stages. A rate needs a clock frequency.
    RateWithoutClock,
    /// The requested rate exceeds one point a clock.
    Rate {
        /// The highest rate, in million points a second.
        most: f64,
    },
    /// Every possible interval needs more multipliers than the user allows.
    Multipliers {
        /// The smallest possible number of multipliers.
        fewest: usize,
    },
    /// The solver that assigns operations to stages found no solution although one exists, which is a bug of Glint.
    Unsolved,
}

#[derive(Clone, Debug)]
pub struct PipelineError {
    /// The kind, in most cases with the nearest possible value.
    pub kind: PipelineErrorKind,
    /// The message for the user, with the line of the Rust source that it concerns.
    pub diagnostic: Diagnostic,
}

impl PipelineError {
    /// Makes the error for a microprogram that Glint cannot unroll.
    pub(super) fn of_microprogram(diagnostic: Diagnostic) -> Self {
        Self { kind: PipelineErrorKind::Microprogram, diagnostic }
    }

    /// Makes the error for an option that the design as a whole cannot satisfy, such as a rate, at the design's first net.
    pub(super) fn of_design(design: &Design, kind: PipelineErrorKind, message: String) -> Self {
        Self::at(design.nets[0].location, kind, message)
    }

    /// Makes the error for an option that the operation at the source line `location` cannot satisfy.
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

//! Defines the error for a pipeline that cannot be made as requested. In most cases the error states the nearest possible value.
//! For example, the error for a request of 900 MHz may state that 130 MHz is possible. An error about the microprogram, about a
//! rate without a clock frequency, or about a failure of the solver states no such value.

use std::fmt;

use crate::netlist::Design;
use glint_base::codes;
use glint_base::diagnostic::{Diagnostic, SourceLocation};

/// The reason why Glint cannot turn a sequential design into a pipeline with the clock, stages or interval that the user
/// requested.
///
/// Most variants state the nearest possible value. For example, a request for 900 MHz may fail with
/// `Clock { nearest: 130.0, .. }`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PipelineErrorKind {
    /// The microprogram cannot be unrolled into a computation without loops.
    Microprogram,
    /// A single operation takes longer than the clock period.
    Clock {
        /// The highest clock frequency that can be reached, in MHz.
        nearest: f64,
        /// The highest clock frequency, in MHz, if products use the output registers of multipliers. `None` if this frequency is
        /// not higher, or if the options request these registers already.
        registered: Option<f64>,
    },
    /// The requested number of stages is larger than useful: the additional stages would not make the pipeline faster.
    TooManyStages {
        /// The largest useful number of stages: more stages make the pipeline no faster.
        most: usize,
    },
    /// The requested number of stages is too small. Block memories and the registers of multipliers need more stages.
    TooFewStages {
        /// The smallest possible number of stages.
        least: usize,
    },
    /// The requested interval exceeds the number of clocks that the sequential core takes for a point.
    Interval {
        /// The largest possible interval in clocks: the number of clocks that the sequential core takes for a point.
        most: usize,
    },
    /// The user requested a rate in points per second together with a number of stages. A rate needs a clock frequency instead.
    RateWithoutClock,
    /// The requested rate exceeds one point a clock.
    Rate {
        /// The highest rate, in million points a second.
        most: f64,
    },
    /// Every possible interval needs more multipliers than the user allows.
    Multipliers {
        /// The smallest number of multipliers that is possible.
        fewest: usize,
    },
    /// The solver that assigns operations to stages found no solution although one exists, which is a bug of Glint.
    Unsolved,
}

/// The error for a pipeline that Glint cannot make as the user requested.
#[derive(Clone, Debug)]
pub struct PipelineError {
    /// The reason why the pipeline cannot be made, in most cases with the nearest possible value.
    pub kind: PipelineErrorKind,
    /// The reason as a message for the user, with the line of the Rust source that it concerns.
    pub diagnostic: Diagnostic,
}

impl PipelineError {
    /// Makes the error for a microprogram (the program in a device's control ROM) that Glint cannot unroll into a computation
    /// without loops.
    pub(super) fn of_microprogram(diagnostic: Diagnostic) -> Self {
        Self { kind: PipelineErrorKind::Microprogram, diagnostic }
    }

    /// Makes the error for an option of the pipeline that the design as a whole cannot satisfy, such as a rate. The source line
    /// is the line of the design's first net.
    pub(super) fn of_design(design: &Design, kind: PipelineErrorKind, message: String) -> Self {
        Self::at(design.nets[0].location, kind, message)
    }

    /// Makes the error for an option of the pipeline that one operation cannot satisfy. `location` is the line of the Rust source
    /// with the operation.
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

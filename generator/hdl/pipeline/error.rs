//! Defines the error of a pipeline that cannot be made, with the nearest options that can.

use std::fmt;

use crate::netlist::Design;
use glint_base::codes;
use glint_base::diagnostic::{Diagnostic, SourceLocation};

/// The reason why a design has no pipeline with the given [`Options`](super::Options).
///
/// A variant has the nearest value that can be reached. For example, a pipeline that is asked to run at 900 MHz may fail with
/// `Clock { nearest: 130.0, .. }`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PipelineErrorKind {
    /// The microprogram cannot be unrolled.
    Microprogram,
    /// One operation alone takes longer than the clock.
    Clock {
        /// The fastest clock, in MHz.
        nearest: f64,
        /// Whether the clock can be reached if products end in the registers of multipliers.
        needs_registered: bool,
    },
    /// Some of the stages make the pipeline no faster.
    TooManyStages {
        /// The largest number of stages that is of use.
        most: usize,
    },
    /// The registers in memories and multipliers need more stages.
    TooFewStages {
        /// The smallest number of stages.
        least: usize,
    },
    /// The interval is longer than the sequential core's.
    Interval {
        /// The longest interval, in clocks.
        most: usize,
    },
    /// A rate needs a clock, and the goal is a number of stages.
    RateWithoutClock,
    /// The rate is above a point every clock.
    Rate {
        /// The highest rate, in million points a second.
        most: f64,
    },
    /// Every interval needs more multipliers.
    Multipliers {
        /// The smallest number of multipliers.
        fewest: usize,
    },
    /// The solver found no schedule although there is one: a mistake of Glint's.
    Unsolved,
}

/// A pipeline that cannot be made.
#[derive(Clone, Debug)]
pub struct PipelineError {
    /// The reason.
    pub kind: PipelineErrorKind,
    /// The reason in words, with the line of the Rust source.
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

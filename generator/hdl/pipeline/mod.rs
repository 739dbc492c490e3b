//! Turns a design with a microprogram into a pipeline, which accepts a point (a set of operands) every clock or every few clocks.
//!
//! `unroll` turns the design into a graph of values. `passes` rewrite the graph; the first splits its products to fit the
//! multipliers of a [`Timing`]. `request` finds a schedule (`schedule`), which assigns every value to a stage. `stages` builds
//! the pipeline: it has no microprogram, and a register wherever a value crosses from one stage to the next. None of these
//! modules knows a particular device.

mod delay;
mod error;
mod gates;
mod graph;
mod interval;
mod passes;
mod possible;
mod rebuild;
mod request;
mod schedule;
mod settle;
mod sharing;
mod split;
mod stages;
mod sums;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod text;
mod unroll;

use crate::netlist::Design;
use glint_base::target::Timing;

pub use delay::delay_of;
pub use error::{PipelineError, PipelineErrorKind};
pub use graph::{Cell, Graph, Node, NodeId, NodeOp};
pub use interval::IntervalGoal;
pub use passes::{PASSES, Pass};
use request::Request;
pub use unroll::{
    Cycle, StateValues, Unrolled, UnrolledLine, WalkRegister, any_cycle, carried, unroll,
    unroll_in_powers, unroll_line,
};

/// The goal of the schedule: a clock frequency or a number of stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The fewest register bits for this clock frequency.
    ClockMhz(f64),
    /// The highest clock frequency with this number of stages.
    Stages(usize),
}

/// How values are stored that nothing reads for several stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delays {
    /// In a small memory, if the target has one.
    Memory,
    /// In a register in each stage.
    Registers,
}

/// The options with which a user requests a pipeline.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The FPGA target whose delays and multipliers the schedule assumes.
    pub target: &'static Timing,
    /// The goal of the schedule.
    pub goal: Goal,
    /// How the interval, the number of clocks from one point to the next, is chosen.
    pub interval: IntervalGoal,
    /// Whether products use the output registers of multipliers, if the target states a delay for them.
    pub registered: bool,
    /// Whether the environment can stop the pipeline by `out_ready`.
    pub stall: bool,
    /// The number of bits of the side channel, which travels with a point.
    pub side: u32,
    /// How values are stored that nothing reads for several stages.
    pub delays: Delays,
}

/// Returns the pipeline of a sequential design.
///
/// # Errors
/// Fails if the microprogram cannot be unrolled; the error has its source line. Fails if a clock or a number of
/// stages cannot be reached; the error has the nearest value that can.
pub fn pipeline(sequential: &Design, options: &Options) -> Result<Design, PipelineError> {
    let unrolled =
        unroll::unroll_for_pipeline(sequential).map_err(PipelineError::of_microprogram)?;
    let unrolled = passes::applied(unrolled, options);
    let request = Request::new(sequential, &unrolled, options);
    let interval = request.interval()?;
    let problems = request.problems(options.registered, interval);
    let schedule = request.schedule(&problems, interval)?;
    Ok(stages::assemble(sequential, &unrolled, &problems, &schedule, (options, interval)))
}

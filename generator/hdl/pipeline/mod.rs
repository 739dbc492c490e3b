//! Makes a pipeline of a design with a microprogram. The pipeline takes a point every clock or every few clocks.
//!
//! `unroll` turns the design into a graph of values. The first of the `passes` splits its products to fit the
//! multipliers of a [`Timing`]. A schedule (`schedule`, for a `request`) assigns every value to a stage. `stages`
//! builds a design from that, without a microprogram and with a register wherever a value crosses from a stage to the
//! next. Nothing here knows a device.

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

/// The goal of the schedule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The fewest registers for a clock.
    ClockMhz(f64),
    /// The fastest clock in this number of stages.
    Stages(usize),
}

/// The storage of values that nothing reads for several stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delays {
    /// A small memory, if the target has one.
    Memory,
    /// A register a stage.
    Registers,
}

/// The options of a pipeline.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The target whose delays and multipliers count.
    pub target: &'static Timing,
    /// The goal of the schedule.
    pub goal: Goal,
    /// The least number of clocks between two points.
    pub interval: IntervalGoal,
    /// Products end in the register of a multiplier, if the target has a delay for it.
    pub registered: bool,
    /// The environment can hold the results back.
    pub stall: bool,
    /// Bits that travel with a point.
    pub side: u32,
    /// The storage of values on their way.
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

//! Turns a design with a microprogram into a pipeline, which accepts a point every clock or every few clocks.
//!
//! `unroll` turns the design into a graph of values, which the passes in `passes` rewrite. `request` finds a schedule
//! (`schedule`), which assigns every value to a stage. `stages` builds the pipeline, with a register wherever a value passes from
//! one stage to the next.

mod delay;
mod error;
mod gates;
mod graph;
mod interval;
#[cfg(test)]
mod parse_text;
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
mod text;
mod unroll;

use crate::netlist::Design;
use glint_base::target::Timing;

pub use delay::delay_of;
pub use error::{PipelineError, PipelineErrorKind};
pub use graph::{Cell, Graph, Node, NodeId, NodeOp};
pub use interval::IntervalGoal;
pub use passes::{PASSES, Pass, PassResult};
use request::Request;
pub use unroll::{
    Cycle, DispatchedResults, StateValues, Unrolled, UnrolledLine, WalkRegister, any_cycle,
    carried, unroll, unroll_in_powers, unroll_line,
};

/// How Glint divides a computation into stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// This clock frequency in MHz, with as few stages as possible, and then as few register bits.
    ClockMhz(f64),
    /// This number of stages, with as high a clock frequency as possible.
    Stages(usize),
}

/// How a pipeline stores a value that no stage reads for several stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delays {
    /// In a small memory of look-up tables, if the target has such memories and they take fewer resources than registers.
    Memory,
    /// In a register at the end of each stage.
    Registers,
    /// In registers as long as they are beside look-up tables that the logic needs anyway, and beyond that in memories.
    Auto,
}

/// A user's request, for example a clock of 100 MHz on ECP5, a point every clock, no stalls.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The FPGA target, whose delays and multipliers determine the schedule.
    pub target: &'static Timing,
    pub goal: Goal,
    /// The number of clocks from one point to the next.
    pub interval: IntervalGoal,
    /// Whether products use the output registers inside the multipliers, if the target states a delay for them.
    pub registered: bool,
    /// Whether the environment can stall the pipeline by setting `out_ready` to 0.
    pub stall: bool,
    /// The number of bits of the side channel, which carries the user's data along with a point, such as a pixel's position.
    pub side: u32,
    pub delays: Delays,
}

/// Returns the unrolled microprogram, and the computation after each pass. Glint schedules the last entry. Fails, with a source
/// line, if the microprogram cannot be unrolled.
pub fn pass_results(
    sequential: &Design,
    options: &Options,
) -> Result<Vec<PassResult>, PipelineError> {
    let unrolled =
        unroll::unroll_for_pipeline(sequential).map_err(PipelineError::of_microprogram)?;
    Ok(passes::results(unrolled, options))
}

/// Turns a sequential design, which executes a microprogram, into a pipeline with the same results.
///
/// # Errors
/// Fails if the microprogram cannot be unrolled into a computation without loops. Also fails if a pipeline cannot have the
/// requested clock, number of stages, interval, rate or number of multipliers; the error states the nearest possible value.
/// Fails without such a value if a rate comes without a clock frequency, or if the solver finds no schedule.
pub fn pipeline(sequential: &Design, options: &Options) -> Result<Design, PipelineError> {
    let mut results = pass_results(sequential, options)?;
    let Some(PassResult { computation, .. }) = results.pop() else {
        unreachable!("the first result is the unrolled microprogram")
    };
    let request = Request::new(sequential, &computation, options);
    let interval = request.interval()?;
    let problems = request.problems(options.registered, interval);
    let schedule = request.schedule(&problems, interval)?;
    Ok(stages::assemble(sequential, &computation, &problems, &schedule, (options, interval)))
}

//! Turns a design with a microprogram into a pipeline, which accepts a point (a set of operands) every clock or every few clocks.
//!
//! `unroll` turns the design into a graph of values. The passes in `passes` rewrite the graph, for example to split products that
//! are too wide for the multipliers of the FPGA target. `request` finds a schedule (`schedule`), which assigns every value to a
//! stage. `stages` builds the pipeline, which has no microprogram, and a register wherever a value passes from one stage to the
//! next.

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
    Cycle, StateValues, Unrolled, UnrolledLine, WalkRegister, any_cycle, carried, unroll,
    unroll_in_powers, unroll_line,
};

/// The goal with which Glint divides a computation into pipeline stages: a clock frequency or a number of stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The pipeline must reach this clock frequency in MHz, with as few stages as possible, and then with as few register bits as
    /// possible.
    ClockMhz(f64),
    /// The pipeline must have this number of stages, with as high a clock frequency as possible.
    Stages(usize),
}

/// The way in which a pipeline stores a value that no stage reads for several stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delays {
    /// A waiting value is stored in a small memory of look-up tables, if the target has such memories and if they take fewer
    /// resources than registers.
    Memory,
    /// A waiting value is stored in a register at the end of each stage.
    Registers,
}

/// The options with which a user requests a pipeline. For example, a clock of 100 MHz on ECP5, a point every clock, no stalls.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The FPGA target whose delays and multipliers the schedule assumes.
    pub target: &'static Timing,
    /// Whether Glint divides the computation into stages for a clock frequency or for a number of stages.
    pub goal: Goal,
    /// How Glint chooses the interval, the number of clocks from one point to the next.
    pub interval: IntervalGoal,
    /// Whether products use the output registers inside the multipliers, if the target states a delay for them.
    pub registered: bool,
    /// Whether the environment can stall the pipeline by setting `out_ready` to 0.
    pub stall: bool,
    /// The number of bits of the side channel. The side channel carries data of the user along with a point, such as a pixel's
    /// position.
    pub side: u32,
    /// How the pipeline stores values that no stage reads for several stages: in registers or in small memories.
    pub delays: Delays,
}

/// Returns the computation of a pipeline before the passes and after each of them, in the order of the passes. The first entry is
/// the unrolled microprogram, and Glint schedules the last entry.
///
/// # Errors
/// Fails if the microprogram cannot be unrolled; the error has its source line.
pub fn pass_results(
    sequential: &Design,
    options: &Options,
) -> Result<Vec<PassResult>, PipelineError> {
    let unrolled =
        unroll::unroll_for_pipeline(sequential).map_err(PipelineError::of_microprogram)?;
    Ok(passes::results(unrolled, options))
}

/// Turns a sequential design, which executes a microprogram, into a pipeline with the same results, and returns the pipeline.
///
/// # Errors
/// Fails if the microprogram cannot be unrolled into a computation without loops; the error has the source line. Fails if the
/// requested clock, number of stages, interval, rate or number of multipliers cannot be reached. The error then states the
/// nearest value that can be reached. Fails if the options give a rate without a clock frequency, or if the solver finds no
/// schedule; these errors state no nearest value.
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

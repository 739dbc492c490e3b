//! Makes a pipeline of a design with a microprogram: it takes a point every clock or every few.
//!
//! A design with a microprogram is unrolled (`unroll`) into a graph of values, whose products are
//! split to the multipliers of a [`Timing`] by the first of the `passes`; a schedule (`schedule`, as a `request` wants it) gives
//! every value its stage, and `stages` makes a design of it again, without a microprogram: a register wherever a value
//! crosses from a stage to the next. Nothing here knows a device.

mod delay;
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
use glint_base::diagnostic::Diagnostics;
use glint_base::target::Timing;

pub use delay::delay_of;
pub use graph::{Cell, Graph, Node, NodeId, Op};
pub use interval::Interval;
pub use passes::{PASSES, Pass};
use request::Request;
pub use unroll::{
    Cycle, Held, Line, Unrolled, WalkRegister, any_cycle, carried, unroll, unroll_in_powers,
    unroll_line,
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
    /// A small memory, where the target has such.
    Memory,
    /// A register a stage.
    Registers,
}

/// The options of a configuration's pipeline.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The target whose delays and multipliers count.
    pub target: &'static Timing,
    /// The goal of the schedule.
    pub goal: Goal,
    /// A point is taken every so many clocks at most.
    pub interval: Interval,
    /// Products end in the register of a multiplier, where the target has a delay for it.
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
/// A microprogram that cannot be unrolled, with its source line; a clock or a number of stages that
/// cannot be reached, with the nearest that can.
pub fn pipeline(sequential: &Design, options: &Options) -> Result<Design, Diagnostics> {
    let unrolled = unroll::unroll_in_powers(sequential).map_err(request::sequentially)?;
    let unrolled = passes::applied(unrolled, options);
    let request = Request::new(sequential, &unrolled, options);
    let interval = request.interval()?;
    let problems = request.problems(options.registered, interval);
    let schedule = request.schedule(&problems, interval)?;
    Ok(stages::assemble(sequential, &unrolled, &problems, &schedule, (options, interval)))
}

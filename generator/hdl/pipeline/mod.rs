//! The pipelined architecture: one microprogram, a point every clock or every few.
//!
//! A design with a microprogram is unrolled (`unroll`) into a graph of values, whose products are
//! split (`split`) to the multipliers of a [`Timing`]; a schedule (`schedule`) gives every value its stage,
//! and `stages` makes a design of it again, without a microprogram: a register wherever a value
//! crosses from a stage to the next. Nothing here knows a device.

mod delay;
mod gates;
mod graph;
mod interval;
mod possible;
mod rebuild;
mod schedule;
mod settle;
mod sharing;
mod split;
mod stages;
mod sums;
#[cfg(test)]
mod tests;
mod unroll;

use crate::netlist::{Design, decided_by_data, latest_done};
use glint_base::diagnostic::{Diagnostic, Diagnostics};
use glint_base::target::Timing;

pub use delay::delay_of;
pub use graph::{Cell, Graph, Node, NodeId, Op};
pub use interval::Interval;
use schedule::{Refusal, Unreachable};
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

/// The pipeline of a sequential design.
///
/// # Errors
/// A microprogram that cannot be unrolled, with its source line; a clock or a number of stages that
/// cannot be reached, with the nearest that can.
pub fn pipeline(sequential: &Design, options: &Options) -> Result<Design, Diagnostics> {
    let sequentially = |found: Diagnostics| {
        let remedy = || "set architecture = \"sequential\"".to_owned();
        Diagnostics(found.0.into_iter().map(|it| it.of_key("architecture", remedy())).collect())
    };
    let unrolled =
        split::split(&unroll::unroll_in_powers(sequential).map_err(sequentially)?, options.target);
    let unrolled = if options.registered { gates::gated(&unrolled) } else { unrolled };
    let results: Vec<_> = unrolled.results.iter().map(|&(_, value)| value).collect();
    let problems = |registered: bool, interval: usize| {
        let registered = options.target.registered.filter(|_| registered);
        schedule::Problems::new(&unrolled.graph, options.target, registered, interval, &results)
    };
    let wrong = |key: &'static str, message: String, remedy: String, at: Option<NodeId>| {
        let place =
            at.map_or(sequential.nets[0].location, |at| unrolled.graph.node(at).label.location);
        Diagnostics(vec![Diagnostic::new(message, place).of_key(key, remedy)])
    };
    let (name, target) = (&sequential.name, options.target.name);
    // With the clock of `start`, in which the operands are written. Iterations that operands decide on are counted at their most.
    let steps = unrolled.steps.len();
    let most = latest_done(sequential).filter(|_| !decided_by_data(sequential).is_empty());
    let clocks = most.map_or(steps, |it| steps.max(it as usize)) + 1;
    let with_interval = |interval| problems(options.registered, interval);
    let interval = interval::clocks(name, options, clocks, with_interval)
        .map_err(|it| wrong(it.key, it.message, it.remedy, None))?;
    let registered = (!options.registered).then(|| problems(true, interval));
    let problems = with_interval(interval);
    let unsolved = |why: String, at: Option<NodeId>| {
        let message = format!("`{name}` has no schedule: {why}; this is a mistake of Glint's");
        let remedy = "ask for another pipeline.clock_mhz or pipeline.stages";
        wrong("pipeline.clock_mhz", message, remedy.to_owned(), at)
    };
    let schedule = match options.goal {
        Goal::ClockMhz(clock) => problems.for_period(1000.0 / clock).map_err(|refusal| {
            let Unreachable { limiting, period } = match refusal {
                Refusal::Unreachable(unreachable) => unreachable,
                Refusal::Unsolved(why, at) => return unsolved(why, at),
            };
            let nearest = schedule::megahertz(period);
            let message = format!(
                "`{name}` cannot run at {clock} MHz: `{}` alone takes {period:.2} ns on {target}, which allows {nearest} MHz at \
                 most",
                unrolled.graph.node(limiting).label.name
            );
            let faster = registered.and_then(|problems| problems.fastest());
            let faster = faster.is_some_and(|it| it.period * clock <= 1000.0);
            let faster = if faster { ", or pipeline.multipliers = \"registered\"" } else { "" };
            let remedy = format!("set pipeline.clock_mhz to {nearest} or less{faster}");
            let mut wrong = wrong("pipeline.clock_mhz", message, remedy, Some(limiting));
            wrong.0.iter_mut().for_each(|it| it.nearest = Some(nearest));
            wrong
        })?,
        Goal::Stages(stages) => {
            let key = "pipeline.stages";
            let most = problems.most_stages();
            if stages > most {
                let message = format!(
                    "`{name}` has no use for {stages} stages: more than {most} make it no faster on {target}"
                );
                let remedy = format!("set pipeline.stages to {most} or less");
                let limiting = problems.fastest().map(|it| it.limiting);
                return Err(wrong(key, message, remedy, limiting));
            }
            let schedule = problems.for_stages(stages).map_err(|refusal| match refusal {
                Refusal::Unsolved(why, at) => unsolved(why, at),
                Refusal::Unreachable(it) => unsolved("no clock is slow enough".to_owned(), Some(it.limiting)),
            })?;
            if schedule.latency > stages {
                let least = schedule.latency;
                let plural = if stages == 1 { "" } else { "s" };
                let message = format!(
                    "`{name}` cannot have {stages} stage{plural}: its registered memories and multipliers need {least} on {target}"
                );
                return Err(wrong(key, message, format!("set pipeline.stages to {least} or more"), None));
            }
            schedule
        }
    };
    Ok(stages::assemble(sequential, &unrolled, &problems, &schedule, (options, interval)))
}

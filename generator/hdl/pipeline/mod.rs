//! The pipelined architecture: one microprogram, a point every clock.
//!
//! A design with a microprogram is unrolled (`unroll`) into a graph of values, whose products are
//! split (`split`) to the multipliers of a [`Target`]; a schedule (`schedule`) gives every value its stage,
//! and `stages` makes a design of it again, without a microprogram: a register wherever a value
//! crosses from a stage to the next. Nothing here knows a device.

mod graph;
mod possible;
mod schedule;
mod split;
mod stages;
mod target;
#[cfg(test)]
mod tests;
mod unroll;
mod value;

use crate::base::diagnostic::{Diagnostic, Diagnostics};
use crate::config::Config;
use crate::hdl::netlist::Design;

pub use target::{TARGETS, Target};

/// What is asked of the schedule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The fewest registers for a clock.
    ClockMhz(f64),
    /// The fastest clock in so many stages.
    Stages(usize),
}

/// What a configuration says of its pipeline.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Whose delays and multipliers count.
    pub target: &'static Target,
    /// What is asked of the schedule.
    pub goal: Goal,
    /// The environment can hold the results back.
    pub stall: bool,
    /// Bits that travel with a point.
    pub side: u32,
}

/// What a configuration says; none if its architecture is sequential.
pub fn options(config: &Config) -> Option<Options> {
    (config.choice("architecture") == "pipelined").then(|| Options {
        target: Target::named(config.choice("pipeline.target")).unwrap_or(&TARGETS[0]),
        goal: match config.integer("pipeline.stages") {
            0 => Goal::ClockMhz(config.number("pipeline.clock_mhz")),
            stages => Goal::Stages(stages as usize),
        },
        stall: config.choice("pipeline.stall") == "ready",
        side: config.integer("pipeline.side") as u32,
    })
}

/// The pipeline of a sequential design.
///
/// # Errors
/// A microprogram that cannot be unrolled, with its source line; a clock or a number of stages that
/// cannot be reached, with the nearest that can.
pub fn pipeline(sequential: &Design, options: &Options) -> Result<Design, Diagnostics> {
    let unrolled = split::split(&unroll::unroll(sequential)?, options.target);
    let results: Vec<_> = unrolled.results.iter().map(|&(_, value)| value).collect();
    let problems = schedule::Problems::new(&unrolled.graph, options.target, &results);
    let wrong = |message: String, at: Option<schedule::Unreachable>| {
        let place = at.map_or(sequential.nets[0].location, |at| {
            unrolled.graph.node(at.limiting).label.location
        });
        Diagnostics(vec![Diagnostic::new(message, place)])
    };
    let schedule = match options.goal {
        Goal::ClockMhz(clock) => problems.for_period(1000.0 / clock).map_err(|unreachable| {
            let node = unrolled.graph.node(unreachable.limiting);
            // Rounded down, so that what is proposed can be reached.
            let nearest = (1000.0 / unreachable.period * 10.0).floor() / 10.0;
            wrong(
                format!(
                    "pipeline.clock_mhz = {clock}: `{}` alone takes {:.2} ns on {}, which allows {nearest} MHz at most; \
                     set pipeline.clock_mhz to {nearest} or less",
                    node.label.name, unreachable.period, options.target.name
                ),
                Some(unreachable),
            )
        })?,
        Goal::Stages(stages) => {
            let most = problems.most_stages();
            if stages > most {
                return Err(wrong(
                    format!(
                        "pipeline.stages = {stages}: `{}` has no use for more than {most} on {}; set pipeline.stages to \
                         {most} or less",
                        sequential.name, options.target.name
                    ),
                    problems.fastest(),
                ));
            }
            let schedule = problems.for_stages(stages);
            if schedule.latency > stages {
                return Err(wrong(
                    format!(
                        "pipeline.stages = {stages}: block memories of `{}` need {} on {}; set pipeline.stages to that \
                         or more",
                        sequential.name, schedule.latency, options.target.name
                    ),
                    None,
                ));
            }
            schedule
        }
    };
    Ok(stages::assemble(sequential, &unrolled, &problems, &schedule, options))
}

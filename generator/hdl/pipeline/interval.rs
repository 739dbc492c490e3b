//! Chooses the interval of a pipeline.
//!
//! A user requests the interval itself, a rate in points per second, or a largest number of multipliers. For example, 25 million
//! points a second at 100 MHz allow an interval of 4.

use super::error::{PipelineError, PipelineErrorKind};
use super::schedule::ScheduleProblem;
use super::{Goal, Options};
use crate::netlist::Design;

/// The way in which Glint chooses the interval of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntervalGoal {
    /// The interval itself, in clocks.
    Clocks(usize),
    /// The largest interval with at least this rate, in million points a second, at the requested clock. The interval does not
    /// exceed the clocks of the sequential core for a point. For example, 26 million points a second at 130 MHz allow an
    /// interval of 5 clocks.
    Rate(f64),
    /// The smallest interval that reaches the requested clock with at most this number of multipliers.
    Multipliers(usize),
}

/// Returns the interval in clocks that `options.interval` requests. `most` is the number of clocks in which the sequential core
/// computes a point. `problems` makes the scheduling problem for an interval.
///
/// A rate gets the longest interval up to `most` that reaches the rate and the clock. A number of multipliers gets the shortest
/// interval that reaches the clock with this number. If no interval reaches the clock, the result is 1, and the scheduler
/// reports the error.
///
/// # Errors
/// Fails if the requested interval exceeds `most`, or the rate exceeds one point a clock or lacks a clock frequency. Also fails
/// if every interval that reaches the clock needs more multipliers than the options allow.
pub fn clocks<'a>(
    sequential: &Design,
    options: &Options,
    most: usize,
    problems: impl Fn(usize) -> ScheduleProblem<'a>,
) -> Result<usize, PipelineError> {
    let name = &sequential.name;
    let error = |kind, message| Err(PipelineError::of_design(sequential, kind, message));
    // The muxes in front of a shared multiplier take time too, so that some intervals do not reach the clock.
    let reaches = |interval: &usize| match options.goal {
        Goal::ClockMhz(clock) => {
            problems(*interval).fastest().is_none_or(|it| it.period <= 1000.0 / clock + 1e-9)
        }
        Goal::Stages(_) => true,
    };
    match options.interval {
        IntervalGoal::Clocks(interval) if interval > most => {
            let message = format!(
                "`{name}` cannot use an interval of {interval} clocks: its sequential core already accepts a \
                 point every {most} clocks"
            );
            error(PipelineErrorKind::Interval { most }, message)
        }
        IntervalGoal::Clocks(interval) => Ok(interval),
        IntervalGoal::Rate(rate) => {
            let Goal::ClockMhz(clock) = options.goal else {
                let message = format!(
                    "with a number of stages, the clock of `{name}` is not fixed, so no interval can be \
                     chosen for a rate"
                );
                return error(PipelineErrorKind::RateWithoutClock, message);
            };
            let longest = (clock / rate + 1e-9).floor() as usize;
            if longest == 0 {
                let message = format!(
                    "`{name}` accepts at most {clock} million points a second: one point every clock at \
                     {clock} MHz"
                );
                return error(PipelineErrorKind::Rate { most: clock }, message);
            }
            Ok((1..=longest.min(most)).rev().find(reaches).unwrap_or(1))
        }
        IntervalGoal::Multipliers(allowed) => {
            // The interval with the fewest multipliers, and their number.
            let mut best: Option<(usize, usize)> = None;
            for interval in (1..=most).filter(reaches) {
                let multipliers = problems(interval).multipliers();
                if multipliers <= allowed {
                    return Ok(interval);
                }
                if best.is_none_or(|(_, fewest)| multipliers < fewest) {
                    best = Some((interval, multipliers));
                }
            }
            let Some((interval, fewest)) = best else {
                return Ok(1);
            };
            let message = format!(
                "`{name}` needs at least {fewest} multipliers, with a point every {interval} clocks"
            );
            error(PipelineErrorKind::Multipliers { fewest }, message)
        }
    }
}

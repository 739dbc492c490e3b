//! Finds the clocks from a point to the next: as given, or as a wanted rate or number of multipliers asks for.

use super::schedule::ScheduleProblem;
use super::{Goal, Options};

/// The clocks from a point to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntervalGoal {
    /// A number of clocks.
    Clocks(usize),
    /// The longest interval with this number of million points a second at the clock of the goal. For example, 26 million
    /// points a second at 130 MHz allow an interval of at most 5 clocks.
    Rate(f64),
    /// The fewest with which there are no more multipliers than this.
    Multipliers(usize),
}

/// The key that is wrong, the problem with its value, and the remedy.
pub struct Unreached {
    pub key: &'static str,
    pub message: String,
    pub remedy: String,
}

/// Returns the clocks from a point to the next. A sequential core takes a point every `most`.
///
/// # Errors
/// Fails if the interval is longer than the sequential core's, or if no interval reaches the rate. Fails if a rate is wanted
/// without a clock. Fails if every interval needs more multipliers than the configuration allows.
pub fn clocks<'a>(
    name: &str,
    options: &Options,
    most: usize,
    problems: impl Fn(usize) -> ScheduleProblem<'a>,
) -> Result<usize, Unreached> {
    let wrong = |key, message, remedy| Err(Unreached { key, message, remedy });
    // Muxes before a multiplier take time of the clock.
    let reaches = |interval: &usize| match options.goal {
        Goal::ClockMhz(clock) => {
            problems(*interval).fastest().is_none_or(|it| it.period <= 1000.0 / clock + 1e-9)
        }
        Goal::Stages(_) => true,
    };
    match options.interval {
        IntervalGoal::Clocks(interval) if interval > most => wrong(
            "pipeline.interval",
            format!(
                "`{name}` has no use for a point every {interval} clocks: its sequential core takes one every {most}"
            ),
            format!("set pipeline.interval to {most} or less, or architecture = \"sequential\""),
        ),
        IntervalGoal::Clocks(interval) => Ok(interval),
        IntervalGoal::Rate(rate) => {
            let Goal::ClockMhz(clock) = options.goal else {
                let message = format!(
                    "pipeline.stages leaves the clock of `{name}` open, and with it the rate"
                );
                let remedy = "set pipeline.clock_mhz in place of pipeline.stages".to_owned();
                return wrong("pipeline.rate", message, remedy);
            };
            let longest = (clock / rate + 1e-9).floor() as usize;
            if longest == 0 {
                let message = format!(
                    "`{name}` takes {clock} million points a second at most: one every clock at {clock} MHz"
                );
                let remedy = format!(
                    "set pipeline.rate to {clock} or less, or pipeline.clock_mhz to {rate} or more"
                );
                return wrong("pipeline.rate", message, remedy);
            }
            Ok((1..=longest.min(most)).rev().find(reaches).unwrap_or(1))
        }
        IntervalGoal::Multipliers(allowed) => {
            let all = || (1..=most).filter(reaches).map(|it| (it, problems(it).multipliers()));
            let Some((interval, fewest)) = all().min_by_key(|&(_, multipliers)| multipliers) else {
                // The schedule says why.
                return Ok(1);
            };
            if fewest > allowed {
                let message = format!(
                    "`{name}` has {fewest} multipliers at the least: with a point every {interval} clocks"
                );
                let remedy = format!("set pipeline.max_multipliers to {fewest} or more");
                return wrong("pipeline.max_multipliers", message, remedy);
            }
            Ok(all().find(|&(_, multipliers)| multipliers <= allowed).map_or(interval, |it| it.0))
        }
    }
}

//! Finds an error bound that Gappa can prove, for statements without a bound.
//!
//! Gappa first answers each statement with an upper bound. A bisection then searches a smaller bound that Gappa proves, with a
//! precision of 1/2048 output units. The smallest true bound may be below the result.

use std::fs;
use std::time::Duration;

use anyhow::{Context, Result};
use rayon::prelude::*;

use super::proof::{ProofOutcome, prove};
use super::statement::{ASKED, Statement};
use glint_tools::transient::Directory;
use glint_tools::{LimitReached, Tool};

/// Gappa's answers are rounded up to a multiple of one millionth.
const MILLIONTHS: f64 = 1e6;

/// The search's precision, in output units.
const STEP: f64 = 1.0 / 2048.0;
const TRY: Duration = Duration::from_secs(2);

/// Returns one error bound, in output units, that Gappa proves for all statements `asked`. The inner error is a reason in words
/// why Gappa finds no bound. `limit` is the time limit of Gappa's first answer to each statement.
///
/// # Errors
///
/// Fails if Gappa cannot be run.
pub fn bound(gappa: &Tool, asked: &[Statement], limit: Duration) -> Result<Result<f64, String>> {
    let answers = asked.par_iter().map(|one| answer(gappa, one, limit));
    let answers: Result<Vec<_>, String> =
        answers.collect::<Result<Vec<_>>>()?.into_iter().collect();
    let answers = match answers {
        Ok(answers) => answers,
        Err(why) => return Ok(Err(why)),
    };
    let mut largest: Vec<(f64, &Statement)> =
        answers.into_iter().zip(asked).filter_map(|(answer, one)| Some((answer?, one))).collect();
    largest.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut bound = 0.0;
    for (answer, one) in largest {
        let holds = |bound: f64| -> Result<bool> {
            let outcome = prove(gappa, None, &one.within(bound), limit.min(TRY))?;
            Ok(matches!(outcome, ProofOutcome::Proved(..)))
        };
        if answer <= bound || holds(bound)? {
            continue;
        }
        let mut above = answer;
        while above - bound > STEP {
            let middle = libm::ceil((above + bound) / 2.0 / STEP) * STEP;
            if middle >= above {
                break;
            }
            if holds(middle)? { above = middle } else { bound = middle }
        }
        bound = above;
    }
    Ok(Ok(bound))
}

/// Returns the smallest bound, in output units, that Gappa finds with one of the statement's scripts. The inner value is `None`
/// if the statement asks for no bound, and a reason in words if Gappa finds none.
fn answer(
    gappa: &Tool,
    statement: &Statement,
    limit: Duration,
) -> Result<Result<Option<f64>, String>> {
    let place = Directory::new().context("cannot make a temporary directory")?;
    let Statement { output, number, .. } = statement;
    let mut why = format!("Gappa finds no error bound for statement {number} of {output}");
    let (mut least, mut asks) = (None, false);
    for script in statement.scripts.iter().filter(|script| script.contains(ASKED)) {
        asks = true;
        fs::write(place.path().join("statement.g"), script)
            .context("cannot write a script for Gappa")?;
        match gappa.run(["statement.g"], place.path(), limit) {
            Ok(run) if run.status.success() => {
                let found = largest(&run.output);
                least = least.into_iter().chain(found).reduce(f64::min);
            }
            Ok(_) => {}
            Err(error) if error.is::<LimitReached>() => why = error.to_string(),
            Err(error) => return Err(error),
        }
    }
    Ok(match least {
        None if asks => Err(why),
        least => Ok(least),
    })
}

/// Returns the upper end of the interval in Gappa's output, rounded up to six digits after the point. Returns 0 if Gappa says
/// that the hypotheses contradict each other. For example, `|d_1| in [0, 43998467b-26 {0.655628, 2^(-0.60905)}]` gives
/// 0.655629.
fn largest(output: &str) -> Option<f64> {
    if output.contains("anything can be proved") {
        return Some(0.0);
    }
    let line = output.lines().find(|line| line.trim_start().starts_with('|'))?;
    let (_, end) = line.split_once("| in [")?.1.split_once(", ")?;
    let end = end.split([' ', ']']).next()?;
    let value = match end.split_once('b') {
        Some((factor, power)) => {
            factor.parse::<f64>().ok()? * libm::exp2(power.parse::<f64>().ok()?)
        }
        None => end.parse().ok()?,
    };
    // The factor may have more bits than an f64, so the parsed value may be too small.
    let value = if value * MILLIONTHS == libm::floor(value * MILLIONTHS) {
        value
    } else {
        value * (1.0 + f64::EPSILON)
    };
    let rounded = libm::ceil(value * MILLIONTHS) / MILLIONTHS;
    Some(if rounded < value { rounded + 1.0 / MILLIONTHS } else { rounded })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_upper_end_is_read_and_rounded_up() {
        let text = |end: &str| format!("Warning: w\nResults:\n  |d_1| in [0, {end}]\n");
        assert_eq!(largest(&text("43998467b-26 {0.655628, 2^(-0.60905)}")), Some(0.655629));
        assert_eq!(largest(&text("1b-1 {0.5, 2^(-1)}")), Some(0.5));
        assert_eq!(largest(&text("255")), Some(255.0));
        let never = "Results:\n  remaining results are pointless, anything can be proved.\n";
        assert_eq!(largest(never), Some(0.0));
        assert_eq!(largest("Error: some properties were not satisfied:\n  BND(|d|)\n"), None);
    }
}

//! Reads samples, the measured points that a configuration of the device `function` may state instead of a formula.

use glint_approximate::Samples;
use glint_base::config_error::ConfigError;
use glint_base::fixed::exp2;
use glint_formula::{Enclosure, Expression, parse};

/// A step between two samples is a gap, which is an error, if it exceeds the longer neighbouring step by more than this factor.
const GAP: i64 = 4;

const KEY: &str = "function.samples";

/// Reads samples from a text such as `0,0 2,0.5`. `fraction` is the number of fraction bits of the operand, and `domain` has
/// the smallest and the largest raw operand.
///
/// # Errors
/// Fails if a sample is not a pair of numbers, if its x is not an operand of the domain, or if two samples have the same x. Also
/// fails if an end of the domain has no sample, or if there is a [`GAP`].
pub(super) fn read(text: &str, fraction: u32, domain: (i64, i64)) -> Result<Samples, ConfigError> {
    let mut points: Vec<(i64, Enclosure)> = Vec::new();
    for point in text.split(' ').filter(|point| !point.is_empty()) {
        points.push(read_point(point, fraction, domain)?);
    }
    points.sort_by_key(|point| point.0);
    check_points(&points, fraction, domain)?;
    Ok(Samples::through(points))
}

/// Reads a sample from the text `x,y`: its raw operand and an interval that contains its value.
fn read_point(
    point: &str,
    fraction: u32,
    domain: (i64, i64),
) -> Result<(i64, Enclosure), ConfigError> {
    let numbers = point.split_once(',').and_then(|(x, y)| Some((parse(x).ok()?, number(y)?)));
    let Some((x, y)) = numbers.filter(|(x, _)| x.enclose(&[]).is_ok()) else {
        let message = format!("the sample `{point}` is not a pair of numbers");
        return Err(ConfigError::new(
            KEY,
            message,
            "write a number for x, a comma and a number for y",
        ));
    };
    let Some(raw) = raw_operand(&x, fraction) else {
        let message =
            format!("x of the sample `{point}` is not an operand with {fraction} fraction bits");
        let remedy = "set a larger operand.fraction, or number the samples: 0, 1, 2 …";
        return Err(ConfigError::new(KEY, message, remedy));
    };
    match i64::try_from(raw) {
        Ok(raw) if (domain.0..=domain.1).contains(&raw) => Ok((raw, y)),
        _ => {
            let message = format!("the sample `{point}` is outside the domain");
            let remedy = "change function.from or function.to, or remove the sample";
            Err(ConfigError::new(KEY, message, remedy))
        }
    }
}

/// Checks points in the order of rising operands. Fails if two points have the same operand, if an end of the domain has no
/// point, or if there is a [`GAP`]. A list of at most three points has no gap.
fn check_points(
    points: &[(i64, Enclosure)],
    fraction: u32,
    domain: (i64, i64),
) -> Result<(), ConfigError> {
    let unit = exp2(-(fraction as i32));
    for pair in points.windows(2) {
        if pair[0].0 == pair[1].0 {
            let message = format!("there are two samples for x = {}", pair[0].0 as f64 * unit);
            return Err(ConfigError::new(
                KEY,
                message,
                "keep one of the two samples, or their mean",
            ));
        }
    }
    let first = points.first().map(|point| point.0);
    let last = points.last().map(|point| point.0);
    if (first, last) != (Some(domain.0), Some(domain.1)) {
        let missing = if first == Some(domain.0) { domain.1 } else { domain.0 };
        let x = missing as f64 * unit;
        let message = format!("there is no sample at the end of the domain, x = {x}");
        return Err(ConfigError::new(
            KEY,
            message,
            "add a sample there, or let the domain end at a sample",
        ));
    }
    let steps: Vec<i64> = points.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    if steps.len() <= 2 {
        return Ok(());
    }
    for (at, step) in steps.iter().enumerate() {
        let before = if at > 0 { steps[at - 1] } else { 0 };
        let after = steps.get(at + 1).copied().unwrap_or(0);
        if *step > GAP * before.max(after) {
            let [from, to] = [at, at + 1].map(|at| points[at].0 as f64 * unit);
            let message = format!("there is a gap between the samples at x = {from} and {to}");
            let remedy = "add samples there, or describe two functions with separate domains";
            return Err(ConfigError::new(KEY, message, remedy));
        }
    }
    Ok(())
}

/// Returns the raw operand of a number, if it is one: 1.5 with one fraction bit gives 3. A number with many decimal digits may
/// also be the printed form of an `f64` that is an operand.
fn raw_operand(x: &Expression, fraction: u32) -> Option<i128> {
    match x.ceiling(fraction) {
        Ok((raw, true)) => Some(raw),
        _ => {
            let raw = x.printed_double()? * exp2(fraction as i32);
            (raw.fract() == 0.0).then_some(raw as i128)
        }
    }
}

fn number(text: &str) -> Option<Enclosure> {
    let value = parse(text).and_then(|formula| formula.enclose(&[])).ok()?;
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_points_of_the_domain_without_gaps() {
        let samples = read("0,0 3,-0.5 1,1e-1 2,0.25", 0, (0, 3)).unwrap();
        assert_eq!(samples.limits(2), Enclosure::exactly(0.25));
        assert!(samples.limits(1).holds(0.1) && samples.limits(1).low < samples.limits(1).high);
        let halves = read("0,0 1,1", 1, (0, 2)).unwrap();
        assert!(halves.limits(1).holds(0.5) && halves.count() == 2);
        // The decimals are as NumPy prints them: 1 − 2^−20 has 20 digits, and `%.18e` prints 19 of them.
        let near = "9.999980926513671875e-01,0 9.999990463256835938e-01,+0.5 1e0,1";
        let samples = read(near, 20, ((1 << 20) - 2, 1 << 20)).unwrap();
        assert_eq!(samples.limits((1 << 20) - 1), Enclosure::exactly(0.5));
        for (text, message) in [
            ("0,0 1,1 3,x", "the sample `3,x` is not a pair of numbers"),
            ("0,0 1 3,1", "the sample `1` is not a pair of numbers"),
            ("0,0 0.25,1 3,1", "x of the sample `0.25,1` is not an operand with 1 fraction bits"),
            ("0,0 3.5,1", "the sample `3.5,1` is outside the domain"),
            ("0,0 1,1 1.0,1 3,1", "there are two samples for x = 1"),
            ("1,1 3,1", "there is no sample at the end of the domain, x = 0"),
            ("0,0 1,1", "there is no sample at the end of the domain, x = 3"),
            (
                "0,0 0.5,1 2.75,1 3,1",
                "x of the sample `2.75,1` is not an operand with 1 fraction bits",
            ),
            ("0,0 0.5,1 3,1", "there is no gap"),
            ("0,0 0.5,1 1,1 3,1", "there is no gap"),
            ("0,0 0.5,1 2.5,1 3,1", "there is no gap"),
        ] {
            match read(text, 1, (0, 6)) {
                Err(error) => assert_eq!(error.message, message),
                Ok(_) => assert_eq!(message, "there is no gap", "{text}"),
            }
        }
        let gap = read("0,0 1,1 2,1 9,2 10,3", 0, (0, 10)).unwrap_err();
        assert_eq!(gap.message, "there is a gap between the samples at x = 2 and 9");
    }
}

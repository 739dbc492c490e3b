//! Reads samples, and computes the curve through them. Samples are measured points that a configuration of the device
//! `function` may state instead of a formula.
//!
//! Between two samples the curve is Steffen's cubic (Astronomy and Astrophysics 239, 443, 1990). The curve has a continuous
//! derivative, and it rises or falls wherever the samples do. Its slopes at the samples are the f64 numbers that Steffen's
//! formula gives.

use super::Refusal;
use glint_base::fixed::exp2;
use glint_formula::{Enclosure, Expression, parse};

/// The largest ratio of a step between two samples to the longer of the two neighbouring steps. A step with a larger ratio is a
/// gap, which is an error.
const GAP: i64 = 4;

/// The configuration key that states the samples.
const KEY: &str = "function.samples";

/// Samples in the order of rising operands. A sample has its raw operand, its value, and the slope of the curve per step of the
/// raw operand.
#[derive(Clone, Debug)]
pub struct Samples(Vec<(i64, Enclosure, f64)>);

impl Samples {
    /// Reads samples from the text of a configuration. The text has the form `x,y x,y`, for example `0,0 2,0.5`. `fraction` is
    /// the number of fraction bits of the operand, and `domain` has the smallest and the largest raw operand.
    ///
    /// # Errors
    /// Fails if a sample is not a pair of numbers, or if its x is not an operand of the domain. Also fails if two samples have
    /// the same operand, or if an end of the domain has no sample. More than three samples also fail if a step is over four
    /// times as long as both neighbouring steps.
    pub fn read(text: &str, fraction: u32, domain: (i64, i64)) -> Result<Self, Refusal> {
        let mut points: Vec<(i64, Enclosure)> = Vec::new();
        for point in text.split(' ').filter(|point| !point.is_empty()) {
            points.push(read_point(point, fraction, domain)?);
        }
        points.sort_by_key(|point| point.0);
        check_points(&points, fraction, domain)?;
        let slopes = slopes(&points);
        let mut samples = Vec::with_capacity(points.len());
        for ((raw, value), slope) in points.into_iter().zip(slopes) {
            samples.push((raw, value, slope));
        }
        Ok(Self(samples))
    }

    /// Returns the number of samples.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Returns an interval that contains the value of the curve at the raw operand `raw`. The operand must be in the domain.
    pub fn limits(&self, raw: i64) -> Enclosure {
        let at = self.0.partition_point(|point| point.0 < raw).min(self.0.len() - 1);
        let (to, above, last) = self.0[at];
        if to == raw || at == 0 {
            return above;
        }
        let (from, below, first) = self.0[at - 1];
        let [way, length, first, last] =
            [(raw - from) as f64, (to - from) as f64, first, last].map(Enclosure::exactly);
        let chord = (above - below) / length;
        let two = Enclosure::exactly(2.0);
        let square = (chord + chord + (chord - first) - first - last) / length;
        let cube = (first + last - two * chord) / (length * length);
        below + way * (first + way * (square + way * cube))
    }
}

/// Reads a sample from the text `x,y`. Returns its raw operand and an interval that contains its value.
///
/// # Errors
/// Fails if the text is not a pair of numbers, or if x is not an operand of the domain.
fn read_point(point: &str, fraction: u32, domain: (i64, i64)) -> Result<(i64, Enclosure), Refusal> {
    let numbers = point.split_once(',').and_then(|(x, y)| Some((parse(x).ok()?, number(y)?)));
    let Some((x, y)) = numbers.filter(|(x, _)| x.enclose(&[]).is_ok()) else {
        let message = format!("the sample `{point}` is not a pair of numbers");
        return Err(Refusal::new(KEY, message, "write a number for x, a comma and a number for y"));
    };
    let Some(raw) = raw_operand(&x, fraction) else {
        let message =
            format!("x of the sample `{point}` is not an operand with {fraction} fraction bits");
        let remedy = "set a larger operand.fraction, or number the samples: 0, 1, 2 …";
        return Err(Refusal::new(KEY, message, remedy));
    };
    match i64::try_from(raw) {
        Ok(raw) if (domain.0..=domain.1).contains(&raw) => Ok((raw, y)),
        _ => {
            let message = format!("the sample `{point}` is outside the domain");
            let remedy = "change function.from or function.to, or remove the sample";
            Err(Refusal::new(KEY, message, remedy))
        }
    }
}

/// Checks points in the order of rising operands.
///
/// # Errors
/// Fails if two points have the same operand, if an end of the domain has no point, or if a step is longer than [`GAP`] times
/// both neighbouring steps. A list of at most three points has no gap.
fn check_points(
    points: &[(i64, Enclosure)],
    fraction: u32,
    domain: (i64, i64),
) -> Result<(), Refusal> {
    let unit = exp2(-(fraction as i32));
    for pair in points.windows(2) {
        if pair[0].0 == pair[1].0 {
            let message = format!("there are two samples for x = {}", pair[0].0 as f64 * unit);
            return Err(Refusal::new(KEY, message, "keep one of the two samples, or their mean"));
        }
    }
    let first = points.first().map(|point| point.0);
    let last = points.last().map(|point| point.0);
    if (first, last) != (Some(domain.0), Some(domain.1)) {
        let missing = if first == Some(domain.0) { domain.1 } else { domain.0 };
        let x = missing as f64 * unit;
        let message = format!("there is no sample at the end of the domain, x = {x}");
        return Err(Refusal::new(
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
            return Err(Refusal::new(KEY, message, remedy));
        }
    }
    Ok(())
}

/// Returns the raw operand of a number with `fraction` fraction bits. For example, 1.5 with one fraction bit gives 3. A number
/// with many decimal digits may also be the printed form of an `f64` that is an operand. Returns `None` if the number is not an
/// operand.
fn raw_operand(x: &Expression, fraction: u32) -> Option<i128> {
    match x.ceiling(fraction) {
        Ok((raw, true)) => Some(raw),
        _ => {
            let raw = x.printed_double()? * exp2(fraction as i32);
            (raw.fract() == 0.0).then_some(raw as i128)
        }
    }
}

/// A chord between two neighbouring points: its length in steps of the raw operand, and its slope.
type Chord = (f64, f64);

/// Returns the slopes of Steffen's curve at the points. The points must be in the order of rising operands.
fn slopes(points: &[(i64, Enclosure)]) -> Vec<f64> {
    let mut chords: Vec<Chord> = Vec::new();
    for pair in points.windows(2) {
        let length = (pair[1].0 - pair[0].0) as f64;
        let slope = (pair[1].1.middle() - pair[0].1.middle()) / length;
        chords.push((length, slope));
    }
    let [first, .., last] = chords[..] else {
        // A single chord gives the slope at both ends.
        return chords.iter().flat_map(|&chord| [end_slope(chord, None); 2]).collect();
    };
    let mut slopes = vec![end_slope(first, Some(chords[1]))];
    for pair in chords.windows(2) {
        slopes.push(inner_slope(pair[0], pair[1]));
    }
    slopes.push(end_slope(last, Some(chords[chords.len() - 2])));
    slopes
}

/// Returns the slope of Steffen's curve at the point between two chords. The slope is 0 if the chords do not both rise or both
/// fall.
fn inner_slope((h, s): Chord, (k, t): Chord) -> f64 {
    let parabola = (s * k + t * h) / (h + k);
    let least = s.abs().min(t.abs()).min(parabola.abs() / 2.0);
    if s * t > 0.0 { 2.0 * least.copysign(s) } else { 0.0 }
}

/// Returns the slope of Steffen's curve at an end, whose chord is `(h, s)`. `beside` is the neighbouring chord. If `beside` is
/// `None`, there is only one chord, and its slope is the result. Otherwise the result is the slope of the parabola through the
/// three points at this end, limited to the range from 0 to twice the chord's slope.
fn end_slope((h, s): Chord, beside: Option<Chord>) -> f64 {
    let parabola = beside.map_or(s, |(k, t)| s + (s - t) * h / (h + k));
    if parabola * s <= 0.0 { 0.0 } else { parabola.abs().min(2.0 * s.abs()).copysign(s) }
}

fn number(text: &str) -> Option<Enclosure> {
    let value = parse(text).and_then(|formula| formula.enclose(&[])).ok()?;
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_of_one_derivative_and_monotone() {
        // By hand: chords 1, 1, 4, 0. Slopes: at the first end 1 + (1 − 1)/2 = 1; between 1 and 1: 2·min(1, 1, 1/2) = 1; between
        // 1 and 4: parabola 5/2, 2·min(1, 4, 5/4) = 2; between 4 and 0: 0; at the last end the chord is 0.
        let curve = Samples::read("0,0 2,2 4,4 6,12 8,12", 0, (0, 8)).unwrap();
        assert_eq!(curve.0.iter().map(|it| it.2).collect::<Vec<_>>(), [1.0, 1.0, 2.0, 0.0, 0.0]);
        // Halfway of 4 … 6 a cubic of Hermite: (4 + 12)/2 + 2·(2 − 0)/8 = 8.5; of 2 … 4: 3 + 2·(1 − 2)/8 = 2.75.
        let at = [1, 3, 5, 7].map(|raw| curve.limits(raw));
        assert!(
            at.iter().zip([1.0, 2.75, 8.5, 12.0]).all(|(limits, value)| limits.holds(value)),
            "{at:?}"
        );
    }

    #[test]
    fn samples_are_points_of_the_domain_without_gaps() {
        let samples = Samples::read("0,0 3,-0.5 1,1e-1 2,0.25", 0, (0, 3)).unwrap();
        assert_eq!(samples.limits(2), Enclosure::exactly(0.25));
        assert!(samples.limits(1).holds(0.1) && samples.limits(1).low < samples.limits(1).high);
        let halves = Samples::read("0,0 1,1", 1, (0, 2)).unwrap();
        assert!(halves.limits(1).holds(0.5) && halves.count() == 2);
        // The decimals are as NumPy prints them: 1 − 2^−20 has 20 digits, and `%.18e` prints 19 of them.
        let near = "9.999980926513671875e-01,0 9.999990463256835938e-01,+0.5 1e0,1";
        let samples = Samples::read(near, 20, ((1 << 20) - 2, 1 << 20)).unwrap();
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
            match Samples::read(text, 1, (0, 6)) {
                Err(refusal) => assert_eq!(refusal.message, message),
                Ok(_) => assert_eq!(message, "there is no gap", "{text}"),
            }
        }
        let gap = Samples::read("0,0 1,1 2,1 9,2 10,3", 0, (0, 10)).unwrap_err();
        assert_eq!(gap.message, "there is a gap between the samples at x = 2 and 9");
    }
}

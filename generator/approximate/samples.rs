//! Reads samples, which are measured points that a configuration of the device `function` may give in place of a formula, and
//! computes the curve through them.
//!
//! Between two samples the curve is Steffen's cubic (Astronomy and Astrophysics 239, 443, 1990). It has a continuous derivative,
//! and it rises or falls wherever the samples do. The slopes at the samples are the f64 numbers that Steffen's formula gives.

use super::Refusal;
use glint_base::fixed::exp2;
use glint_formula::{Enclosure, Expression, parse};

/// How many times the longer of the steps beside it a step between samples may be.
const GAP: i64 = 4;

/// The key that has them.
const KEY: &str = "function.samples";

/// Samples in the order of their operands. Each has its raw operand, its value, and the slope of the curve per step of the raw
/// operand.
#[derive(Clone, Debug)]
pub struct Samples(Vec<(i64, Enclosure, f64)>);

impl Samples {
    /// Reads samples from the text of a configuration, `x,y x,y`. `fraction` is the number of fraction bits of the operand, and
    /// `domain` the smallest and the largest raw operand.
    /// # Errors
    /// Fails if a point is no pair of numbers or at no operand of the domain, if two points have the same operand, if the
    /// domain has no point at an end, or if the points have a gap.
    pub fn read(text: &str, fraction: u32, domain: (i64, i64)) -> Result<Self, Refusal> {
        let refused = |message: String, remedy: &str| Err(Refusal::new(KEY, message, remedy));
        let mut points: Vec<(i64, Enclosure)> = Vec::new();
        for point in text.split(' ').filter(|point| !point.is_empty()) {
            let numbers =
                point.split_once(',').and_then(|(x, y)| Some((parse(x).ok()?, number(y)?)));
            let Some((x, y)) = numbers.filter(|(x, _)| x.enclose(&[]).is_ok()) else {
                let remedy = "a number for x, a comma and a number for y";
                return refused(format!("the sample `{point}` is no pair of numbers"), remedy);
            };
            let Some(raw) = raw_operand(&x, fraction) else {
                let message =
                    format!("the sample `{point}` is at no operand with {fraction} fraction bits");
                let remedy = "more operand.fraction bits, or number the samples: 0, 1, 2 …";
                return refused(message, remedy);
            };
            let inside = i64::try_from(raw).ok().filter(|raw| (domain.0..=domain.1).contains(raw));
            let Some(raw) = inside else {
                let message = format!("the sample `{point}` is outside the domain");
                return refused(message, "change function.from or function.to, or leave it out");
            };
            points.push((raw, y));
        }
        points.sort_by_key(|point| point.0);
        let value = |raw: i64| raw as f64 * exp2(-(fraction as i32));
        if let Some(pair) = points.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            let message = format!("there are two samples for x = {}", value(pair[0].0));
            return refused(message, "keep one of the two, or their mean");
        }
        let ends = points.first().zip(points.last()).map(|(first, last)| (first.0, last.0));
        if ends != Some(domain) {
            let missing = if ends.is_some_and(|it| it.0 == domain.0) { domain.1 } else { domain.0 };
            let message =
                format!("there is no sample at the end of the domain, x = {}", value(missing));
            return refused(message, "add it, or let the domain end at a sample");
        }
        let steps: Vec<i64> = points.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        for (at, step) in steps.iter().enumerate().filter(|_| steps.len() > 2) {
            let beside = [at.checked_sub(1), Some(at + 1)].into_iter().flatten();
            let longest = beside.filter_map(|at| steps.get(at)).max();
            if longest.is_some_and(|longest| *step > GAP * longest) {
                let [from, to] = [at, at + 1].map(|at| value(points[at].0));
                let message = format!("there is a gap between the samples at x = {from} and {to}");
                return refused(message, "add samples there, or make two functions of it");
            }
        }
        let slopes = slopes(&points);
        let points = points.into_iter().zip(slopes);
        Ok(Self(points.map(|((raw, value), slope)| (raw, value, slope)).collect()))
    }

    /// Returns the number of samples in the list.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Returns an interval that contains the value of the curve at a raw operand.
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

/// Returns the raw operand that a number is: exactly, or as the `f64` that its many digits were printed from.
fn raw_operand(x: &Expression, fraction: u32) -> Option<i128> {
    match x.ceiling(fraction) {
        Ok((raw, true)) => Some(raw),
        _ => {
            let raw = x.printed_double()? * exp2(fraction as i32);
            (raw.fract() == 0.0).then_some(raw as i128)
        }
    }
}

/// Returns the slopes of Steffen's curve at points.
fn slopes(points: &[(i64, Enclosure)]) -> Vec<f64> {
    let chord = |pair: &[(i64, Enclosure)]| {
        let length = (pair[1].0 - pair[0].0) as f64;
        (length, (pair[1].1.middle() - pair[0].1.middle()) / length)
    };
    let chords: Vec<(f64, f64)> = points.windows(2).map(chord).collect();
    let within = |(h, s): (f64, f64), (k, t): (f64, f64)| {
        let parabola = (s * k + t * h) / (h + k);
        let least = s.abs().min(t.abs()).min(parabola.abs() / 2.0);
        if s * t > 0.0 { 2.0 * least.copysign(s) } else { 0.0 }
    };
    // The parabola through the last three points, as far as it goes the way of the last chord.
    let end = |(h, s): (f64, f64), beside: Option<&(f64, f64)>| {
        let parabola = beside.map_or(s, |(k, t)| s + (s - t) * h / (h + k));
        if parabola * s <= 0.0 { 0.0 } else { parabola.abs().min(2.0 * s.abs()).copysign(s) }
    };
    let first = chords.first().map(|it| end(*it, chords.get(1)));
    let last = chords.last().map(|it| end(*it, chords.len().checked_sub(2).map(|at| &chords[at])));
    let middle = chords.windows(2).map(|pair| within(pair[0], pair[1]));
    first.into_iter().chain(middle).chain(last).collect()
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
            ("0,0 1,1 3,x", "the sample `3,x` is no pair of numbers"),
            ("0,0 1 3,1", "the sample `1` is no pair of numbers"),
            ("0,0 0.25,1 3,1", "the sample `0.25,1` is at no operand with 1 fraction bits"),
            ("0,0 3.5,1", "the sample `3.5,1` is outside the domain"),
            ("0,0 1,1 1.0,1 3,1", "there are two samples for x = 1"),
            ("1,1 3,1", "there is no sample at the end of the domain, x = 0"),
            ("0,0 1,1", "there is no sample at the end of the domain, x = 3"),
            ("0,0 0.5,1 2.75,1 3,1", "the sample `2.75,1` is at no operand with 1 fraction bits"),
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

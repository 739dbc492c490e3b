//! Measured points in place of a formula.

use super::Refusal;
use glint_base::fixed::exp2;
use glint_formula::{Enclosure, parse};

/// How many times the longer of the steps beside it a step between samples may be.
const GAP: i64 = 4;

/// The key that has them.
const KEY: &str = "function.samples";

/// Points with rising operands.
#[derive(Clone, Debug)]
pub struct Samples(Vec<(i64, Enclosure)>);

impl Samples {
    /// Reads points as a configuration has them, `x,y x,y`, for a domain of raw operands.
    ///
    /// # Errors
    /// A point that is no number or no operand of the domain, two of one operand, and gaps between them.
    pub fn read(text: &str, fraction: u32, domain: (i64, i64)) -> Result<Self, Refusal> {
        let refused = |message: String, remedy: &str| Err(Refusal::new(KEY, message, remedy));
        let mut points: Vec<(i64, Enclosure)> = Vec::new();
        for point in text.split(' ').filter(|point| !point.is_empty()) {
            let numbers = point.split_once(',').map(|(x, y)| [x, y].map(number));
            let Some([Some(x), Some(y)]) = numbers else {
                let remedy = "a number for x, a comma and a number for y";
                return refused(format!("the sample `{point}` is no pair of numbers"), remedy);
            };
            let raw = x.low * exp2(fraction as i32);
            if x.low != x.high || raw.fract() != 0.0 {
                let message =
                    format!("the sample `{point}` is at no operand with {fraction} fraction bits");
                let remedy = "more operand.fraction bits, or number the samples: 0, 1, 2 …";
                return refused(message, remedy);
            }
            let raw = raw as i64;
            if raw < domain.0 || raw > domain.1 {
                let message = format!("the sample `{point}` is outside the domain");
                return refused(message, "change function.from or function.to, or leave it out");
            }
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
        Ok(Self(points))
    }

    /// The raw operands.
    pub fn operands(&self) -> impl ExactSizeIterator<Item = i64> {
        self.0.iter().map(|point| point.0)
    }

    /// Whether there is a sample at a raw operand.
    pub fn has(&self, raw: i64) -> bool {
        self.0.binary_search_by_key(&raw, |point| point.0).is_ok()
    }

    /// The value of a sample, and of other operands that on the line between both beside it.
    pub fn limits(&self, raw: i64) -> Enclosure {
        let at = self.0.partition_point(|point| point.0 < raw).min(self.0.len() - 1);
        let (to, above) = self.0[at];
        if to == raw || at == 0 {
            return above;
        }
        let (from, below) = self.0[at - 1];
        let part = |a: i64, b: i64| Enclosure::exactly((a - b) as f64);
        below + (above - below) * part(raw, from) / part(to, from)
    }

    /// How far the samples beside an operand, two on either side, are from each other.
    pub fn spread(&self, raw: i64) -> f64 {
        let at = self.0.partition_point(|point| point.0 < raw);
        let beside = &self.0[at.saturating_sub(2)..(at + 2).min(self.0.len())];
        let all = beside.iter().map(|point| point.1).reduce(Enclosure::hull);
        all.map_or(0.0, |all| all.high - all.low)
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
        let samples = Samples::read("0,0 3,-0.5 1,1e-1 2,0.25", 0, (0, 3)).unwrap();
        assert_eq!(samples.limits(2), Enclosure::exactly(0.25));
        assert!(samples.limits(1).holds(0.1) && samples.limits(1).low < samples.limits(1).high);
        let halves = Samples::read("0,0 1,1", 1, (0, 2)).unwrap();
        assert!(halves.limits(1).holds(0.5) && !halves.has(1) && halves.has(2));
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

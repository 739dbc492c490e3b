//! Computes the curve through samples, measured points that a user may state instead of a formula.
//!
//! Between two samples the curve is Steffen's cubic (Astronomy and Astrophysics 239, 443, 1990). It has a continuous derivative,
//! and it rises or falls wherever the samples do. Its slopes at the samples are the f64 numbers that Steffen's formula gives.

use glint_formula::Enclosure;

/// The points in the order of rising operands: the raw operand, the value, and the slope of the curve per step of the raw
/// operand.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples(Vec<(i64, Enclosure, f64)>);

impl Samples {
    /// Makes the curve through at least one point: a raw operand, and an interval that contains the value. The raw operands must
    /// rise from point to point.
    pub fn through(points: Vec<(i64, Enclosure)>) -> Self {
        let slopes = slopes(&points);
        let mut samples = Vec::with_capacity(points.len());
        for ((raw, value), slope) in points.into_iter().zip(slopes) {
            samples.push((raw, value, slope));
        }
        Self(samples)
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Returns an interval that contains the value of the curve at the raw operand `raw`, which must be in the domain.
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

/// A chord between neighbouring points: its length in steps of the raw operand, and its slope.
type Chord = (f64, f64);

/// Returns the slopes of Steffen's curve at the points, which must be in the order of rising operands.
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

/// Returns the slope of Steffen's curve between two chords: 0 unless both rise or both fall.
fn inner_slope((h, s): Chord, (k, t): Chord) -> f64 {
    let parabola = (s * k + t * h) / (h + k);
    let least = s.abs().min(t.abs()).min(parabola.abs() / 2.0);
    if s * t > 0.0 { 2.0 * least.copysign(s) } else { 0.0 }
}

/// Returns the slope of Steffen's curve at an end, whose chord is `(h, s)`. `beside` is the neighbouring chord. The parabola
/// through the three points at this end gives the slope, limited to the range from 0 to twice the chord's slope. A single chord
/// has its own slope.
fn end_slope((h, s): Chord, beside: Option<Chord>) -> f64 {
    let parabola = beside.map_or(s, |(k, t)| s + (s - t) * h / (h + k));
    if parabola * s <= 0.0 { 0.0 } else { parabola.abs().min(2.0 * s.abs()).copysign(s) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_of_one_derivative_and_monotone() {
        // By hand: chords 1, 1, 4, 0. Slopes: at the first end 1 + (1 − 1)/2 = 1; between 1 and 1: 2·min(1, 1, 1/2) = 1; between
        // 1 and 4: parabola 5/2, 2·min(1, 4, 5/4) = 2; between 4 and 0: 0; at the last end the chord is 0.
        let points = [(0, 0.0), (2, 2.0), (4, 4.0), (6, 12.0), (8, 12.0)]
            .map(|(raw, value)| (raw, Enclosure::exactly(value)));
        let curve = Samples::through(points.to_vec());
        assert_eq!(curve.0.iter().map(|it| it.2).collect::<Vec<_>>(), [1.0, 1.0, 2.0, 0.0, 0.0]);
        // Halfway of 4 … 6 a cubic of Hermite: (4 + 12)/2 + 2·(2 − 0)/8 = 8.5; of 2 … 4: 3 + 2·(1 − 2)/8 = 2.75.
        let at = [1, 3, 5, 7].map(|raw| curve.limits(raw));
        assert!(
            at.iter().zip([1.0, 2.75, 8.5, 12.0]).all(|(limits, value)| limits.holds(value)),
            "{at:?}"
        );
    }
}

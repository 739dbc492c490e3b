//! An increasing function by straight segments, computed afresh.
//!
//! The operand u is an integer of C bits. Ranges, each a quarter of the one before, are cut uniformly,
//! and so is the tail below them; a value is a raw u0.S.

use glint_base::fixed::exp2;

/// The parameters of the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Params {
    /// Bits of the operand, C.
    pub operand_bits: u32,
    /// Fraction bits of a value, S.
    pub fraction: u32,
    /// Fraction bits of a slope, D; a slope is the rise over a whole segment.
    pub slope_fraction: u32,
    /// log₂ of the number of prefixes in each range; a quarter of them lies below it.
    pub segments: Vec<u32>,
    /// log₂ of the number of segments of the tail.
    pub tail: u32,
}

/// Segments of up to this many operands are looked at operand by operand for their errors.
const SHORT: u64 = 64;

/// How the function bends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bend {
    /// Its slope grows.
    Convex,
    /// Its slope falls.
    Concave,
}

/// A segment, with what is stored for it.
#[derive(Clone, Copy, Debug)]
struct Segment {
    start: u64,
    log_length: u32,
    base: i64,
    slope: i64,
}

/// A segment and how far its values are from the function's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The smallest of its operands.
    pub start: u64,
    /// The largest of them.
    pub last: u64,
    /// The largest `|value − function|` among its operands.
    pub error: f64,
    /// The error of the best straight line with words of unlimited width.
    pub shape: f64,
}

/// The table.
#[derive(Clone, Debug)]
pub struct Curve {
    params: Params,
    /// From the topmost range down: log₂ of a segment's length, and where the range's prefix 0 would
    /// stand in `segments`.
    ranges: Vec<(u32, i64)>,
    segments: Vec<Segment>,
    largest: i64,
    pieces: Vec<Piece>,
}

impl Curve {
    /// The table of `function`, of u as an integer: increasing from 0 to 1.
    pub fn new(params: &Params, bend: Bend, function: impl Fn(f64) -> f64) -> Self {
        let mut curve = Self {
            params: params.clone(),
            ranges: Vec::new(),
            segments: Vec::new(),
            largest: (1 << params.fraction) - 1,
            pieces: Vec::new(),
        };
        let mut bits = params.operand_bits;
        for &prefix in &params.segments {
            curve.cut(bits - prefix, 1 << (prefix - 2), 1 << prefix);
            bits -= 2;
        }
        curve.cut(bits - params.tail, 0, 1 << params.tail);
        for at in 0..curve.segments.len() {
            curve.fit(at, bend, &function);
        }
        curve
    }

    /// Appends the segments number `first .. end` of length 2^`log_length`.
    fn cut(&mut self, log_length: u32, first: u64, end: u64) {
        let zero = self.segments.len() as i64 - first as i64;
        self.ranges.push((log_length, zero));
        self.segments.extend((first..end).map(|number| Segment {
            start: number << log_length,
            log_length,
            base: 0,
            slope: 0,
        }));
    }

    /// Base and slope of a segment, and its errors.
    ///
    /// The slope is the chord's, rounded. Relative to it a convex function falls and then rises, so its
    /// extremes are the ends and the point from which on it rises more, from one operand to the next, than
    /// the line; a concave one rises and then falls. The base halves the extremes. Of a convex function it makes up for
    /// half an ulp that the truncated rise loses; where a segment has one operand there is no rise.
    fn fit(&mut self, at: usize, bend: Bend, function: &impl Fn(f64) -> f64) {
        let Segment { start, log_length, .. } = self.segments[at];
        let steps = 1u64 << log_length;
        let scale = exp2(self.params.fraction as i32);
        let value = |step: u64| function((start + step) as f64);
        let first = value(0);
        let (slope, turn, low, high) = if steps == 1 {
            (0, 0, first, first)
        } else {
            let slope_scale = exp2(self.params.slope_fraction as i32);
            let slope = ((value(steps) - first) * slope_scale + 0.5).floor();
            let rise = slope / slope_scale / steps as f64;
            let above = |step: u64| value(step) - rise * step as f64;
            let turned = |step: u64| match bend {
                Bend::Convex => value(step + 1) - value(step) > rise,
                Bend::Concave => above(step + 1) <= above(step),
            };
            // The first step at which the function has turned.
            let (mut from, mut to) = (0, steps - 1);
            while from < to {
                let middle = (from + to) / 2;
                if turned(middle) {
                    to = middle;
                } else {
                    from = middle + 1;
                }
            }
            let ends = [above(0), above(steps - 1)];
            match bend {
                Bend::Convex => (slope as i64, from, above(from), ends[0].max(ends[1])),
                Bend::Concave => (slope as i64, from, ends[0].min(ends[1]), above(from)),
            }
        };
        let half = if steps == 1 || bend == Bend::Concave { 0.0 } else { 0.5 };
        let base = ((low + high) / 2.0 * scale + half + 0.5).floor() as i64;
        let segment = &mut self.segments[at];
        segment.base = base.clamp(0, self.largest);
        segment.slope = slope;

        // The line is off by the most at its extremes; the truncated rise takes less than an ulp.
        let line = segment.base as f64 / scale;
        let each = |step| (self.at((start + step) as i64) as f64 / scale - value(step)).abs();
        let error = match bend {
            _ if steps == 1 => each(0),
            Bend::Convex if steps <= SHORT => (0..steps).map(each).fold(0.0, f64::max),
            Bend::Convex => (line - low).max(high - line + 1.0 / scale),
            // Saturation to 1 − ulp is off by up to an ulp.
            Bend::Concave => (high + 1.0 / scale - line).max(line - low).max(1.0 / scale),
        };
        let shape = match bend {
            Bend::Convex => (high - low) / 2.0,
            Bend::Concave => {
                let chord = first + (value(steps) - first) * turn as f64 / steps as f64;
                if steps == 1 { 0.0 } else { (value(turn) - chord) / 2.0 }
            }
        };
        self.pieces.push(Piece { start, last: start + steps - 1, error, shape });
    }

    /// Every segment.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The value for u.
    #[inline]
    pub fn at(&self, u: i64) -> i64 {
        let length = 64 - (u as u64).leading_zeros();
        // Two bits a range.
        let range = ((self.params.operand_bits - length) / 2) as usize;
        let (log_length, zero) = self.ranges[range.min(self.ranges.len() - 1)];
        let segment = &self.segments[(zero + (u >> log_length)) as usize];
        let step = u - segment.start as i64;
        let shift = self.params.slope_fraction + segment.log_length;
        let product = segment.slope * step;
        let rise = if shift > self.params.fraction {
            product >> (shift - self.params.fraction)
        } else {
            product << (self.params.fraction - shift)
        };
        (segment.base + rise.min(self.largest)).min(self.largest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// C = 4 and the parabola (u/16)²·¾: one range, 4 … 15, in prefixes of four operands; a tail of one segment.
    fn parabola(segments: &[u32], tail: u32) -> Curve {
        let params = Params {
            operand_bits: 4,
            fraction: 8,
            slope_fraction: 8,
            segments: segments.to_vec(),
            tail,
        };
        Curve::new(&params, Bend::Convex, |u| 0.75 * u * u / 256.0)
    }

    #[test]
    fn by_hand() {
        // In units of 1/256 the function is 0.75·u².
        let curve = parabola(&[2], 0);
        // Tail, u = 0 … 3 (to 4): slope 12 over the segment, 3 a step. Above the line: 0, −2.25, −3,
        // −2.25; from −3 to 0: base −1.5 + 0.5, which no word holds: 0.
        assert_eq!([0, 1, 2, 3].map(|u| curve.at(u)), [0, 3, 6, 9]);
        // u = 4 … 7: 12 … 36.75, to 48: slope 36, 9 a step; above: 12, 9.75, 9, 9.75: base 10.5 + 0.5 = 11.
        assert_eq!([4, 5, 6, 7].map(|u| curve.at(u)), [11, 20, 29, 38]);
        // The last of four segments, 12 … 15: 108, 126.75, 147, 168.75, to 192: slope 84, 21 a step;
        // above: 108, 105.75, 105, 105.75: base 106.5 + 0.5 = 107.
        assert_eq!([12, 15].map(|u| curve.at(u)), [107, 170]);
    }

    #[test]
    fn pieces_bound_every_operand() {
        for (segments, tail) in [(&[2, 2][..], 0), (&[4][..], 1), (&[3, 2][..], 0)] {
            let curve = parabola(segments, tail);
            for u in 0..16i64 {
                let holds = |piece: &&Piece| (piece.start..=piece.last).contains(&(u as u64));
                let piece = curve.pieces().iter().find(holds).expect("a piece");
                let error = (curve.at(u) as f64 - 0.75 * (u * u) as f64).abs() / 256.0;
                assert!(error <= piece.error, "{u}: {error} > {piece:?}");
            }
        }
    }
}

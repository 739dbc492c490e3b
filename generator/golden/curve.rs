//! Builds a table of straight segments that approximates an increasing, concave function, such as the square root. The golden
//! model of the device `rough` uses it for its sines.
//!
//! The operand u is an unsigned integer of C bits. The upper three quarters of the operands are the first range. The upper three
//! quarters of the remaining quarter are the second range, and so on. The operands below all ranges are called the tail. All
//! segments of a range have the same length, and so have all segments of the tail. A value of the table is a raw number in the
//! format u0.S.

use glint_base::fixed::exp2;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CurveParams {
    /// The number C of bits of the operand u.
    pub operand_bits: u32,
    /// The number S of fraction bits of a value.
    pub fraction: u32,
    /// The number D of fraction bits of a slope, the rise over a whole segment.
    pub slope_fraction: u32,
    /// log₂ of the number of prefixes in each range, the topmost range first; at least 2. A prefix is the leading bits of u
    /// that select a segment; a quarter of the prefixes belongs to the operands below the range. For example, 4 makes 16
    /// prefixes, 12 of them segments of the range.
    pub segments: Vec<u32>,
    /// log₂ of the number of segments of the tail.
    pub tail: u32,
}

/// A straight segment. `base` and `slope` are the raw values that the table stores.
#[derive(Clone, Copy, Debug)]
struct CurveSegment {
    start: u64,
    log_length: u32,
    base: i64,
    slope: i64,
}

/// A segment of a [`SegmentedCurve`] with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The smallest operand of the segment.
    pub start: u64,
    /// The largest operand of the segment.
    pub last: u64,
    /// The largest `|value − function|` over the segment's operands, as a value.
    pub error: f64,
    /// The error that words of unlimited width would leave: the largest distance of the straight line from the function.
    pub shape: f64,
}

#[derive(Clone, Debug)]
pub struct SegmentedCurve {
    params: CurveParams,
    /// For each range from the topmost down, and then for the tail: log₂ of the number of operands of a segment, and an index
    /// in `segments`. A segment of the range has this index plus its prefix.
    ranges: Vec<(u32, i64)>,
    segments: Vec<CurveSegment>,
    largest: i64,
    pieces: Vec<Piece>,
}

impl SegmentedCurve {
    /// Makes the table of `function`, whose argument is u from 0 to 2^C. `function` must be concave and increase from 0 to 1.
    pub fn new(params: &CurveParams, function: impl Fn(f64) -> f64) -> Self {
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
            curve.fit(at, &function);
        }
        curve
    }

    /// Appends a range, or the tail, with the segments number `first .. end`, each of 2^`log_length` operands.
    fn cut(&mut self, log_length: u32, first: u64, end: u64) {
        let zero = self.segments.len() as i64 - first as i64;
        self.ranges.push((log_length, zero));
        self.segments.extend((first..end).map(|number| CurveSegment {
            start: number << log_length,
            log_length,
            base: 0,
            slope: 0,
        }));
    }

    /// Fits the base and the slope of segment number `at`, and appends its errors to `pieces`.
    ///
    /// The slope is the rounded slope of the chord. The difference between a concave function and a line of this slope rises and
    /// then falls. The smallest difference is therefore at an end of the segment. The largest is at the turning point, after
    /// which the function rises less than the line from one operand to the next. The base is the mean of the smallest and the
    /// largest difference. A segment with a single operand has the slope 0.
    fn fit(&mut self, at: usize, function: &impl Fn(f64) -> f64) {
        let CurveSegment { start, log_length, .. } = self.segments[at];
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
            // The turning point: the first step after which the function does not rise more than the line.
            let (mut from, mut to) = (0, steps - 1);
            while from < to {
                let middle = (from + to) / 2;
                if above(middle + 1) <= above(middle) {
                    to = middle;
                } else {
                    from = middle + 1;
                }
            }
            (slope as i64, from, above(0).min(above(steps - 1)), above(from))
        };
        let base = ((low + high) / 2.0 * scale + 0.5).floor() as i64;
        let segment = &mut self.segments[at];
        segment.base = base.clamp(0, self.largest);
        segment.slope = slope;

        // The line has its largest errors at the two extremes. Truncation of the rise loses less than an ulp, and saturation to
        // 1 − ulp loses up to an ulp.
        let line = segment.base as f64 / scale;
        let (error, shape) = if steps == 1 {
            ((self.at(start as i64) as f64 / scale - first).abs(), 0.0)
        } else {
            let chord = first + (value(steps) - first) * turn as f64 / steps as f64;
            let error = (high + 1.0 / scale - line).max(line - low).max(1.0 / scale);
            (error, (value(turn) - chord) / 2.0)
        };
        self.pieces.push(Piece { start, last: start + steps - 1, error, shape });
    }

    /// Returns all segments: first the topmost range's segments, and last the tail.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Returns the table's value at the operand u, from 0 to 2^C − 1.
    #[inline]
    pub fn at(&self, u: i64) -> i64 {
        let length = 64 - (u as u64).leading_zeros();
        // Every two leading zeros of u lead to the next range.
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

    /// Returns three quarters of x·(2 − x) at x = u/16.
    fn lobe(u: f64) -> f64 {
        0.75 * (u / 16.0) * (2.0 - u / 16.0)
    }

    /// Operands have 4 bits, values and slopes 8 fraction bits. `parabola(&[2], 0)` has one range, 4 … 15, in segments of four
    /// operands, and a tail of one segment.
    fn parabola(segments: &[u32], tail: u32) -> SegmentedCurve {
        let params = CurveParams {
            operand_bits: 4,
            fraction: 8,
            slope_fraction: 8,
            segments: segments.to_vec(),
            tail,
        };
        SegmentedCurve::new(&params, lobe)
    }

    #[test]
    fn by_hand() {
        // In units of 1/256 the function is 24·u − 0.75·u².
        let curve = parabola(&[2], 0);
        // Tail, u = 0 … 3 (to 4): slope 84 over the segment, 21 a step. Above the line: 0, 2.25, 3, 2.25: base 1.5 + 0.5.
        assert_eq!([0, 1, 2, 3].map(|u| curve.at(u)), [2, 23, 44, 65]);
        // u = 4 … 7: 84 … 131.25, to 144: slope 60, 15 a step; above: 84, 86.25, 87, 86.25: base 85.5 + 0.5.
        assert_eq!([4, 5, 6, 7].map(|u| curve.at(u)), [86, 101, 116, 131]);
        // The last of four segments, 12 … 15: 180 … 191.25, to 192: slope 12, 3 a step; above: 180, 182.25, 183, 182.25.
        assert_eq!([12, 15].map(|u| curve.at(u)), [182, 191]);
    }

    #[test]
    fn pieces_bound_every_operand() {
        for (segments, tail) in [(&[2, 2][..], 0), (&[4][..], 1), (&[3, 2][..], 0)] {
            let curve = parabola(segments, tail);
            for u in 0..16i64 {
                let holds = |piece: &&Piece| (piece.start..=piece.last).contains(&(u as u64));
                let piece = curve.pieces().iter().find(holds).expect("a piece");
                let error = (curve.at(u) as f64 / 256.0 - lobe(u as f64)).abs();
                assert!(error <= piece.error, "{u}: {error} > {piece:?}");
            }
        }
    }
}

//! Makes the table of sines of the device `rough`, ROM 18, for its golden model.
//!
//! The table maps a cosine x to the sine √(1 − x²). It has one entry for each bucket (an interval of x), or straight segments
//! that become shorter toward x = 1. x is a raw value with C fraction bits from 0 to 2^C. A sine has the format u0.S.

use super::curve::{self, SegmentedCurve};
use glint_base::fixed::exp2;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TableScheme {
    /// One entry for each value of the `address` leading fraction bits of x. For example, 12 bits make 4096 entries.
    Direct {
        /// The number A of address bits.
        address: u32,
    },
    /// Straight segments over u = 1.0 − x, interpolated linearly. The ranges are as in [`SegmentedCurve`]; the values of u below
    /// all ranges have an entry each.
    Segmented {
        /// log₂ of the number of prefixes (leading bits of u) in each range; a quarter of the prefixes belongs to the values
        /// below the range.
        segments: Vec<u32>,
        /// The number D of fraction bits of a slope, the rise over a whole segment.
        slope_fraction: u32,
    },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SineParams {
    /// The number C of fraction bits of the operand x.
    pub operand_fraction: u32,
    /// The number S of fraction bits of the sine.
    pub fraction: u32,
    pub scheme: TableScheme,
}

/// A set of adjacent operands, with the largest error of the table among these operands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorRange {
    /// The smallest and the largest operand, as cosines.
    pub cosines: (f64, f64),
    /// The largest `|table − √(1 − x²)|`.
    pub error: f64,
    /// The error that words of unlimited width would leave: the distance of √(1 − x²) from the bucket's constant, or from the
    /// segment's line.
    pub shape: f64,
}

#[derive(Clone, Debug)]
pub struct Sine {
    operand_fraction: u32,
    fraction: u32,
    table: SineTable,
}

#[derive(Clone, Debug)]
enum SineTable {
    Direct {
        address: u32,
        entries: Vec<i64>,
    },
    /// `rest` is the number of values of u below all ranges, each with its own entry.
    Segmented {
        curve: SegmentedCurve,
        rest: i64,
    },
}

impl Sine {
    pub fn new(params: &SineParams) -> Self {
        let (operand, fraction) = (params.operand_fraction, params.fraction);
        let table = match &params.scheme {
            TableScheme::Direct { address } => SineTable::Direct {
                address: *address,
                entries: (0..1 << address).map(|a| direct_entry(a, *address, fraction)).collect(),
            },
            TableScheme::Segmented { segments, slope_fraction } => {
                let tail = operand - 2 * segments.len() as u32;
                let params = curve::CurveParams {
                    operand_bits: operand,
                    fraction,
                    slope_fraction: *slope_fraction,
                    segments: segments.clone(),
                    tail,
                };
                let sine = |u: f64| sine_of(operand, u as i64);
                SineTable::Segmented { curve: SegmentedCurve::new(&params, sine), rest: 1 << tail }
            }
        };
        Self { operand_fraction: operand, fraction, table }
    }

    /// Returns the raw sine of the raw operand `x`, which is from 0 to 2^C.
    #[inline]
    pub fn at(&self, x: i64) -> i64 {
        let one = 1i64 << self.operand_fraction;
        match &self.table {
            SineTable::Direct { address, entries } => {
                // 1.0 has no fraction bits; it goes to the last bucket.
                let fraction = x.min(one - 1);
                entries[(fraction >> (self.operand_fraction - address)) as usize]
            }
            SineTable::Segmented { .. } if x == 0 => (1 << self.fraction) - 1,
            SineTable::Segmented { curve, .. } => curve.at(one - x),
        }
    }

    /// Calls `visit` with sets of adjacent operands that together contain every operand from 0 to 2^C.
    pub fn for_each_piece(&self, mut visit: impl FnMut(ErrorRange)) {
        let operand = self.operand_fraction;
        let (one, ulp) = (1i64 << operand, exp2(-(self.fraction as i32)));
        let cosine = |x: i64| x as f64 * exp2(-(operand as i32));
        match &self.table {
            SineTable::Direct { address, entries } => {
                let bucket = one >> address;
                for (&entry, a) in entries.iter().zip(0i64..) {
                    let first = a * bucket;
                    let last = if first + bucket == one { one } else { first + bucket - 1 };
                    let error = |x| (entry as f64 * ulp - sine_of(operand, one - x)).abs();
                    let error = error(first).max(error(last));
                    visit(ErrorRange {
                        cosines: (cosine(first), cosine(last)),
                        error,
                        shape: (error - ulp / 2.0).max(0.0),
                    });
                }
            }
            SineTable::Segmented { curve, rest } => {
                // x = 0 gives 1 − ulp, an ulp less than the exact sine.
                visit(ErrorRange { cosines: (0.0, 0.0), error: ulp, shape: 0.0 });
                for piece in curve.pieces().iter().filter(|piece| piece.start as i64 >= *rest) {
                    let cosines =
                        (cosine(one - piece.last as i64), cosine(one - piece.start as i64));
                    visit(ErrorRange { cosines, error: piece.error, shape: piece.shape });
                }
                // These sines are below √7/4, so no entry saturates.
                visit(ErrorRange {
                    cosines: (cosine(one - rest + 1), 1.0),
                    error: ulp / 2.0,
                    shape: 0.0,
                });
            }
        }
    }
}

/// Returns the sine `√(1 − x²)`. `u` is the raw value of 1.0 − x, from 0 to 2^C, where C is `operand`.
fn sine_of(operand: u32, u: i64) -> f64 {
    let one = 1i64 << operand;
    let x = one - u;
    ((one * one - x * x) as f64).sqrt() * exp2(-(operand as i32))
}

/// Rounds `sine` to `fraction` fraction bits, at most 1.0 less an ulp, and returns it raw.
fn to_raw(sine: f64, fraction: u32) -> i64 {
    let raw = (sine * exp2(fraction as i32) + 0.5).floor() as i64;
    raw.clamp(0, (1 << fraction) - 1)
}

/// Returns the raw sine at the middle of bucket `a`, in a table with `address` address bits.
fn direct_entry(a: i64, address: u32, fraction: u32) -> i64 {
    let x = (a as f64 + 0.5) * exp2(-(address as i32));
    to_raw((1.0 - x * x).sqrt(), fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(operand_fraction: u32, fraction: u32, scheme: TableScheme) -> Sine {
        Sine::new(&SineParams { operand_fraction, fraction, scheme })
    }

    fn segmented(segments: &[u32], slope_fraction: u32) -> TableScheme {
        TableScheme::Segmented { segments: segments.to_vec(), slope_fraction }
    }

    #[test]
    fn a_direct_table_by_hand() {
        // Buckets of a quarter: x = 1/8, 3/8, 5/8, 7/8; sines 0.9922, 0.9270, 0.7806, 0.4841; in
        // sixteenths 15.87 (saturated), 14.83, 12.49, 7.75.
        let it = sine(3, 4, TableScheme::Direct { address: 2 });
        let sines = [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|x| it.at(x));
        assert_eq!(sines, [15, 15, 15, 15, 12, 12, 8, 8, 8]);
    }

    #[test]
    fn a_segmented_table_by_hand() {
        // C = 4, one range of four prefixes: u = 4…7, 8…11, 12…15 in sixteenths, and exact entries
        // for u = 0…3. S = 6 and D = 5: slopes in 1/32, sines in 1/64.
        // Sines at u = 0, 1, …: 0, 0.3480, 0.4841, 0.5830; 0.6614, 0.7262, 0.7806, 0.8268; 0.8660,
        // 0.8992, 0.9270, 0.9499; 0.9682, 0.9823, 0.9922, 0.9980; 1.
        // Segment 4: slope = 32·(0.8660 − 0.6614) = 6.55 → 7; e = 0.6614, 0.6715, 0.6712, 0.6627;
        //   base = 64·(0.6614 + 0.6715)/2 = 42.65 → 43. A quarter of the slope is 3.5 of 1/64.
        // Segment 8: slope = 32·0.1022 = 3.27 → 3; e = 0.8660, 0.8758, 0.8801, 0.8796; base = 55.87 → 56.
        // Segment 12: slope = 32·0.0318 = 1.02 → 1; e = 0.9682, 0.9745, 0.9766, 0.9746; base = 62.23 → 62.
        let it = sine(4, 6, segmented(&[2], 5));
        let sines: Vec<i64> = (0..=16).map(|u| it.at(16 - u)).collect();
        let rest = [0, 22, 31, 37];
        let ranges = [43, 46, 50, 53, 56, 57, 59, 60, 62, 62, 63, 63];
        assert_eq!(sines[..4], rest);
        assert_eq!(sines[4..16], ranges);
        assert_eq!(sines[16], 63);
    }

    /// Every operand is in a piece, and its error is at most the piece's error.
    #[test]
    fn pieces_bound_every_operand() {
        let tables = [
            sine(10, 12, TableScheme::Direct { address: 5 }),
            sine(10, 12, TableScheme::Direct { address: 10 }),
            sine(12, 14, segmented(&[4, 5, 4, 3], 12)),
            sine(12, 9, segmented(&[2, 2], 8)),
            sine(9, 9, segmented(&[9, 3], 9)),
        ];
        for it in &tables {
            let one = 1i64 << it.operand_fraction;
            let mut pieces = Vec::new();
            it.for_each_piece(|piece| pieces.push(piece));
            for x in 0..=one {
                let cosine = x as f64 / one as f64;
                let exact = (1.0 - cosine * cosine).sqrt();
                let error = (it.at(x) as f64 * exp2(-(it.fraction as i32)) - exact).abs();
                let holds =
                    |piece: &&ErrorRange| piece.cosines.0 <= cosine && cosine <= piece.cosines.1;
                let piece = pieces.iter().find(holds).expect("a piece");
                assert!(error <= piece.error, "{x} of {it:?}: {error} > {}", piece.error);
                // The bound is also not idle: no piece allows an error above ¼.
                assert!(piece.error <= 0.25);
            }
        }
    }
}

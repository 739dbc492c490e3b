//! Computes the inverse square root 1/√S of a sum of three squares S by a table, with a proven error bound. The golden models of
//! `normaliser` and `dot-product` scale a vector to length 1 by it.
//!
//! The sum is shifted by pairs of bits to a mantissa m from 1.0 to 4.0; the table interpolates 1/√m linearly. The module also
//! computes the exact unit vector of a direction for the accuracy contracts.

use super::Sweep;
use glint_base::fixed::{exp2, mask};

/// The largest sum of squares: each of the three components is at least −2.0, so its square is at most 4.
const FARTHEST: i64 = 12;

pub(super) struct Root {
    /// The number of bits of the sum of squares.
    pub width: u32,
    address: u32,
    fraction: u32,
    /// The raw values of 1/√m at the ends of the segments, from m = 1.0 to m = 4.0.
    ends: Vec<i64>,
}

impl Root {
    /// Makes the table for components with `components` fraction bits. The `address` leading bits of the mantissa select a
    /// segment. The table's values have `fraction` fraction bits.
    pub fn new(components: u32, address: u32, fraction: u32) -> Self {
        let segments = 1i64 << address;
        let scale = exp2(fraction as i32);
        // m goes from 1.0 to 4.0 in steps of 4.0/segments.
        let end =
            |at: i64| (scale / (at as f64 * (4.0 / segments as f64)).sqrt() + 0.5).floor() as i64;
        let ends = (segments / 4..=segments).map(end).collect();
        Self { width: 2 * components + 4, address, fraction, ends }
    }

    /// Returns the number of pairs of leading zeros of `sum`. For 0, returns the largest number that the shifter can count. For
    /// example, the sum 0b0001 of 4 bits has three leading zeros, so one pair.
    pub fn pairs(&self, sum: i64) -> i64 {
        match sum {
            0 => (1 << self.pair_bits()) - 1,
            _ => i64::from((self.width - 1 - sum.ilog2()) / 2),
        }
    }

    /// Returns the width of the count that [`Self::pairs`] returns.
    pub fn pair_bits(&self) -> u32 {
        (self.width - 1).ilog2()
    }

    /// Returns the mantissa: `sum` shifted left by `pairs` pairs of bits. The mantissa of 0 is 0.
    pub fn mantissa(&self, sum: i64, pairs: i64) -> i64 {
        if sum == 0 { 0 } else { sum << (2 * pairs) }
    }

    /// Returns the raw 1/√m for a raw mantissa m, interpolated linearly in its segment, or 0 for 0.
    pub fn inverse(&self, mantissa: i64) -> i64 {
        if mantissa == 0 {
            return 0;
        }
        let below = self.width - self.address;
        let at = ((mantissa >> below) - (1 << (self.address - 2))) as usize;
        let along = below.min(self.fraction - self.address + 2);
        let rest = (mantissa >> (below - along)) & mask(along) as i64;
        self.ends[at] - (((self.ends[at] - self.ends[at + 1]) * rest) >> along)
    }

    /// Returns upper limits of two errors of √m·r, as values: the first comes from the chords, the second from roundings. Let m
    /// be the mantissa, 1 ≤ m < 4, and f = 1/√m. Let r be the hardware's value of f with R fraction bits, u the weight of its
    /// last bit, and A the number of address bits.
    ///
    /// - f is convex, so a chord lies above it, by at most h²/8·max f″ = h²/8·¾·a^(−5/2) in the segment of length h that begins
    ///   at a.
    /// - The chord's ends are rounded: ½u. The position in the segment is truncated by at most 2^−(R − A + 2) of the segment's
    ///   length, over which f falls by at most h/2 = 2^(1 − A): ½u. The fall is truncated: u. The sum is 2u.
    /// - √m is below 2, so the roundings contribute at most 4u to the error of √m·r. The error of the chord is multiplied by
    ///   the square root of the segment's upper end.
    pub fn error(&self) -> [f64; 2] {
        let h = 4.0 / exp2(self.address as i32);
        let chord = (1 << (self.address - 2)..1u32 << self.address)
            .map(|at| {
                let a = f64::from(at) * h;
                h * h / 8.0 * 0.75 * libm::pow(a, -2.5) * (a + h).sqrt()
            })
            .fold(0.0, f64::max);
        [chord, 4.0 * exp2(-(self.fraction as i32))]
    }

    /// Visits every sum of squares from 1 on, because the sum alone determines the inverse root.
    pub fn sweep(&self) -> Sweep {
        Sweep::ranges([("sum of squares", (1, FARTHEST << (self.width - 4)))])
    }

    /// Returns the relative error |√m·r − 1| of the inverse root r for a sum with the mantissa m.
    pub fn relative_error(&self, sum: i64) -> f64 {
        let mantissa = self.mantissa(sum, self.pairs(sum));
        let root = (mantissa as f64 * exp2(2 - self.width as i32)).sqrt();
        (self.inverse(mantissa) as f64 * exp2(-(self.fraction as i32)) * root - 1.0).abs()
    }
}

/// Returns three random components from −1 to 1, from random numbers 0 to 1 that `unit` returns.
pub(super) fn centred(unit: &mut dyn FnMut() -> f64) -> [f64; 3] {
    [(); 3].map(|()| 2.0 * unit() - 1.0)
}

pub(super) fn unit_vector(vector: [f64; 3]) -> [f64; 3] {
    let now = vector.map(|it| it * it).iter().sum::<f64>().sqrt();
    vector.map(|it| if now == 0.0 { 0.0 } else { it / now })
}

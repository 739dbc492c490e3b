//! 2^−y of a fixed-point y by added tables and a shift, computed afresh.

use glint_base::fixed::{Format, Rounding, exp2};

use super::narrow::Narrow;

/// The parameters of the tables.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Params {
    /// Leading bits of the fraction of y, of which each value has a word.
    pub address: u32,
    /// The fields below, from the top: bits, and leading bits of the fraction that choose its slope.
    pub offsets: Vec<(u32, u32)>,
    /// Fraction bits of the tables.
    pub fraction: u32,
    /// Fraction bits of the result.
    pub result_fraction: u32,
    /// The rounding of the result.
    pub rounding: Rounding,
}

impl Params {
    /// Bits of the fraction of y.
    pub fn bits(&self) -> u32 {
        self.address + self.offsets.iter().map(|offset| offset.0).sum::<u32>()
    }
}

/// One table of offsets.
#[derive(Clone, Debug)]
struct Offsets {
    /// Where the field begins, and its bits.
    low: u32,
    bits: u32,
    /// How far the fraction is shifted for its leading bits.
    leading: u32,
    /// For each slope, the upper half of the field: what its values add.
    words: Vec<i64>,
}

/// The tables.
///
/// The bend of 2^−x below its chord 1 − x/2 is a sum of words: one by the leading bits of x, and one for each
/// field. A field that is v values above its middle adds v times a slope; when it is as far below, it
/// subtracts as much. All words are floors, which the first word makes up for.
#[derive(Clone, Debug)]
pub struct Halving {
    bits: u32,
    address: u32,
    fraction: u32,
    first: Vec<i64>,
    offsets: Vec<Offsets>,
    to_kept: Narrow,
    to_result: Narrow,
    result_fraction: u32,
}

impl Halving {
    /// Computes the tables.
    pub fn new(params: &Params) -> Self {
        let bits = params.bits();
        // The hardware's chord is the inverse of x behind a one: at the middle of an ulp of x, which the
        // words are for, it is a quarter of that ulp low.
        let quarter = exp2(-(bits as i32)) / 4.0;
        let bend = |x: f64| 1.0 - x / 2.0 - quarter - libm::exp2(-x);
        let ulps = exp2(params.fraction as i32);

        let mut low = bits - params.address;
        let mut offsets = Vec::new();
        for &(field, leading) in &params.offsets {
            low -= field;
            let intervals = 1u64 << leading;
            let mut words = Vec::new();
            for interval in 0..intervals {
                let (from, to) =
                    (interval as f64 / intervals as f64, (interval + 1) as f64 / intervals as f64);
                let slope = (bend(to) - bend(from)) * intervals as f64;
                for value in 0..1u64 << (field - 1) {
                    let distance = (2 * value + 1) as f64 / 2.0 * exp2(low as i32 - bits as i32);
                    words.push((slope * distance * ulps).floor() as i64);
                }
            }
            offsets.push(Offsets { low, bits: field, leading: bits - leading, words });
        }

        let count = 1u64 << params.address;
        let first = (0..count)
            .map(|at| {
                let [from, middle, to] =
                    [0.0, 0.5, 1.0].map(|part| bend((at as f64 + part) / count as f64));
                let level = (middle + (from + to) / 2.0) / 2.0;
                (level * ulps - 0.5 * offsets.len() as f64 + 0.5).floor() as i64
            })
            .collect();
        let kept_fraction = match params.rounding {
            Rounding::Truncate => params.result_fraction,
            Rounding::Nearest => params.result_fraction + 1,
        };
        let format = |fraction: u32| Format::unsigned(0, fraction as i32);
        Self {
            bits,
            address: params.address,
            fraction: params.fraction,
            first,
            offsets,
            to_kept: Narrow::new(
                params.fraction.max(bits + 1),
                format(kept_fraction),
                Rounding::Truncate,
            ),
            to_result: Narrow::new(kept_fraction, format(params.result_fraction), params.rounding),
            result_fraction: params.result_fraction,
        }
    }

    /// 2^−x for the fraction x, with as many fraction bits as the finer of tables and chord.
    #[inline]
    fn mantissa(&self, x: i64) -> i64 {
        let mut bend = self.first[(x >> (self.bits - self.address)) as usize];
        for table in &self.offsets {
            let half = 1i64 << (table.bits - 1);
            let value = x >> table.low & (2 * half - 1);
            let row = (x >> table.leading) * half;
            bend += if value >= half {
                table.words[(row + value - half) as usize]
            } else {
                -1 - table.words[(row + half - 1 - value) as usize]
            };
        }
        let chord = (1 << (self.bits + 1)) - 1 - x;
        let finer = self.fraction.max(self.bits + 1);
        (chord << (finer - self.bits - 1)) - (bend << (finer - self.fraction))
    }

    /// The result for y, which has [`Params::bits`] fraction bits.
    #[inline]
    pub fn at(&self, y: i64) -> i64 {
        let x = y & ((1 << self.bits) - 1);
        let kept = self.to_kept.apply(self.mantissa(x));
        let places = (y >> self.bits).min(63);
        self.to_result.apply(kept >> places)
    }

    /// The largest error of 2^−x before rounding, where x stands for everything from it to an ulp above it;
    /// at the largest at 1.0 in place of it.
    pub fn error(&self) -> f64 {
        let scale = exp2(-(self.fraction.max(self.bits + 1) as i32));
        let ulp = exp2(-(self.bits as i32));
        let exact = |x: i64| libm::exp2(-(x as f64) * ulp);
        let mut worst = 1.0 - exact(1);
        let mut from = 1.0;
        for x in 0..1i64 << self.bits {
            let (value, to) = (self.mantissa(x) as f64 * scale, exact(x + 1));
            worst = worst.max(value - to).max(from - value);
            from = to;
        }
        worst
    }

    /// The largest error of rounding the result; 1.0 is not representable.
    pub fn rounding_error(&self) -> f64 {
        exp2(-(self.result_fraction as i32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        // One leading bit and a field of two: x in eighths, tables in 1/64. Bend at x: 1 − x/2 − 1/32 − 2^−x.
        // bend(0) = −0.03125, (¼): 0.00285, (½): 0.01164, (¾): −0.00085, (1): −0.03125.
        let params = Params {
            address: 1,
            offsets: vec![(2, 0)],
            fraction: 6,
            result_fraction: 6,
            rounding: Rounding::Truncate,
        };
        let it = Halving::new(&params);
        // The one slope is 0: words 0 and 0. First words: (0.00285 − 0.00980)/2·64 − 0.5 + 0.5 = −0.22 → −1, and
        // (−0.00085 − 0.00980)/2·64 = −0.34 → −1.
        assert_eq!((it.first.clone(), it.offsets[0].words.clone()), (vec![-1, -1], vec![0, 0]));
        // x = 0: field 0 is below its middle: −1 − 0; bend −2; chord 15/16 = 60/64: 62.
        assert_eq!(it.at(0), 62);
        // x = 2/8: field above: bend −1; chord 13/16 = 52/64: 53. Shifted by 3: 6.
        assert_eq!(it.at(2), 53);
        assert_eq!(it.at(3 << 3 | 2), 6);
        // x = 4/8: bend −2; chord 11/16 = 44/64: 46; shifted by 1 and to the nearest with one bit fewer.
        assert_eq!(it.at(1 << 3 | 4), 23);
        let nearest = Params { result_fraction: 5, rounding: Rounding::Nearest, ..params };
        let nearest = Halving::new(&nearest);
        assert_eq!(nearest.at(1 << 3 | 4), 12);
        // 62/64 rounds to 31/32; everything is shifted out beyond y = 6.
        assert_eq!(nearest.at(0), 31);
        assert_eq!(nearest.at(7 << 3), 0);
    }

    #[test]
    fn the_error_is_the_largest() {
        let params = Params {
            address: 5,
            offsets: vec![(2, 4), (3, 2)],
            fraction: 14,
            result_fraction: 12,
            rounding: Rounding::Nearest,
        };
        let it = Halving::new(&params);
        let bound = it.error() + it.rounding_error();
        for y in 0..4 << 10 {
            for part in [0.0, 0.5, 1.0] {
                let exact = libm::exp2(-(f64::from(y) + part) / 1024.0);
                let error = (it.at(i64::from(y)) as f64 / 4096.0 - exact).abs();
                assert!(error <= bound, "{y}: {error} > {bound}");
            }
        }
        // Not idle either: 0.35 ulps of x, and a few of the tables.
        assert!(it.error() < 1.5e-3);
    }
}

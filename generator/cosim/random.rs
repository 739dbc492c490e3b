//! Numbers at random, the same on every machine.

use crate::base::fixed::{exp2, mask};
use crate::golden::Operand;

/// A small deterministic generator (SplitMix64): the same numbers on every machine, and fast enough
/// not to matter beside the simulation.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// An integer from 0 to `below - 1`.
    pub fn below(&mut self, below: u64) -> u64 {
        ((u128::from(self.bits()) * u128::from(below)) >> 64) as u64
    }

    /// True once in `times`.
    pub fn once_in(&mut self, times: u64) -> bool {
        self.below(times) == 0
    }

    /// An integer from `low` to `high`.
    pub fn within(&mut self, low: i64, high: i64) -> i64 {
        let span = high.wrapping_sub(low).wrapping_add(1) as u64;
        if span == 0 { self.bits() as i64 } else { low.wrapping_add(self.below(span) as i64) }
    }

    /// A raw value from `low` to `high`: often one of its ends or close to one (or to 0, which is as good as an
    /// end).
    pub fn of_domain(&mut self, (low, high): (i64, i64)) -> i64 {
        let choice = self.below(16);
        match choice {
            0 => low,
            1 => high,
            // Off by a random power of two: from the upper end, from the lower, from 0 where that is between
            // (an angle, the component of a vector).
            3..=13 if choice <= 8 || low < 0 && high > 0 => {
                let off = self.magnitude(high.abs_diff(low)) as i64;
                match choice {
                    3 | 4 => high.wrapping_sub(off),
                    _ if low >= 0 || high <= 0 => low.wrapping_add(off),
                    _ if choice.is_multiple_of(2) => off.min(high),
                    _ => (-off).max(low),
                }
            }
            _ => self.within(low, high),
        }
    }

    /// A bit pattern for an operand: mostly of its domain, as [`Random::of_domain`] draws it, at times any.
    pub fn pattern(&mut self, operand: &Operand) -> u64 {
        let raw =
            if self.once_in(16) { self.bits() as i64 } else { self.of_domain(operand.domain) };
        raw as u64 & mask(operand.format.width())
    }

    /// An integer from 0 to `most`, of each magnitude as often as of any other.
    pub fn magnitude(&mut self, most: u64) -> u64 {
        let bits = self.below(u64::from(64 - most.max(1).leading_zeros()) + 1);
        self.below(1 << bits.min(62)).min(most)
    }

    /// A number from 0 to just below 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * exp2(-53)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_drawn_of_a_domain_is_in_it() {
        let mut random = Random::new(5);
        for (low, high) in [(0, 0), (7, 7), (0, 1), (-3, -2), (-4, 9), (i64::MIN, i64::MAX)] {
            let mut ends = [false; 2];
            for _ in 0..500 {
                let raw = random.of_domain((low, high));
                assert!((low..=high).contains(&raw), "{raw} of {low}..={high}");
                ends = [ends[0] || raw == low, ends[1] || raw == high];
            }
            assert_eq!(ends, [true; 2], "{low}..={high}");
        }
    }
}

//! Draws pseudo-random numbers. The same seed gives the same numbers on every machine.

use glint_base::fixed::{exp2, mask};
use glint_golden::Operand;

/// A small deterministic random number generator (SplitMix64), fast compared with the simulation.
#[derive(Clone, Debug)]
pub struct Random(u64);

/// The constant that is added to the state for each number.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// [`Random::of_domain`] makes a list of seven values, and draws one of the 16 entries of a table: the index of the value that
/// the function returns. The first table is for a domain on both sides of 0, the second table for any other domain.
const AROUND_ZERO: [usize; 16] = [0, 1, 2, 3, 3, 6, 5, 6, 5, 6, 5, 6, 5, 6, 2, 2];
const TO_ONE_SIDE: [usize; 16] = [0, 1, 2, 3, 3, 4, 4, 4, 4, 2, 2, 2, 2, 2, 2, 2];

/// Converts 64 random bits to an integer from 0 to `below` − 1.
#[inline]
fn scaled(bits: u64, below: u64) -> u64 {
    ((u128::from(bits) * u128::from(below)) >> 64) as u64
}

/// Converts 64 random bits to an integer from `low` to `high`, both included.
#[inline]
fn within(bits: u64, low: i64, high: i64) -> i64 {
    let span = high.wrapping_sub(low).wrapping_add(1) as u64;
    if span == 0 { bits as i64 } else { low.wrapping_add(scaled(bits, span) as i64) }
}

/// Converts random bits to an integer from 0 to `most`. Every number of binary digits is equally likely.
#[inline]
fn magnitude([first, second]: [u64; 2], most: u64) -> u64 {
    let bits = scaled(first, u64::from(64 - most.max(1).leading_zeros()) + 1);
    scaled(second, 1 << bits.min(62)).min(most)
}

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        let bits = self.ahead(1);
        self.skip(1);
        bits
    }

    /// Returns the 64 random bits of a later draw without advancing the generator: `draws` = 1 denotes the next draw.
    #[inline]
    fn ahead(&self, draws: u64) -> u64 {
        let mut z = self.0.wrapping_add(STEP.wrapping_mul(draws));
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    #[inline]
    fn skip(&mut self, draws: u64) {
        self.0 = self.0.wrapping_add(STEP.wrapping_mul(draws));
    }

    /// Returns a random integer from 0 to `below` − 1.
    pub fn below(&mut self, below: u64) -> u64 {
        scaled(self.bits(), below)
    }

    /// Returns true with the probability 1 / `times`.
    pub fn once_in(&mut self, times: u64) -> bool {
        self.below(times) == 0
    }

    /// Returns a random integer from `low` to `high`, both included.
    pub fn within(&mut self, low: i64, high: i64) -> i64 {
        within(self.bits(), low, high)
    }

    /// Returns a random raw value from `low` to `high`, both included. The value is often one of these ends, or close to an
    /// end or to 0, because errors often show there.
    ///
    /// The function computes all seven candidates and takes one without a branch, which the processor could not predict. The
    /// generator advances only by the draws that the taken value needs.
    #[inline]
    pub fn of_domain(&mut self, (low, high): (i64, i64)) -> i64 {
        let [choice, first, second] = [1, 2, 3].map(|draws| self.ahead(draws));
        let off = magnitude([first, second], high.abs_diff(low)) as i64;
        let values = [
            low,
            high,
            within(first, low, high),
            // Off by a random magnitude: below the upper end, above the lower end, and on both sides of 0. Only a domain on
            // both sides of 0 uses the last two (an angle, the component of a vector).
            high.wrapping_sub(off),
            low.wrapping_add(off),
            off.min(high),
            (-off).max(low),
        ];
        let places = if low < 0 && high > 0 { &AROUND_ZERO } else { &TO_ONE_SIDE };
        let place = places[scaled(choice, 16) as usize];
        self.skip([1, 1, 2, 3, 3, 3, 3][place]);
        values[place]
    }

    /// Returns a random bit pattern for an operand: in one of 16 cases arbitrary bits, otherwise a value of
    /// [`Random::of_domain`].
    pub fn pattern(&mut self, operand: &Operand) -> u64 {
        let raw =
            if self.once_in(16) { self.bits() as i64 } else { self.of_domain(operand.domain) };
        raw as u64 & mask(operand.format.width())
    }

    /// Returns a random integer from 0 to `most`, both included. Small and large magnitudes are equally likely.
    pub fn magnitude(&mut self, most: u64) -> u64 {
        magnitude([self.bits(), self.bits()], most)
    }

    /// Returns a random number from 0 to just below 1, a multiple of 2^−53.
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
    /// Draws a number from a domain in separate steps, with only the draws that it needs.
    fn one_by_one(random: &mut Random, (low, high): (i64, i64)) -> i64 {
        let choice = random.below(16);
        match choice {
            0 => low,
            1 => high,
            3..=13 if choice <= 8 || low < 0 && high > 0 => {
                let off = random.magnitude(high.abs_diff(low)) as i64;
                match choice {
                    3 | 4 => high.wrapping_sub(off),
                    _ if low >= 0 || high <= 0 => low.wrapping_add(off),
                    _ if choice.is_multiple_of(2) => off.min(high),
                    _ => (-off).max(low),
                }
            }
            _ => random.within(low, high),
        }
    }

    #[test]
    fn what_is_not_taken_counts_as_not_drawn() {
        let mut random = Random::new(9);
        for (low, high) in [(0, 9), (-9, 0), (3, 3), (-4, 900), (i64::MIN, i64::MAX)] {
            for _ in 0..500 {
                let mut plain = random.clone();
                assert_eq!(random.of_domain((low, high)), one_by_one(&mut plain, (low, high)));
                assert_eq!(random.0, plain.0);
            }
        }
    }
}

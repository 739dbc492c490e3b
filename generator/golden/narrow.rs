//! Rounds raw values to a format and saturates them. The golden models convert formats in their inner loop, so [`Narrow`]
//! computes the constants of a conversion once.

use glint_base::fixed::{Format, Rounding};

/// A conversion of raw values with a fixed number of fraction bits to one format, which rounds and saturates.
///
/// It returns the same value as [`Format::narrow`] with `Overflow::Saturate`, but works on `i64`. For example, from 3 fraction
/// bits to `s0.1`, rounded, 5/8 becomes the raw value 1 (½), and 12/8 saturates to 1.
#[derive(Clone, Copy, Debug)]
pub struct Narrow {
    /// The number that is added before the shift: half a unit in the last place of the result, or 0.
    half: i64,
    right: u32,
    left: u32,
    min: i64,
    max: i64,
}

impl Narrow {
    /// Converts values with `from_frac` fraction bits to `format`, which may be at most 63 bits wide.
    pub fn new(from_frac: u32, format: Format, rounding: Rounding) -> Self {
        let places = from_frac as i32 - format.frac;
        let right = places.max(0) as u32;
        Self {
            half: match rounding {
                Rounding::Nearest if right > 0 => 1 << (right - 1),
                _ => 0,
            },
            right,
            left: (-places).max(0) as u32,
            min: format.min_raw() as i64,
            max: format.max_raw() as i64,
        }
    }

    /// Returns the raw value in the new format, rounded and limited to the format's range.
    #[inline]
    pub fn apply(&self, raw: i64) -> i64 {
        (((raw + self.half) >> self.right) << self.left).clamp(self.min, self.max)
    }
}

/// Returns an upper limit of the error, as a value, of a conversion from `from_frac` to `frac` fraction bits without saturation.
/// For example, 5 to 4 fraction bits give 1/16 if truncated, and 1/32 if rounded to the nearest.
pub fn rounding_error(from_frac: u32, frac: u32, rounding: Rounding) -> f64 {
    let ulp = glint_base::fixed::exp2(-(frac as i32));
    match rounding {
        _ if from_frac <= frac => 0.0,
        Rounding::Truncate => ulp,
        Rounding::Nearest => ulp / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_and_saturates_by_hand() {
        // s1.3 to s0.1: 5/8 → 1/2, −5/8 → −1 (truncate) or −1/2 (nearest), 12/8 → the largest, 1/2.
        let truncate = Narrow::new(3, Format::signed(0, 1), Rounding::Truncate);
        let nearest = Narrow::new(3, Format::signed(0, 1), Rounding::Nearest);
        assert_eq!([5, -5, 12, -12].map(|raw| truncate.apply(raw)), [1, -2, 1, -2]);
        assert_eq!([5, -5, -6, 12].map(|raw| nearest.apply(raw)), [1, -1, -1, 1]);
        // One fraction bit to three: exact.
        let finer = Narrow::new(1, Format::unsigned(1, 3), Rounding::Nearest);
        assert_eq!(finer.apply(3), 12);
        assert_eq!(finer.apply(4), 15);
    }

    #[test]
    fn error_vanishes_where_nothing_is_dropped() {
        assert_eq!(rounding_error(4, 4, Rounding::Truncate), 0.0);
        assert_eq!(rounding_error(5, 4, Rounding::Truncate), 0.0625);
        assert_eq!(rounding_error(5, 4, Rounding::Nearest), 0.03125);
    }
}

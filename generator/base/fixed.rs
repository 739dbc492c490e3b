//! Defines fixed-point formats and computes their rounding and overflow.
//!
//! A format is written `uI.F` or `sI.F`: I integer bits, F fraction bits and, in a signed format, one sign bit more. The *raw*
//! value is the integer that the bits denote. The value is `raw · 2⁻ᶠ`, and one ulp is `2⁻ᶠ`. For example, raw 3 in `u1.2` is the
//! value 0.75. Functions pass raw values as `i128`, and the bit pattern of a wire as `u64`.

use std::fmt;
use std::str::FromStr;

/// The largest number of bits of a net.
pub const MAX_WIDTH: u32 = 64;

/// The largest absolute number of fraction bits, up to which `f64` represents one ulp exactly.
pub const MAX_POINT: i32 = 1000;

/// A fixed-point format, `uI.F` or `sI.F`. The width is I + F bits, plus the sign bit of a signed format.
///
/// I and F may be negative as long as the width stays positive. For example, `u-3.15` is a 12-bit fraction whose three leading
/// bits are known to be zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Format {
    /// Whether the format is in two's complement, with a sign bit above the integer bits.
    pub signed: bool,
    /// The number of integer bits I, without the sign bit.
    pub int: i32,
    /// The number of fraction bits F.
    pub frac: i32,
}

/// Returns the integer nearest to `x`, ties upward: 2.5 gives 3, and −2.5 gives −2.
///
/// `(x + 0.5).floor()` would be wrong, because the sum is rounded. It would give 1 for 0.49999999999999994.
pub fn nearest(x: f64) -> f64 {
    let below = x.floor();
    if x - below >= 0.5 { below + 1.0 } else { below }
}

impl Format {
    /// Returns the format `uI.F`. For example, `unsigned(1, 20)` is `u1.20`.
    pub const fn unsigned(int: i32, frac: i32) -> Self {
        Self { signed: false, int, frac }
    }

    /// Returns the format `sI.F`. For example, `signed(1, 20)` is `s1.20`.
    pub const fn signed(int: i32, frac: i32) -> Self {
        Self { signed: true, int, frac }
    }

    /// The format of a flag, an enable or a select line.
    pub const BIT: Self = Self::unsigned(1, 0);

    /// Returns the smallest format with `frac` fraction bits for every raw value from `low` to `high`. For example, 0 to 255 with
    /// 8 fraction bits give `u0.8`, and −1 to 3 without fraction bits give `s2.0`.
    pub fn holding(low: i128, high: i128, frac: i32) -> Self {
        let magnitude = |raw: i128| 128 - if raw < 0 { !raw } else { raw }.leading_zeros() as i32;
        let signed = low < 0;
        let bits = magnitude(low).max(magnitude(high));
        // A net has at least one bit, even if it is always zero.
        let bits = if signed { bits } else { bits.max(1) };
        Self { signed, int: bits - frac, frac }
    }

    /// Returns the number of bits, with the sign bit. Panics for a negative number, which neither the DSL nor the configuration
    /// ever accepts.
    pub fn width(self) -> u32 {
        u32::try_from(self.int + self.frac + i32::from(self.signed)).expect("a positive width")
    }

    /// Returns the smallest raw value: 0 for an unsigned format, and −4 for `s2.0`. For a format that is too wide for any net,
    /// returns the smallest `i128`.
    pub fn min_raw(self) -> i128 {
        if self.signed { i128::MIN >> 128u32.saturating_sub(self.width()) } else { 0 }
    }

    /// Returns the largest raw value, such as 255 for `u0.8`. For a format that is too wide for any net, returns the largest
    /// `i128`.
    pub fn max_raw(self) -> i128 {
        i128::MAX >> 127u32.saturating_sub(self.width().saturating_sub(u32::from(self.signed)))
    }

    /// Returns the smallest and the largest raw value, such as (−4, 3) for `s2.0`.
    pub fn range(self) -> (i128, i128) {
        (self.min_raw(), self.max_raw())
    }

    /// Returns whether the format can represent `raw`. For example, `u2.0` can represent 3, but not 4 or −1.
    pub fn holds(self, raw: i128) -> bool {
        (self.min_raw()..=self.max_raw()).contains(&raw)
    }

    /// Returns the value `raw · 2⁻ᶠ`, exact if `raw` has at most 53 significant bits. For example, raw 3 in `u1.2` gives 0.75.
    pub fn to_f64(self, raw: i128) -> f64 {
        // Processors convert integers of 64 bits directly, with the same rounding.
        let value = i64::try_from(raw).map_or(raw as f64, |raw| raw as f64);
        value * exp2(-self.frac)
    }

    /// Returns the raw value nearest to `x`, ties upward, or `None` if this value is outside the format.
    ///
    /// For example, `u0.8` represents 0 to 255/256. 0.998 is rounded to 255/256. 0.999 gives `None`, since its nearest multiple
    /// of 1/256 is 1.0.
    pub fn nearest_raw(self, x: f64) -> Option<i128> {
        let raw = nearest(x * exp2(self.frac));
        let (low, high) = (self.min_raw() as f64, self.max_raw() as f64);
        (low..=high).contains(&raw).then(|| self.quantise(x))
    }

    /// Returns the raw value nearest to `x`, ties upward, saturated to the format. For example, in `u8.0` 2.5 gives 3, and 300.0
    /// gives 255. NaN gives the smallest raw value.
    pub fn quantise(self, x: f64) -> i128 {
        let scaled = nearest(x * exp2(self.frac));
        let (low, high) = (self.min_raw(), self.max_raw());
        if scaled.is_nan() || scaled <= low as f64 {
            low
        } else if scaled >= high as f64 {
            high
        } else {
            scaled as i128
        }
    }

    /// Returns the bit pattern of `raw`, wrapped to the width. For example, −1 in `s2.0` is `0b111`.
    pub fn bits(self, raw: i128) -> u64 {
        raw as u64 & mask(self.width())
    }

    /// Returns the raw value of a bit pattern, and ignores the bits above the width. For example, `0b111` is −1 in `s2.0`, and 7
    /// in `u3.0`.
    pub fn raw(self, bits: u64) -> i128 {
        let width = self.width();
        let bits = bits & mask(width);
        if self.signed && bits >> (width - 1) & 1 == 1 {
            i128::from(bits) - (1i128 << width)
        } else {
            i128::from(bits)
        }
    }

    /// Converts `raw`, which has `from_frac` fraction bits, to the format. For example, raw 6 with two fraction bits is 1.5. In
    /// `u4.0` this becomes 1 if truncated, and 2 if rounded to the nearest. A result outside the format saturates or wraps, as
    /// `overflow` states.
    pub fn narrow(self, raw: i128, from_frac: i32, rounding: Rounding, overflow: Overflow) -> i128 {
        let shifted = rounding.shift(raw, from_frac - self.frac);
        match overflow {
            Overflow::Saturate => shifted.clamp(self.min_raw(), self.max_raw()),
            Overflow::Wrap => self.raw(self.bits(shifted)),
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let sign = if self.signed { 's' } else { 'u' };
        write!(f, "{sign}{}.{}", self.int, self.frac)
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not a format; write u1.20 or s1.20");
        let (signed, rest) = match text.split_at_checked(1) {
            Some(("u", rest)) => (false, rest),
            Some(("s", rest)) => (true, rest),
            _ => return Err(wrong()),
        };
        let (int, frac) = rest.split_once('.').ok_or_else(wrong)?;
        let (int, frac): (i32, i32) =
            (int.parse().map_err(|_| wrong())?, frac.parse().map_err(|_| wrong())?);
        let width = i64::from(int) + i64::from(frac) + i64::from(signed);
        if !(1..=i64::from(MAX_WIDTH)).contains(&width) {
            return Err(format!("`{text}` has {width} bits; a format has 1 to {MAX_WIDTH} bits"));
        }
        Ok(Self { signed, int, frac })
    }
}

/// How a conversion treats fraction bits that it drops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// Drops the fraction bits, which rounds toward minus infinity and costs no logic. For example, 1.75 becomes 1, and −1.25
    /// becomes −2.
    Truncate,
    /// Rounds to the nearest value, ties upward, which costs an incrementer. For example, 1.5 becomes 2, and −1.5 becomes −1.
    Nearest,
}

impl Rounding {
    /// Divides `raw` by `2^places` and rounds. For example, −3 by one place gives −2 if truncated, and −1 if rounded to the
    /// nearest. A negative `places` multiplies exactly. Panics if a multiplication gives more than 127 bits and a sign.
    pub fn shift(self, raw: i128, places: i32) -> i128 {
        match (self, places) {
            (_, ..=0) => shifted_left(raw, -places).expect("a value of at most 128 bits"),
            // If `places` exceeds the number of bits, only the sign is left.
            (Self::Truncate, _) => raw >> places.min(127),
            (Self::Nearest, _) => ((raw >> (places - 1).min(127)) + 1) >> 1,
        }
    }
}

/// Returns `raw` times 2^`places`, or `None` if the product has more than 127 bits and a sign. `places` must not be negative.
pub fn shifted_left(raw: i128, places: i32) -> Option<i128> {
    if raw == 0 {
        return Some(0);
    }
    let shifted = raw.checked_shl(u32::try_from(places).ok()?)?;
    (shifted >> places == raw).then_some(shifted)
}

/// How a conversion treats a value that its format cannot represent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overflow {
    /// Drops the upper bits, which is arithmetic modulo 2^width. For example, 260 in `u8.0` becomes 4.
    Wrap,
    /// Takes the nearest value that the format can represent. For example, 260 in `u8.0` becomes 255.
    Saturate,
}

/// Returns `width` ones, such as `0b111` for 3. A width of 64 or more gives all ones.
pub const fn mask(width: u32) -> u64 {
    if width >= 64 { u64::MAX } else { (1 << width) - 1 }
}

/// Returns `2^exponent`, exact from −1074 to 1023. A smaller `exponent` gives 0, and a larger one gives infinity.
#[inline]
pub fn exp2(exponent: i32) -> f64 {
    match exponent {
        // A normal number: its fraction bits are all 0, so only the exponent must be set.
        -1022..=1023 => f64::from_bits(((exponent + 1023) as u64) << 52),
        _ => libm::ldexp(1.0, exponent),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_exact_to_the_smallest() {
        // 2^-1074 is the smallest positive number, 2^1023 the largest power.
        let mut power = f64::from_bits(1);
        for exponent in -1074..=1023 {
            assert_eq!(exp2(exponent), power, "2^{exponent}");
            power *= 2.0;
        }
        assert_eq!([exp2(-1075), exp2(1024)], [0.0, f64::INFINITY]);
    }

    #[test]
    fn formats_read_and_print() {
        for text in ["u1.20", "s0.16", "u-3.15", "u10.0", "s-1.8"] {
            assert_eq!(text.parse::<Format>().unwrap().to_string(), text);
        }
        for text in ["", "x1.2", "u1", "u0.0", "u60.20", "s-3.2", "ї1.2"] {
            assert!(text.parse::<Format>().is_err(), "{text}");
        }
    }

    #[test]
    fn smallest_format_holds_the_range() {
        assert_eq!(Format::holding(0, 1 << 20, 20), Format::unsigned(1, 20));
        assert_eq!(Format::holding(0, (1 << 20) - 1, 20), Format::unsigned(0, 20));
        assert_eq!(Format::holding(-(1 << 20), 5, 20), Format::signed(0, 20));
        assert_eq!(Format::holding(0, 0, 4).width(), 1);
        assert_eq!(Format::holding(-1, 0, 0).width(), 1);
    }

    #[test]
    fn formats_that_no_net_can_have_hold_what_there_is() {
        assert_eq!(Format::unsigned(127, 0).range(), (0, i128::MAX));
        assert_eq!(Format::signed(127, 0).range(), (i128::MIN, i128::MAX));
        assert_eq!(Format::unsigned(300, 0).range(), (0, i128::MAX));
        assert_eq!(Format::signed(300, 0).range(), (i128::MIN, i128::MAX));
        assert_eq!(Format::signed(126, 0).range(), (-(1 << 126), (1 << 126) - 1));
        assert_eq!(Format::signed(3, -4).max_raw(), 0);
        // 2^200 times smaller, no number is near 1 or below -1.
        assert_eq!([Rounding::Truncate, Rounding::Nearest].map(|it| it.shift(-5, 200)), [-1, 0]);
        assert_eq!(Rounding::Nearest.shift(i128::MAX, 127), 1);
        assert_eq!([i128::MIN, i128::MAX].map(|raw| Rounding::Nearest.shift(raw, 128)), [0, 0]);
    }

    #[test]
    fn narrowing_rounds_and_saturates() {
        let to = Format::signed(0, 2);
        assert_eq!(to.narrow(-5, 4, Rounding::Truncate, Overflow::Wrap), -2);
        assert_eq!(to.narrow(-5, 4, Rounding::Nearest, Overflow::Wrap), -1);
        assert_eq!(to.narrow(100, 4, Rounding::Truncate, Overflow::Saturate), 3);
        assert_eq!(to.narrow(-100, 4, Rounding::Truncate, Overflow::Saturate), -4);
        assert_eq!(to.narrow(20, 4, Rounding::Truncate, Overflow::Wrap), -3);
        assert_eq!(to.narrow(1, 0, Rounding::Truncate, Overflow::Wrap), -4);
    }

    #[test]
    fn bits_and_raw_are_inverse() {
        for format in [Format::signed(2, 3), Format::unsigned(2, 3), Format::signed(63, 0)] {
            for raw in [format.min_raw(), -1, 0, 1, format.max_raw()] {
                if format.holds(raw) {
                    assert_eq!(format.raw(format.bits(raw)), raw);
                }
            }
        }
    }
}

//! `schlick`: c / (n − n·c + c), c = cos γ (seed 002), by formula.

mod clock_model;
mod contract;

pub use clock_model::SchlickModel;
pub use contract::SchlickContract;

use super::keys;
use super::narrow::Narrow;
use crate::base::fixed::{Format, Rounding};
use crate::config::Config;

/// What a configuration of the device says.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// `cosine.fraction`: fraction bits of cos γ, C.
    pub cosine_fraction: u32,
    /// `cosine.signed`: cos γ may be negative, and is then taken as 0.
    pub cosine_signed: bool,
    /// `exponent.bits`: bits of n.
    pub exponent_bits: u32,
    /// `colour.bits`: bits of a colour operand and of a colour output, K.
    pub colour_bits: u32,
    /// `intensity.fraction`: bits of the quotient, Q.
    pub intensity_fraction: u32,
    /// `output.rounding`: of the colour outputs.
    pub output_rounding: Rounding,
    /// `domain.exponent_min` and `domain.exponent_max`: the contract's n.
    pub exponents: (i64, i64),
}

impl Default for Params {
    /// The least quotient with which 8-bit colours are proven below one unit is one of 9 bits; 10 leave
    /// a quarter of a unit.
    fn default() -> Self {
        Self {
            cosine_fraction: 20,
            cosine_signed: false,
            exponent_bits: 10,
            colour_bits: 8,
            intensity_fraction: 10,
            output_rounding: Rounding::Nearest,
            exponents: (1, 1000),
        }
    }
}

impl Params {
    /// What a configuration of the device `schlick` says.
    pub fn from_config(config: &Config) -> Self {
        Self {
            cosine_fraction: keys::bits(config, "cosine.fraction"),
            cosine_signed: config.flag("cosine.signed"),
            exponent_bits: keys::bits(config, "exponent.bits"),
            colour_bits: keys::bits(config, "colour.bits"),
            intensity_fraction: keys::bits(config, "intensity.fraction"),
            output_rounding: keys::rounding(config, "output.rounding"),
            exponents: keys::exponents(config),
        }
    }

    /// Whether the model's 64-bit arithmetic holds every intermediate value.
    ///
    /// # Errors
    /// Names the configuration key that is out of its range.
    pub fn check(&self) -> Result<(), String> {
        let in_range = |key: &str, value: u32, least: u32, most: u32| match value {
            v if (least..=most).contains(&v) => Ok(()),
            v => Err(format!("{key} is {v}; {least} to {most} are possible")),
        };
        in_range("cosine.fraction", self.cosine_fraction, 1, 30)?;
        in_range("exponent.bits", self.exponent_bits, 1, 16)?;
        in_range("colour.bits", self.colour_bits, 1, 16)?;
        in_range("intensity.fraction", self.intensity_fraction, 2, 30)
    }

    fn one(&self) -> i64 {
        1 << self.cosine_fraction
    }

    fn cosine_format(&self) -> Format {
        Format { signed: self.cosine_signed, int: 1, frac: self.cosine_fraction as i32 }
    }

    fn exponent_format(&self) -> Format {
        Format::unsigned(self.exponent_bits as i32, 0)
    }

    fn colour_format(&self) -> Format {
        Format::unsigned(self.colour_bits as i32, 0)
    }
}

/// The arithmetic of the device. Cosines, divisors and remainders are in ulps of the cosine.
#[derive(Clone, Debug)]
struct Arithmetic {
    one: i64,
    quotient_bits: u32,
    output: Narrow,
}

impl Arithmetic {
    fn new(params: &Params) -> Self {
        Self {
            one: params.one(),
            quotient_bits: params.intensity_fraction,
            output: Narrow::new(
                params.intensity_fraction,
                params.colour_format(),
                params.output_rounding,
            ),
        }
    }

    /// Word 1: `n − n·cos γ + cos γ`, and an ulp for a surface that faces away.
    #[inline]
    fn divisor(&self, cosine: i64, exponent: i64) -> i64 {
        exponent * self.one - exponent * cosine + cosine + i64::from(cosine == 0)
    }

    /// The first so many bits of the quotient, and the remainder that they leave. A quotient of 1.0 is
    /// the largest fraction.
    #[inline]
    fn divide(dividend: i64, divisor: i64, bits: u32) -> (i64, i64) {
        let quotient = ((dividend << bits) / divisor).min((1 << bits) - 1);
        (quotient, (dividend << bits) - quotient * divisor)
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.output.apply(f * colour)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden::{Contract, Model};

    /// C = 4, Q = 4: small enough to follow by hand.
    fn small() -> Params {
        Params {
            cosine_fraction: 4,
            exponent_bits: 4,
            colour_bits: 4,
            intensity_fraction: 4,
            exponents: (1, 15),
            ..Params::default()
        }
    }

    #[test]
    fn f_by_hand() {
        let contract = SchlickContract::from_params(&small()).unwrap();
        let f = |cosine, exponent| contract.f(&[cosine, exponent]);
        // 14 / (6·2 + 14) = 14/26: 224/26 = 8.6.
        assert_eq!(f(14, 6), 8);
        // 8 / (15·8 + 8) = 1/16, exactly; 7 / (15·9 + 7) is less.
        assert_eq!(f(8, 15), 1);
        assert_eq!(f(7, 15), 0);
        // n = 1 is c itself; c = 1.0 and n = 0 give the largest fraction.
        assert_eq!(f(11, 1), 11);
        assert_eq!([f(16, 9), f(16, 0), f(1, 0)], [15, 15, 15]);
        // Facing away, at n = 0 as well; beyond the operand's range.
        assert_eq!([f(0, 9), f(0, 0), f(0, 1)], [0, 0, 0]);
        assert_eq!(f(31, 9), 15);
    }

    /// One point followed clock by clock: words 0, 1, 2 four times, 3 and idle.
    #[test]
    fn a_point_clock_by_clock() {
        let mut model = SchlickModel::from_params(&small()).unwrap();
        let value = |model: &SchlickModel, name: &str| {
            model.values()[model.signals().iter().position(|it| it == name).unwrap()]
        };
        // c = 14/16, n = 6, red 15, written together with start.
        model.clock(&[1, 1, 14, 1, 6, 1, 15, 1, 0, 0, 0, 0]);
        let names = [
            "run",
            "word_address",
            "quotient_divisor",
            "quotient_remainder",
            "quotient",
            "quotient_remaining",
            "valid",
            "done",
        ];
        let mut seen = Vec::new();
        for _ in 0..7 {
            seen.push(names.map(|name| value(&model, name)));
            // Writes while busy change nothing.
            model.clock(&[1, 0, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0]);
        }
        let expected = [
            [1, 0, 0, 0, 0, 0, 0, 0],
            [1, 1, 0, 0, 0, 0, 0, 0],
            // Divisor 6·2 + 14.
            [1, 2, 26, 14, 0, 3, 0, 0],
            // 28 − 26 = 2, bit 1; 4, 8, 16: bits 0.
            [1, 2, 26, 2, 1, 2, 0, 0],
            [1, 2, 26, 4, 2, 1, 0, 0],
            [1, 2, 26, 8, 4, 0, 0, 0],
            // The counter has gone round.
            [1, 3, 26, 16, 8, 3, 1, 1],
        ];
        assert_eq!(seen, expected);
        assert_eq!(
            ["run", "word_address", "valid", "done", "quotient"].map(|name| value(&model, name)),
            [0, 0, 0, 0, 8]
        );
        // red: 15·8/16 = 7.5, to the nearest, upward.
        assert_eq!(value(&model, "red_out"), 8);
        assert_eq!(value(&model, "cos_gamma_reg"), 14);
    }

    #[test]
    fn the_default_is_proven() {
        let bound = |fraction| {
            let params = Params { intensity_fraction: fraction, ..Params::default() };
            SchlickContract::from_params(&params).unwrap().bound()
        };
        assert_eq!(bound(10).units, 255.0 / 1024.0 + 0.5);
        assert_eq!(Params::default().intensity_fraction, 10);
        // 9 bits: 255/512 + 1/2 is just below 1; 8 are not enough.
        assert!(bound(9).units < 1.0 && bound(8).units > 1.0);
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let params = Params { intensity_fraction: 1, ..small() };
        let refused = SchlickContract::from_params(&params).unwrap_err();
        assert!(refused.contains("intensity.fraction"), "{refused}");
    }
}

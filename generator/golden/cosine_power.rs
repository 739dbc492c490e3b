//! `cosine-power`: the paper's W(n, γ) = (n/m·(cos γ − 1) + 1)^m (seed 002), by formula.

mod clock_model;
mod contract;

pub use clock_model::CosinePowerModel;
pub use contract::CosinePowerContract;

use super::keys;
use super::narrow::Narrow;
use crate::base::fixed::{Format, Rounding};
use crate::config::Config;

/// What a configuration of the device says.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// `power`: m, a power of two, 2 … 16.
    pub power: u32,
    /// `cosine.fraction`: fraction bits of cos γ, C.
    pub cosine_fraction: u32,
    /// `cosine.signed`: cos γ may be negative, and is then taken as 0.
    pub cosine_signed: bool,
    /// `exponent.bits`: bits of n.
    pub exponent_bits: u32,
    /// `colour.bits`: bits of a colour operand and of a colour output, K.
    pub colour_bits: u32,
    /// `intensity.fraction`: fraction bits of the accumulator, F.
    pub intensity_fraction: u32,
    /// `intensity.rounding`: of everything that the accumulator takes.
    pub intensity_rounding: Rounding,
    /// `output.rounding`: of the colour outputs.
    pub output_rounding: Rounding,
    /// `domain.exponent_min` and `domain.exponent_max`: the contract's n.
    pub exponents: (i64, i64),
}

impl Default for Params {
    /// Proven below one unit with 16-bit squarings, which are one DSP block everywhere.
    fn default() -> Self {
        Self {
            power: 16,
            cosine_fraction: 20,
            cosine_signed: false,
            exponent_bits: 10,
            colour_bits: 8,
            intensity_fraction: 16,
            intensity_rounding: Rounding::Truncate,
            output_rounding: Rounding::Nearest,
            exponents: (1, 1000),
        }
    }
}

impl Params {
    /// What a configuration of the device `cosine-power` says.
    pub fn from_config(config: &Config) -> Self {
        Self {
            power: keys::bits(config, "power"),
            cosine_fraction: keys::bits(config, "cosine.fraction"),
            cosine_signed: config.flag("cosine.signed"),
            exponent_bits: keys::bits(config, "exponent.bits"),
            colour_bits: keys::bits(config, "colour.bits"),
            intensity_fraction: keys::bits(config, "intensity.fraction"),
            intensity_rounding: keys::rounding(config, "intensity.rounding"),
            output_rounding: keys::rounding(config, "output.rounding"),
            exponents: keys::exponents(config),
        }
    }

    /// Whether the model's 64-bit arithmetic holds every intermediate value.
    ///
    /// # Errors
    /// Names the configuration key that is out of its range.
    pub fn check(&self) -> Result<(), String> {
        let in_range = |key: &str, value: u32, most: u32| match value {
            v if (1..=most).contains(&v) => Ok(()),
            v => Err(format!("{key} is {v}; 1 to {most} are possible")),
        };
        if !matches!(self.power, 2 | 4 | 8 | 16) {
            return Err(format!("power is {}; 2, 4, 8 or 16 are possible", self.power));
        }
        in_range("cosine.fraction", self.cosine_fraction, 30)?;
        in_range("exponent.bits", self.exponent_bits, 16)?;
        in_range("colour.bits", self.colour_bits, 16)?;
        in_range("intensity.fraction", self.intensity_fraction, 30)
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

/// The arithmetic of the device, one operation a method.
#[derive(Clone, Debug)]
struct Arithmetic {
    one: i64,
    /// 1.0 − ulp of the accumulator.
    largest: i64,
    scaled: Narrow,
    square: Narrow,
    output: Narrow,
    squarings: u32,
}

impl Arithmetic {
    fn new(params: &Params) -> Self {
        let f = params.intensity_fraction;
        let accumulator = Format::unsigned(0, f as i32);
        let squarings = params.power.ilog2();
        let narrow = |frac| Narrow::new(frac, accumulator, params.intensity_rounding);
        Self {
            one: params.one(),
            largest: (1 << f) - 1,
            // n/m has log₂ m fraction bits: the same integer n, read elsewhere.
            scaled: narrow(params.cosine_fraction + squarings),
            square: narrow(2 * f),
            output: Narrow::new(f, params.colour_format(), params.output_rounding),
            squarings,
        }
    }

    /// Word 1: `n/m·(1 − cos γ)`, saturated.
    #[inline]
    fn scaled(&self, cosine: i64, exponent: i64) -> i64 {
        self.scaled.apply((self.one - cosine) * exponent)
    }

    /// The inverse of the accumulator, `1.0 − ulp − accumulator`; 0 for a surface that faces away.
    #[inline]
    fn base(&self, cosine: i64, accumulator: i64) -> i64 {
        if cosine == 0 { 0 } else { self.largest - accumulator }
    }

    #[inline]
    fn square(&self, x: i64) -> i64 {
        self.square.apply(x * x)
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

    /// C = 4, F = 4, m = 4, small enough to follow by hand.
    fn small(power: u32) -> Params {
        Params {
            power,
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
        let f = |power, cosine, exponent| {
            CosinePowerContract::from_params(&small(power)).unwrap().f(&[cosine, exponent])
        };
        // c = 15/16, n = 6, m = 4: t = 1/16·6/4 = 1.5/16 → 1/16; base 15 − 1 = 14; 14² = 196/256 →
        // 12/16; 144/256 → 9/16.
        assert_eq!(f(4, 15, 6), 9);
        // One squaring with m = 2: t = 3/16, base 12, 144/256 → 9/16.
        assert_eq!(f(2, 15, 6), 9);
        // m = 16, n = 6: t = 6/256 → 0; 15 → 225/256 → 14 → 12 → 9 → 5.
        assert_eq!(f(16, 15, 6), 5);
        // Beyond the zero, at 1.0, at 0 and beyond the operand's range.
        assert_eq!(f(4, 8, 15), 0);
        assert_eq!(f(2, 16, 15), 14);
        assert_eq!(f(2, 31, 15), 14);
        assert_eq!(f(2, 0, 1), 0);
    }

    /// One point with m = 8 followed clock by clock: words 0, 1, 2, 3, 3, 4 and idle.
    #[test]
    fn a_point_clock_by_clock() {
        let mut model = CosinePowerModel::from_params(&small(8)).unwrap();
        let value = |model: &CosinePowerModel, name: &str| {
            model.values()[model.signals().iter().position(|it| it == name).unwrap()]
        };
        // c = 14/16, n = 12, red 15, written together with start: t = 2/16·12/8 = 3/16; base 12.
        model.clock(&[1, 1, 14, 1, 12, 1, 15, 1, 0, 0, 0, 0]);
        let mut seen = Vec::new();
        for _ in 0..6 {
            seen.push(
                ["run", "word_address", "accumulator", "remaining", "valid", "done"]
                    .map(|name| value(&model, name)),
            );
            // Writes while busy change nothing.
            model.clock(&[1, 0, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0]);
        }
        let expected = [
            [1, 0, 0, 0, 0, 0],
            [1, 1, 0, 0, 0, 0],
            [1, 2, 3, 2, 0, 0],
            // 144/256 → 9, 81/256 → 5, 25/256 → 1.
            [1, 3, 9, 2, 0, 0],
            [1, 3, 5, 1, 0, 0],
            [1, 4, 1, 0, 1, 1],
        ];
        assert_eq!(seen, expected);
        assert_eq!(
            ["run", "word_address", "valid", "done", "accumulator"].map(|name| value(&model, name)),
            [0, 0, 0, 0, 1]
        );
        // red: 15/16 → 1, to the nearest.
        assert_eq!(value(&model, "red_out"), 1);
        assert_eq!(value(&model, "cos_gamma_reg"), 14);
    }

    #[test]
    fn the_default_is_proven() {
        let bound = CosinePowerContract::from_params(&Params::default()).unwrap().bound();
        // (16 + 15) ulps of 2⁻¹⁶ times 255, and half a unit.
        assert_eq!(bound.units, 31.0 * 255.0 / 65536.0 + 0.5);
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let refused = |params: Params| CosinePowerContract::from_params(&params).unwrap_err();
        assert!(refused(Params { power: 3, ..small(4) }).contains("power"));
        assert!(
            refused(Params { intensity_fraction: 0, ..small(4) }).contains("intensity.fraction")
        );
    }
}

//! `threshold`: `(n/2·(cos γ − 1) + 1)²` where it reaches ROM(n), otherwise 0 (UA 30041), by formula.

mod clock_model;
mod contract;

pub use clock_model::ThresholdModel;
pub use contract::ThresholdContract;

use super::keys;
use super::narrow::Narrow;
use crate::base::fixed::{Format, Rounding};
use crate::config::Config;

/// What a configuration of the device says.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// `cosine.fraction`: fraction bits of cos γ.
    pub cosine_fraction: u32,
    /// `cosine.signed`: cos γ may be negative, and is then taken as 0.
    pub cosine_signed: bool,
    /// `exponent.bits`: bits of n.
    pub exponent_bits: u32,
    /// `colour.bits`: bits of a colour operand and of a colour output.
    pub colour_bits: u32,
    /// `intensity.fraction`: fraction bits of the base, of its square and of the levels.
    pub intensity_fraction: u32,
    /// `intensity.rounding`: of the base and of its square.
    pub intensity_rounding: Rounding,
    /// `output.rounding`: of the colour outputs.
    pub output_rounding: Rounding,
    /// `visibility.levels`: hundredths of an output unit, an octave of n each, at least one.
    pub levels: Vec<i64>,
    /// `domain.exponent_min` and `domain.exponent_max`: the contract's n.
    pub exponents: (i64, i64),
}

impl Default for Params {
    /// Half an output unit for every n: what would be rounded to 0 is 0.
    fn default() -> Self {
        Self {
            cosine_fraction: 20,
            cosine_signed: false,
            exponent_bits: 10,
            colour_bits: 8,
            intensity_fraction: 16,
            intensity_rounding: Rounding::Truncate,
            output_rounding: Rounding::Nearest,
            levels: vec![50],
            exponents: (1, 1000),
        }
    }
}

impl Params {
    /// What a configuration of the device `threshold` says.
    pub fn from_config(config: &Config) -> Self {
        Self {
            cosine_fraction: keys::bits(config, "cosine.fraction"),
            cosine_signed: config.flag("cosine.signed"),
            exponent_bits: keys::bits(config, "exponent.bits"),
            colour_bits: keys::bits(config, "colour.bits"),
            intensity_fraction: keys::bits(config, "intensity.fraction"),
            intensity_rounding: keys::rounding(config, "intensity.rounding"),
            output_rounding: keys::rounding(config, "output.rounding"),
            levels: config.integers("visibility.levels").to_vec(),
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
        in_range("cosine.fraction", self.cosine_fraction, 30)?;
        in_range("exponent.bits", self.exponent_bits, 16)?;
        in_range("colour.bits", self.colour_bits, 16)?;
        in_range("intensity.fraction", self.intensity_fraction, 30)?;
        let most = 100 * ((1 << self.colour_bits) - 1);
        if self.levels.is_empty() || self.levels.iter().any(|level| !(0..most).contains(level)) {
            return Err(format!(
                "visibility.levels is {:?}; levels from 0 to {} are possible, at least one",
                self.levels,
                most - 1
            ));
        }
        Ok(())
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

    /// The least word of f that is shown, an entry an octave of n: `levels / 100` units, rounded up to a
    /// word. There is none above 1.0 − ulp.
    fn thresholds(&self) -> Vec<i64> {
        // 100 · largest · word ≥ level · 2^F, for the least word; less than 2^30 · 2^24.
        let unit = 100 * ((1 << self.colour_bits) - 1);
        let word = |level: i64| {
            let wanted = level << self.intensity_fraction;
            wanted / unit + i64::from(wanted % unit != 0)
        };
        let largest = (1 << self.intensity_fraction) - 1;
        self.levels.iter().map(|&level| word(level).min(largest)).collect()
    }
}

/// The arithmetic of the device, one operation a method.
#[derive(Clone, Debug)]
struct Arithmetic {
    one: i64,
    /// 1.0 as a base.
    base_one: i64,
    scaled: Narrow,
    square: Narrow,
    output: Narrow,
    thresholds: Vec<i64>,
}

impl Arithmetic {
    fn new(params: &Params) -> Self {
        let f = params.intensity_fraction;
        let rounding = params.intensity_rounding;
        Self {
            one: params.one(),
            base_one: 1 << f,
            // n/2 has one fraction bit.
            scaled: Narrow::new(params.cosine_fraction + 1, Format::signed(0, f as i32), rounding),
            square: Narrow::new(2 * f, Format::unsigned(0, f as i32), rounding),
            output: Narrow::new(f, params.colour_format(), params.output_rounding),
            thresholds: params.thresholds(),
        }
    }

    /// Word 1: `n/2·(cos γ − 1)`, not below −1.0.
    #[inline]
    fn scaled(&self, cosine: i64, exponent: i64) -> i64 {
        self.scaled.apply((cosine - self.one) * exponent)
    }

    /// ROM(n).
    #[inline]
    fn threshold(&self, exponent: i64) -> i64 {
        let octave = exponent.max(1).ilog2() as usize;
        self.thresholds[octave.min(self.thresholds.len() - 1)]
    }

    /// Word 2: the square of the base, if it is shown.
    #[inline]
    fn gated(&self, cosine: i64, exponent: i64, scaled: i64) -> i64 {
        let base = scaled + self.base_one;
        let square = self.square.apply(base * base);
        if cosine == 0 || square < self.threshold(exponent) { 0 } else { square }
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.output.apply(f * colour)
    }
}

#[cfg(test)]
mod tests;

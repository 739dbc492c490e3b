//! `quadratic`: `c + a(n)·(c² − c)`, not below 0 (UA 20998), by formula.

mod clock_model;
pub mod coefficient;
mod contract;

pub use clock_model::QuadraticModel;
pub use contract::QuadraticContract;

use super::keys;
use super::narrow::Narrow;
use crate::base::fixed::{Format, Rounding};
use crate::config::Config;

/// What ROM(n) holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// n − 1.
    Taylor,
    /// The coefficient of the least largest error, with so many fraction bits.
    Minimax { fraction: u32 },
}

/// What a configuration of the device says.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// `coefficient.scheme`, and `coefficient.fraction` where it applies.
    pub scheme: Scheme,
    /// `cosine.fraction`: fraction bits of c = cos γ.
    pub cosine_fraction: u32,
    /// `cosine.signed`: cos γ may be negative, and is then taken as 0.
    pub cosine_signed: bool,
    /// `exponent.bits`: bits of n.
    pub exponent_bits: u32,
    /// `colour.bits`: bits of a colour operand and of a colour output.
    pub colour_bits: u32,
    /// `difference.fraction`: fraction bits of c² − c.
    pub difference_fraction: u32,
    /// `difference.rounding`: of c² − c.
    pub difference_rounding: Rounding,
    /// `intensity.fraction`: fraction bits of f.
    pub intensity_fraction: u32,
    /// `intensity.rounding`: of f.
    pub intensity_rounding: Rounding,
    /// `output.rounding`: of the colour outputs.
    pub output_rounding: Rounding,
    /// `domain.exponent_min` and `domain.exponent_max`: the contract's n.
    pub exponents: (i64, i64),
}

impl Default for Params {
    /// Proven below one unit with 18 bits of c² − c.
    fn default() -> Self {
        Self {
            scheme: Scheme::Minimax { fraction: 8 },
            cosine_fraction: 20,
            cosine_signed: false,
            exponent_bits: 10,
            colour_bits: 8,
            difference_fraction: 19,
            difference_rounding: Rounding::Truncate,
            intensity_fraction: 16,
            intensity_rounding: Rounding::Truncate,
            output_rounding: Rounding::Nearest,
            exponents: (1, 1000),
        }
    }
}

impl Params {
    /// What a configuration of the device `quadratic` says.
    pub fn from_config(config: &Config) -> Self {
        Self {
            scheme: match config.choice("coefficient.scheme") {
                "minimax" => {
                    Scheme::Minimax { fraction: keys::bits(config, "coefficient.fraction") }
                }
                _ => Scheme::Taylor,
            },
            cosine_fraction: keys::bits(config, "cosine.fraction"),
            cosine_signed: config.flag("cosine.signed"),
            exponent_bits: keys::bits(config, "exponent.bits"),
            colour_bits: keys::bits(config, "colour.bits"),
            difference_fraction: keys::bits(config, "difference.fraction"),
            difference_rounding: keys::rounding(config, "difference.rounding"),
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
        in_range("cosine.fraction", self.cosine_fraction, 28)?;
        in_range("exponent.bits", self.exponent_bits, 14)?;
        in_range("colour.bits", self.colour_bits, 16)?;
        in_range(
            "difference.fraction",
            self.difference_fraction,
            30.min(2 * self.cosine_fraction),
        )?;
        in_range("intensity.fraction", self.intensity_fraction, 30)?;
        // A fraction of 0 is possible too.
        in_range("coefficient.fraction", self.coefficient_fraction() + 1, 15)
    }

    fn coefficient_fraction(&self) -> u32 {
        match self.scheme {
            Scheme::Taylor => 0,
            Scheme::Minimax { fraction } => fraction,
        }
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

    /// c² − c: from −0.25 to 0.
    fn difference_format(&self) -> Format {
        Format::signed(-2, self.difference_fraction as i32)
    }
}

/// The arithmetic of the device, one operation a method.
#[derive(Clone, Debug)]
struct Arithmetic {
    one: i64,
    cosine_fraction: u32,
    difference: Narrow,
    /// ROM(n), unrounded and as words.
    exact: Vec<f64>,
    words: Vec<i64>,
    /// Zeros to append to c and to the product, so that their points agree.
    pads: (u32, u32),
    sum: Narrow,
    output: Narrow,
}

impl Arithmetic {
    fn new(params: &Params) -> Self {
        let (cosine, f) = (params.cosine_fraction, params.intensity_fraction);
        let scale = f64::from(1u32 << params.coefficient_fraction());
        let exact = coefficient::table(params.scheme, 1 << params.exponent_bits);
        let product = params.difference_fraction + params.coefficient_fraction();
        let point = product.max(cosine);
        Self {
            one: params.one(),
            cosine_fraction: cosine,
            difference: Narrow::new(
                2 * cosine,
                params.difference_format(),
                params.difference_rounding,
            ),
            words: exact.iter().map(|a| (a * scale + 0.5).floor() as i64).collect(),
            exact,
            pads: (point - cosine, point - product),
            sum: Narrow::new(point, Format::unsigned(0, f as i32), params.intensity_rounding),
            output: Narrow::new(f, params.colour_format(), params.output_rounding),
        }
    }

    /// Word 1: `c² − c`.
    #[inline]
    fn difference(&self, cosine: i64) -> i64 {
        self.difference.apply(cosine * cosine - (cosine << self.cosine_fraction))
    }

    /// Word 2: `c + a(n)·(c² − c)`, limited to a fraction.
    #[inline]
    fn intensity(&self, cosine: i64, exponent: i64, difference: i64) -> i64 {
        let product = difference * self.words[exponent as usize];
        self.sum.apply((cosine << self.pads.0) + (product << self.pads.1))
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.output.apply(f * colour)
    }
}

#[cfg(test)]
mod tests;

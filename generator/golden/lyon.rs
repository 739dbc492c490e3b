//! `lyon`: `max(0, 1 − β·D²)^m` from a difference vector (US 5 739 820), by formula.

mod clock_model;
mod contract;

pub use clock_model::LyonModel;
pub use contract::LyonContract;

use super::keys;
use super::narrow::Narrow;
use crate::base::fixed::{Format, Rounding};
use crate::config::Config;

/// How β is had.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// `2^shift/(2·m)`; the operand is `shift`.
    Shift,
    /// `n/(2·m)`; the operand is `exponent`.
    Multiplier,
}

/// What a configuration of the device says.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// `power`: m, a power of two, 2 … 16.
    pub power: u32,
    /// `scale`.
    pub scale: Scale,
    /// `vector.fraction`: fraction bits of dx, dy and dz.
    pub vector_fraction: u32,
    /// `distance.fraction`: fraction bits of D².
    pub distance_fraction: u32,
    /// `distance.rounding`: of D².
    pub distance_rounding: Rounding,
    /// `exponent.bits`: bits of n.
    pub exponent_bits: u32,
    /// `colour.bits`: bits of a colour operand and of a colour output.
    pub colour_bits: u32,
    /// `intensity.fraction`: fraction bits of the accumulator.
    pub intensity_fraction: u32,
    /// `intensity.rounding`: of β·D² and of the squares.
    pub intensity_rounding: Rounding,
    /// `output.rounding`: of the colour outputs.
    pub output_rounding: Rounding,
    /// `domain.exponent_min` and `domain.exponent_max`: the contract's n.
    pub exponents: (i64, i64),
}

impl Default for Params {
    /// Proven below one unit with 18-bit components and 16-bit squarings.
    fn default() -> Self {
        Self {
            power: 16,
            scale: Scale::Shift,
            vector_fraction: 16,
            distance_fraction: 20,
            distance_rounding: Rounding::Truncate,
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
    /// What a configuration of the device `lyon` says.
    pub fn from_config(config: &Config) -> Self {
        Self {
            power: keys::bits(config, "power"),
            scale: match config.choice("scale") {
                "shift" => Scale::Shift,
                _ => Scale::Multiplier,
            },
            vector_fraction: keys::bits(config, "vector.fraction"),
            distance_fraction: keys::bits(config, "distance.fraction"),
            distance_rounding: keys::rounding(config, "distance.rounding"),
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
        in_range("vector.fraction", self.vector_fraction, 24)?;
        in_range("distance.fraction", self.distance_fraction, 30.min(2 * self.vector_fraction))?;
        in_range("exponent.bits", self.exponent_bits, 14)?;
        in_range("colour.bits", self.colour_bits, 16)?;
        in_range("intensity.fraction", self.intensity_fraction, 30)
    }

    /// s, the number of squarings.
    fn squarings(&self) -> u32 {
        self.power.ilog2()
    }

    fn vector_format(&self) -> Format {
        Format::signed(1, self.vector_fraction as i32)
    }

    /// Of n, or of log₂ n, which is `exponent.bits` at most.
    fn scale_format(&self) -> Format {
        match self.scale {
            Scale::Shift => Format::unsigned(self.exponent_bits.ilog2() as i32 + 1, 0),
            Scale::Multiplier => Format::unsigned(self.exponent_bits as i32, 0),
        }
    }

    fn colour_format(&self) -> Format {
        Format::unsigned(self.colour_bits as i32, 0)
    }

    /// The operand `shift` or `exponent` for an exponent: log₂ n to the nearest, or n itself.
    pub fn scale_operand(&self, n: i64) -> i64 {
        match self.scale {
            Scale::Multiplier => n,
            Scale::Shift => {
                let n = n.max(1);
                let below = n.ilog2();
                // Above the geometric mean of two powers of two, the upper one is nearer.
                i64::from(below) + i64::from(n * n > 2 << (2 * below))
            }
        }
    }

    /// The exponent that an operand `shift` or `exponent` stands for.
    fn exponent(&self, operand: i64) -> i64 {
        match self.scale {
            Scale::Shift => 1 << operand,
            Scale::Multiplier => operand,
        }
    }
}

/// The arithmetic of the device, one operation a method.
#[derive(Clone, Debug)]
struct Arithmetic {
    scale: Scale,
    squarings: u32,
    /// 1.0 in the point of f.
    one: i64,
    /// The largest word of the shift register.
    shifted_most: i64,
    distance: Narrow,
    scaled: Narrow,
    square: Narrow,
    output: Narrow,
}

impl Arithmetic {
    fn new(params: &Params) -> Self {
        let (f, squarings) = (params.intensity_fraction, params.squarings());
        let distance = params.distance_fraction;
        let rounding = params.intensity_rounding;
        // n/2^(s+1) is the integer n with s + 1 fraction bits; the shift register has one more.
        let beta_fraction = match params.scale {
            Scale::Multiplier => squarings + 1,
            Scale::Shift => squarings + 2,
        };
        Self {
            scale: params.scale,
            squarings,
            one: 1 << f,
            shifted_most: (2 << (distance + squarings + 2)) - 1,
            distance: Narrow::new(
                2 * params.vector_fraction,
                Format::unsigned(4, distance as i32),
                params.distance_rounding,
            ),
            scaled: Narrow::new(distance + beta_fraction, Format::unsigned(1, f as i32), rounding),
            square: Narrow::new(2 * f, Format::unsigned(0, f as i32), rounding),
            output: Narrow::new(f, params.colour_format(), params.output_rounding),
        }
    }

    /// Word 1: D² as the register takes it.
    #[inline]
    fn distance(&self, vector: [i64; 3]) -> i64 {
        let [x, y, z] = vector;
        self.distance.apply(x * x + y * y + z * z)
    }

    /// One place of the shift register.
    #[inline]
    fn shifted(&self, word: i64) -> i64 {
        (2 * word).min(self.shifted_most)
    }

    /// Word 2 with the multiplier, and what becomes of the shift register's word: β·D², saturated below 2.0.
    #[inline]
    fn scaled(&self, product: i64) -> i64 {
        self.scaled.apply(product)
    }

    /// β·D² from the word of D² and the operand `shift` or `exponent`.
    #[inline]
    fn beta_distance(&self, distance: i64, operand: i64) -> i64 {
        self.scaled(match self.scale {
            Scale::Multiplier => distance * operand,
            Scale::Shift => (distance << (operand + 1)).min(self.shifted_most),
        })
    }

    /// `1.0 − ulp − β·D²`, or 0 where β·D² is not below 1.0.
    #[inline]
    fn base(&self, scaled: i64) -> i64 {
        (self.one - 1 - scaled).max(0)
    }

    #[inline]
    fn square(&self, x: i64) -> i64 {
        self.square.apply(x * x)
    }

    /// f from the word of D².
    #[inline]
    fn f(&self, distance: i64, operand: i64) -> i64 {
        let base = self.base(self.beta_distance(distance, operand));
        if base == 0 {
            return 0;
        }
        (0..self.squarings).fold(base, |power, _| self.square(power))
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.output.apply(f * colour)
    }
}

#[cfg(test)]
mod tests;

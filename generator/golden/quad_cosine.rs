//! `quad-cosine`: cosᵏ(√(n/k)·δ) along a scan line (seed 000, the claimed device), by formula.

mod clock_model;
mod contract;
#[cfg(test)]
mod tests;

pub use clock_model::QuadCosineModel;
pub use contract::QuadCosineContract;

use super::keys;
use super::line::{CosineTable, magnitude};
use super::narrow::Narrow;
use crate::base::fixed::{Format, Rounding};
use crate::config::Config;

/// What a configuration of the device says.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// `angle.fraction`: fraction bits of an angle in right angles, F.
    pub angle_fraction: u32,
    /// `angle.multiplied`: those that multiplier 11 takes, A.
    pub angle_multiplied: u32,
    /// `root.fraction`: fraction bits of ROM 9, G.
    pub root_fraction: u32,
    /// `table.address`: log₂ of the steps of a table of ROM 12, T.
    pub table_address: u32,
    /// `length.bits`: bits of counter 5.
    pub length_bits: u32,
    /// `exponent.bits`: bits of n.
    pub exponent_bits: u32,
    /// `colour.bits`: bits of the amplitude and of the output, K.
    pub colour_bits: u32,
    /// `intensity.fraction`: fraction bits of ROM 12.
    pub intensity_fraction: u32,
    /// `output.rounding`: of the output.
    pub output_rounding: Rounding,
    /// `domain.exponent_min` and `domain.exponent_max`: the contract's n.
    pub exponents: (i64, i64),
}

impl Default for Params {
    /// Proven below one unit with 80 kbit of ROM 12, and within two over the longest line.
    fn default() -> Self {
        Self {
            angle_fraction: 26,
            angle_multiplied: 17,
            root_fraction: 14,
            table_address: 11,
            length_bits: 12,
            exponent_bits: 10,
            colour_bits: 8,
            intensity_fraction: 10,
            output_rounding: Rounding::Nearest,
            exponents: (1, 1000),
        }
    }
}

impl Params {
    /// What a configuration of the device `quad-cosine` says.
    pub fn from_config(config: &Config) -> Self {
        Self {
            angle_fraction: keys::bits(config, "angle.fraction"),
            angle_multiplied: keys::bits(config, "angle.multiplied"),
            root_fraction: keys::bits(config, "root.fraction"),
            table_address: keys::bits(config, "table.address"),
            length_bits: keys::bits(config, "length.bits"),
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
        in_range("angle.fraction", self.angle_fraction, 1, 30)?;
        in_range("angle.multiplied", self.angle_multiplied, 1, self.angle_fraction)?;
        in_range("root.fraction", self.root_fraction, 1, 24)?;
        let product = self.angle_multiplied + self.root_fraction;
        in_range("table.address", self.table_address, 1, product.min(20))?;
        in_range("length.bits", self.length_bits, 1, 16)?;
        in_range("exponent.bits", self.exponent_bits, 1, 16)?;
        in_range("colour.bits", self.colour_bits, 1, 16)?;
        in_range("intensity.fraction", self.intensity_fraction, 1, 30)
    }

    fn angle_format(&self) -> Format {
        Format::signed(1, self.angle_fraction as i32)
    }

    fn exponent_format(&self) -> Format {
        Format::unsigned(self.exponent_bits as i32, 0)
    }

    fn colour_format(&self) -> Format {
        Format::unsigned(self.colour_bits as i32, 0)
    }
}

/// The power that serves n, as a number of a table: the seed's ranges.
#[inline]
fn range_of(n: i64) -> usize {
    if n == 1 {
        0
    } else if n == 2 {
        1
    } else if (3..=6).contains(&n) {
        2
    } else {
        3
    }
}

/// The power k of each range.
const POWERS: [i64; 4] = [1, 2, 4, 16];

/// The arithmetic of the device, one operation a method.
#[derive(Clone, Debug)]
struct Arithmetic {
    params: Params,
    /// ROM 9, a word for each n.
    roots: Vec<i64>,
    /// ROM 12, a table for each range of n.
    tables: [CosineTable; 4],
    output: Narrow,
}

impl Arithmetic {
    fn new(params: &Params) -> Self {
        let f = params.intensity_fraction;
        Self {
            roots: (0..1 << params.exponent_bits)
                .map(|n| root(n, POWERS[range_of(n)], params.root_fraction))
                .collect(),
            tables: POWERS.map(|power| CosineTable::new(power as u32, params.table_address, f)),
            output: Narrow::new(f, params.colour_format(), params.output_rounding),
            params: params.clone(),
        }
    }

    /// What multiplier 11 takes of register 8; `None` where the surface faces away.
    #[inline]
    fn magnitude(&self, angle: i64) -> Option<i64> {
        let params = &self.params;
        magnitude(angle, params.angle_fraction, params.angle_multiplied)
    }

    /// The word of ROM 12 for n, the magnitude, and ROM 9's word.
    #[inline]
    fn cosine(&self, n: i64, magnitude: Option<i64>, root: i64) -> i64 {
        let params = &self.params;
        let fraction = params.angle_multiplied + params.root_fraction;
        let scaled = magnitude.map_or(i64::MAX, |magnitude| magnitude * root);
        let address = CosineTable::address(scaled, fraction, params.table_address);
        self.tables[range_of(n)].words[address]
    }

    #[inline]
    fn root(&self, n: i64) -> i64 {
        self.roots[n as usize]
    }

    #[inline]
    fn colour(&self, f: i64, amplitude: i64) -> i64 {
        self.output.apply(f * amplitude)
    }
}

/// `√(n/k)` rounded to the nearest word, by integers: the r with (r − ½)² ≤ n·2^2G/k < (r + ½)².
fn root(n: i64, k: i64, fraction: u32) -> i64 {
    let square = n << (2 * fraction);
    let floor = (square / k).isqrt();
    // (2·floor + 1)²·k ≤ 4·square.
    let middle = i128::from(2 * floor + 1);
    floor + i64::from(middle * middle * i128::from(k) <= 4 * i128::from(square))
}

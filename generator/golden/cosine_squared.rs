//! `cosine-squared`: cos²(a·δ) along a scan line (seed 000, the prototype), by formula.

mod clock_model;
mod contract;

pub use clock_model::CosineSquaredModel;
pub use contract::CosineSquaredContract;

use super::keys;
use super::line::{CosineTable, magnitude};
use super::narrow::Narrow;
use crate::base::fixed::{Format, Rounding};
use crate::config::Config;

/// What a configuration of the device says.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// `angle.integer`: integer bits of a stretched angle in right angles.
    pub angle_integer: u32,
    /// `angle.fraction`: its fraction bits, F.
    pub angle_fraction: u32,
    /// `table.address`: log₂ of the steps of ROM 12, T.
    pub table_address: u32,
    /// `length.bits`: bits of counter 5.
    pub length_bits: u32,
    /// `colour.bits`: bits of the amplitude and of the output, K.
    pub colour_bits: u32,
    /// `intensity.fraction`: fraction bits of ROM 12.
    pub intensity_fraction: u32,
    /// `output.rounding`: of the output.
    pub output_rounding: Rounding,
}

impl Default for Params {
    /// Proven below one unit with 10 kbit of ROM 12, and within two over the longest line.
    fn default() -> Self {
        Self {
            angle_integer: 7,
            angle_fraction: 22,
            table_address: 10,
            length_bits: 12,
            colour_bits: 8,
            intensity_fraction: 10,
            output_rounding: Rounding::Nearest,
        }
    }
}

impl Params {
    /// What a configuration of the device `cosine-squared` says.
    pub fn from_config(config: &Config) -> Self {
        Self {
            angle_integer: keys::bits(config, "angle.integer"),
            angle_fraction: keys::bits(config, "angle.fraction"),
            table_address: keys::bits(config, "table.address"),
            length_bits: keys::bits(config, "length.bits"),
            colour_bits: keys::bits(config, "colour.bits"),
            intensity_fraction: keys::bits(config, "intensity.fraction"),
            output_rounding: keys::rounding(config, "output.rounding"),
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
        in_range("angle.integer", self.angle_integer, 1, 16)?;
        in_range("angle.fraction", self.angle_fraction, 1, 30)?;
        in_range("table.address", self.table_address, 1, self.angle_fraction.min(20))?;
        in_range("length.bits", self.length_bits, 1, 16)?;
        in_range("colour.bits", self.colour_bits, 1, 16)?;
        in_range("intensity.fraction", self.intensity_fraction, 1, 30)
    }

    fn angle_format(&self) -> Format {
        Format::signed(self.angle_integer as i32, self.angle_fraction as i32)
    }

    fn colour_format(&self) -> Format {
        Format::unsigned(self.colour_bits as i32, 0)
    }
}

/// The arithmetic of the device, one operation a method.
#[derive(Clone, Debug)]
struct Arithmetic {
    params: Params,
    /// ROM 12.
    table: CosineTable,
    output: Narrow,
}

impl Arithmetic {
    fn new(params: &Params) -> Self {
        let f = params.intensity_fraction;
        Self {
            table: CosineTable::new(2, params.table_address, f),
            output: Narrow::new(f, params.colour_format(), params.output_rounding),
            params: params.clone(),
        }
    }

    /// The word of ROM 12 for a stretched angle.
    #[inline]
    fn cosine(&self, angle: i64) -> i64 {
        let params = &self.params;
        let words = &self.table.words;
        magnitude(angle, params.angle_fraction, params.table_address)
            .map_or(words[words.len() - 1], |step| words[step as usize])
    }

    #[inline]
    fn colour(&self, f: i64, amplitude: i64) -> i64 {
        self.output.apply(f * amplitude)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden::Contract;

    #[test]
    fn f_by_hand() {
        let contract = CosineSquaredContract::from_params(&Params {
            angle_integer: 2,
            angle_fraction: 6,
            table_address: 3,
            intensity_fraction: 6,
            ..Params::default()
        })
        .unwrap();
        let f = |angle| contract.f(&[0, angle, 0]);
        // Steps of 11.25°: (1 + cos² 11.25°)/2 = 0.98097; 20/64 is step 2: (0.85355 + 0.69134)/2 = 0.77245.
        assert_eq!(f(0), 63);
        assert_eq!(f(20), 49);
        assert_eq!(f(-20), 49);
        // The last step, a right angle and beyond, to the ends of the word.
        assert_eq!([56, 63, 64, 255, -64, -65, -256].map(f), [0; 7]);
        assert_eq!(contract.point(&[3, -10, 7], 4), [3, 2, 7]);
        // s2.6 wraps at 256.
        assert_eq!(contract.point(&[100, 100, 7], 2), [100, -212, 7]);
        assert_eq!(contract.colour(49, 255), 195);
    }

    #[test]
    fn the_default_is_within_the_contract() {
        let bound = CosineSquaredContract::from_params(&Params::default()).unwrap().bound();
        assert!(bound.units < 1.0, "{bound:?}");
    }
}

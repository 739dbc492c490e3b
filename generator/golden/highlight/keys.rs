//! The keys that devices share which compute f from cos γ and n.

use super::Products;
use crate::base::fixed::{Format, Rounding, exp2};
use crate::config::Config;
use crate::golden::frame::{Frame, Slot};
use crate::golden::{Operand, contract, keys};

/// The keys of a device that computes f from cos γ and n.
#[derive(Clone, Debug, PartialEq)]
pub struct Keys {
    /// `cosine.fraction`: fraction bits of cos γ.
    pub cosine_fraction: u32,
    /// `cosine.signed`: cos γ may be negative, and is then taken as 0.
    pub cosine_signed: bool,
    /// `exponent.bits`: bits of n.
    pub exponent_bits: u32,
    /// `colour.bits`: bits of a colour operand and of a colour output.
    pub colour_bits: u32,
    /// `colour.multipliers`: one for all colours, which takes them in turn.
    pub colours_in_turn: bool,
    /// `intensity.fraction`: fraction bits of f.
    pub intensity_fraction: u32,
    /// `output.rounding`: of the colour outputs.
    pub output_rounding: Rounding,
    /// `domain.exponent_min` and `domain.exponent_max`: the contract's n.
    pub exponents: (i64, i64),
}

impl Keys {
    /// The keys of a configuration.
    pub fn new(config: &Config) -> Self {
        Self {
            cosine_fraction: keys::bits(config, "cosine.fraction"),
            cosine_signed: config.flag("cosine.signed"),
            ..Self::without_cosine(config)
        }
    }

    /// Those of a device to which the angle comes in another way.
    pub fn without_cosine(config: &Config) -> Self {
        Self {
            cosine_fraction: 0,
            cosine_signed: false,
            exponent_bits: keys::bits(config, "exponent.bits"),
            colour_bits: keys::bits(config, "colour.bits"),
            colours_in_turn: keys::colours_in_turn(config),
            intensity_fraction: keys::bits(config, "intensity.fraction"),
            output_rounding: keys::rounding(config, "output.rounding"),
            exponents: keys::exponents(config),
        }
    }

    /// Words of four bits, small enough to follow by hand.
    #[cfg(test)]
    pub fn small() -> Self {
        Self {
            cosine_fraction: 4,
            cosine_signed: false,
            exponent_bits: 4,
            colour_bits: 4,
            colours_in_turn: false,
            intensity_fraction: 4,
            output_rounding: Rounding::Nearest,
            exponents: (1, 15),
        }
    }

    /// 1.0 as a raw cosine.
    pub fn one(&self) -> i64 {
        1 << self.cosine_fraction
    }

    /// An ulp of the cosine.
    pub fn ulp(&self) -> f64 {
        exp2(-(self.cosine_fraction as i32))
    }

    /// The format of cos γ.
    pub fn cosine_format(&self) -> Format {
        Format { signed: self.cosine_signed, int: 1, frac: self.cosine_fraction as i32 }
    }

    /// The format of n.
    pub fn exponent_format(&self) -> Format {
        Format::unsigned(self.exponent_bits as i32, 0)
    }

    /// The format of f.
    pub fn f_format(&self) -> Format {
        Format::unsigned(0, self.intensity_fraction as i32)
    }

    /// The products of f with the colours.
    pub fn products(&self) -> Products {
        Products::colours(self.f_format(), self.colour_bits, self.output_rounding)
            .in_turn(self.colours_in_turn)
    }

    /// The operands cos γ and n.
    pub fn operands(&self) -> Vec<Operand> {
        let lowest = if self.cosine_signed { -self.one() } else { 0 };
        vec![
            contract::cosine_operand(self.cosine_format(), (lowest, self.one())),
            contract::exponent_operand(self.exponent_format(), self.exponents),
        ]
    }

    /// The slots of the operands cos γ, which is taken for 0 … 1.0, and n.
    pub fn slots(&self, frame: &mut Frame) -> [Slot; 2] {
        let cosine = frame.clamped("cos_gamma", self.cosine_format(), 0, self.one());
        [cosine, frame.operand("exponent", self.exponent_format())]
    }

    /// cos γ as the register takes it.
    #[inline]
    pub fn clamped(&self, cosine: i64) -> i64 {
        cosine.clamp(0, self.one())
    }

    /// The value of [`Keys::clamped`].
    #[inline]
    pub fn cosine(&self, cosine: i64) -> f64 {
        self.clamped(cosine) as f64 * self.ulp()
    }
}

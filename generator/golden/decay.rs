//! What the models of `blinn` and `gauss` share: f = 2^(−n·decay), where the decay is a function of cos γ.

mod clock_model;
mod contract;
#[cfg(test)]
mod tests;

pub use clock_model::DecayModel;
pub use contract::DecayContract;

use std::f64::consts::LN_2;

use super::curve::{self, Curve};
use super::halving::{self, Halving};
use super::keys;
use super::narrow::Narrow;
use crate::base::fixed::{Format, Rounding, exp2};
use crate::config::Config;

/// The decay as a function of c = cos γ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// `blinn`: −log₂ c.
    Logarithm,
    /// `gauss`: γ²/(2 ln 2).
    Angle,
}

/// What a configuration of a device says.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// The device.
    pub function: Function,
    /// `cosine.fraction`: fraction bits of cos γ, C.
    pub cosine_fraction: u32,
    /// `cosine.signed`: cos γ may be negative, and is then taken as 0.
    pub cosine_signed: bool,
    /// `exponent.bits`: bits of n.
    pub exponent_bits: u32,
    /// `colour.bits`: bits of a colour operand and of a colour output, K.
    pub colour_bits: u32,
    /// `decay.fraction`: fraction bits of what the table of the decay gives, S.
    pub decay_fraction: u32,
    /// `decay.segments`, by range.
    pub decay_segments: Vec<u32>,
    /// `decay.tail`.
    pub decay_tail: u32,
    /// `decay.slope_fraction`.
    pub decay_slope_fraction: u32,
    /// `decay.coarse_fraction`: fraction bits of a decay that is not small.
    pub decay_coarse_fraction: u32,
    /// `exponential.address`.
    pub exponential_address: u32,
    /// `exponential.offset_bits` and `exponential.offset_address`, by field.
    pub exponential_offsets: Vec<(u32, u32)>,
    /// `exponential.fraction`.
    pub exponential_fraction: u32,
    /// `intensity.fraction`: fraction bits of f, F.
    pub intensity_fraction: u32,
    /// `intensity.rounding`: of f.
    pub intensity_rounding: Rounding,
    /// `output.rounding`: of the colour outputs.
    pub output_rounding: Rounding,
    /// `domain.exponent_min` and `domain.exponent_max`: the contract's n.
    pub exponents: (i64, i64),
}

impl Params {
    /// What a configuration of one of the devices says.
    pub fn from_config(config: &Config, function: Function) -> Self {
        // The schema allows no negative entries.
        let list = |key: &str| config.integers(key).iter().map(|&entry| entry as u32);
        Self {
            function,
            cosine_fraction: keys::bits(config, "cosine.fraction"),
            cosine_signed: config.flag("cosine.signed"),
            exponent_bits: keys::bits(config, "exponent.bits"),
            colour_bits: keys::bits(config, "colour.bits"),
            decay_fraction: keys::bits(config, "decay.fraction"),
            decay_segments: list("decay.segments").collect(),
            decay_tail: keys::bits(config, "decay.tail"),
            decay_slope_fraction: keys::bits(config, "decay.slope_fraction"),
            decay_coarse_fraction: keys::bits(config, "decay.coarse_fraction"),
            exponential_address: keys::bits(config, "exponential.address"),
            exponential_offsets: list("exponential.offset_bits")
                .zip(list("exponential.offset_address"))
                .collect(),
            exponential_fraction: keys::bits(config, "exponential.fraction"),
            intensity_fraction: keys::bits(config, "intensity.fraction"),
            intensity_rounding: keys::rounding(config, "intensity.rounding"),
            output_rounding: keys::rounding(config, "output.rounding"),
            exponents: keys::exponents(config),
        }
    }

    /// Whether the model's 64-bit arithmetic holds every intermediate value, and the tables are defined.
    ///
    /// # Errors
    /// Names the configuration key that is out of its range.
    pub fn check(&self) -> Result<(), String> {
        let limits = [
            ("cosine.fraction", self.cosine_fraction, 2, 26),
            ("exponent.bits", self.exponent_bits, 1, 16),
            ("colour.bits", self.colour_bits, 1, 16),
            ("intensity.fraction", self.intensity_fraction, 1, 28),
            ("decay.coarse_fraction", self.decay_coarse_fraction, 1, self.decay_fraction),
        ];
        for (key, value, least, most) in limits {
            if !(least..=most).contains(&value) {
                return Err(format!("{key} is {value}; {least} to {most} are possible"));
            }
        }
        self.curve().check()?;
        self.halving().check()
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

    /// How many times what the table gives the decay is, as a power of two.
    fn scale(&self) -> u32 {
        match self.function {
            Function::Logarithm => 0,
            Function::Angle => 1,
        }
    }

    fn curve(&self) -> curve::Params {
        curve::Params {
            // Of a cosine of at least one half, u is below one half.
            operand_bits: match self.function {
                Function::Logarithm => self.cosine_fraction - 1,
                Function::Angle => self.cosine_fraction,
            },
            fraction: self.decay_fraction,
            slope_fraction: self.decay_slope_fraction,
            segments: self.decay_segments.clone(),
            tail: self.decay_tail,
        }
    }

    /// What the table holds, at u, an integer with C fraction bits: 1 − c, less an ulp.
    fn table(&self, u: f64) -> f64 {
        let cosine = 1.0 - (u + 1.0) * exp2(-(self.cosine_fraction as i32));
        match self.function {
            Function::Logarithm => -libm::log2(cosine),
            Function::Angle => {
                let gamma = libm::acos(cosine);
                gamma * gamma / (4.0 * LN_2)
            }
        }
    }

    fn halving(&self) -> halving::Params {
        halving::Params {
            address: self.exponential_address,
            offsets: self.exponential_offsets.clone(),
            fraction: self.exponential_fraction,
            result_fraction: self.intensity_fraction,
            rounding: self.intensity_rounding,
        }
    }
}

/// The arithmetic of the device, one operation a method.
#[derive(Clone, Debug)]
struct Arithmetic {
    function: Function,
    cosine_fraction: u32,
    one: i64,
    /// 1.0 − ulp of f.
    largest: i64,
    /// A raw decay below this is small.
    small: i64,
    coarse_fraction: u32,
    /// Bits that a coarse decay loses.
    coarse_loss: u32,
    curve: Curve,
    from_fine: Narrow,
    from_coarse: Narrow,
    halving: Halving,
    output: Narrow,
}

impl Arithmetic {
    fn new(params: &Params) -> Result<Self, String> {
        params.check()?;
        let halving = params.halving();
        // The integer reaches F + 2 at least, where no bit of f is left.
        let integer = 64 - u64::from(params.intensity_fraction + 2).leading_zeros();
        let halvings = Format::unsigned(integer as i32, halving.bits() as i32);
        let narrow =
            |fraction: u32| Narrow::new(fraction - params.scale(), halvings, Rounding::Truncate);
        Ok(Self {
            function: params.function,
            cosine_fraction: params.cosine_fraction,
            one: params.one(),
            largest: (1 << params.intensity_fraction) - 1,
            small: 1 << (params.decay_fraction - 2),
            coarse_fraction: params.decay_coarse_fraction,
            coarse_loss: params.decay_fraction - params.decay_coarse_fraction,
            curve: Curve::new(&params.curve(), |u| params.table(u))?,
            from_fine: narrow(params.decay_fraction),
            from_coarse: narrow(params.decay_coarse_fraction),
            halving: Halving::new(&halving)?,
            output: Narrow::new(
                params.intensity_fraction,
                params.colour_format(),
                params.output_rounding,
            ),
        })
    }

    /// How often c doubles before it is at least one half, and the operand of the table: the inverse of what
    /// has become of c's fraction.
    ///
    /// Without a fraction (c = 0 and 1.0) the hardware counts all ones; f does not depend on either.
    #[inline]
    fn operand(&self, cosine: i64) -> (i64, i64) {
        let fraction = cosine & (self.one - 1);
        match self.function {
            Function::Angle => (0, self.one - 1 - fraction),
            Function::Logarithm if fraction == 0 => {
                let ones = (self.cosine_fraction - 1).ilog2() + 1;
                ((1 << ones) - 1, self.one / 2 - 1)
            }
            Function::Logarithm => {
                let octave = self.cosine_fraction - 1 - fraction.ilog2();
                (i64::from(octave), self.one - 1 - (fraction << octave))
            }
        }
    }

    /// Word 1: what the table says of the decay.
    #[inline]
    fn decay(&self, cosine: i64) -> i64 {
        self.curve.at(self.operand(cosine).1)
    }

    /// Word 2: n times the decay.
    #[inline]
    fn halvings(&self, cosine: i64, decay: i64, exponent: i64) -> i64 {
        let octave = self.operand(cosine).0;
        if octave == 0 && decay < self.small {
            self.from_fine.apply(decay * exponent)
        } else {
            let coarse = (octave << self.coarse_fraction) + (decay >> self.coarse_loss);
            self.from_coarse.apply(coarse * exponent)
        }
    }

    /// Word 4: f.
    #[inline]
    fn reflectance(&self, cosine: i64, halvings: i64) -> i64 {
        if cosine == 0 {
            0
        } else if cosine == self.one || halvings == 0 {
            self.largest
        } else {
            self.halving.at(halvings)
        }
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.output.apply(f * colour)
    }
}

//! The golden model and the accuracy contract of the device `rough`, which computes f = (n/2·(cos(γ ± dγ) − 1) + 1)²
//! ([symbols](crate#symbols)).
//!
//! dγ is the deviation of the normal on a rough surface. The operands are cos γ and cos dγ, and a table gives the sines. A
//! negative base of the square counts as 0, except with `clamp = false`, and f is 0 if cos γ ≤ 0. The golden model follows the
//! steps that seed 001, the patent UA 60139, describes.

mod analysis;
mod bound;
mod clock_model;
mod contract;
mod pairs;
#[cfg(test)]
mod tests;

pub use clock_model::model;
pub use contract::contract;

use easy_ext::ext;

use super::Operand;
use super::contract as shared;
use super::highlight::{self, Products};
use super::narrow::Narrow;
use super::sine::{self, Sine, TableScheme};
use glint_base::fixed::{Format, exp2};
use glint_config::Config;
use glint_keys::rough::{ArithmeticMode as Kind, Keys, RomLayout};

/// Returns the keys. In the patent's arithmetic, f gets the fraction bits of the cosine, and the cosine has no sign.
fn keys_of(config: &Config) -> Keys {
    let mut keys = Keys::of(config);
    if keys.patent() {
        keys.f.fraction = keys.operands.cosine.fraction;
        keys.operands.cosine.signed = false;
    }
    keys
}

#[ext(Derived)]
impl Keys {
    fn ulp(&self) -> f64 {
        exp2(-(self.operands.cosine.fraction as i32))
    }

    /// Returns the smallest and largest raw value of cos dγ. The smallest has an angle of at most the key `domain.deviation`.
    fn cos_dgamma_domain(&self) -> (i64, i64) {
        let largest = self.largest_cosine();
        let cosine = libm::cos(self.deviation.to_radians());
        (((cosine / self.ulp()).ceil() as i64).min(largest), largest)
    }

    fn control(&self) -> Vec<Operand> {
        let (largest, cos_gamma) = (self.largest_cosine(), self.cos_gamma_format());
        let lowest = if cos_gamma.signed { -largest } else { 0 };
        let sign = "1: the deviation is taken from the angle; 0: added to it";
        vec![
            shared::cosine_operand(cos_gamma, (lowest, largest)),
            shared::control(
                "cos_dgamma",
                self.cos_dgamma_format(),
                self.cos_dgamma_domain(),
                "cosine of the deviation of the microfacet",
            ),
            shared::exponent_operand(self.operands.exponent_format(), self.domain.exponents()),
            shared::control("dgamma_negative", Format::BIT, (0, 1), sign),
        ]
    }

    #[inline]
    fn clamped(&self, cosine: i64) -> i64 {
        cosine.clamp(0, self.largest_cosine())
    }

    fn products(&self) -> Products {
        highlight::products(&self.operands.colours, &self.f)
    }

    fn sine(&self) -> sine::SineParams {
        let cosine = self.operands.cosine.fraction;
        sine::SineParams {
            operand_fraction: cosine,
            fraction: if self.patent() { cosine } else { self.sine_fraction },
            scheme: match self.scheme {
                RomLayout::Direct => TableScheme::Direct { address: self.address },
                RomLayout::Segmented => TableScheme::Segmented {
                    segments: self.segments.clone(),
                    slope_fraction: self.slope_fraction,
                },
            },
        }
    }

    fn cos_gamma_format(&self) -> Format {
        Format { signed: self.operands.cosine.signed, ..self.cos_dgamma_format() }
    }

    fn cos_dgamma_format(&self) -> Format {
        let int = if self.patent() { 0 } else { 1 };
        Format::unsigned(int, self.operands.cosine.fraction as i32)
    }

    /// Returns the largest raw cosine in a register: 1.0, or in the patent's arithmetic an ulp less.
    fn largest_cosine(&self) -> i64 {
        (1 << self.operands.cosine.fraction) - i64::from(self.patent())
    }

    /// Returns the format of register 13, which contains first n/2·(cos(γ ± dγ) − 1) and then the square.
    fn result_format(&self) -> Format {
        let frac = self.f.fraction as i32;
        match (self.arithmetic, self.clamp) {
            (Kind::Patent, _) => Format::unsigned(0, frac),
            (Kind::Exact, true) => Format::signed(0, frac),
            (Kind::Exact, false) => Format::signed(1, frac),
        }
    }
}

/// The combinational blocks between the registers, on raw values.
struct RoughArithmetic {
    keys: Keys,
    sine: Sine,
    kind: RoughBlocks,
}

enum RoughBlocks {
    Exact {
        /// `product_one` is 1.0 with the fraction bits of registers 11 and 12 (the products). `result_one` is 1.0 with the
        /// fraction bits of register 13 (the base and its square).
        product_one: i64,
        result_one: i64,
        clamp: bool,
        cos_cos: Narrow,
        sin_sin: Narrow,
        scaled: Narrow,
        square: Narrow,
    },
    Patent {
        width: u32,
        mask: i64,
    },
}

impl RoughArithmetic {
    fn new(keys: Keys) -> Self {
        let (p, f) = (keys.product_fraction, keys.f.fraction);
        let kind = match keys.arithmetic {
            Kind::Patent => RoughBlocks::Patent {
                width: keys.operands.cosine.fraction,
                mask: (1 << keys.operands.cosine.fraction) - 1,
            },
            Kind::Exact => {
                let product = |from, int| {
                    Narrow::new(from, Format::unsigned(int, p as i32), keys.product_rounding)
                };
                let result = |from| Narrow::new(from, keys.result_format(), keys.f.rounding);
                RoughBlocks::Exact {
                    product_one: 1 << p,
                    result_one: 1 << f,
                    clamp: keys.clamp,
                    cos_cos: product(2 * keys.operands.cosine.fraction, 1),
                    sin_sin: product(2 * keys.sine_fraction, 0),
                    scaled: result(p + 1),
                    square: result(2 * f),
                }
            }
        };
        Self { sine: Sine::new(&keys.sine()), kind, keys }
    }

    /// Returns the next value of register 11: cos γ·cos dγ.
    #[inline]
    fn cos_cos(&self, cos_gamma: i64, cos_dgamma: i64) -> i64 {
        match &self.kind {
            RoughBlocks::Exact { cos_cos, .. } => cos_cos.apply(cos_gamma * cos_dgamma),
            RoughBlocks::Patent { width, .. } => (cos_gamma * cos_dgamma) >> width,
        }
    }

    /// Returns the next value of register 12: sin γ·sin dγ.
    #[inline]
    fn sin_sin(&self, sin_gamma: i64, sin_dgamma: i64) -> i64 {
        match &self.kind {
            RoughBlocks::Exact { sin_sin, .. } => sin_sin.apply(sin_gamma * sin_dgamma),
            RoughBlocks::Patent { width, .. } => (sin_gamma * sin_dgamma) >> width,
        }
    }

    /// Returns the output of adder 15: cos(γ ± dγ) − 1.0 from registers 11 and 12.
    ///
    /// The patent's numbers have no integer bit, so dropping this bit subtracts the 1.0. If `dgamma_negative` is 0, mux 14
    /// offers the inverse of register 12; without a carry this subtracts an ulp too much. Otherwise (trigger 4) mux 14 offers
    /// the output of adder 31, which is an ulp too small. Trigger 4 is also the carry-in, which adds this ulp again.
    #[inline]
    fn adder_15(&self, cos_cos: i64, sin_sin: i64, dgamma_negative: i64) -> i64 {
        match &self.kind {
            RoughBlocks::Exact { product_one, .. } if dgamma_negative == 0 => {
                cos_cos - sin_sin - product_one
            }
            RoughBlocks::Exact { product_one, .. } => cos_cos + sin_sin - product_one,
            RoughBlocks::Patent { mask, .. } => {
                let adder_31 = (sin_sin - 1) & mask;
                let mux_14 = if dgamma_negative == 0 { !sin_sin & mask } else { adder_31 };
                (cos_cos + mux_14 + dgamma_negative) & mask
            }
        }
    }

    /// Returns the first value of register 13: n/2·(cos(γ ± dγ) − 1). In the exact arithmetic, a surface that faces away, which
    /// has cos γ = 0, gets −1.0.
    #[inline]
    fn scaled(&self, adder_15: i64, exponent: i64, cos_gamma: i64) -> i64 {
        match &self.kind {
            RoughBlocks::Exact { result_one, .. } if cos_gamma == 0 => -result_one,
            // n is read with one fraction bit, which divides it by 2.
            RoughBlocks::Exact { scaled, .. } => scaled.apply(adder_15 * exponent),
            // n is shifted right by one place, and loses its low bit.
            RoughBlocks::Patent { mask, .. } => (adder_15 * (exponent >> 1)) & mask,
        }
    }

    /// Returns the second value of register 13: the square of the output of adder 16, which is register 13 + 1.0.
    #[inline]
    fn squared(&self, result: i64, cos_gamma: i64) -> i64 {
        match &self.kind {
            RoughBlocks::Exact { result_one, .. } if cos_gamma == 0 => -result_one,
            RoughBlocks::Exact { result_one, square, .. } => {
                let adder_16 = result + result_one;
                square.apply(adder_16 * adder_16)
            }
            // The words have no integer bit, so only the carry-in of adder 16 remains of the 1.0.
            RoughBlocks::Patent { width, mask } => {
                let adder_16 = (result + 1) & mask;
                (adder_16 * adder_16) >> width
            }
        }
    }

    /// Returns the f that the colour multipliers read from register 13.
    ///
    /// With the clamp, f is the low bits of register 13, because the square is below 1.0. Without the clamp, register 13 has an
    /// integer bit, and f is the register limited to 0 … 1.0 − ulp. In the patent's arithmetic, f is register 13 itself.
    #[inline]
    fn f_of(&self, result: i64) -> i64 {
        match &self.kind {
            RoughBlocks::Exact { result_one, clamp: true, .. } => result & (result_one - 1),
            RoughBlocks::Exact { result_one, clamp: false, .. } => result.clamp(0, result_one - 1),
            RoughBlocks::Patent { .. } => result,
        }
    }
}

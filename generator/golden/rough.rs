//! `rough`: (n/2·(cos(γ ± dγ) − 1) + 1)² (UA 60139, seed 001), by the patent's narrative.

mod analysis;
mod bound;
mod clock_model;
mod contract;
mod pairs;
#[cfg(test)]
mod tests;

pub use clock_model::model;
pub use contract::contract;

use super::highlight::Keys;
use super::keys;
use super::narrow::Narrow;
use super::sine::{self, Sine, TableScheme};
use crate::base::fixed::{Format, Rounding};
use crate::config::Config;

/// How sums and products are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// With integer bits and signs.
    Exact,
    /// The patent's: every word is a fraction modulo 1.0, and every "−1" a missing carry.
    Patent,
}

/// What a configuration of the device says.
///
/// In the patent's arithmetic all words have `cosine.fraction` bits; `cosine.signed`, `clamp`,
/// `product.*`, `intensity.*` and `sine.fraction` do not apply.
#[derive(Clone)]
struct Params {
    /// In the patent's arithmetic f has the fraction bits of the cosine, which has no sign.
    keys: Keys,
    /// `arithmetic`.
    arithmetic: Kind,
    /// `clamp`: a negative base becomes 0.
    clamp: bool,
    /// `product.fraction`: fraction bits of registers 11 and 12, P.
    product_fraction: u32,
    /// `product.rounding`: of what they take.
    product_rounding: Rounding,
    /// `intensity.rounding`: of what it takes.
    intensity_rounding: Rounding,
    /// `sine.scheme` with `sine.address`, or `sine.segments` and `sine.slope_fraction`.
    sine_scheme: TableScheme,
    /// `sine.fraction`: fraction bits of the sine, S.
    sine_fraction: u32,
    /// `domain.deviation`: the contract's largest dγ, in degrees, 0 … 90.
    deviation: f64,
}

impl Params {
    fn of(config: &Config) -> Self {
        let sine_scheme = match config.choice("sine.scheme") {
            "direct" => TableScheme::Direct { address: keys::bits(config, "sine.address") },
            _ => TableScheme::Segmented {
                // The schema allows no negative entries.
                segments: config
                    .integers("sine.segments")
                    .iter()
                    .map(|&bits| bits as u32)
                    .collect(),
                slope_fraction: keys::bits(config, "sine.slope_fraction"),
            },
        };
        let mut keys = Keys::new(config);
        let arithmetic = match config.choice("arithmetic") {
            "patent" => Kind::Patent,
            _ => Kind::Exact,
        };
        if arithmetic == Kind::Patent {
            keys.intensity_fraction = keys.cosine_fraction;
            keys.cosine_signed = false;
        }
        Self {
            keys,
            arithmetic,
            clamp: config.flag("clamp"),
            product_fraction: keys::bits(config, "product.fraction"),
            product_rounding: keys::rounding(config, "product.rounding"),
            intensity_rounding: keys::rounding(config, "intensity.rounding"),
            sine_scheme,
            sine_fraction: keys::bits(config, "sine.fraction"),
            deviation: config.number("domain.deviation"),
        }
    }

    fn patent(&self) -> bool {
        self.arithmetic == Kind::Patent
    }

    fn sine(&self) -> sine::Params {
        sine::Params {
            operand_fraction: self.keys.cosine_fraction,
            fraction: if self.patent() { self.keys.cosine_fraction } else { self.sine_fraction },
            scheme: self.sine_scheme.clone(),
        }
    }

    /// The format of cos γ, which may have a sign.
    fn cos_gamma_format(&self) -> Format {
        Format { signed: self.keys.cosine_signed, ..self.cos_dgamma_format() }
    }

    fn cos_dgamma_format(&self) -> Format {
        let int = if self.patent() { 0 } else { 1 };
        Format::unsigned(int, self.keys.cosine_fraction as i32)
    }

    /// The largest raw cosine that a register holds: 1.0, or in the patent's words an ulp less.
    fn largest_cosine(&self) -> i64 {
        (1 << self.keys.cosine_fraction) - i64::from(self.patent())
    }

    /// The format of register 13.
    fn result_format(&self) -> Format {
        let frac = self.keys.intensity_fraction as i32;
        match (self.arithmetic, self.clamp) {
            (Kind::Patent, _) => Format::unsigned(0, frac),
            (Kind::Exact, true) => Format::signed(0, frac),
            (Kind::Exact, false) => Format::signed(1, frac),
        }
    }
}

/// The blocks between the registers, one a method. Words are raw values.
struct Arithmetic {
    params: Params,
    sine: Sine,
    kind: Blocks,
}

enum Blocks {
    Exact {
        /// 1.0 of registers 11 and 12, and of register 13.
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

impl Arithmetic {
    fn new(params: Params) -> Self {
        let (p, f) = (params.product_fraction, params.keys.intensity_fraction);
        let kind = match params.arithmetic {
            Kind::Patent => Blocks::Patent {
                width: params.keys.cosine_fraction,
                mask: (1 << params.keys.cosine_fraction) - 1,
            },
            Kind::Exact => {
                let product = |from, int| {
                    Narrow::new(from, Format::unsigned(int, p as i32), params.product_rounding)
                };
                let result =
                    |from| Narrow::new(from, params.result_format(), params.intensity_rounding);
                Blocks::Exact {
                    product_one: 1 << p,
                    result_one: 1 << f,
                    clamp: params.clamp,
                    cos_cos: product(2 * params.keys.cosine_fraction, 1),
                    sin_sin: product(2 * params.sine_fraction, 0),
                    scaled: result(p + 1),
                    square: result(2 * f),
                }
            }
        };
        Self { sine: Sine::new(&params.sine()), kind, params }
    }

    /// What register 11 takes: cos γ·cos dγ.
    #[inline]
    fn cos_cos(&self, cos_gamma: i64, cos_dgamma: i64) -> i64 {
        match &self.kind {
            Blocks::Exact { cos_cos, .. } => cos_cos.apply(cos_gamma * cos_dgamma),
            Blocks::Patent { width, .. } => (cos_gamma * cos_dgamma) >> width,
        }
    }

    /// What register 12 takes: sin γ·sin dγ.
    #[inline]
    fn sin_sin(&self, sin_gamma: i64, sin_dgamma: i64) -> i64 {
        match &self.kind {
            Blocks::Exact { sin_sin, .. } => sin_sin.apply(sin_gamma * sin_dgamma),
            Blocks::Patent { width, .. } => (sin_gamma * sin_dgamma) >> width,
        }
    }

    /// Adder 15: cos(γ ± dγ) − 1.0 from registers 11 and 12.
    ///
    /// In the patent's words the 1.0 is the integer position that they lack. Mux 14 offers the inverse
    /// of register 12, which without a carry subtracts an ulp too much, or (trigger 4) what adder 31
    /// makes of it, an ulp too little, which trigger 4 as the carry-in brings back.
    #[inline]
    fn adder_15(&self, cos_cos: i64, sin_sin: i64, dgamma_negative: i64) -> i64 {
        match &self.kind {
            Blocks::Exact { product_one, .. } if dgamma_negative == 0 => {
                cos_cos - sin_sin - product_one
            }
            Blocks::Exact { product_one, .. } => cos_cos + sin_sin - product_one,
            Blocks::Patent { mask, .. } => {
                let adder_31 = (sin_sin - 1) & mask;
                let mux_14 = if dgamma_negative == 0 { !sin_sin & mask } else { adder_31 };
                (cos_cos + mux_14 + dgamma_negative) & mask
            }
        }
    }

    /// What register 13 takes first: n/2·(cos(γ ± dγ) − 1), or −1.0 for a surface that faces away.
    #[inline]
    fn scaled(&self, adder_15: i64, exponent: i64, cos_gamma: i64) -> i64 {
        match &self.kind {
            Blocks::Exact { result_one, .. } if cos_gamma == 0 => -result_one,
            // n is read with its low bit behind the point.
            Blocks::Exact { scaled, .. } => scaled.apply(adder_15 * exponent),
            // n is wired a place down, and loses its low bit.
            Blocks::Patent { mask, .. } => (adder_15 * (exponent >> 1)) & mask,
        }
    }

    /// What register 13 takes next: the square of adder 16, which is register 13 + 1.0.
    #[inline]
    fn squared(&self, result: i64, cos_gamma: i64) -> i64 {
        match &self.kind {
            Blocks::Exact { result_one, .. } if cos_gamma == 0 => -result_one,
            Blocks::Exact { result_one, square, .. } => {
                let adder_16 = result + result_one;
                square.apply(adder_16 * adder_16)
            }
            // The carry-in of adder 16 is all that is left of the 1.0.
            Blocks::Patent { width, mask } => {
                let adder_16 = (result + 1) & mask;
                (adder_16 * adder_16) >> width
            }
        }
    }

    /// The word f that the colour multipliers see in register 13.
    ///
    /// With the clamp, its low bits: the square is below 1.0. Without, register 13 has an integer bit,
    /// and is brought to 0 … 1.0 − ulp.
    #[inline]
    fn f_of(&self, result: i64) -> i64 {
        match &self.kind {
            Blocks::Exact { result_one, clamp: true, .. } => result & (result_one - 1),
            Blocks::Exact { result_one, clamp: false, .. } => result.clamp(0, result_one - 1),
            Blocks::Patent { .. } => result,
        }
    }
}

//! The shared model of `blinn` and `gauss`: f = 2^(−n·decay), where the decay is a function of cos γ.

#[cfg(test)]
mod tests;

use std::f64::consts::LN_2;
use std::sync::Arc;

use super::contract::{self, ErrorShare};
use super::curve::{self, Bend, Curve, Piece};
use super::frame::{Clocked, Frame, idle, step_by};
use super::halving::{self, Halving};
use super::highlight::{self, Highlight, Reflectance};
use super::narrow::Narrow;
use super::{Contract, Model};
use crate::formulas;
use glint_base::fixed::{Format, Rounding, exp2};
use glint_config::Config;
use glint_keys::decay::Keys;

/// The decay as a function of c = cos γ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// `blinn`: −log₂ c.
    Logarithm,
    /// `gauss`: γ²/(2 ln 2).
    Angle,
}

/// One of the devices, and what a configuration of it says.
struct Params {
    function: Function,
    keys: Keys,
}

impl Params {
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
                Function::Logarithm => self.keys.operands.cosine.fraction - 1,
                Function::Angle => self.keys.operands.cosine.fraction,
            },
            fraction: self.keys.decay_fraction,
            slope_fraction: self.keys.slope_fraction,
            segments: self.keys.segments.clone(),
            tail: self.keys.tail,
        }
    }

    /// Returns the entry of the table at u, an integer with C fraction bits: 1 − c, less an ulp.
    fn table(&self, u: f64) -> f64 {
        let cosine = 1.0 - (u + 1.0) * self.keys.operands.cosine.ulp();
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
            address: self.keys.address,
            offsets: self.keys.offsets().collect(),
            fraction: self.keys.fraction,
            result_fraction: self.keys.f.fraction,
            rounding: self.keys.f.rounding,
        }
    }
}

/// The arithmetic of the device, one operation a method.
struct Arithmetic {
    params: Params,
    /// 1.0 − ulp of f.
    largest: i64,
    /// A raw decay below this is small.
    small: i64,
    /// Bits that a coarse decay loses.
    coarse_loss: u32,
    curve: Curve,
    /// The format of the register `halvings`.
    halvings: Format,
    from_fine: Narrow,
    from_coarse: Narrow,
    halving: Halving,
}

impl Arithmetic {
    fn new(params: Params) -> Self {
        let halving = params.halving();
        // The integer reaches F + 2 at least, where no bit of f is left.
        let integer = 64 - u64::from(params.keys.f.fraction + 2).leading_zeros();
        let halvings = Format::unsigned(integer as i32, halving.bits() as i32);
        let narrow =
            |fraction: u32| Narrow::new(fraction - params.scale(), halvings, Rounding::Truncate);
        Self {
            largest: (1 << params.keys.f.fraction) - 1,
            small: 1 << (params.keys.decay_fraction - 2),
            coarse_loss: params.keys.decay_fraction - params.keys.coarse_fraction,
            curve: Curve::new(&params.curve(), Bend::Convex, |u| params.table(u)),
            halvings,
            from_fine: narrow(params.keys.decay_fraction),
            from_coarse: narrow(params.keys.coarse_fraction),
            halving: Halving::new(&halving),
            params,
        }
    }

    /// How often c doubles before it is at least one half, and the operand of the table: the inverse of what
    /// has become of c's fraction.
    ///
    /// Without a fraction (c = 0 and 1.0) the hardware counts all ones; f does not depend on either.
    #[inline]
    fn operand(&self, cosine: i64) -> (i64, i64) {
        let fraction = cosine & (self.params.keys.operands.cosine.one() - 1);
        match self.params.function {
            Function::Angle => (0, self.params.keys.operands.cosine.one() - 1 - fraction),
            Function::Logarithm if fraction == 0 => {
                let ones = (self.params.keys.operands.cosine.fraction - 1).ilog2() + 1;
                ((1 << ones) - 1, self.params.keys.operands.cosine.one() / 2 - 1)
            }
            Function::Logarithm => {
                let octave = self.params.keys.operands.cosine.fraction - 1 - fraction.ilog2();
                (
                    i64::from(octave),
                    self.params.keys.operands.cosine.one() - 1 - (fraction << octave),
                )
            }
        }
    }

    /// Returns the decay by the table.
    #[inline]
    fn decay(&self, cosine: i64) -> i64 {
        self.curve.at(self.operand(cosine).1)
    }

    /// n times the decay.
    #[inline]
    fn halvings(&self, cosine: i64, decay: i64, exponent: i64) -> i64 {
        let octave = self.operand(cosine).0;
        if octave == 0 && decay < self.small {
            self.from_fine.apply(decay * exponent)
        } else {
            let coarse = (octave << self.params.keys.coarse_fraction) + (decay >> self.coarse_loss);
            self.from_coarse.apply(coarse * exponent)
        }
    }

    /// f.
    #[inline]
    fn reflectance(&self, cosine: i64, halvings: i64) -> i64 {
        if cosine == 0 {
            0
        } else if cosine == self.params.keys.operands.cosine.one() || halvings == 0 {
            self.largest
        } else {
            self.halving.at(halvings)
        }
    }

    /// The error of f from the decay of a piece in an octave: that of the segment's shape, of its words, and of
    /// what the product does not see.
    fn of_piece(&self, piece: &Piece, octave: f64) -> [f64; 3] {
        let params = &self.params;
        let scale = exp2(params.scale() as i32);
        // Small decays are multiplied whole.
        let quarter = 0.25 - piece.error;
        let coarse = if octave > 0.0 || params.table(piece.last as f64) >= quarter {
            scale * exp2(-(params.keys.coarse_fraction as i32))
        } else {
            0.0
        };
        let shape = piece.shape.min(piece.error) * scale;
        let parts = [shape, piece.error * scale - shape, coarse];
        let error: f64 = parts.iter().sum();
        let least = octave + params.table(piece.start as f64) * scale - error;
        let (from, to) = (params.keys.domain.least as f64, params.keys.domain.most as f64);
        let n = if least > 0.0 { (1.0 / (least * LN_2)).clamp(from, to) } else { to };
        let weight = LN_2 * n * libm::exp2(-n * least.max(0.0));
        parts.map(|part| part * weight)
    }
}

/// The golden model of one of the devices.
pub fn model(config: &Config, function: Function) -> Box<dyn Model> {
    Box::new(clocked(Arithmetic::new(Params { function, keys: Keys::of(config) })))
}

/// The device, clock by clock.
///
/// Synchronous tables are addressed by registers that the microinstruction before did not change, so that they
/// show the same as others would.
fn clocked(it: Arithmetic) -> Clocked {
    let it = Arc::new(it);
    let mut frame = Frame::default();
    let [cosine, exponent] = highlight::slots(&it.params.keys.operands, &mut frame);
    let decay = frame.register("decay", Format::unsigned(0, it.params.keys.decay_fraction as i32));
    let halvings = frame.register("halvings", it.halvings);
    let reflectance = frame.register("reflectance", it.params.keys.f.format());
    frame.shows("f_out", reflectance);
    let program = vec![
        idle(),
        step_by(&it, move |it, s| s[decay] = it.decay(s[cosine])),
        step_by(&it, move |it, s| s[halvings] = it.halvings(s[cosine], s[decay], s[exponent])),
        idle(),
        step_by(&it, move |it, s| s[reflectance] = it.reflectance(s[cosine], s[halvings])),
    ];
    highlight::products(&it.params.keys.operands.colours, &it.params.keys.f).behind(
        frame,
        reflectance,
        program,
    )
}

/// The accuracy contract of one of the devices. Control operands: `cos_gamma`, `exponent`.
pub fn contract(config: &Config, function: Function) -> Box<dyn Contract> {
    let it = Arithmetic::new(Params { function, keys: Keys::of(config) });
    let keys = &it.params.keys;
    let operands = highlight::operands(&keys.operands, &keys.domain);
    let products = highlight::products(&keys.operands.colours, &keys.f);
    Box::new(Highlight::new(it, operands, products))
}

impl Reflectance for Arithmetic {
    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let cosine = self.params.keys.operands.cosine.clamped(control[0]);
        let halvings = self.halvings(cosine, self.decay(cosine), control[1]);
        self.reflectance(cosine, halvings)
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let (cosine, exponent) =
            (self.params.keys.operands.cosine.value(control[0]), control[1] as f64);
        match self.params.function {
            Function::Logarithm => formulas::blinn(cosine, exponent),
            Function::Angle => formulas::gauss(cosine, exponent),
        }
    }

    /// n·c^(n − 1), for cosⁿγ.
    fn slope(&self) -> Option<f64> {
        let (least, most) = self.params.keys.domain.exponents();
        (least > 0 && self.params.function == Function::Logarithm).then_some(most as f64)
    }

    fn expressions(&self) -> Vec<String> {
        vec![contract::where_it_faces(match self.params.function {
            Function::Logarithm => "cos_gamma ** exponent",
            Function::Angle => "exp(-exponent * acos(cos_gamma) ** 2 / 2)",
        })]
    }

    /// Let y = n·decay be exact and z the hardware's product before it is cut to the fraction bits of the tables of 2^−x.
    ///
    /// - |z − y| ≤ n·e, where e is the error of the decay's segment and of the bits that a coarse decay
    ///   loses. So |2^−z − 2^−y| ≤ ln 2·n·e·2^−min(y, z), and min(y, z) ≥ n·(decay − e) with the smallest decay of
    ///   the segment: as a function of n this is largest at n = 1/(ln 2·(decay − e)). Octaves beyond the
    ///   first have the same segments and larger decays; the first of them is the worst.
    /// - The tables' error covers every z that is cut to one word; the shift makes it smaller.
    /// - f is rounded, or saturated just below 1.0: an ulp. Where n·decay saturates, nothing of f is left: its integer
    ///   is F + 2 at least, which is less than that ulp too.
    /// - The output adds its own rounding; it cannot exceed the largest colour, for f < 1.
    fn shares(&self) -> Vec<ErrorShare> {
        let octaves: &[f64] = match self.params.function {
            Function::Logarithm => &[0.0, 1.0],
            Function::Angle => &[0.0],
        };
        let [shape, words, coarse] = octaves
            .iter()
            .flat_map(|&octave| {
                let pieces = self.curve.pieces().iter();
                pieces.map(move |piece| self.of_piece(piece, octave))
            })
            .max_by(|a, b| a.iter().sum::<f64>().total_cmp(&b.iter().sum()))
            .unwrap_or_default();
        vec![
            ("decay.segments", "straight segments for the decay, times n", shape),
            ("decay.fraction", "rounding of the decay, times n", words),
            (
                "decay.coarse_fraction",
                "bits of the decay that the product by n does not see",
                coarse,
            ),
            ("exponential.address", "the tables of 2^-x", self.halving.error()),
            ("intensity.fraction", "rounding of f", self.halving.rounding_error()),
        ]
    }
}

//! The accuracy contract of `blinn` and `gauss`.

use std::f64::consts::LN_2;

use super::{Arithmetic, Function, Params};
use crate::base::fixed::{Format, exp2};
use crate::golden::contract::{self as shared, Share};
use crate::golden::curve::Piece;
use crate::golden::formulas;
use crate::golden::{Bound, Contract, Operand};

/// The accuracy contract. Control operands: `cos_gamma`, `exponent`.
#[derive(Clone, Debug)]
pub struct DecayContract {
    params: Params,
    arithmetic: Arithmetic,
    /// An ulp of the cosine.
    ulp: f64,
    operands: Vec<Operand>,
    outputs: Vec<String>,
}

impl DecayContract {
    /// The contract from parameters.
    ///
    /// # Errors
    /// As [`Params::check`].
    pub fn from_params(params: &Params) -> Result<Self, String> {
        let arithmetic = Arithmetic::new(params)?;
        let one = params.one();
        let cosine = params.cosine_format();
        let mut operands = vec![
            Operand {
                name: "cos_gamma".to_string(),
                format: cosine,
                domain: (if cosine.signed { -one } else { 0 }, one),
                colour: false,
                doc: "cosine of the angle between the normal and the half vector".to_string(),
            },
            Operand {
                name: "exponent".to_string(),
                format: params.exponent_format(),
                domain: params.exponents,
                colour: false,
                doc: "specular exponent n".to_string(),
            },
        ];
        operands.extend(shared::colour_operands(params.colour_format()));
        Ok(Self {
            arithmetic,
            ulp: exp2(-(params.cosine_fraction as i32)),
            params: params.clone(),
            operands,
            outputs: shared::colour_outputs(),
        })
    }

    /// The error of f from the decay of a piece in an octave: that of the segment's shape, of its words, and of
    /// what the product does not see.
    fn of_piece(&self, piece: &Piece, octave: f64) -> [f64; 3] {
        let params = &self.params;
        let scale = exp2(params.scale() as i32);
        // Small decays are multiplied whole.
        let quarter = 0.25 - piece.error;
        let coarse = if octave > 0.0 || params.table(piece.last as f64) >= quarter {
            scale * exp2(-(params.decay_coarse_fraction as i32))
        } else {
            0.0
        };
        let shape = piece.shape.min(piece.error) * scale;
        let parts = [shape, piece.error * scale - shape, coarse];
        let error: f64 = parts.iter().sum();
        let least = octave + params.table(piece.start as f64) * scale - error;
        let (from, to) = (params.exponents.0 as f64, params.exponents.1 as f64);
        let n = if least > 0.0 { (1.0 / (least * LN_2)).clamp(from, to) } else { to };
        let weight = LN_2 * n * libm::exp2(-n * least.max(0.0));
        parts.map(|part| part * weight)
    }
}

impl Contract for DecayContract {
    fn operands(&self) -> &[Operand] {
        &self.operands
    }

    fn outputs(&self) -> &[String] {
        &self.outputs
    }

    fn f_format(&self) -> Format {
        Format::unsigned(0, self.params.intensity_fraction as i32)
    }

    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let it = &self.arithmetic;
        let cosine = control[0].clamp(0, it.one);
        let halvings = it.halvings(cosine, it.decay(cosine), control[1]);
        it.reflectance(cosine, halvings)
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.arithmetic.colour(f, colour)
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let cosine = control[0].clamp(0, self.arithmetic.one) as f64 * self.ulp;
        let exponent = control[1] as f64;
        match self.params.function {
            Function::Logarithm => formulas::blinn(cosine, exponent),
            Function::Angle => formulas::gauss(cosine, exponent),
        }
    }

    fn expressions(&self) -> Vec<String> {
        vec![shared::where_it_faces(match self.params.function {
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
    fn bound(&self) -> Bound {
        let params = &self.params;
        let octaves: &[f64] = match params.function {
            Function::Logarithm => &[0.0, 1.0],
            Function::Angle => &[0.0],
        };
        let [shape, words, coarse] = octaves
            .iter()
            .flat_map(|&octave| {
                let pieces = self.arithmetic.curve.pieces().iter();
                pieces.map(move |piece| self.of_piece(piece, octave))
            })
            .max_by(|a, b| a.iter().sum::<f64>().total_cmp(&b.iter().sum()))
            .unwrap_or_default();
        let shares: [Share; 5] = [
            ("decay.segments", "straight segments for the decay, times n", shape),
            ("decay.fraction", "rounding of the decay, times n", words),
            (
                "decay.coarse_fraction",
                "bits of the decay that the product by n does not see",
                coarse,
            ),
            ("exponential.address", "the tables of 2^-x", self.arithmetic.halving.error()),
            ("intensity.fraction", "rounding of f", self.arithmetic.halving.rounding_error()),
        ];
        shared::bound(
            &shares,
            params.intensity_fraction,
            params.colour_bits,
            params.output_rounding,
        )
    }
}

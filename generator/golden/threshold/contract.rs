//! The accuracy contract of `threshold`.

use super::{Arithmetic, Params};
use crate::base::fixed::{Format, exp2};
use crate::config::Config;
use crate::golden::contract as shared;
use crate::golden::formulas;
use crate::golden::narrow::rounding_error;
use crate::golden::{Bound, Contract, Operand};

/// The accuracy contract. Control operands: `cos_gamma`, `exponent`.
#[derive(Clone, Debug)]
pub struct ThresholdContract {
    params: Params,
    arithmetic: Arithmetic,
    /// An ulp of the cosine, and one of f.
    ulps: (f64, f64),
    /// How far from ROM(n) the square may be seen on its other side.
    margin: f64,
    operands: Vec<Operand>,
    outputs: Vec<String>,
}

impl ThresholdContract {
    /// The contract of a configuration.
    ///
    /// # Panics
    /// If the configuration is one that [`Params::check`] refuses and the device's schema does not.
    pub fn new(config: &Config) -> Self {
        Self::from_params(&Params::from_config(config))
            .expect("a configuration that its schema accepts")
    }

    /// The contract from parameters.
    ///
    /// # Errors
    /// As [`Params::check`].
    pub fn from_params(params: &Params) -> Result<Self, String> {
        params.check()?;
        let one = params.one();
        let lowest = if params.cosine_signed { -one } else { 0 };
        let mut operands = vec![
            Operand {
                name: "cos_gamma".to_string(),
                format: params.cosine_format(),
                domain: (lowest, one),
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
            arithmetic: Arithmetic::new(params),
            ulps: (
                exp2(-(params.cosine_fraction as i32)),
                exp2(-(params.intensity_fraction as i32)),
            ),
            margin: bound(params).f,
            params: params.clone(),
            operands,
            outputs: shared::colour_outputs(),
        })
    }

    /// The ungated parabola's square in f64, and ROM(n).
    #[inline]
    fn square_and_level(&self, control: &[i64]) -> (f64, f64) {
        let cosine = control[0].clamp(0, self.arithmetic.one) as f64 * self.ulps.0;
        let level = self.arithmetic.threshold(control[1]) as f64 * self.ulps.1;
        (formulas::parabola(cosine, control[1] as f64), level)
    }
}

impl Contract for ThresholdContract {
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
        it.gated(cosine, control[1], it.scaled(cosine, control[1]))
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.arithmetic.colour(f, colour)
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let (square, level) = self.square_and_level(control);
        formulas::threshold(square, level)
    }

    /// Where the exact square is within the bound on its error of ROM(n), the word may be on either side.
    #[inline]
    fn references(&self, control: &[i64]) -> [f64; 2] {
        let (square, level) = self.square_and_level(control);
        if (square - level).abs() <= self.margin {
            [square, 0.0]
        } else {
            [formulas::threshold(square, level); 2]
        }
    }

    /// With ROM(n) as it stands.
    fn expressions(&self) -> Vec<String> {
        let square = format!("{} ** 2", shared::clamped_at_0("exponent / 2 * (cos_gamma - 1) + 1"));
        let margin = self.margin;
        ["-", "+"]
            .map(|side| {
                let level = format!("levels[int(exponent)] {side} {margin:e}");
                shared::where_it_faces(&format!("({square} if {square} >= {level} else 0)"))
            })
            .to_vec()
    }

    fn bound(&self) -> Bound {
        bound(&self.params)
    }

    /// A level above what rounds to 0 is seen as an edge around the highlight.
    fn remarks(&self) -> Vec<String> {
        let largest = (1 << self.params.colour_bits) - 1;
        let (first, last) = self.params.exponents;
        let hidden = |n: i64| self.arithmetic.threshold(n) - 1;
        // One n of each octave stands for all.
        let Some((n, word)) = (0..=12)
            .map(|octave| (1i64 << octave).clamp(first, last))
            .map(|n| (n, hidden(n)))
            .max_by_key(|&(n, word)| (word, -n))
        else {
            return Vec::new();
        };
        let shown = self.arithmetic.colour(word.max(0), largest);
        if shown == 0 {
            return Vec::new();
        }
        vec![format!(
            "visibility.levels cut into what is visible: at n = {n} outputs up to {shown} become 0, which the \
             formula without ROM(n) shows (levels of at most 50 hide only what rounds to 0)"
        )]
    }
}

/// All of base, square and formula lie in 0 … 1, so that an error ε of the base is at most 2·ε in the square.
///
/// The product is rounded into the base, and limited to −1.0 where the formula is clamped. The square
/// is rounded; the square of 1.0 is an ulp low. The gates add nothing: within the sum of these of
/// ROM(n) either side is right.
fn bound(params: &Params) -> Bound {
    let f = params.intensity_fraction;
    let base = rounding_error(params.cosine_fraction + 1, f, params.intensity_rounding);
    let shares = [
        ("intensity.rounding", "rounding of the base", 2.0 * base),
        (
            "intensity.fraction",
            "rounding of the square, and 1.0 as the largest word",
            exp2(-(f as i32)),
        ),
    ];
    shared::bound(&shares, f, params.colour_bits, params.output_rounding)
}

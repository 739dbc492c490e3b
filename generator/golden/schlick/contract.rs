//! The accuracy contract of `schlick`.

use super::{Arithmetic, Params};
use crate::base::fixed::{Format, exp2};
use crate::config::Config;
use crate::golden::contract as shared;
use crate::golden::formulas;
use crate::golden::{Bound, Contract, Operand};

/// The accuracy contract. Control operands: `cos_gamma`, `exponent`.
#[derive(Clone, Debug)]
pub struct SchlickContract {
    params: Params,
    arithmetic: Arithmetic,
    /// An ulp of the cosine.
    ulp: f64,
    operands: Vec<Operand>,
    outputs: Vec<String>,
}

impl SchlickContract {
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
            ulp: exp2(-(params.cosine_fraction as i32)),
            params: params.clone(),
            operands,
            outputs: shared::colour_outputs(),
        })
    }
}

impl Contract for SchlickContract {
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
        let divisor = it.divisor(cosine, control[1]);
        Arithmetic::divide(cosine, divisor, it.quotient_bits).0
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.arithmetic.colour(f, colour)
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let cosine = control[0].clamp(0, self.arithmetic.one) as f64;
        formulas::schlick(cosine * self.ulp, control[1] as f64)
    }

    fn expressions(&self) -> Vec<String> {
        vec![shared::where_it_faces("cos_gamma / (exponent * (1 - cos_gamma) + cos_gamma)")]
    }

    /// Dividend and divisor are exact, so that nothing but the quotient's own last bit is lost: it is
    /// truncated, and 1.0 becomes the largest fraction. Both are at most an ulp below the formula.
    fn bound(&self) -> Bound {
        let fraction = self.params.intensity_fraction;
        let share = ("intensity.fraction", "truncation of the quotient", exp2(-(fraction as i32)));
        let (colour, rounding) = (self.params.colour_bits, self.params.output_rounding);
        shared::bound(&[share], fraction, colour, rounding)
    }
}

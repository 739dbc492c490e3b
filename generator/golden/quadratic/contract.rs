//! The accuracy contract of `quadratic`.

use super::{Arithmetic, Params, Scheme, coefficient};
use crate::base::fixed::{Format, exp2};
use crate::config::Config;
use crate::golden::contract as shared;
use crate::golden::formulas;
use crate::golden::narrow::rounding_error;
use crate::golden::{Bound, Contract, Operand};

/// The accuracy contract. Control operands: `cos_gamma`, `exponent`.
#[derive(Clone, Debug)]
pub struct QuadraticContract {
    params: Params,
    arithmetic: Arithmetic,
    /// An ulp of the cosine.
    ulp: f64,
    operands: Vec<Operand>,
    outputs: Vec<String>,
}

impl QuadraticContract {
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

impl Contract for QuadraticContract {
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
        it.intensity(cosine, control[1], it.difference(cosine))
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.arithmetic.colour(f, colour)
    }

    /// With a(n) as it was before ROM(n) rounded it.
    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let cosine = control[0].clamp(0, self.arithmetic.one) as f64 * self.ulp;
        formulas::quadratic(cosine, self.arithmetic.exact[control[1] as usize])
    }

    /// The coefficient of the least largest error has no closed form; ROM(n) holds it.
    fn expressions(&self) -> Vec<String> {
        let coefficient = match self.params.scheme {
            Scheme::Taylor => "(max(exponent, 1) - 1)",
            Scheme::Minimax { .. } => "coefficient[int(exponent)]",
        };
        let f = format!("cos_gamma * (1 - {coefficient} * (1 - cos_gamma))");
        vec![shared::where_it_faces(&shared::clamped_at_0(&f))]
    }

    /// The error of `c − a·g`, with g = c − c² in 0 … 1/4. Where formula and hardware are both clamped there is
    /// none; otherwise `a·g ≤ c`, that is `1 − c ≤ 1/a`, for one of the two, and g is at most 1/a.
    ///
    /// - An error of the word a(n) is multiplied by g.
    /// - The rounding of g is multiplied by the word a(n).
    /// - f is rounded; 1.0 is an ulp low.
    fn bound(&self) -> Bound {
        let params = &self.params;
        let f = params.intensity_fraction;
        let scale = exp2(-(params.coefficient_fraction() as i32));
        let (first, last) = params.exponents;
        let table = (first..=last).map(|n| {
            let n = n as usize;
            (self.arithmetic.exact[n], self.arithmetic.words[n] as f64 * scale)
        });
        let (mut rounded, mut largest) = (0.0f64, 0.0f64);
        for (exact, word) in table {
            let reach = (1.0 / exact.min(word).max(4.0)).min(0.25);
            rounded = rounded.max((exact - word).abs() * reach);
            largest = largest.max(word);
        }
        let difference = rounding_error(
            2 * params.cosine_fraction,
            params.difference_fraction,
            params.difference_rounding,
        );
        let shares = [
            ("coefficient.fraction", "rounding of a(n)", rounded),
            ("difference.fraction", "rounding of c² − c, times a(n)", difference * largest),
            ("intensity.fraction", "rounding of f, and 1.0 as the largest word", exp2(-(f as i32))),
        ];
        shared::bound(&shares, f, params.colour_bits, params.output_rounding)
    }

    /// What n − 1 costs beside the minimax table.
    fn remarks(&self) -> Vec<String> {
        if self.params.scheme != Scheme::Taylor {
            return Vec::new();
        }
        let n = self.params.exponents.1;
        let best = coefficient::table(Scheme::Minimax { fraction: 0 }, n as u32 + 1);
        let errors = [(n - 1) as f64, best[n as usize]].map(|a| formula_error(n, a));
        if errors[1] >= errors[0] {
            return Vec::new();
        }
        vec![format!(
            "with coefficient.scheme = \"taylor\" the formula is off from cos^n by up to {:.4}, at n = {n}; with \
             \"minimax\" by {:.4}",
            errors[0], errors[1]
        )]
    }
}

/// The largest difference between the parabola and cⁿ, on a grid that the highlight fills.
fn formula_error(n: i64, a: f64) -> f64 {
    const GRID: u32 = 2048;
    let n = n as f64;
    let reach = (8.0 / n).min(1.0);
    (0..=GRID)
        .map(|step| 1.0 - reach * f64::from(step) / f64::from(GRID))
        // The zero of the parabola, where the error has its corner.
        .chain([1.0 - 1.0 / a.max(1.0)])
        .map(|cosine| (formulas::quadratic(cosine, a) - formulas::blinn(cosine, n)).abs())
        .fold(0.0, f64::max)
}

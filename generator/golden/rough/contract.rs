//! The accuracy contract of `rough`.

use super::{Arithmetic, Kind, Params, bound};
use crate::base::fixed::{Format, exp2};
use crate::config::Config;
use crate::golden::formulas;
use crate::golden::{Axis, Bound, Contract, Operand, Sweep, Values, contract};

/// The settings of dγ, in degrees, that an exhaustive check visits beside the largest of the domain.
const SWEPT_DEVIATIONS: [f64; 4] = [0.0, 1.0, 5.0, 15.0];

/// The accuracy contract. Control operands: `cos_gamma`, `cos_dgamma`, `exponent`, `dgamma_negative`.
#[derive(Clone, Debug)]
pub struct RoughContract {
    params: Params,
    arithmetic: Arithmetic,
    largest_cosine: i64,
    /// An ulp of a cosine.
    ulp: f64,
    operands: Vec<Operand>,
    outputs: Vec<String>,
}

impl RoughContract {
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
        let arithmetic = Arithmetic::new(params)?;
        let largest = params.largest_cosine();
        let cos_gamma = params.cos_gamma_format();
        let lowest = if cos_gamma.signed { -largest } else { 0 };
        let cosine = libm::cos(params.deviation.to_radians());
        // The smallest cosine whose angle is within the deviation.
        let steepest = (cosine * exp2(params.cosine_fraction as i32)).ceil() as i64;
        let operand = |name: &str, format, domain, doc: &str| Operand {
            name: name.to_string(),
            format,
            domain,
            colour: false,
            doc: doc.to_string(),
        };
        let mut operands = vec![
            operand(
                "cos_gamma",
                cos_gamma,
                (lowest, largest),
                "cosine of the angle between the normal and the half vector",
            ),
            operand(
                "cos_dgamma",
                params.cos_dgamma_format(),
                (steepest.min(largest), largest),
                "cosine of the deviation of the microfacet",
            ),
            operand("exponent", params.exponent_format(), params.exponents, "specular exponent n"),
            operand(
                "dgamma_negative",
                Format::BIT,
                (0, 1),
                "1: the deviation is taken from the angle; 0: added to it",
            ),
        ];
        operands.extend(contract::colour_operands(params.colour_format()));
        Ok(Self {
            arithmetic,
            largest_cosine: largest,
            ulp: exp2(-(params.cosine_fraction as i32)),
            params: params.clone(),
            operands,
            outputs: contract::colour_outputs(),
        })
    }

    /// Words and bits per word of ROM 18.
    pub fn rom_size(&self) -> (u64, u32) {
        self.arithmetic.sine.rom_size()
    }

    #[inline]
    fn clamped(&self, cosine: i64) -> i64 {
        cosine.clamp(0, self.largest_cosine)
    }
}

impl Contract for RoughContract {
    fn operands(&self) -> &[Operand] {
        &self.operands
    }

    fn outputs(&self) -> &[String] {
        &self.outputs
    }

    fn f_format(&self) -> Format {
        Format::unsigned(0, self.params.f_fraction() as i32)
    }

    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let it = &self.arithmetic;
        let (cos_gamma, cos_dgamma) = (self.clamped(control[0]), self.clamped(control[1]));
        let sin_sin = it.sin_sin(it.sine.at(cos_gamma), it.sine.at(cos_dgamma));
        let adder_15 = it.adder_15(it.cos_cos(cos_gamma, cos_dgamma), sin_sin, control[3]);
        let scaled = it.scaled(adder_15, control[2], cos_gamma);
        it.f(it.squared(scaled, cos_gamma))
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.arithmetic.colour(f, colour)
    }

    /// The patent's arithmetic is held against the clamped formula, which shows what it costs.
    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let cosine = |raw| self.clamped(raw) as f64 * self.ulp;
        let (cos_gamma, cos_dgamma) = (cosine(control[0]), cosine(control[1]));
        let (negative, exponent) = (control[3] == 1, control[2] as f64);
        match (self.params.arithmetic, self.params.clamp) {
            (Kind::Exact, false) => {
                formulas::rough_unclamped(cos_gamma, cos_dgamma, negative, exponent)
            }
            _ => formulas::rough(cos_gamma, cos_dgamma, negative, exponent),
        }
    }

    fn expressions(&self) -> Vec<String> {
        let sines = "sqrt((1 - cos_gamma ** 2) * (1 - cos_dgamma ** 2))";
        let turned = format!("cos_gamma * cos_dgamma + (2 * dgamma_negative - 1) * {sines}");
        let base = format!("exponent / 2 * ({turned} - 1) + 1");
        vec![contract::where_it_faces(&match (self.params.arithmetic, self.params.clamp) {
            (Kind::Exact, false) => format!("min(({base}) ** 2, 1)"),
            _ => format!("{} ** 2", contract::clamped_at_0(&base)),
        })]
    }

    /// With dγ = 0.
    fn at(&self, gamma: f64, n: f64) -> Option<Vec<i64>> {
        let no_deviation = [("cos_dgamma", self.largest_cosine)];
        contract::operands_at(&self.operands, gamma, n, &no_deviation)
    }

    /// Every cos γ and every n, with some settings of dγ of the domain, of both signs.
    fn sweep(&self) -> Sweep {
        let mut deviations: Vec<i64> = SWEPT_DEVIATIONS
            .into_iter()
            .filter(|&degrees| degrees < self.params.deviation)
            .chain([self.params.deviation])
            .map(|degrees| (libm::cos(degrees.to_radians()) / self.ulp).ceil() as i64)
            .map(|raw| raw.clamp(self.operands[1].domain.0, self.operands[1].domain.1))
            .collect();
        deviations.dedup();
        let axes = self.operands.iter().take(4).map(|operand| Axis {
            name: operand.name.clone(),
            values: match operand.name.as_str() {
                "cos_dgamma" => Values::List(deviations.clone()),
                _ => Values::Range(operand.domain.0, operand.domain.1),
            },
        });
        Sweep {
            axes: axes.collect(),
            omits: "values of cos_dgamma between the settings: they are met at random points"
                .to_owned(),
        }
    }

    fn bound(&self) -> Bound {
        bound::bound(&self.params, &self.arithmetic.sine)
    }
}

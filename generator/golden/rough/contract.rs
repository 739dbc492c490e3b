//! The accuracy contract of the device `rough`: the exact formula, the operands at which f is largest, the error bound, and the
//! operands that an exhaustive check visits.

use super::{Derived as _, Kind, RoughArithmetic, bound, keys_of};
use crate::contract::{self as shared, ErrorShare};
use crate::formulas;
use crate::highlight::{Highlight, Reflectance};
use crate::{Axis, Contract, Operand, Sweep, Values};
use glint_config::Config;

/// Deviations dγ in degrees. An exhaustive check visits those entries that are below the largest dγ of the domain, and the
/// largest dγ.
const SWEPT_DEVIATIONS: [f64; 4] = [0.0, 1.0, 5.0, 15.0];

/// Returns the accuracy contract. The control operands are `cos_gamma`, `cos_dgamma`, `exponent` and `dgamma_negative`.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let keys = keys_of(config);
    let (control, products) = (keys.control(), keys.products());
    Box::new(Highlight::new(RoughArithmetic::new(keys), control, products))
}

impl Reflectance for RoughArithmetic {
    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let it = self;
        let (cos_gamma, cos_dgamma) =
            (self.keys.clamped(control[0]), self.keys.clamped(control[1]));
        let sin_sin = it.sin_sin(it.sine.at(cos_gamma), it.sine.at(cos_dgamma));
        let adder_15 = it.adder_15(it.cos_cos(cos_gamma, cos_dgamma), sin_sin, control[3]);
        let scaled = it.scaled(adder_15, control[2], cos_gamma);
        it.f_of(it.squared(scaled, cos_gamma))
    }

    /// Returns the formula's value. The patent's arithmetic is also compared with the clamped formula, so its error shows the
    /// cost of this arithmetic.
    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let cosine = |raw| self.keys.clamped(raw) as f64 * self.keys.ulp();
        let (cos_gamma, cos_dgamma) = (cosine(control[0]), cosine(control[1]));
        let (negative, exponent) = (control[3] == 1, control[2] as f64);
        match (self.keys.arithmetic, self.keys.clamp) {
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
        vec![shared::where_it_faces(&match (self.keys.arithmetic, self.keys.clamp) {
            (Kind::Exact, false) => format!("min(({base}) ** 2, 1)"),
            _ => format!("{} ** 2", shared::clamped_at_0(&base)),
        })]
    }

    /// Returns the operands of γ and n with dγ = 0, or `None` if the domain does not contain `n`. The patent's arithmetic has no
    /// cosine 1.0, so it gets the largest cosine instead.
    fn at(&self, operands: &[Operand], gamma: f64, n: f64) -> Option<Vec<i64>> {
        let no_deviation = [("cos_dgamma", self.keys.largest_cosine())];
        shared::operands_at(operands, gamma, n, &no_deviation)
    }

    /// Returns the operands with the largest cos(γ ± dγ). If dγ is subtracted, γ becomes dγ; if dγ is added, both become 0.
    fn peak(&self, control: &[i64]) -> Option<Vec<i64>> {
        let deviation = if control[3] == 1 { control[1] } else { self.keys.largest_cosine() };
        Some(vec![deviation, deviation, control[2], control[3]])
    }

    /// Visits every cos γ and every n, with a few values of dγ and both signs of dγ.
    fn sweep(&self) -> Option<Sweep> {
        let (low, high) = self.keys.cos_dgamma_domain();
        let mut degrees = SWEPT_DEVIATIONS.to_vec();
        degrees.retain(|&degrees| degrees < self.keys.deviation);
        degrees.push(self.keys.deviation);
        let mut deviations: Vec<i64> = Vec::new();
        for setting in degrees {
            let raw = (libm::cos(setting.to_radians()) / self.keys.ulp()).ceil() as i64;
            deviations.push(raw.clamp(low, high));
        }
        deviations.dedup();
        let axes = self.keys.control().into_iter().map(|operand| Axis {
            values: match operand.name.as_str() {
                "cos_dgamma" => Values::List(deviations.clone()),
                _ => Values::Range(operand.domain.0, operand.domain.1),
            },
            name: operand.name,
        });
        Some(Sweep {
            axes: axes.collect(),
            omits: "values of cos_dgamma between the settings: they are met at random points"
                .to_owned(),
        })
    }

    fn shares(&self) -> Vec<ErrorShare> {
        bound::shares(self)
    }
}

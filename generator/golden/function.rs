//! The golden model and the accuracy contract of the device `function`, which computes y = g(x) for one operand x.
//!
//! A configuration states g as a formula, such as `sqrt(x)`, or as samples of a curve. The device approximates g by a piecewise
//! polynomial: the operand selects a segment, and Horner's rule evaluates the segment's polynomial.

use std::sync::Arc;

use super::device::{self, Formula};
use super::plan::plan_device;
use super::{Contract, Model, Term};
use glint_approximate::{Curve, Piecewise, TargetFunction};
use glint_base::fixed::exp2;
use glint_config::Config;
use glint_formula::{Enclosure, parse};
use glint_keys::function::{FunctionPlan, operand};

/// The domain is cut into this number of pieces; `slope` encloses the slope in each. It is a power of two, so the ends of the
/// pieces are exact.
const PIECES: u32 = 4096;

fn device(config: &Config, planned: &FunctionPlan) -> device::Device {
    plan_device(&[operand(&planned.polynomials)], &planned.plan, &["result_out".to_owned()], config)
}

pub fn model(config: &Config, planned: &FunctionPlan) -> Box<dyn Model> {
    device(config, planned).model()
}

pub fn contract(config: &Config, planned: &FunctionPlan) -> Box<dyn Contract> {
    let function = planned.function.clone();
    device(config, planned).contract(Stated { function, polynomials: planned.polynomials.clone() })
}

/// Returns the value of `formula` at x, or NaN if the formula cannot be parsed or has no value.
pub(super) fn at(formula: &str, x: f64) -> f64 {
    let value = parse(formula).and_then(|it| it.enclose(&[("x", Enclosure::exactly(x))]));
    value.map_or(f64::NAN, Enclosure::middle)
}

/// Returns a proved upper limit of the formula's absolute slope over its domain, from interval derivatives. Returns `None` if the
/// formula may jump or be infinitely steep, or if samples give the function.
pub(super) fn slope(planned: &FunctionPlan) -> Option<f64> {
    let FunctionPlan { function, polynomials: it, .. } = planned;
    let Curve::Formula(formula) = &function.curve else { return None };
    let [low, high] = [it.domain.0, it.domain.1].map(|raw| it.operand.to_f64(raw.into()));
    let mut steepest: f64 = 0.0;
    for piece in 0..PIECES {
        let [from, to] =
            [piece, piece + 1].map(|at| low + (high - low) * f64::from(at) / f64::from(PIECES));
        let (_, slope) = formula.slope("x", Enclosure::between(from, to)).ok()?;
        steepest = steepest.max(slope.low.abs().max(slope.high.abs()));
    }
    Some(steepest)
}

struct Stated {
    function: TargetFunction,
    polynomials: Arc<Piecewise>,
}

impl Formula for Stated {
    /// Returns the exact value, or NaN if the formula or the curve has none there.
    fn exact(&self, operands: &[f64]) -> Vec<f64> {
        let x = operand(&self.polynomials).computed(operands[0]);
        let raw = (x * exp2(self.function.operand.frac)) as i64;
        let value = self.function.limits(raw).map_or(f64::NAN, |limits| limits.middle());
        vec![value * exp2(-(self.function.fraction as i32))]
    }

    /// Appends the raw result and returns true, if the operand is in the domain. An operand that the device limits to its domain
    /// is limited first.
    fn results(&self, operands: &[i64], raw: &mut Vec<i64>) -> bool {
        let (first, last) = self.polynomials.domain;
        let x = operand(&self.polynomials).computed_raw(operands[0]);
        let inside = (first..=last).contains(&x);
        if inside {
            raw.push(self.polynomials.result(x));
        }
        inside
    }

    fn terms(&self, _output: usize) -> Vec<Term> {
        let bound = self.polynomials.bound;
        let rounding = bound.min(0.5);
        vec![
            Term { key: "result.fraction", what: "rounding of the result", units: rounding },
            Term {
                key: "result.error",
                what: "the polynomials and their roundings, at every operand",
                units: bound - rounding,
            },
        ]
    }

    fn limit(&self, _output: usize) -> f64 {
        self.function.error
    }

    fn expressions(&self) -> Vec<String> {
        match &self.function.curve {
            Curve::Formula(formula) => vec![formula.python()],
            Curve::Samples(_) => Vec::new(),
        }
    }

    fn remarks(&self) -> Vec<String> {
        let of_samples = match &self.function.curve {
            Curve::Formula(_) => None,
            Curve::Samples(samples) => Some(format!(
                "The bound is proved at every operand, against the monotone cubic through the {} samples.",
                samples.count()
            )),
        };
        let of_pole = self.function.pole().map(|(from, to)| {
            format!(
                "between x = {from} and {to} the formula has a pole or comes near to a pole: the results at \
                 these two operands are right, and no operand lies between them"
            )
        });
        of_samples.into_iter().chain(of_pole).collect()
    }
}

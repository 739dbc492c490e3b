//! The golden model and the accuracy contract of the device `expression`, which computes formulas of several operands.
//!
//! A configuration states the formulas, such as `a / b` or `sqrt(x*x + y*y)`. The planner ([`glint_plan`]) translates them into a
//! plan and proves a bound on its error against the formulas. The golden model executes the plan in integers.

use std::sync::Arc;

use super::device::{self, Formula};
use super::plan::plan_device;
use super::{ComputedPart, Contract, Model, Term};
use glint_base::fixed::{Format, exp2};
use glint_config::Config;
use glint_formula::{Comparison, Enclosure, RBig};
use glint_plan::{NodeId, Operation, ProvedPlan, StatedOverflow, StatedWidth};

fn device(config: &Config, planned: &ProvedPlan) -> device::Device {
    let results = planned.statement.results.iter();
    let outputs: Vec<String> = results.map(|result| format!("{}_out", result.name)).collect();
    plan_device(&planned.statement.operands, &planned.plan, &outputs, config)
}

pub fn model(config: &Config, planned: &ProvedPlan) -> Box<dyn Model> {
    device(config, planned).model()
}

pub fn contract(config: &Config, planned: &Arc<ProvedPlan>) -> Box<dyn Contract> {
    device(config, planned).contract(ProvedFormulas { planned: planned.clone() })
}

/// Returns two numbers that differ from `value` by a multiple of the format's range: first the one in the format, then the
/// nearest one outside. For s0.7, with the range 2 from −1 to below 1, 1.25 gives −0.75 and 1.25.
fn values_in_format(value: f64, format: Format) -> [f64; 2] {
    let range = exp2(format.width() as i32 - format.frac);
    let least = format.to_f64(format.min_raw());
    let inside = value - range * ((value - least) / range).floor();
    let is_in_upper_half = inside - least > range / 2.0;
    [inside, if is_in_upper_half { inside - range } else { inside + range }]
}

/// The largest number of parts of a formula that is written out as text for benches and programs.
const MOST_PARTS: u32 = 20_000;

struct ProvedFormulas {
    planned: Arc<ProvedPlan>,
}

impl ProvedFormulas {
    fn is_writable(&self) -> bool {
        self.planned.statement.results.iter().all(|result| {
            let promise = result.promise.iter();
            let mut sides = promise.flat_map(|it| [it.left.size(), it.right.size()]);
            result.target().size() <= MOST_PARTS && sides.all(|size| size <= MOST_PARTS)
        })
    }

    /// Returns the values of the operands by name, as intervals of a single number.
    fn enclosed(&self, operands: &[f64]) -> Vec<(&str, Enclosure)> {
        let mut named = Vec::with_capacity(operands.len());
        for (operand, value) in self.planned.statement.operands.iter().zip(operands) {
            named.push((operand.name.as_str(), Enclosure::exactly(operand.computed(*value))));
        }
        named
    }

    /// Returns the values of the operands by name, as rational numbers.
    fn rational(&self, operands: &[f64]) -> Vec<(&str, RBig)> {
        let mut named = Vec::with_capacity(operands.len());
        for (operand, value) in self.planned.statement.operands.iter().zip(operands) {
            let value =
                RBig::try_from(operand.computed(*value)).expect("an operand is a finite number");
            named.push((operand.name.as_str(), value));
        }
        named
    }
}

impl Formula for ProvedFormulas {
    /// Returns NaN for a formula without a value, such as 1 / 0.
    fn exact(&self, operands: &[f64]) -> Vec<f64> {
        let enclosed = self.enclosed(operands);
        let mut values = Vec::with_capacity(self.planned.statement.results.len());
        for result in &self.planned.statement.results {
            let value = result.value(&enclosed, || self.rational(operands));
            values.push(value.map_or(f64::NAN, Enclosure::middle));
        }
        values
    }

    fn right_values(&self, value: f64, output: usize) -> [f64; 2] {
        match &self.planned.statement.results[output].width {
            Some(StatedWidth { format, overflow: StatedOverflow::Wrap }) => {
                values_in_format(value, *format)
            }
            _ => [value; 2],
        }
    }

    fn is_promised(&self, operands: &[f64], output: usize) -> bool {
        let result = &self.planned.statement.results[output];
        result.promise.is_none() || result.is_promised(&self.enclosed(operands)) != Some(false)
    }

    /// Appends the raw results of the plan and returns true, if `operands` are in the domain. An operand that the device limits
    /// to its domain is limited first.
    fn results(&self, operands: &[i64], raw: &mut Vec<i64>) -> bool {
        let mut computed = Vec::with_capacity(operands.len());
        for (operand, raw) in self.planned.statement.operands.iter().zip(operands) {
            let (low, high) = operand.domain;
            let raw = operand.computed_raw(*raw);
            if !(low..=high).contains(&raw) {
                return false;
            }
            computed.push(raw);
        }
        let values = self.planned.plan.values(&computed);
        for result in self.planned.plan.results() {
            raw.push(values[result.0] as i64);
        }
        true
    }

    /// Returns the rounding of the result and all errors before it as separate terms.
    fn terms(&self, output: usize) -> Vec<Term> {
        let bound = self.planned.bounds[output];
        let rounding = bound.min(0.5);
        vec![
            Term { key: "results", what: "rounding of the result", units: rounding },
            Term {
                key: "results",
                what: "the polynomials and the roundings before the result",
                units: bound - rounding,
            },
        ]
    }

    fn parts(&self) -> Vec<ComputedPart> {
        let plan = &self.planned.plan;
        let mut parts = Vec::new();
        for (at, node) in plan.nodes().iter().enumerate() {
            let is_given = match node.operation {
                Operation::Operand(_) => true,
                Operation::Constant { .. } => node.source.is_none(),
                _ => false,
            };
            if is_given {
                continue;
            }
            parts.push(ComputedPart {
                name: node.name.clone(),
                words: plan.words(NodeId(at)),
                format: node.format,
                shares: self.planned.shares.iter().map(|of_result| of_result[at]).collect(),
                cells: plan.cells(NodeId(at)),
                products: plan.products(NodeId(at)),
            });
        }
        parts
    }

    fn limit(&self, output: usize) -> f64 {
        self.planned.statement.results[output].error
    }

    /// Returns the formulas in Python, or nothing if a formula is too long. Each use of a named part repeats the formula of this
    /// part.
    fn expressions(&self) -> Vec<String> {
        if !self.is_writable() {
            return Vec::new();
        }
        let results = self.planned.statement.results.iter();
        results.map(|result| result.target().python()).collect()
    }

    fn conditions(&self) -> Option<Vec<Option<Comparison>>> {
        if !self.is_writable() {
            return None;
        }
        let results = self.planned.statement.results.iter();
        Some(results.map(|result| result.promise.clone()).collect())
    }

    fn wraps(&self) -> bool {
        let wraps = |width: &StatedWidth| matches!(width.overflow, StatedOverflow::Wrap);
        let mut results = self.planned.statement.results.iter();
        results.any(|result| result.width.as_ref().is_some_and(wraps))
    }
}

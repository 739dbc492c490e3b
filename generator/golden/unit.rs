//! The golden model and the accuracy contract of the device `unit`, several functions behind one datapath.
//!
//! The golden model executes the merged plan of all functions, clock by clock. The contract does not know the merged plan: it takes
//! the results from the plan of each function alone, and the exact values from the function's formulas.

use std::sync::Arc;

use super::device::{self, Formula};
use super::plan::plan_device;
use super::{ComputedPart, Contract, Model, Term};
use glint_base::fixed::exp2;
use glint_config::Config;
use glint_formula::Enclosure;
use glint_plan::{ExpressionStatement, NodeId, Operation, UnitPlan};

fn device(config: &Config, planned: &UnitPlan) -> device::Device {
    let outputs: Vec<String> =
        planned.results.iter().map(|(name, _)| format!("{name}_out")).collect();
    plan_device(&planned.operands, &planned.plan, &outputs, config)
}

pub fn model(config: &Config, planned: &UnitPlan) -> Box<dyn Model> {
    device(config, planned).model()
}

pub fn contract(config: &Config, planned: &Arc<UnitPlan>) -> Box<dyn Contract> {
    device(config, planned).contract(FunctionFormulas { planned: planned.clone() })
}

/// The formulas of the functions, with their plans and proved bounds.
struct FunctionFormulas {
    planned: Arc<UnitPlan>,
}

/// The function that an opcode selects, with the raw values of its operands.
struct SelectedFunction<'p> {
    statement: &'p ExpressionStatement,
    opcode: usize,
    raw: Vec<i64>,
}

impl FunctionFormulas {
    /// Returns the selected function. `words` are the raw values of the ports, the opcode first. Returns `None` if no function
    /// has this opcode.
    fn selected(&self, words: &[i64]) -> Option<SelectedFunction<'_>> {
        let (opcode, words) = words.split_first()?;
        let opcode = usize::try_from(*opcode).ok()?;
        let statement = &self.planned.functions.get(opcode)?.planned.statement;
        Some(SelectedFunction { statement, opcode, raw: self.planned.operands_of(opcode, words) })
    }

    fn selected_by_values(&self, ports: &[f64]) -> Option<SelectedFunction<'_>> {
        let words: Vec<i64> = ports.iter().map(|value| *value as i64).collect();
        self.selected(&words)
    }
}

impl SelectedFunction<'_> {
    fn enclosed(&self) -> Vec<(&str, Enclosure)> {
        let limits: Vec<(i64, i64)> = self.raw.iter().map(|raw| (*raw, *raw)).collect();
        self.statement.enclosed_operands(&limits)
    }

    fn is_in_domain(&self) -> bool {
        let mut operands = self.statement.operands.iter().zip(&self.raw);
        operands.all(|(operand, raw)| (operand.domain.0..=operand.domain.1).contains(raw))
    }

    /// Returns whether the function promises anything for result number `output`. A missing result counts as promised: the output
    /// is then 0.
    fn is_promised(&self, output: usize) -> bool {
        let Some(result) = self.statement.results.get(output) else { return true };
        self.is_in_domain() && result.is_promised(&self.enclosed()) != Some(false)
    }
}

impl Formula for FunctionFormulas {
    /// Returns the exact values, in units of the function's last place, because the words at the ports are integers. An opcode
    /// without a function gives 0, and a formula without a value gives NaN.
    fn exact(&self, operands: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.planned.results.len()];
        let Some(selected) = self.selected_by_values(operands) else { return values };
        let enclosed = selected.enclosed();
        for (value, result) in values.iter_mut().zip(&selected.statement.results) {
            let exact =
                result.value(&enclosed, || selected.statement.exact_operands(&selected.raw));
            let exact = exact.map_or(f64::NAN, Enclosure::middle);
            *value = exact * exp2(result.fraction as i32);
        }
        values
    }

    /// Returns the values that count as right. An unsigned word shows a negative value modulo the word's range.
    fn right_values(&self, value: f64, output: usize) -> [f64; 2] {
        let (_, format) = self.planned.results[output];
        match format.signed {
            true => [value; 2],
            false => [value, value + exp2(format.width() as i32)],
        }
    }

    fn is_promised(&self, operands: &[f64], output: usize) -> bool {
        self.selected_by_values(operands).is_none_or(|selected| selected.is_promised(output))
    }

    /// Appends the results of the function's own plan and returns true, if the function promises all results for `operands`.
    fn results(&self, operands: &[i64], raw: &mut Vec<i64>) -> bool {
        let Some(selected) = self.selected(operands) else { return false };
        let outputs = self.planned.results.len();
        if !(0..outputs).all(|output| selected.is_promised(output)) {
            return false;
        }
        let [_, own] = self.planned.both_results(selected.opcode, &operands[1..]);
        raw.extend(own.into_iter().map(|word| word as i64));
        true
    }

    fn terms(&self, output: usize) -> Vec<Term> {
        let functions = self.planned.functions.iter();
        let bounds = functions.filter_map(|function| function.planned.bounds.get(output).copied());
        let bound = bounds.fold(0.0, f64::max);
        let rounding = bound.min(0.5);
        vec![
            Term { key: "functions", what: "rounding of the result", units: rounding },
            Term {
                key: "functions",
                what: "the polynomials and the roundings before the result, of the function with the largest error",
                units: bound - rounding,
            },
        ]
    }

    fn parts(&self) -> Vec<ComputedPart> {
        let plan = &self.planned.plan;
        let mut parts = Vec::new();
        for (at, node) in plan.nodes().iter().enumerate() {
            if matches!(node.operation, Operation::Operand(_) | Operation::Constant { .. }) {
                continue;
            }
            parts.push(ComputedPart {
                name: node.name.clone(),
                words: plan.words(NodeId(at)),
                format: node.format,
                shares: vec![0.0; self.planned.results.len()],
                cells: plan.cells(NodeId(at)),
                products: plan.products(NodeId(at)),
            });
        }
        parts
    }

    fn limit(&self, output: usize) -> f64 {
        let functions = self.planned.functions.iter();
        let results =
            functions.filter_map(|function| function.planned.statement.results.get(output));
        results.map(|result| result.error).fold(0.0, f64::max)
    }

    fn wraps(&self) -> bool {
        self.planned.results.iter().any(|(_, format)| !format.signed)
    }
}

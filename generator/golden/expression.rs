//! The golden model and the accuracy contract of the device `expression`, which computes formulas of several operands.
//!
//! A configuration states the formulas; for example, `a / b` or `sqrt(x*x + y*y)`. The planner ([`glint_plan`]) translates them
//! into a plan, a list of fixed-point operations with formats, and proves a bound on its error against the formulas. The golden
//! model executes the operations of the plan in integers. It takes the plan from the planner, because that proof covers the plan.

use std::sync::Arc;

use super::device::{self, Formula};
use super::frame::{Frame, FrameStep, Slot, State, idle, step_by};
use super::polynomial::Polynomial;
use super::{ComputedPart, Contract, Model, Term};
use glint_base::fixed::{Format, exp2};
use glint_config::Config;
use glint_formula::{Comparison, Enclosure, RBig};
use glint_keys::expression::found;
use glint_plan::{
    ExpressionPlan, NodeId, Operation, PlanStep, ProvedPlan, StatedOverflow, StatedWidth,
};

/// A plan with the places of its values in the state of the model.
struct PlanModel {
    found: Arc<ProvedPlan>,
    operands: Vec<Slot>,
    /// The slot of the register of each node of the plan, or `None` for a node without a register.
    registers: Vec<Option<Slot>>,
}

impl PlanModel {
    fn plan(&self) -> &ExpressionPlan {
        &self.found.plan
    }

    /// Returns the raw value of a node, from the registers before it.
    fn value(&self, id: NodeId, state: &State) -> i128 {
        match self.registers[id.0] {
            Some(slot) => state[slot].into(),
            None => self.computed(id, state),
        }
    }

    /// Returns the raw value that a node has now: its register takes this value at the next clock.
    fn computed(&self, id: NodeId, state: &State) -> i128 {
        let operands: Vec<i64> = self.operands.iter().map(|slot| state[*slot]).collect();
        // Between a product and its register, nodes are computed anew.
        self.plan().value(id, &operands, &|input| self.value(input, state))
    }
}

/// Makes the device: a register for each value that the schedule of the plan holds.
fn device(found: &Arc<ProvedPlan>) -> device::Device {
    let plan = &found.plan;
    let schedule = plan.schedule();
    let mut frame = Frame::default();
    let mut operands = Vec::new();
    for operand in &found.statement.operands {
        operands.push(frame.operand(&operand.name, operand.format));
    }
    let mut registers = Vec::with_capacity(plan.nodes.len());
    let mut polynomials = Vec::with_capacity(plan.nodes.len());
    for (node, is_held) in plan.nodes.iter().zip(&schedule.held) {
        let mut polynomial = None;
        registers.push(match &node.operation {
            Operation::Polynomial(_, approximation) => {
                let it = approximation.polynomials.as_ref().expect("polynomials that are found");
                let name = &node.name;
                let names = [name.clone(), format!("{name}_sum1"), format!("{name}_sum2")];
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                let sums = Polynomial::new(&mut frame, &names, it);
                let q = sums.q();
                polynomial = Some(sums);
                Some(q)
            }
            _ if *is_held => Some(frame.register(&node.name, node.format)),
            _ => None,
        });
        polynomials.push(polynomial);
    }
    for (result, node) in found.statement.results.iter().zip(&plan.results) {
        let register = registers[node.0].expect("a result is held");
        frame.shows(&format!("{}_out", result.name), register);
    }
    let model = Arc::new(PlanModel { found: found.clone(), operands, registers });
    let mut program = vec![idle()];
    for plan_step in &schedule.steps {
        match plan_step {
            PlanStep::Product { held, .. } => program.push(loads(&model, vec![*held])),
            PlanStep::Hold(nodes) => program.push(loads(&model, nodes.clone())),
            PlanStep::Address(polynomial) => {
                program.push(idle());
                let sums = polynomials[polynomial.0].as_ref().expect("a polynomial");
                program.extend(sum_steps(&model, *polynomial, sums));
            }
            // All sums of a polynomial follow its address.
            PlanStep::Sum { .. } => {}
        }
    }
    program.push(idle().valid().end());
    let mut device = frame.device(program);
    for operand in &found.statement.operands {
        device = device.domain(&operand.name, operand.domain.0, operand.domain.1);
    }
    device
}

/// Returns the microinstruction that loads the registers of some nodes.
fn loads(model: &Arc<PlanModel>, nodes: Vec<NodeId>) -> FrameStep {
    step_by(model, move |model, state| {
        let mut loaded = Vec::with_capacity(nodes.len());
        for node in &nodes {
            let slot = model.registers[node.0].expect("a register of a node that is held");
            loaded.push((slot, model.computed(*node, state) as i64));
        }
        for (slot, value) in loaded {
            state[slot] = value;
        }
    })
}

/// Returns the microinstructions of a polynomial's sums.
fn sum_steps(model: &Arc<PlanModel>, id: NodeId, sums: &Polynomial) -> Vec<FrameStep> {
    let inputs = model.plan().node(id).operation.inputs();
    let reader = model.clone();
    let operand = move |state: &State| reader.value(inputs[0], state) as i64;
    sums.steps(operand).map(super::frame::step).collect()
}

/// Returns the golden model of the device `expression` for a configuration.
///
/// # Panics
/// Panics if the check of the schema has not accepted the configuration. The caller must check it first.
pub fn model(config: &Config) -> Box<dyn Model> {
    device(&found(config).expect("a configuration that is checked")).model()
}

/// Returns the accuracy contract of the device `expression` for a configuration.
///
/// # Panics
/// Panics as [`model`] does.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let found = found(config).expect("a configuration that is checked");
    device(&found).contract(ProvedFormulas { found })
}

/// Returns the two numbers nearest to a format that differ from a value by a multiple of the format's range. The first is in the
/// format. For example, 1.25 gives −0.75 and 1.25 for s0.7, whose range is 2.
fn values_in_format(value: f64, format: Format) -> [f64; 2] {
    let range = exp2(format.width() as i32 - format.frac);
    let least = format.to_f64(format.min_raw());
    let inside = value - range * ((value - least) / range).floor();
    let is_in_upper_half = inside - least > range / 2.0;
    [inside, if is_in_upper_half { inside - range } else { inside + range }]
}

/// The formulas with the bounds that were proved.
struct ProvedFormulas {
    found: Arc<ProvedPlan>,
}

impl ProvedFormulas {
    /// Returns the operands by their names.
    fn enclosed(&self, operands: &[f64]) -> Vec<(&str, Enclosure)> {
        let mut named = Vec::with_capacity(operands.len());
        for (operand, value) in self.found.statement.operands.iter().zip(operands) {
            named.push((operand.name.as_str(), Enclosure::exactly(*value)));
        }
        named
    }

    /// Returns the operands by their names, as rational numbers.
    fn rational(&self, operands: &[f64]) -> Vec<(&str, RBig)> {
        let mut named = Vec::with_capacity(operands.len());
        for (operand, value) in self.found.statement.operands.iter().zip(operands) {
            let value = RBig::try_from(*value).expect("an operand is a finite number");
            named.push((operand.name.as_str(), value));
        }
        named
    }
}

impl Formula for ProvedFormulas {
    /// Returns the values of the formulas; no number where one has no value.
    fn exact(&self, operands: &[f64]) -> Vec<f64> {
        let enclosed = self.enclosed(operands);
        let mut values = Vec::with_capacity(self.found.statement.results.len());
        for result in &self.found.statement.results {
            let value = result.value(&enclosed, || self.rational(operands));
            values.push(value.map_or(f64::NAN, Enclosure::middle));
        }
        values
    }

    fn right_values(&self, value: f64, output: usize) -> [f64; 2] {
        match &self.found.statement.results[output].width {
            Some(StatedWidth { format, overflow: StatedOverflow::Wrap }) => {
                values_in_format(value, *format)
            }
            _ => [value; 2],
        }
    }

    fn is_promised(&self, operands: &[f64], output: usize) -> bool {
        let result = &self.found.statement.results[output];
        result.promise.is_none() || result.is_promised(&self.enclosed(operands)) != Some(false)
    }

    /// Appends the results within the domain. No value leaves its format there, which was proved.
    fn results(&self, operands: &[i64], raw: &mut Vec<i64>) -> bool {
        let domain = self.found.statement.domain();
        let is_inside = |(raw, (low, high)): (&i64, &(i64, i64))| (low..=high).contains(&raw);
        if !operands.iter().zip(&domain).all(is_inside) {
            return false;
        }
        let values = self.found.plan.values(operands);
        for result in &self.found.plan.results {
            raw.push(values[result.0] as i64);
        }
        true
    }

    /// Returns the terms of the result whose bound is the largest part of the error that it may have.
    fn terms(&self) -> Vec<Term> {
        let bound = self.found.bounds.iter().copied().fold(0.0, f64::max);
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

    /// Returns the operations of the plan, without operands and exact constants.
    fn parts(&self) -> Vec<ComputedPart> {
        let plan = &self.found.plan;
        let mut parts = Vec::new();
        for (at, node) in plan.nodes.iter().enumerate() {
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
                shares: self.found.shares.iter().map(|of_result| of_result[at]).collect(),
                cells: plan.cells(NodeId(at)),
                products: plan.products(NodeId(at)),
            });
        }
        parts
    }

    fn output_bound(&self, output: usize) -> Option<f64> {
        Some(self.found.bounds[output])
    }

    fn limit(&self) -> f64 {
        self.found.statement.results.iter().map(|result| result.error).fold(0.0, f64::max)
    }

    fn expressions(&self) -> Vec<String> {
        let results = self.found.statement.results.iter();
        results.map(|result| result.target().python()).collect()
    }

    fn conditions(&self) -> Option<Vec<Option<Comparison>>> {
        let results = self.found.statement.results.iter();
        Some(results.map(|result| result.promise.clone()).collect())
    }

    fn wraps(&self) -> bool {
        let wraps = |width: &StatedWidth| matches!(width.overflow, StatedOverflow::Wrap);
        let mut results = self.found.statement.results.iter();
        results.any(|result| result.width.as_ref().is_some_and(wraps))
    }
}

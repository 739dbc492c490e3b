//! The golden model of a plan, which is a list of fixed-point operations ([`glint_plan`]).
//!
//! The devices `function` and `expression` use this model. The model executes the operations in integers, with a register for
//! each value that the schedule of the plan stores. The model takes the plan from the planner, because a proof covers the plan:
//! the proof compares the plan's results with the formulas.

use std::sync::Arc;

use super::device;
use super::frame::{Frame, FrameStep, Slot, State, idle, step_by};
use super::polynomial::Polynomial;
use glint_approximate::Outside;
use glint_plan::{ExpressionPlan, NodeId, Operation, PlanStep, StatedOperand};

/// A plan with the places of its values in the state of the model.
struct PlanModel {
    plan: ExpressionPlan,
    operands: Vec<Slot>,
    /// The slot of the register of each node of the plan, or `None` for a node without a register.
    registers: Vec<Option<Slot>>,
}

impl PlanModel {
    /// Returns the raw value of a node: the value in its register, or the computed value of a node without a register.
    fn value(&self, id: NodeId, state: &State) -> i128 {
        match self.registers[id.0] {
            Some(slot) => state[slot].into(),
            None => self.computed(id, state),
        }
    }

    /// Returns the raw value that a node has now, computed from its inputs. A register of the node takes this value at the next
    /// edge.
    fn computed(&self, id: NodeId, state: &State) -> i128 {
        let operands: Vec<i64> = self.operands.iter().map(|slot| state[*slot]).collect();
        // Between a product and its register, nodes are computed anew.
        self.plan.value(id, &operands, &|input| self.value(input, state))
    }
}

/// Makes the device of a plan: a register for each value that the schedule of the plan stores. Result number k of the plan goes
/// to the port with name number k of `outputs`. The function panics if the polynomials of a function are not known yet.
pub(super) fn plan_device(
    operands: &[StatedOperand],
    plan: &ExpressionPlan,
    outputs: &[String],
) -> device::Device {
    let schedule = plan.schedule();
    let mut frame = Frame::default();
    let mut slots = Vec::new();
    for StatedOperand { name, format, domain, outside } in operands {
        slots.push(match outside {
            Outside::Clamp => frame.clamped(name, *format, domain.0, domain.1),
            Outside::Wrap | Outside::Anything => frame.operand(name, *format),
        });
    }
    let mut registers = Vec::with_capacity(plan.nodes.len());
    let mut polynomials = Vec::with_capacity(plan.nodes.len());
    for (at, (node, is_held)) in plan.nodes.iter().zip(&schedule.held).enumerate() {
        let mut polynomial = None;
        registers.push(match &node.operation {
            Operation::Polynomial(_, approximation) => {
                let it = approximation.polynomials.as_ref().expect("polynomials that are found");
                let names = plan.sum_names(NodeId(at));
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
    for (name, node) in outputs.iter().zip(&plan.results) {
        let register = registers[node.0].expect("a result is held");
        frame.shows(name, register);
    }
    let model = Arc::new(PlanModel { plan: plan.clone(), operands: slots, registers });
    let mut program = vec![idle()];
    for plan_step in &schedule.steps {
        match plan_step {
            PlanStep::Product { held, .. } => program.push(loads(&model, vec![*held])),
            PlanStep::Hold(nodes) => program.push(loads(&model, nodes.clone())),
            PlanStep::Address(_) => program.push(idle()),
            PlanStep::Sum { polynomial, coefficient } => {
                let sums = polynomials[polynomial.0].as_ref().expect("a polynomial");
                program.push(sum_step(&model, *polynomial, sums, *coefficient));
            }
        }
    }
    program.push(idle().valid().end());
    let mut device = frame.device(program);
    for operand in operands {
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

/// Returns the microinstruction that adds coefficient number `coefficient` of the polynomial at node `id`, for Horner's rule.
fn sum_step(
    model: &Arc<PlanModel>,
    id: NodeId,
    sums: &Polynomial,
    coefficient: usize,
) -> FrameStep {
    let inputs = model.plan.node(id).operation.inputs();
    let reader = model.clone();
    let operand = move |state: &State| reader.value(inputs[0], state) as i64;
    super::frame::step(sums.step(coefficient, operand))
}

//! The golden model of a plan, a list of fixed-point operations ([`glint_plan`]), for the devices `function`, `expression` and
//! `unit`.
//!
//! The model executes the operations in integers, with a register for each value that the schedule of the plan stores. It takes
//! the plan from the planner, because a proof compares the plan's results with the formulas.

use std::sync::Arc;

use super::device;
use super::frame::{Frame, FrameStep, Slot, State, idle, step_by};
use super::polynomial::Polynomial;
use glint_approximate::Outside;
use glint_config::{Config, Shared};
use glint_plan::{ExpressionPlan, NodeId, Operation, PlanStep, StatedOperand, StepWork};

struct PlanModel {
    plan: ExpressionPlan,
    operands: Vec<Slot>,
    /// The slot of the register of each node that has one.
    registers: Vec<Option<Slot>>,
}

/// The nodes that the hardware computes between two edges, from registers, to get the values of certain nodes.
struct ClockCone {
    /// The nodes in the plan's order, so each reads registers or nodes before it.
    nodes: Vec<NodeId>,
    /// For each node of the plan, its place in `nodes`.
    places: Vec<Option<usize>>,
}

impl ClockCone {
    /// Collects the nodes on which `ends` depend, back to nodes with a register. A node of `ends` is included even if it has a
    /// register.
    fn new(model: &PlanModel, ends: &[NodeId]) -> Self {
        let count = model.plan.nodes().len();
        let mut needed = vec![false; count];
        for end in ends {
            needed[end.0] = true;
        }
        for at in (0..count).rev() {
            if !needed[at] {
                continue;
            }
            for input in model.plan.nodes()[at].operation.inputs() {
                needed[input.0] |= model.registers[input.0].is_none();
            }
        }
        let mut nodes = Vec::new();
        let mut places = vec![None; count];
        for at in 0..count {
            if needed[at] {
                places[at] = Some(nodes.len());
                nodes.push(NodeId(at));
            }
        }
        Self { nodes, places }
    }

    /// Returns the raw values of the nodes `ends` before the next edge, which loads these values into the nodes' registers.
    fn values(&self, model: &PlanModel, ends: &[NodeId], state: &State) -> Vec<i64> {
        let operands: Vec<i64> = model.operands.iter().map(|slot| state[*slot]).collect();
        let mut values: Vec<i128> = Vec::with_capacity(self.nodes.len());
        for id in &self.nodes {
            let value = model.plan.value(*id, &operands, &|input| match model.registers[input.0] {
                Some(slot) => state[slot].into(),
                None => values[self.place(input)],
            });
            values.push(value);
        }
        ends.iter().map(|end| values[self.place(*end)] as i64).collect()
    }

    fn place(&self, id: NodeId) -> usize {
        self.places[id.0].expect("a node of the cone")
    }
}

/// Makes the device of `plan`, with the architecture that `config` states. Result number k of the plan goes to the port
/// `outputs[k]`. Panics if a function's polynomials have not been found yet.
pub(super) fn plan_device(
    operands: &[StatedOperand],
    plan: &ExpressionPlan,
    outputs: &[String],
    config: &Config,
) -> device::Device {
    let is_pipelined = Shared::of(config).architecture == "pipelined";
    let schedule = plan.schedule(is_pipelined);
    let mut frame = Frame::default();
    let mut slots = Vec::new();
    for StatedOperand { name, format, domain, outside, .. } in operands {
        slots.push(match outside {
            Outside::Clamp => frame.clamped(name, *format, domain.0, domain.1),
            Outside::Wrap | Outside::Anything => frame.operand(name, *format),
        });
    }
    let mut registers: Vec<Option<Slot>> = Vec::with_capacity(plan.nodes().len());
    let mut polynomials: Vec<Option<Polynomial>> = Vec::with_capacity(plan.nodes().len());
    for (at, (node, is_held)) in plan.nodes().iter().zip(&schedule.held).enumerate() {
        let mut polynomial = None;
        registers.push(match &node.operation {
            Operation::Polynomial(..) if *is_held && schedule.table_owners[at] != NodeId(at) => {
                let first = polynomials[schedule.table_owners[at].0].as_ref();
                let sums = first.expect("an earlier polynomial").sharing(&mut frame, &node.name);
                let q = sums.q();
                polynomial = Some(sums);
                Some(q)
            }
            Operation::Polynomial(_, approximation) if *is_held => {
                let it = approximation.polynomials.as_ref().expect("polynomials that are found");
                if it.is_writable {
                    frame.write_port();
                }
                let names = plan.sum_names(NodeId(at));
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                let mut sums = Polynomial::new(&mut frame, &names, it);
                if schedule.is_coefficient_held[at] {
                    sums = sums.with_highest(&mut frame, &plan.highest_name(NodeId(at)));
                }
                let q = sums.q();
                polynomial = Some(sums);
                Some(q)
            }
            _ if *is_held => Some(match schedule.register_owners[at] {
                owner if owner.0 < at => registers[owner.0].expect("the register of an owner"),
                _ => frame.register(&node.name, node.format),
            }),
            _ => None,
        });
        polynomials.push(polynomial);
    }
    for (name, node) in outputs.iter().zip(plan.results()) {
        let register = registers[node.0].expect("a result is held");
        frame.shows(name, register);
    }
    let model = Arc::new(PlanModel { plan: plan.clone(), operands: slots, registers });
    let mut program = vec![idle()];
    for plan_step in &schedule.steps {
        program.push(microinstruction(&model, &polynomials, plan_step));
    }
    program.push(idle().valid().end());
    for (at, microinstruction) in program.iter_mut().enumerate() {
        if let Some(targets) = schedule.dispatch(at) {
            // Operand 0 of a unit is the opcode.
            *microinstruction = microinstruction.clone().dispatch(model.operands[0], targets);
        }
    }
    let mut device = frame.device(program);
    for operand in operands {
        device = device.domain(&operand.name, operand.domain.0, operand.domain.1);
        if operand.outside == Outside::Clamp {
            device = device.limits(&operand.name);
        }
    }
    device
}

/// Loads a register of a polynomial: a partial sum, or the highest coefficient.
type TableLoad = Box<dyn Fn(&mut State) + Send + Sync>;

/// Returns the microinstruction of `plan_step`. Its registers load the values that their nodes have before the edge.
fn microinstruction(
    model: &Arc<PlanModel>,
    polynomials: &[Option<Polynomial>],
    plan_step: &PlanStep,
) -> FrameStep {
    let mut nodes = plan_step.loads.clone();
    let mut of_tables: Vec<TableLoad> = Vec::new();
    let sums_of = |id: NodeId| polynomials[id.0].as_ref().expect("a polynomial");
    match &plan_step.work {
        Some(StepWork::Product { held, .. }) => nodes.push(*held),
        Some(StepWork::Sum { polynomial, coefficient }) => {
            let operand = operand_of(model, *polynomial);
            of_tables.push(Box::new(sums_of(*polynomial).step(*coefficient, operand)));
        }
        Some(StepWork::Address(_)) | None => {}
    }
    for polynomial in &plan_step.coefficients {
        let operand = operand_of(model, *polynomial);
        of_tables.push(Box::new(sums_of(*polynomial).load_highest(operand)));
    }
    if nodes.is_empty() && of_tables.is_empty() {
        return idle();
    }
    let cone = ClockCone::new(model, &nodes);
    step_by(model, move |model, state| {
        let values = cone.values(model, &nodes, state);
        for load in &of_tables {
            load(state);
        }
        for (node, value) in nodes.iter().zip(values) {
            let slot = model.registers[node.0].expect("a register of a node that is held");
            state[slot] = value;
        }
    })
}

/// Returns a function that reads the operand of the polynomial at node `id` from the model's state.
fn operand_of(model: &Arc<PlanModel>, id: NodeId) -> impl Fn(&State) -> i64 + Send + Sync + use<> {
    let input = model.plan.node(id).operation.inputs()[0];
    let cone = ClockCone::new(model, &[input]);
    let reader = model.clone();
    move |state: &State| match reader.registers[input.0] {
        Some(slot) => state[slot],
        None => cone.values(&reader, &[input], state)[0],
    }
}

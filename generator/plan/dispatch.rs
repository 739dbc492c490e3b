//! Lets each function of a unit skip the microinstructions that it does not need.
//!
//! A function needs the microinstructions that load the registers on which its results depend, given its opcode. After each of
//! these, the function continues with the next one that it needs. Where functions continue differently, the shared microprogram
//! dispatches by the opcode: for example, a reciprocal skips the steps that prepare the quotient of an arctangent. A skipped
//! microinstruction leaves registers with earlier values, on which no result of the function depends.

use super::node::{NodeId, Operation};
use super::placement::{PlanSchedule, PlanStep, StepWork};
use super::plan::ExpressionPlan;

/// Returns for each microinstruction of a unit the microinstructions that follow it, one for each opcode, as
/// [`PlanSchedule::dispatches`] numbers them. An entry is `None` if the next microinstruction follows for every opcode that
/// executes this one.
pub(super) fn dispatches(
    plan: &ExpressionPlan,
    schedule: &PlanSchedule,
) -> Vec<Option<Vec<usize>>> {
    let opcode = plan.nodes().iter().find(|node| matches!(node.operation, Operation::Operand(0)));
    let bits = opcode.expect("the opcode of a unit").format.width();
    let last = schedule.steps.len() + 1;
    let mut of_opcodes = Vec::new();
    for opcode in 0..1 << bits {
        of_opcodes.push(following(&executed_steps(plan, schedule, opcode)));
    }
    let mut dispatches = Vec::with_capacity(last);
    for at in 0..last {
        let following: Vec<Option<usize>> = of_opcodes.iter().map(|it| it[at]).collect();
        let mut stated = following.iter().flatten();
        let first = stated.next().copied();
        let is_next = first.is_none_or(|first| first == at + 1) && stated.all(|it| *it == at + 1);
        // An opcode that does not execute this microinstruction may continue anywhere.
        let anywhere = first.unwrap_or(at + 1);
        let targets = || following.iter().map(|it| it.unwrap_or(anywhere)).collect();
        dispatches.push((!is_next).then(targets));
    }
    dispatches
}

/// Returns for each microinstruction, except the last, the number of the microinstruction that follows, or `None` if it is not
/// executed. Entry i of `executed` belongs to microinstruction i + 1, which is step i of the schedule.
fn following(executed: &[bool]) -> Vec<Option<usize>> {
    let last = executed.len() + 1;
    let mut following = vec![None; last];
    let mut before = 0;
    for (step, is_executed) in executed.iter().enumerate() {
        if *is_executed {
            following[before] = Some(step + 1);
            before = step + 1;
        }
    }
    following[before] = Some(last);
    following
}

/// Returns for each step of the schedule whether a computation with this opcode executes it.
fn executed_steps(plan: &ExpressionPlan, schedule: &PlanSchedule, opcode: i64) -> Vec<bool> {
    let function = FunctionNodes::new(plan, schedule, opcode);
    let mut executed: Vec<bool> =
        schedule.steps.iter().map(|step| function.needs_step(step)).collect();
    // A table gives its word one clock after it got the address. The golden model has no such clock, so the rule also holds for
    // tables that the function does not need.
    while let Some(at) = function.early_read(&executed) {
        executed[at - 1] = true;
    }
    executed
}

/// The nodes on which the results of a unit depend if the opcode has a known value.
struct FunctionNodes<'p> {
    plan: &'p ExpressionPlan,
    schedule: &'p PlanSchedule,
    /// The value of each node that depends on the opcode alone, without a register in between.
    constants: Vec<Option<i128>>,
    is_needed: Vec<bool>,
}

impl<'p> FunctionNodes<'p> {
    fn new(plan: &'p ExpressionPlan, schedule: &'p PlanSchedule, opcode: i64) -> Self {
        let count = plan.nodes().len();
        let constants = Vec::with_capacity(count);
        let mut function = Self { plan, schedule, constants, is_needed: vec![false; count] };
        for at in 0..count {
            let constant = function.constant(NodeId(at), opcode);
            function.constants.push(constant);
        }
        for result in plan.results() {
            function.is_needed[result.0] = true;
        }
        for at in (0..count).rev() {
            if function.is_needed[at] {
                for input in function.inputs(NodeId(at)) {
                    function.is_needed[input.0] = true;
                }
            }
        }
        function
    }

    /// Returns the value of a node if it depends on the opcode alone. All nodes before it have their entries in `constants`.
    fn constant(&self, id: NodeId, opcode: i64) -> Option<i128> {
        let operation = &self.plan.node(id).operation;
        let can_depend_on_opcode = match operation {
            Operation::Operand(number) => *number == 0,
            Operation::Polynomial(..) | Operation::Normalise { .. } | Operation::Places(_) => false,
            _ => true,
        };
        let inputs = self.inputs(id);
        let are_constant = inputs.iter().all(|input| self.constants[input.0].is_some());
        if self.schedule.held[id.0] || !can_depend_on_opcode || !are_constant {
            return None;
        }
        if let [chosen] = inputs[..]
            && let Operation::Choose { .. } = operation
        {
            let places = self.plan.node(id).format.frac - self.plan.node(chosen).format.frac;
            return self.constants[chosen.0].map(|raw| raw << places);
        }
        let known = |input: NodeId| self.constants[input.0].expect("a constant");
        Some(self.plan.value(id, &[opcode], &known))
    }

    /// Returns the nodes that decide the value of a node. A choice by the opcode depends on the case that it chooses.
    fn inputs(&self, id: NodeId) -> Vec<NodeId> {
        if self.constants.get(id.0).is_some_and(Option::is_some) {
            return Vec::new();
        }
        let operation = &self.plan.node(id).operation;
        if let Operation::Choose { condition, cases } = operation
            && let Some(chosen) = self.constants[condition.0]
        {
            return vec![cases[chosen as usize]];
        }
        operation.inputs()
    }

    /// Returns whether a step loads a register on which the results of the function depend.
    fn needs_step(&self, step: &PlanStep) -> bool {
        let of_work = match step.work {
            Some(StepWork::Product { held: node, .. } | StepWork::Sum { polynomial: node, .. }) => {
                Some(node)
            }
            Some(StepWork::Address(_)) | None => None,
        };
        let mut loaded = step.loads.iter().chain(&step.coefficients).chain(&of_work);
        loaded.any(|node| self.is_needed[node.0])
    }

    /// Returns the first executed step that would read a table too early. The executed step before it changes the table's
    /// address, or lets another polynomial address the table.
    fn early_read(&self, executed: &[bool]) -> Option<usize> {
        (0..executed.len()).filter(|at| executed[*at]).find(|&at| {
            let before = executed[..at].iter().rposition(|is_executed| *is_executed);
            let addressing = before.map_or(0, |step| step + 1);
            self.schedule.steps[at].tables_read().into_iter().any(|polynomial| {
                let address = self.plan.node(polynomial).operation.inputs()[0];
                let changes =
                    before.is_some() && self.last_load(address, &executed[..at]) == before;
                let owner = self.schedule.table_owners[polynomial.0];
                let is_addressed = self.schedule.addressing(owner, addressing) == Some(polynomial);
                // Operands in one register need no choice between them.
                changes || !is_addressed && self.schedule.register_sharers(address).len() == 1
            })
        })
    }

    /// Returns the last executed step that loads a register on which the value of `id` depends. `executed` has an entry for each step
    /// that counts.
    fn last_load(&self, id: NodeId, executed: &[bool]) -> Option<usize> {
        if self.schedule.held[id.0] {
            let sharers = self.schedule.register_sharers(id);
            let loads = |step: usize| {
                let step = &self.schedule.steps[step];
                sharers.iter().any(|sharer| step.loads_register(*sharer))
            };
            return (0..executed.len()).rev().find(|step| executed[*step] && loads(*step));
        }
        self.inputs(id).into_iter().filter_map(|input| self.last_load(input, executed)).max()
    }
}

impl PlanStep {
    fn loads_register(&self, id: NodeId) -> bool {
        let is_worked_out = match self.work {
            Some(StepWork::Product { held, .. }) => held == id,
            Some(StepWork::Sum { polynomial, coefficient: 0 }) => polynomial == id,
            _ => false,
        };
        is_worked_out || self.loads.contains(&id)
    }
}

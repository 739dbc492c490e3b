//! Places the operations of a plan in the microinstructions of a microprogram.

use super::node::{NodeId, Operation};
use super::plan::ExpressionPlan;

/// The operation of the multiplier or of a table in a microinstruction.
#[derive(Clone, Debug, PartialEq)]
pub enum StepWork {
    /// The multiplier computes a product, and a register loads the product or a value that follows from it.
    Product {
        /// The node of the product.
        product: NodeId,
        /// The node whose register is loaded: the product itself, or the product after it was scaled or shortened.
        held: NodeId,
    },
    /// The table of this node's polynomial gets its address, and there is nothing else to do.
    Address(NodeId),
    /// The multiplier and an adder compute one partial sum of Horner's rule.
    Sum {
        /// The node of the polynomial.
        polynomial: NodeId,
        /// The index of the coefficient that is added; 0 is the constant coefficient.
        coefficient: usize,
    },
}

/// One microinstruction of a plan's microprogram.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanStep {
    pub work: Option<StepWork>,
    /// The nodes whose registers load their values, besides those of `work`.
    pub loads: Vec<NodeId>,
    /// The polynomials whose highest coefficient a register loads from the table.
    pub coefficients: Vec<NodeId>,
}

/// The microprogram of a plan, with the nodes that have registers.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanSchedule {
    /// For each node, whether it has a register.
    pub held: Vec<bool>,
    /// For each node, whether it is a polynomial with a register for the highest coefficient. A block memory gives a coefficient too
    /// late in the clock for the multiplier.
    pub is_coefficient_held: Vec<bool>,
    /// For each node of a sequential core that is a polynomial, the first polynomial with the same table. Polynomials with the same
    /// table share its memory, the adders, and all registers except the one with the value. Other nodes have themselves.
    pub table_owners: Vec<NodeId>,
    /// For each node, the node whose register also stores its value, at another time: for the operands of polynomials with the same
    /// table, the operand of the first one. Other nodes have themselves.
    pub register_owners: Vec<NodeId>,
    /// The microinstructions in the order of execution.
    pub steps: Vec<PlanStep>,
    /// For a sequential unit, the microinstructions that follow each microinstruction: `None` if the next one follows for every
    /// opcode, or a number for each value of the opcode. Number 0 waits for `start`, number k executes `steps[k - 1]`, and the last
    /// number, `steps.len() + 1`, shows the results. The list is empty if the plan is no unit.
    pub dispatches: Vec<Option<Vec<usize>>>,
}

impl PlanSchedule {
    /// Returns the polynomials that share the table of `owner`, the first such polynomial.
    pub fn table_sharers(&self, owner: NodeId) -> Vec<NodeId> {
        let mut sharers = Vec::new();
        for (at, other) in self.table_owners.iter().enumerate() {
            if *other == owner {
                sharers.push(NodeId(at));
            }
        }
        sharers
    }

    /// Returns the polynomial whose operand addresses the table of `owner` in microinstruction number `at`. A partial sum of this
    /// microinstruction needs the offset of its own operand. Otherwise the next polynomial that reads the table gives the
    /// address, because the word follows one clock later. Number 0 waits for `start`, and number k executes `steps[k - 1]`.
    pub fn addressing(&self, owner: NodeId, at: usize) -> Option<NodeId> {
        let is_own = |polynomial: &NodeId| self.table_owners[polynomial.0] == owner;
        let present = at.checked_sub(1).and_then(|step| self.steps.get(step)?.polynomial_summed());
        let following = self.steps.get(at..)?.iter();
        let mut read = following.flat_map(PlanStep::tables_read);
        present.filter(is_own).or_else(|| read.find(is_own))
    }

    /// Returns the nodes whose values the register of `node` stores: `node`, and each node that shares its register, in their order.
    pub fn register_sharers(&self, node: NodeId) -> Vec<NodeId> {
        let owner = self.register_owners[node.0];
        let nodes = (0..self.register_owners.len()).map(NodeId);
        nodes.filter(|it| self.register_owners[it.0] == owner).collect()
    }

    /// Returns the numbers of the microinstructions that follow microinstruction `at`, for each opcode, if they differ.
    pub fn dispatch(&self, at: usize) -> Option<&[usize]> {
        self.dispatches.get(at)?.as_deref()
    }
}

impl PlanStep {
    /// Returns the polynomials whose tables the step reads.
    pub(super) fn tables_read(&self) -> Vec<NodeId> {
        let mut read = self.coefficients.clone();
        read.extend(self.polynomial_summed());
        read
    }

    fn polynomial_summed(&self) -> Option<NodeId> {
        match self.work {
            Some(StepWork::Sum { polynomial, .. }) => Some(polynomial),
            _ => None,
        }
    }
}

/// Places the operations of a plan in microinstructions, one operation after the other.
#[derive(Clone)]
pub(super) struct StepPlacement<'p> {
    pub(super) plan: &'p ExpressionPlan,
    /// For each node, the node whose register stores its value.
    pub(super) targets: &'p [NodeId],
    pub(super) is_pipelined: bool,
    /// For each node, the first microinstruction that can read its value. Operands are there before the first one.
    pub(super) ready: Vec<usize>,
    /// For each node, whether a microinstruction loads its register.
    is_placed: Vec<bool>,
    /// The first microinstruction in which the multiplier is free.
    next_work: usize,
    /// For each owner of a table, the first microinstruction in which another polynomial can read the table.
    table_free: Vec<usize>,
    /// For each owner of a register, the first microinstruction that can load the value of another node.
    register_free: Vec<usize>,
    pub(super) schedule: PlanSchedule,
}

impl<'p> StepPlacement<'p> {
    pub(super) fn new(
        plan: &'p ExpressionPlan,
        targets: &'p [NodeId],
        schedule: PlanSchedule,
        is_pipelined: bool,
    ) -> Self {
        let count = plan.nodes().len();
        Self {
            plan,
            targets,
            is_pipelined,
            ready: vec![0; count],
            is_placed: vec![false; count],
            next_work: 0,
            table_free: vec![0; count],
            register_free: vec![0; count],
            schedule,
        }
    }

    /// Places the operation of `node`. All nodes before it must be placed.
    pub(super) fn place(&mut self, node: NodeId) {
        let plan = self.plan;
        match plan.node(node).operation {
            Operation::Multiply(..) => {
                let held = self.targets[node.0];
                let at = self.free_work(self.inputs_ready(node));
                self.step(at).work = Some(StepWork::Product { product: node, held });
                self.loaded(held, at);
            }
            Operation::Places(normalised) => {
                let at = self.free(self.inputs_ready(normalised));
                let word = self.targets[normalised.0];
                let ready = self.inputs_ready(normalised);
                match self.schedule.held[word.0] {
                    true => self.load(word, at),
                    false => self.ready[normalised.0] = ready,
                }
                match self.schedule.held[node.0] {
                    true => self.load(node, at),
                    false => self.ready[node.0] = ready,
                }
            }
            Operation::Polynomial(operand, _) => self.place_polynomial(node, operand),
            _ if self.is_placed[node.0] => {}
            // The node with the shift places the normalised word, too.
            Operation::Normalise { .. } => {}
            _ if self.schedule.held[node.0] && !self.is_last(node) => {
                let register = self.schedule.register_owners[node.0];
                let ready = self.inputs_ready(node).max(self.register_free[register.0]);
                let at = self.free(ready);
                self.load(node, at);
            }
            _ => self.ready[node.0] = self.inputs_ready(node),
        }
    }

    /// Returns whether only the outputs read the node. A pipeline loads all such nodes in its last microinstruction.
    fn is_last(&self, node: NodeId) -> bool {
        let mut others = self.plan.nodes().iter();
        let has_reader = others.any(|other| other.operation.inputs().contains(&node));
        self.is_pipelined && !has_reader
    }

    /// Loads the results that have no register yet.
    pub(super) fn place_results(&mut self) {
        let results = self.plan.results().to_vec();
        let end = self.schedule.steps.len();
        for result in results {
            if !self.is_placed[result.0] {
                self.load(result, end);
            }
        }
    }

    fn place_polynomial(&mut self, node: NodeId, operand: NodeId) {
        let Operation::Polynomial(_, approximation) = &self.plan.node(node).operation else {
            return;
        };
        let degree = approximation.polynomials.as_ref().expect("polynomials").degree();
        // The operands address a table in the clock before the first microinstruction, and a register one clock after it is loaded.
        let address = self.ready[operand.0];
        let mut at = match address {
            _ if self.is_pipelined => self.schedule.steps.len() + usize::from(self.has_steps()),
            0 => 0,
            _ => address + 1,
        };
        let owner = self.schedule.table_owners[node.0];
        at = at.max(self.table_free[owner.0]);
        for gap in self.schedule.steps.len()..at {
            self.step(gap).work = Some(StepWork::Address(node));
        }
        if self.schedule.is_coefficient_held[node.0] {
            self.step(at).coefficients.push(node);
            at += 1;
        }
        for coefficient in (0..degree.max(1)).rev() {
            at = self.free_work(at);
            self.step(at).work = Some(StepWork::Sum { polynomial: node, coefficient });
        }
        // Another operand addresses the table one clock after the last sum.
        self.table_free[owner.0] = at + 2;
        self.register_free[self.schedule.register_owners[operand.0].0] = at;
        self.loaded(node, at);
    }

    fn has_steps(&self) -> bool {
        !self.schedule.steps.is_empty()
    }

    /// Returns the first microinstruction that can read all inputs of a node.
    fn inputs_ready(&self, node: NodeId) -> usize {
        let inputs = self.plan.node(node).operation.hardware_inputs();
        inputs.into_iter().map(|input| self.ready[input.0]).max().unwrap_or(0)
    }

    /// Returns the microinstruction that loads a register with a value of inputs that can be read from microinstruction `ready`
    /// on.
    fn free(&self, ready: usize) -> usize {
        if self.is_pipelined { self.schedule.steps.len() } else { ready }
    }

    /// Returns the microinstruction for a product with factors that can be read from microinstruction `ready` on.
    fn free_work(&mut self, ready: usize) -> usize {
        let at = self.free(ready).max(self.next_work);
        self.next_work = at + 1;
        at
    }

    /// Returns a microinstruction, after adding those that do not exist yet.
    fn step(&mut self, at: usize) -> &mut PlanStep {
        let steps = &mut self.schedule.steps;
        if steps.len() <= at {
            steps.resize(at + 1, PlanStep::default());
        }
        &mut steps[at]
    }

    fn load(&mut self, node: NodeId, at: usize) {
        self.step(at).loads.push(node);
        self.loaded(node, at);
    }

    fn loaded(&mut self, node: NodeId, at: usize) {
        self.is_placed[node.0] = true;
        self.ready[node.0] = at + 1;
    }
}

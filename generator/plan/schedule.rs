//! Turns a plan into a microprogram for one multiplier, with registers for the values that later microinstructions read.
//!
//! Each product, each step of Horner's rule, each normalised word, and each result that other operations read has a register. In
//! a sequential core, so has a value whose logic would otherwise take too long ([`super::hold`]). All other operations are
//! combinational logic between these registers.
//!
//! A microinstruction computes at most one product, and in a sequential core also loads all registers with known values. In a
//! sequential unit, each function skips the microinstructions that it does not need ([`super::dispatch`]).

use super::dispatch::dispatches;
use super::hold::held_nodes;
use super::node::{NodeId, Operation};
use super::placement::{PlanSchedule, StepPlacement};
use super::plan::ExpressionPlan;

/// The size of a table, in bits, from which on some family of FPGAs uses a block memory.
pub const SMALLEST_BLOCK: u64 = 2048;

impl ExpressionPlan {
    /// Returns the microprogram of the plan, with the nodes that have registers. The microprogram computes only nodes that a
    /// result reads ([`ExpressionPlan::read_nodes`]). A sequential core has further registers where logic would take too long. A
    /// pipeline has none of these, because its own schedule places the registers, and loads each register in a microinstruction
    /// of its own.
    ///
    /// # Panics
    /// Panics if the plan has a function whose polynomials are not known yet.
    pub fn schedule(&self, is_pipelined: bool) -> PlanSchedule {
        let computed = self.computed_nodes();
        let mut is_coefficient_held = vec![false; self.nodes().len()];
        for &NodeId(at) in computed.iter().filter(|_| !is_pipelined) {
            if let Operation::Polynomial(_, approximation) = &self.nodes()[at].operation {
                let it = approximation.polynomials.as_ref().expect("polynomials that are found");
                is_coefficient_held[at] = it.degree() > 0 && it.rom_bits() >= SMALLEST_BLOCK;
            }
        }
        let targets = self.register_targets();
        let held = vec![false; self.nodes().len()];
        let table_owners = self.table_owners(is_pipelined);
        let empty = PlanSchedule {
            held,
            is_coefficient_held,
            register_owners: self.register_owners(&table_owners),
            table_owners,
            steps: Vec::new(),
            dispatches: Vec::new(),
        };
        let start = StepPlacement::new(self, &targets, empty, is_pipelined);
        let held = held_nodes(&start, &computed);
        let mut placement = start;
        placement.schedule.held = held;
        for node in computed {
            placement.place(node);
        }
        placement.place_results();
        let mut schedule = placement.schedule;
        if self.is_shared() && !is_pipelined {
            schedule.dispatches = dispatches(self, &schedule);
        }
        schedule
    }

    /// Returns for each polynomial of a sequential core the first polynomial with the same table, and for other nodes themselves. Each
    /// polynomial of a pipeline has a table of its own, because the pipeline reads the tables of several points in the same clock.
    fn table_owners(&self, is_pipelined: bool) -> Vec<NodeId> {
        let mut owners: Vec<NodeId> = (0..self.nodes().len()).map(NodeId).collect();
        let is_read = self.read_nodes();
        for at in (0..self.nodes().len()).filter(|at| is_read[*at] && !is_pipelined) {
            let is_same = |other: &usize| is_read[*other] && self.have_same_table(at, *other);
            if let Some(first) = (0..at).find(is_same) {
                owners[at] = NodeId(first);
            }
        }
        owners
    }

    /// Returns for each node the node whose register also stores its value. The operands of polynomials of a unit that share a table also
    /// share a register. The choice between them is in front of the register, and not in front of the multiplier.
    fn register_owners(&self, table_owners: &[NodeId]) -> Vec<NodeId> {
        let mut owners: Vec<NodeId> = (0..self.nodes().len()).map(NodeId).collect();
        let operand_of = |polynomial: NodeId| match self.node(polynomial).operation {
            Operation::Polynomial(operand, _) => operand,
            _ => unreachable!("only polynomials share a table"),
        };
        for (at, owner) in table_owners.iter().enumerate() {
            let polynomial = NodeId(at);
            if *owner == polynomial || !self.is_shared() {
                continue;
            }
            let [own, first] = [polynomial, *owner].map(operand_of);
            if [own, first].iter().all(|operand| self.is_read_by_table_alone(*operand)) {
                owners[own.0] = first;
            }
        }
        owners
    }

    /// Returns whether a node is computed for a table, and nothing else reads it.
    fn is_read_by_table_alone(&self, node: NodeId) -> bool {
        let is_operand = matches!(self.node(node).operation, Operation::Operand(_));
        let readers = self.nodes().iter().filter(|it| it.operation.inputs().contains(&node));
        !is_operand && readers.count() == 1
    }

    /// Returns whether two nodes are polynomials with the same table and operands of the same format.
    fn have_same_table(&self, at: usize, other: usize) -> bool {
        let [at, other] = [at, other].map(|it| &self.nodes()[it].operation);
        let (Operation::Polynomial(x, own), Operation::Polynomial(y, others)) = (at, other) else {
            return false;
        };
        self.node(*x).format == self.node(*y).format && own.polynomials == others.polynomials
    }

    /// Returns for each node the node whose register stores its value: for most nodes the node itself.
    fn register_targets(&self) -> Vec<NodeId> {
        let mut targets = Vec::with_capacity(self.nodes().len());
        for (at, node) in self.nodes().iter().enumerate() {
            let node_id = NodeId(at);
            let is_stored =
                matches!(node.operation, Operation::Multiply(..) | Operation::Normalise { .. });
            targets.push(if is_stored { self.held_for(node_id) } else { node_id });
        }
        targets
    }

    /// Returns the nodes that a result reads, in their order. One microinstruction computes a normalised word and its shift, so that
    /// the shift is computed with every word that is read.
    fn computed_nodes(&self) -> Vec<NodeId> {
        let is_read = self.read_nodes();
        let mut computed = Vec::new();
        for (at, node) in self.nodes().iter().enumerate() {
            let is_computed = match node.operation {
                Operation::Places(word) => is_read[word.0],
                _ => is_read[at],
            };
            if is_computed {
                computed.push(NodeId(at));
            }
        }
        computed
    }

    /// Returns the node whose register stores the value of `node`: `node` itself, or a later node that only scales or shortens it.
    ///
    /// The function goes from reader to reader while there is only one. It passes `Scale` nodes, and returns the first `Narrow`
    /// or `Middle` node: for a product that a `Scale` and then a `Narrow` node follow, the `Narrow` node. Before any other
    /// reader, and at a result of the plan, it returns the node that it has reached. A reader `Places` does not count.
    fn held_for(&self, node: NodeId) -> NodeId {
        let mut held = node;
        loop {
            let mut readers = Vec::new();
            for (at, other) in self.nodes().iter().enumerate() {
                let is_places = matches!(other.operation, Operation::Places(_));
                if !is_places && other.operation.inputs().contains(&held) {
                    readers.push(NodeId(at));
                }
            }
            let [reader] = readers[..] else { return held };
            if self.results().contains(&held) {
                return held;
            }
            match self.node(reader).operation {
                Operation::Narrow(..) | Operation::Middle(_) => return reader,
                Operation::Scale(_) => held = reader,
                _ => return held,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glint_approximate::Outside;
    use glint_base::fixed::Format;
    use glint_formula::parse;

    use super::*;
    use crate::find::find;
    use crate::placement::{PlanStep, StepWork};
    use crate::statement::{ExpressionStatement, StatedOperand, StatedResult};

    /// Returns the plan of a formula of a, b, c and d, which have 16 bits and are from −1 to below 1.
    fn plan_of(formula: &str) -> ExpressionPlan {
        let formula = parse(formula).expect("a formula");
        let mut operands = Vec::new();
        for name in formula.operands() {
            let format = Format::signed(0, 15);
            let (low, high) = format.range();
            operands.push(StatedOperand {
                name: name.to_owned(),
                format,
                domain: (low as i64, high as i64),
                outside: Outside::Anything,
                doc: String::new(),
            });
        }
        let result = StatedResult {
            name: "r".to_owned(),
            formula,
            fraction: 10,
            error: 1.0,
            promise: None,
            width: None,
        };
        find(&ExpressionStatement { operands, results: vec![result] }).expect("a plan").plan
    }

    /// Returns the nodes with registers that the logic in front of `node` reads.
    fn registers_before(
        plan: &ExpressionPlan,
        schedule: &PlanSchedule,
        node: NodeId,
    ) -> Vec<NodeId> {
        let mut registers = Vec::new();
        for input in plan.node(node).operation.hardware_inputs() {
            match schedule.held[input.0] {
                true => registers.push(input),
                false => registers.extend(registers_before(plan, schedule, input)),
            }
        }
        registers
    }

    #[test]
    fn each_register_is_loaded_before_it_is_read() {
        for formula in [
            "max(max(a, b), max(c, d)) + abs(a - b) * c",
            "sqrt(a^2 + b^2)",
            "sin(pi * a) * b - cos(pi * a) * c",
            "min(max(a * b + c, -1), 1) * d + abs(abs(a) - abs(d))",
            // The operands address the first table, until a register stores the sum for the second quotient.
            "a / (1.25 + b / 8) + c / (1.25 + b / 8)^2",
        ] {
            let plan = plan_of(formula);
            let schedule = plan.schedule(false);
            assert_reads_loaded_registers(&plan, &schedule, formula);
        }
    }

    /// Asserts that each microinstruction reads only registers that earlier ones have loaded, and tables that had their address one
    /// clock before.
    fn assert_reads_loaded_registers(plan: &ExpressionPlan, schedule: &PlanSchedule, what: &str) {
        // For each node, the number of the microinstruction that loads its register.
        let mut loaded: Vec<Option<usize>> = vec![None; plan.nodes().len()];
        for (at, step) in schedule.steps.iter().enumerate() {
            let from_tables = match step.work {
                Some(StepWork::Sum { polynomial, .. }) => Some(polynomial),
                _ => None,
            };
            for table in from_tables.iter().chain(&step.coefficients) {
                let Operation::Polynomial(operand, _) = plan.node(*table).operation else {
                    panic!("{what}: no polynomial");
                };
                for register in registers_of(plan, schedule, operand) {
                    let when = loaded[register.0].unwrap_or(usize::MAX);
                    assert!(
                        when < at.saturating_sub(1),
                        "{what}: a table gets its address too late"
                    );
                }
            }
            let mut ends = step.loads.clone();
            match step.work {
                Some(StepWork::Product { product, .. }) => ends.push(product),
                Some(StepWork::Sum { .. } | StepWork::Address(_)) | None => {}
            }
            for end in ends {
                // The same microinstruction loads a normalised word and its shift.
                let end = match plan.node(end).operation {
                    Operation::Places(word) => word,
                    _ => end,
                };
                for register in registers_before(plan, schedule, end) {
                    let name = &plan.node(register).name;
                    let when = loaded[register.0].unwrap_or(usize::MAX);
                    assert!(when < at, "{what}: {name} is read too early");
                }
            }
            for node in &step.loads {
                assert_eq!(loaded[node.0].replace(at), None, "{what}: a register is loaded twice");
            }
            match step.work {
                Some(StepWork::Product { held, .. }) => loaded[held.0] = Some(at),
                Some(StepWork::Sum { polynomial, coefficient: 0 }) => {
                    loaded[polynomial.0] = Some(at)
                }
                _ => {}
            }
        }
        for result in plan.results() {
            assert!(loaded[result.0].is_some(), "{what}: a result is not loaded");
        }
    }

    /// Returns the registers from which the value of `node` comes: its own, or those in front of it.
    fn registers_of(plan: &ExpressionPlan, schedule: &PlanSchedule, node: NodeId) -> Vec<NodeId> {
        match schedule.held[node.0] {
            true => vec![node],
            false => registers_before(plan, schedule, node),
        }
    }

    #[test]
    fn a_sequential_core_stores_each_level_of_a_wide_maximum() {
        let plan = plan_of("max(max(a, b), max(c, d))");
        let counts = |is_pipelined: bool| -> Vec<usize> {
            let steps = plan.schedule(is_pipelined).steps;
            assert!(steps.iter().all(|step| step.work.is_none()), "a maximum needs no product");
            steps.iter().map(|step| step.loads.len()).collect()
        };
        assert_eq!(counts(true), [1]);
        // Both maxima of two operands are stored in the same clock.
        assert_eq!(counts(false), [2, 1]);
    }

    #[test]
    fn polynomials_with_the_same_table_share_it() {
        let plan = plan_of("sin(pi * a) * b - sin(pi * c) * d");
        let mut polynomials = Vec::new();
        for (at, node) in plan.nodes().iter().enumerate() {
            if matches!(node.operation, Operation::Polynomial(..)) {
                polynomials.push(NodeId(at));
            }
        }
        let [first, second] = polynomials[..] else { panic!("two sines: {polynomials:?}") };
        let schedule = plan.schedule(false);
        assert_eq!(schedule.table_sharers(first), [first, second]);
        // The table gets each operand one clock before it reads a word, and during the sums.
        for (at, step) in schedule.steps.iter().enumerate() {
            for polynomial in step.tables_read() {
                assert_eq!(schedule.addressing(first, at), Some(polynomial), "{at}");
            }
        }
        let pipelined = plan.schedule(true);
        assert_eq!(pipelined.table_sharers(first), [first]);
    }

    #[test]
    fn registers_load_beside_products() {
        // The quotient takes several microinstructions, in which the sum and its absolute value are stored.
        let plan = plan_of("(a / (1.25 + b / 8) + 1) * abs(c + d)");
        let schedule = plan.schedule(false);
        let is_beside = |step: &PlanStep| step.work.is_some() && !step.loads.is_empty();
        assert!(schedule.steps.iter().any(is_beside), "{:?}", schedule.steps);
    }
}

//! Turns a plan into a microprogram for one multiplier, with registers for the values that later microinstructions read.
//!
//! Each product, each step of Horner's rule and each normalised word has its own microinstruction, and a register for its
//! value. So has a result that other operations read, and in a sequential core a value whose logic would otherwise take too long
//! ([`super::depth`]). All other operations are combinational logic between these registers, and the last microinstruction loads the
//! registers of the other results.

use super::depth::{longest_to, time_of};
use super::node::{NodeId, Operation};
use super::plan::ExpressionPlan;

/// One microinstruction of a plan's microprogram.
#[derive(Clone, Debug, PartialEq)]
pub enum PlanStep {
    /// The multiplier computes a product, and a register loads the product or a value that follows from it.
    Product {
        /// The node of the product.
        product: NodeId,
        /// The node whose register is loaded: the product itself, or the product after it was scaled or shortened.
        held: NodeId,
    },
    /// The registers of these nodes load their values.
    Hold(Vec<NodeId>),
    /// The table of this node's polynomial gets its address. No register is loaded.
    Address(NodeId),
    /// The multiplier and an adder compute one partial sum of Horner's rule.
    Sum {
        /// The node of the polynomial.
        polynomial: NodeId,
        /// The index of the coefficient that is added; 0 is the constant coefficient.
        coefficient: usize,
    },
}

/// The microprogram of a plan, with the nodes that have registers.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanSchedule {
    /// For each node, whether it has a register.
    pub held: Vec<bool>,
    /// The microinstructions in the order of execution.
    pub steps: Vec<PlanStep>,
}

impl ExpressionPlan {
    /// Returns the microprogram of the plan, with the nodes that have registers. It computes no node that no result reads
    /// ([`ExpressionPlan::read_nodes`]). A sequential core has further registers where logic would take too long. A pipeline has none
    /// of these, because its own schedule places the registers. Neither has a plan of several functions: the selection of factors and
    /// tables takes longer than other logic, and each function would take more clocks.
    ///
    /// # Panics
    /// Panics if the plan has a function whose polynomials are not known yet.
    pub fn schedule(&self, is_pipelined: bool) -> PlanSchedule {
        let mut schedule = PlanSchedule { held: vec![false; self.nodes.len()], steps: Vec::new() };
        let is_read = self.read_nodes();
        for at in 0..self.nodes.len() {
            let node = NodeId(at);
            let operation = &self.nodes[at].operation;
            let is_computed = match operation {
                // One microinstruction computes a normalised word and its shift.
                Operation::Places(word) => is_read[word.0],
                _ => is_read[at],
            };
            if !is_computed {
                continue;
            }
            if !is_pipelined && !self.is_shared {
                self.store_late_inputs(node, &mut schedule);
            }
            match operation {
                Operation::Multiply(..) => {
                    let held = self.held_for(node);
                    schedule.held[held.0] = true;
                    schedule.steps.push(PlanStep::Product { product: node, held });
                }
                Operation::Places(normalised) => {
                    let mut held = vec![self.held_for(*normalised)];
                    // The results of a function that covers one octave need no shift back.
                    if is_read[at] {
                        held.push(node);
                    }
                    for node in &held {
                        schedule.held[node.0] = true;
                    }
                    schedule.steps.push(PlanStep::Hold(held));
                }
                Operation::Polynomial(_, approximation) => {
                    let polynomials = approximation.polynomials.as_ref();
                    let degree = polynomials.expect("a plan whose polynomials are known").degree();
                    schedule.held[at] = true;
                    // In the first clock, the operands already address the tables.
                    if !schedule.steps.is_empty() {
                        schedule.steps.push(PlanStep::Address(node));
                    }
                    for coefficient in (0..degree.max(1)).rev() {
                        schedule.steps.push(PlanStep::Sum { polynomial: node, coefficient });
                    }
                }
                _ => {}
            }
            // Later microinstructions read the register of a result, so it is loaded before them.
            let has_reader =
                self.nodes.iter().any(|other| other.operation.inputs().contains(&node));
            if self.results.contains(&node) && !schedule.held[at] && has_reader {
                schedule.held[at] = true;
                schedule.steps.push(PlanStep::Hold(vec![node]));
            }
        }
        let mut last = Vec::new();
        for result in &self.results {
            if !schedule.held[result.0] {
                schedule.held[result.0] = true;
                last.push(*result);
            }
        }
        if !last.is_empty() {
            schedule.steps.push(PlanStep::Hold(last));
        }
        schedule
    }

    /// Adds registers for the inputs of `node` if the logic in front of it would take too long. Each is loaded as soon as its value is
    /// there, before any microinstruction that reads it.
    fn store_late_inputs(&self, node: NodeId, schedule: &mut PlanSchedule) {
        let operation = &self.node(node).operation;
        if matches!(operation, Operation::Places(_)) {
            // It is computed together with the normalised word.
            return;
        }
        let arrivals = self.arrivals(node, schedule);
        let inputs = operation.hardware_inputs();
        let latest = inputs.iter().map(|input| arrivals[input.0].time).fold(0.0, f64::max);
        if latest + time_of(self, node) <= longest_to(operation) {
            return;
        }
        for input in inputs {
            if !schedule.held[input.0] && arrivals[input.0].time > 0.0 {
                self.store(input, node, schedule);
            }
        }
    }

    /// Adds a register for the value of `late`, a node before `end`.
    fn store(&self, late: NodeId, end: NodeId, schedule: &mut PlanSchedule) {
        let place = self.arrivals(end, schedule)[late.0].step;
        let reads_late = |node: &NodeId| self.reads_unheld(*node, late, schedule);
        let joins = match schedule.steps.get(place) {
            Some(PlanStep::Hold(others)) => !others.iter().any(reads_late),
            _ => false,
        };
        let addressed = self.addressed_by_operands(schedule);
        let addressed = addressed.filter(|table| self.reads_unheld(*table, late, schedule));
        match (joins, schedule.steps.get_mut(place)) {
            (true, Some(PlanStep::Hold(others))) => others.push(late),
            _ => schedule.steps.insert(place, PlanStep::Hold(vec![late])),
        }
        if let Some(table) = addressed {
            // The operands no longer address the table in the first clock; the register does, one clock later.
            schedule.steps.insert(place + 1, PlanStep::Address(table));
        }
        schedule.held[late.0] = true;
    }

    /// Returns the polynomial whose table the operands address in the first clock, without a microinstruction of its own.
    fn addressed_by_operands(&self, schedule: &PlanSchedule) -> Option<NodeId> {
        let mut polynomials = schedule.steps.iter().filter_map(|step| match step {
            PlanStep::Sum { polynomial, .. } => Some(*polynomial),
            _ => None,
        });
        let first = polynomials.next()?;
        (!schedule.steps.contains(&PlanStep::Address(first))).then_some(first)
    }

    /// Returns whether the logic in front of `node`'s register reads `late`.
    fn reads_unheld(&self, node: NodeId, late: NodeId, schedule: &PlanSchedule) -> bool {
        let inputs = self.node(node).operation.hardware_inputs();
        inputs.into_iter().any(|input| {
            input == late || !schedule.held[input.0] && self.reads_unheld(input, late, schedule)
        })
    }

    /// Returns the arrivals of all nodes before `end`.
    fn arrivals(&self, end: NodeId, schedule: &PlanSchedule) -> Vec<Arrival> {
        let mut loaded = vec![0; self.nodes.len()];
        for (at, step) in schedule.steps.iter().enumerate() {
            match step {
                PlanStep::Product { held, .. } => loaded[held.0] = at + 1,
                PlanStep::Hold(nodes) => nodes.iter().for_each(|node| loaded[node.0] = at + 1),
                PlanStep::Sum { polynomial, .. } => loaded[polynomial.0] = at + 1,
                PlanStep::Address(_) => {}
            }
        }
        let mut arrivals: Vec<Arrival> = Vec::with_capacity(end.0);
        for (at, step) in loaded.into_iter().enumerate().take(end.0) {
            let mut arrival = Arrival { time: 0.0, step };
            if !schedule.held[at] {
                for input in self.nodes[at].operation.hardware_inputs() {
                    arrival.time = arrivals[input.0].time.max(arrival.time);
                    arrival.step = arrivals[input.0].step.max(arrival.step);
                }
                arrival.time += time_of(self, NodeId(at));
            }
            arrivals.push(arrival);
        }
        arrivals
    }

    /// Returns the node whose register stores the value of `node`: `node` itself, or a later node that only scales or shortens it.
    ///
    /// The search begins at `node`, and goes on to the reader of the present node while there is only one. The search passes
    /// `Scale` nodes, and ends at the first `Narrow` or `Middle` node, which it returns. Before any other reader, and at a
    /// result of the plan, it returns the present node. A reader `Places` does not count. For example, for a product that a
    /// `Scale` and then a `Narrow` node follow, it returns the `Narrow` node.
    fn held_for(&self, node: NodeId) -> NodeId {
        let mut held = node;
        loop {
            let mut readers = Vec::new();
            for (at, other) in self.nodes.iter().enumerate() {
                let is_places = matches!(other.operation, Operation::Places(_));
                if !is_places && other.operation.inputs().contains(&held) {
                    readers.push(NodeId(at));
                }
            }
            let [reader] = readers[..] else { return held };
            if self.results.contains(&held) {
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

/// When the value of a node arrives.
#[derive(Clone, Copy)]
struct Arrival {
    /// The time of the logic between the registers before the node and its value, in nanoseconds; 0 for a node with a register.
    time: f64,
    /// The number of microinstructions after which the registers before the node have their values.
    step: usize,
}

#[cfg(test)]
mod tests {
    use glint_approximate::Outside;
    use glint_base::fixed::Format;
    use glint_formula::parse;

    use super::*;
    use crate::find::find;
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
            let mut is_loaded = vec![false; plan.nodes.len()];
            for step in &schedule.steps {
                let loaded = match step {
                    PlanStep::Product { held, .. } => vec![*held],
                    PlanStep::Hold(nodes) => nodes.clone(),
                    PlanStep::Sum { polynomial, coefficient: 0 } => vec![*polynomial],
                    PlanStep::Sum { .. } | PlanStep::Address(_) => Vec::new(),
                };
                // A table gets its address in a microinstruction, or from the operands in the first clock.
                let addressed = match step {
                    PlanStep::Address(table) => Some(*table),
                    PlanStep::Sum { polynomial, .. } => {
                        let address = PlanStep::Address(*polynomial);
                        (!schedule.steps.contains(&address)).then_some(*polynomial)
                    }
                    _ => None,
                };
                if let (Some(table), PlanStep::Sum { .. }) = (addressed, step) {
                    assert!(registers_before(&plan, &schedule, table).is_empty(), "{formula}");
                }
                for node in loaded.iter().chain(&addressed) {
                    // The same microinstruction loads a normalised word and its shift.
                    let node = match plan.node(*node).operation {
                        Operation::Places(word) => word,
                        _ => *node,
                    };
                    for register in registers_before(&plan, &schedule, node) {
                        let name = &plan.node(register).name;
                        assert!(is_loaded[register.0], "{formula}: {name} is read too early");
                    }
                }
                for node in loaded {
                    is_loaded[node.0] = true;
                }
            }
        }
    }

    #[test]
    fn a_sequential_core_stores_each_level_of_a_wide_maximum() {
        let plan = plan_of("max(max(a, b), max(c, d))");
        let counts = |is_pipelined: bool| -> Vec<usize> {
            let steps = plan.schedule(is_pipelined).steps;
            steps
                .iter()
                .map(|step| match step {
                    PlanStep::Hold(nodes) => nodes.len(),
                    other => panic!("a maximum needs no {other:?}"),
                })
                .collect()
        };
        assert_eq!(counts(true), [1]);
        // Both maxima of two operands are stored in the same clock.
        assert_eq!(counts(false), [2, 1]);
    }
}

//! Turns a plan into a microprogram for one multiplier, with registers for the values that later microinstructions read.
//!
//! Each product, each step of Horner's rule and each normalised word has its own microinstruction, and a register for its
//! value. So has a result that other operations read. All other operations are combinational logic between these registers,
//! and the last microinstruction loads the registers of the other results.

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
    /// ([`ExpressionPlan::read_nodes`]).
    ///
    /// # Panics
    /// Panics if the plan has a function whose polynomials are not known yet.
    pub fn schedule(&self) -> PlanSchedule {
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

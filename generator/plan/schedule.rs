//! Orders a plan as a microprogram: a product at a time, with registers for the values that later steps read.
//!
//! The hardware has one multiplier. Each product, each step of Horner's rule and each normalised word has a
//! microinstruction of its own, and a register that holds its value from then on. All other operations are logic between
//! registers.

use super::node::{NodeId, Operation};
use super::plan::ExpressionPlan;

/// A microinstruction of a plan.
#[derive(Clone, Debug, PartialEq)]
pub enum PlanStep {
    /// A product is computed. The register of `held` takes what follows from it.
    Product {
        /// The node of the product.
        product: NodeId,
        /// The node whose register is loaded: the product, or the same value with fewer bits.
        held: NodeId,
    },
    /// The registers of these nodes are loaded.
    Hold(Vec<NodeId>),
    /// The table of a polynomial's coefficients is addressed, and no register is loaded.
    Address(NodeId),
    /// A sum of Horner's rule is computed: that with the coefficient of this number.
    Sum {
        /// The node of the polynomial.
        polynomial: NodeId,
        /// The number of the coefficient, 0 for the constant.
        coefficient: usize,
    },
}

/// The microprogram of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanSchedule {
    /// For each node, whether a register holds its value.
    pub held: Vec<bool>,
    /// The microinstructions, in order.
    pub steps: Vec<PlanStep>,
}

impl ExpressionPlan {
    /// Returns the microprogram of the plan.
    ///
    /// # Panics
    /// Panics if the polynomials of the plan are not known yet.
    pub fn schedule(&self) -> PlanSchedule {
        let mut schedule = PlanSchedule { held: vec![false; self.nodes.len()], steps: Vec::new() };
        for at in 0..self.nodes.len() {
            let node = NodeId(at);
            match &self.nodes[at].operation {
                Operation::Multiply(..) => {
                    let held = self.held_for(node);
                    schedule.held[held.0] = true;
                    schedule.steps.push(PlanStep::Product { product: node, held });
                }
                Operation::Places(normalised) => {
                    let held = vec![self.held_for(*normalised), node];
                    for node in &held {
                        schedule.held[node.0] = true;
                    }
                    schedule.steps.push(PlanStep::Hold(held));
                }
                Operation::Polynomial(_, approximation) => {
                    let polynomials = approximation.polynomials.as_ref();
                    let degree = polynomials.expect("a plan whose polynomials are known").degree();
                    schedule.held[at] = true;
                    schedule.steps.push(PlanStep::Address(node));
                    for coefficient in (0..degree.max(1)).rev() {
                        schedule.steps.push(PlanStep::Sum { polynomial: node, coefficient });
                    }
                }
                _ => {}
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

    /// Returns the node in whose register the value of `node` is held: `node`, or the node that alone reads it and gives it
    /// fewer bits.
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
                Operation::Narrow(..) => return reader,
                Operation::Scale(_) => held = reader,
                _ => return held,
            }
        }
    }
}

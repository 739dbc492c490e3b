//! Checks that a plan does not contradict itself. The analysis of errors, the hardware and the golden model rely on these rules.

use std::collections::HashSet;

use glint_base::interval;

use super::ExpressionPlan;
use crate::node::{NodeId, Operation, PlanNode};
use crate::refusal::PlanRefusal;

impl ExpressionPlan {
    /// Checks each node ([`Self::contradiction`]), and that each result is a node.
    ///
    /// # Errors
    /// Fails at the first contradiction. The message names the node.
    pub(super) fn check(&self) -> Result<(), PlanRefusal> {
        let mut names = HashSet::new();
        for (at, node) in self.nodes.iter().enumerate() {
            let contradiction = match names.insert(&node.name) {
                true => self.contradiction(NodeId(at)),
                false => Some("has the name of another node"),
            };
            if let Some(contradiction) = contradiction {
                return Err(fault(&format!("the node `{}` {contradiction}", node.name)));
            }
        }
        let mut ends = self.results.iter().chain(&self.proved);
        if self.results.len() != self.proved.len() || ends.any(|end| end.0 >= self.nodes.len()) {
            return Err(fault("a result has no node"));
        }
        Ok(())
    }

    /// Returns how a node contradicts the rest of the plan: it reads a node that does not precede it, its values do not fit its
    /// format, or two operations that belong together are apart. Returns `None` for a node without a contradiction.
    fn contradiction(&self, id: NodeId) -> Option<&'static str> {
        let PlanNode { operation, format, range, limits, .. } = self.node(id);
        if operation.inputs().iter().any(|input| input.0 >= id.0) {
            return Some("reads a node that does not precede it");
        }
        if range.0 > range.1 || !interval::fits(*range, *format) {
            return Some("has values that do not fit its format");
        }
        if limits.low > limits.high || limits.low.is_nan() || limits.high.is_nan() {
            return Some("has limits that contain no value");
        }
        let is_consistent = match operation {
            Operation::Normalise { .. } => {
                let next = self.nodes.get(id.0 + 1).map(|node| &node.operation);
                matches!(next, Some(Operation::Places(word)) if *word == id)
            }
            Operation::Places(word) => {
                let is_word = matches!(self.node(*word).operation, Operation::Normalise { .. });
                is_word && word.0 + 1 == id.0
            }
            Operation::FractionPart(number, integer) => {
                matches!(self.node(*integer).operation, Operation::IntegerPart(of) if of == *number)
            }
            Operation::Choose { condition, .. } => {
                let condition = self.node(*condition).format;
                !condition.signed && condition.frac == 0 && condition.width() == 1
            }
            _ => true,
        };
        if is_consistent {
            None
        } else {
            Some("does not belong to the node that it reads or that follows it")
        }
    }
}

/// Makes the refusal for a contradiction, which no formula may cause.
fn fault(message: &str) -> PlanRefusal {
    let remedy = "this is a fault of Glint: please report the formula, and write it in another way";
    PlanRefusal::new(message, remedy)
}

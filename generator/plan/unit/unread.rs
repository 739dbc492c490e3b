//! Counts low bits of a value that the nodes after it do not read.

use glint_base::fixed::Rounding;

use crate::node::{NodeId, Operation, PlanNode};
use crate::plan::ExpressionPlan;

/// Returns the number of low bits of a node that no other node reads, and no result.
pub(super) fn unread_bits(plan: &ExpressionPlan, node: NodeId) -> i32 {
    let all: Vec<NodeId> = (0..plan.nodes().len()).map(NodeId).collect();
    bits_unread_by(plan, node, &all)
}

/// Returns the number of low bits of a node that none of `readers` reads, and no result. It is 0 if none of them reads the node.
pub(super) fn bits_unread_by(plan: &ExpressionPlan, node: NodeId, readers: &[NodeId]) -> i32 {
    if plan.results().contains(&node) {
        return 0;
    }
    let frac = plan.node(node).format.frac;
    let mut unread: Option<i32> = None;
    for reader in readers {
        let PlanNode { operation, format, .. } = plan.node(*reader);
        if !operation.inputs().contains(&node) {
            continue;
        }
        let dropped = frac - format.frac;
        let own = match operation {
            Operation::Scale(_) => bits_unread_by(plan, *reader, readers),
            Operation::Narrow(_, Rounding::Truncate) if dropped >= 0 => {
                dropped + bits_unread_by(plan, *reader, readers)
            }
            // The adder reads the highest bit that is dropped.
            Operation::Narrow(_, Rounding::Nearest) if dropped > 0 => dropped - 1,
            _ => 0,
        };
        unread = Some(unread.map_or(own, |other| other.min(own)));
    }
    unread.unwrap_or(0)
}

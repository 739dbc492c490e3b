//! Shows that two values are equal for all values of a long input, although only some of them are computed.
//!
//! Sums with an input x, and roundings of such sums, repeat: if x grows by 2 to the power of the dropped bits, the value grows by a constant,
//! which is the same for each such step. For example, x + 3 without its lowest 4 bits grows by 1 whenever x grows by 16. If two values of this
//! kind are equal for two periods of x, their constants are equal, too, and so are the values for all x.

use glint_base::fixed::Format;

use crate::node::{NodeId, Operation};
use crate::plan::ExpressionPlan;

/// Returns k if the nodes of a cone have the period 2^k in an input, which the nodes `inputs` have. Returns `None` if a node of
/// the cone is not a sum or a rounding of the input, or a choice that does not depend on it.
pub(super) fn period_bits(
    plan: &ExpressionPlan,
    inputs: &[NodeId],
    cone: &[NodeId],
) -> Option<i32> {
    let mut dropped: Vec<Option<i32>> = vec![None; plan.nodes().len()];
    for input in inputs {
        dropped[input.0] = Some(0);
    }
    let mut most = 0;
    for id in cone {
        let node = plan.node(*id);
        let inputs = node.operation.inputs();
        let Some(before) = inputs.iter().filter_map(|it| dropped[it.0]).max() else { continue };
        let own = match node.operation {
            Operation::Scale(_) | Operation::Add(..) | Operation::Subtract(..) => before,
            Operation::Narrow(a, _) => {
                before + (plan.node(a).format.frac - node.format.frac).max(0)
            }
            Operation::Choose { condition, .. } if dropped[condition.0].is_none() => before,
            _ => return None,
        };
        dropped[id.0] = Some(own);
        most = most.max(own);
    }
    Some(most)
}

/// Returns whether the values of a cone fit the formats of their nodes. Nodes at its end that only drop bits of the last sum do
/// not count, because their values are equal modulo a power of two.
pub(super) fn fit_before_end(
    plan: &ExpressionPlan,
    end: NodeId,
    cone: &[NodeId],
    values: &[i128],
) -> bool {
    let mut last = Vec::new();
    let mut node = end;
    while cone.contains(&node)
        && let Operation::Scale(before) | Operation::Narrow(before, _) = plan.node(node).operation
        && top(plan.node(node).format) <= top(plan.node(before).format)
    {
        last.push(node);
        node = before;
    }
    let others: Vec<NodeId> = cone.iter().copied().filter(|id| !last.contains(id)).collect();
    all_fit(plan, &others, values)
}

/// Returns whether the values of a cone fit the formats of their nodes.
pub(super) fn all_fit(plan: &ExpressionPlan, cone: &[NodeId], values: &[i128]) -> bool {
    cone.iter().all(|id| {
        let value = plan.whole_value(*id, &[], &|input: NodeId| values[input.0]);
        plan.node(*id).format.holds(value)
    })
}

/// Returns the weight of the top bit of a raw value, as the number of bits above its binary point.
fn top(format: Format) -> i32 {
    format.int + i32::from(format.signed)
}

//! Compares the operations of two results of a list: they must be the same operations in the same formats.

use std::collections::HashSet;

use crate::node::{NodeId, Operation};
use crate::plan::ExpressionPlan;

/// A node of one result, and the node of another result at the same place. The same node twice is a part that the results have in
/// common. Nodes with the same value count as the first of them ([`ExpressionPlan::first_of_equal_nodes`]).
pub(super) type NodePair = (NodeId, NodeId);

/// Returns the pairs of nodes of two results, ordered so that a pair follows the pairs that it reads. `first` has for each node
/// the first one with the same value. `own` has the numbers of the operands that only the first and only the second result has;
/// every other operand must be the same.
///
/// # Errors
/// Fails with the first pair of nodes that differ.
pub(super) fn pairs(
    plan: &ExpressionPlan,
    first: &[NodeId],
    results: NodePair,
    own: [Option<usize>; 2],
) -> Result<Vec<NodePair>, NodePair> {
    let results = (first[results.0.0], first[results.1.0]);
    let mut seen = HashSet::from([results]);
    let mut open = vec![results];
    while let Some(pair) = open.pop() {
        let (a, b) = pair;
        if a == b {
            continue;
        }
        let are_own = match (&plan.node(a).operation, &plan.node(b).operation) {
            (Operation::Operand(x), Operation::Operand(y)) => [Some(*x), Some(*y)] == own,
            _ => true,
        };
        if !are_own || !plan.node(a).is_alike(plan.node(b)) {
            return Err(pair);
        }
        let inputs = inputs_of_pair(plan, first, pair).into_iter();
        open.extend(inputs.filter(|pair| seen.insert(*pair)));
    }
    let mut pairs: Vec<NodePair> = seen.into_iter().collect();
    pairs.sort_by_key(|(a, b)| (a.0, b.0));
    Ok(pairs)
}

/// Returns the pairs that a pair of nodes reads, in the order of the operation's inputs.
pub(super) fn inputs_of_pair(
    plan: &ExpressionPlan,
    first: &[NodeId],
    (a, b): NodePair,
) -> Vec<NodePair> {
    let of_second = plan.node(b).operation.inputs();
    let inputs = plan.node(a).operation.inputs().into_iter().zip(of_second);
    inputs.map(|(a, b)| (first[a.0], first[b.0])).collect()
}

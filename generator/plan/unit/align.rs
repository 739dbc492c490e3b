//! Aligns the operations of several plans: operations of the same kind get the same slot, in an order that suits every plan.

use glint_base::fixed::Rounding;

use crate::node::{NodeId, Operation};
use crate::plan::ExpressionPlan;

/// A kind of operation that costs much, and that functions of a unit can therefore share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SharedKind {
    Normaliser,
    /// A table with the widths of the set.
    Table,
    Product,
    LeftShift,
    RightShift,
    /// The rounding of a result.
    Rounding,
}

/// An operation of the merged plan: for each function, the node of its plan that this operation computes, if it has one.
#[derive(Clone, Debug)]
pub(super) struct MergedOperation {
    pub(super) kind: SharedKind,
    pub(super) members: Vec<Option<NodeId>>,
}

impl MergedOperation {
    /// Returns the functions that have the operation, each with its node.
    pub(super) fn present(&self) -> Vec<(usize, NodeId)> {
        let nodes = self.members.iter().enumerate();
        nodes.filter_map(|(function, node)| Some((function, (*node)?))).collect()
    }
}

/// Returns slots for all operations of these kinds. The nodes of each plan are in the order of the slots, so that the merged plan
/// has no circles. `kind_of` returns the kind of a node.
///
/// The plans are added one after the other, the longest first. For each, dynamic programming finds the alignment with the slots so
/// far that shares most operations.
pub(super) fn slots(sequences: &[Vec<(NodeId, SharedKind)>]) -> Vec<MergedOperation> {
    let mut order: Vec<usize> = (0..sequences.len()).collect();
    order.sort_by_key(|function| std::cmp::Reverse(sequences[*function].len()));
    let mut slots: Vec<MergedOperation> = Vec::new();
    for function in order {
        slots = with_sequence(slots, function, &sequences[function], sequences.len());
    }
    slots
}

/// Returns the shared operations of a plan, in the order of its nodes. `is_shared_table` says whether a polynomial has the widths of
/// the set.
pub(super) fn shared_operations(
    plan: &ExpressionPlan,
    is_shared_table: &dyn Fn(NodeId) -> bool,
) -> Vec<(NodeId, SharedKind)> {
    let is_read = plan.read_nodes();
    let mut sequence = Vec::new();
    for (at, node) in plan.nodes.iter().enumerate() {
        let id = NodeId(at);
        let kind = match node.operation {
            Operation::Normalise { .. } => SharedKind::Normaliser,
            Operation::Polynomial(..) if is_shared_table(id) => SharedKind::Table,
            Operation::Multiply(..) => SharedKind::Product,
            Operation::ShiftLeft(..) => SharedKind::LeftShift,
            Operation::ShiftRight(..) => SharedKind::RightShift,
            Operation::Narrow(value, _) if is_rounded_result(plan, id, value) => {
                SharedKind::Rounding
            }
            _ => continue,
        };
        let is_needed = is_read[at] || kind == SharedKind::Normaliser && is_read[at + 1];
        if is_needed {
            sequence.push((id, kind));
        }
    }
    sequence
}

/// Returns whether `id` is a result that is `value`, rounded to the nearest. A rounding after a choice is left out, because one adder
/// computes a choice of differences and its rounding.
fn is_rounded_result(plan: &ExpressionPlan, id: NodeId, value: NodeId) -> bool {
    let is_nearest = matches!(plan.node(id).operation, Operation::Narrow(_, Rounding::Nearest));
    let drops_bits = plan.node(value).format.frac > plan.node(id).format.frac;
    let is_choice = matches!(plan.node(value).operation, Operation::Choose { .. });
    is_nearest && drops_bits && !is_choice && plan.results.contains(&id)
}

/// Adds the operations of a function to the slots: to slots of the same kind as far as possible, and otherwise to new slots.
fn with_sequence(
    slots: Vec<MergedOperation>,
    function: usize,
    sequence: &[(NodeId, SharedKind)],
    functions: usize,
) -> Vec<MergedOperation> {
    // The entry `[s][o]` is the largest number of shared operations among the slots from s on and the operations from o on.
    let mut shared = vec![vec![0; sequence.len() + 1]; slots.len() + 1];
    for s in (0..slots.len()).rev() {
        for o in (0..sequence.len()).rev() {
            let is_same = slots[s].kind == sequence[o].1;
            let both = if is_same { shared[s + 1][o + 1] + 1 } else { 0 };
            shared[s][o] = both.max(shared[s + 1][o]).max(shared[s][o + 1]);
        }
    }
    let mut merged = Vec::with_capacity(slots.len() + sequence.len());
    let mut operations = sequence.iter().enumerate().peekable();
    for (s, mut slot) in slots.into_iter().enumerate() {
        while let Some((o, (node, kind))) = operations.peek().copied() {
            let is_same = slot.kind == *kind;
            if is_same && shared[s][o] == shared[s + 1][o + 1] + 1 {
                slot.members[function] = Some(*node);
                operations.next();
                break;
            }
            if shared[s][o] == shared[s + 1][o] {
                break;
            }
            merged.push(own_slot(*kind, *node, function, functions));
            operations.next();
        }
        merged.push(slot);
    }
    for (_, (node, kind)) in operations {
        merged.push(own_slot(*kind, *node, function, functions));
    }
    merged
}

fn own_slot(kind: SharedKind, node: NodeId, function: usize, functions: usize) -> MergedOperation {
    let mut members = vec![None; functions];
    members[function] = Some(node);
    MergedOperation { kind, members }
}

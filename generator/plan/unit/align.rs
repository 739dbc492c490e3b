//! Aligns the plans of a unit's functions: operations of the same kind, such as a product of each function, share one operation
//! of the merged plan, here called a slot. The order of the slots is also the order of the operations in every plan.

use crate::node::{NodeId, Operation};
use crate::plan::ExpressionPlan;

/// A kind of operation that costs much, and that functions of a unit can therefore share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SharedKind {
    Normaliser,
    /// A table with the common widths of a unit's tables, or a choice between two of them for the same operand ([`TableRead`]).
    Table,
    Product,
    /// A shift to the left or to the right.
    Shift,
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

/// A read of a shared table by a function: a polynomial of an operand, or one of two polynomials of the same operand.
#[derive(Clone, Copy, Debug)]
pub(super) struct TableRead {
    /// The operand of the polynomials.
    pub(super) operand: NodeId,
    /// The polynomials that are read if the condition is 0 and if it is 1. Without a condition, both are the same.
    pub(super) polynomials: [NodeId; 2],
    pub(super) condition: Option<NodeId>,
}

impl TableRead {
    /// Returns how a node of a plan reads a shared table; `None` for other nodes. `is_shared_table` says whether a polynomial has
    /// the common widths.
    pub(super) fn at(
        plan: &ExpressionPlan,
        node: NodeId,
        is_shared_table: &dyn Fn(NodeId) -> bool,
    ) -> Option<Self> {
        if let Operation::Polynomial(operand, _) = plan.node(node).operation {
            let is_own = is_shared_table(node) && !is_read_by_choices(plan, node, is_shared_table);
            return is_own.then_some(Self { operand, polynomials: [node; 2], condition: None });
        }
        let (operand, condition, polynomials) = choice_of_tables(plan, node, is_shared_table)?;
        let mut both = polynomials.iter();
        let is_choice = both.all(|it| is_read_by_choices(plan, *it, is_shared_table));
        is_choice.then_some(Self { operand, polynomials, condition: Some(condition) })
    }
}

/// Returns the operand, the condition and the polynomials of a choice between two polynomials of the same operand, whose tables have the
/// same segments and results with the same fraction bits.
fn choice_of_tables(
    plan: &ExpressionPlan,
    node: NodeId,
    is_shared_table: &dyn Fn(NodeId) -> bool,
) -> Option<(NodeId, NodeId, [NodeId; 2])> {
    let Operation::Choose { condition, cases } = plan.node(node).operation else { return None };
    let [(zero_operand, zero), (one_operand, one)] = [cases[0], cases[1]].map(|case| {
        let Operation::Polynomial(operand, approximation) = &plan.node(case).operation else {
            return (case, None);
        };
        (*operand, approximation.polynomials.as_ref())
    });
    let (zero, one) = (zero?, one?);
    let is_same_operand = zero_operand == one_operand && zero.origin == one.origin;
    let is_alike = zero.segments == one.segments && zero.result.frac == one.result.frac;
    let are_shared = cases.iter().all(|case| is_shared_table(*case));
    let is_choice = is_same_operand && is_alike && are_shared;
    is_choice.then_some((zero_operand, condition, cases))
}

/// Returns whether a polynomial is no result, and only choices between two tables read it.
fn is_read_by_choices(
    plan: &ExpressionPlan,
    polynomial: NodeId,
    is_shared_table: &dyn Fn(NodeId) -> bool,
) -> bool {
    let mut has_reader = false;
    for (at, node) in plan.nodes().iter().enumerate() {
        if node.operation.inputs().contains(&polynomial) {
            has_reader = true;
            if choice_of_tables(plan, NodeId(at), is_shared_table).is_none() {
                return false;
            }
        }
    }
    has_reader && !plan.results().contains(&polynomial)
}

/// Returns slots for the operations in `sequences`, which has the shared operations of each function in the order of its plan.
/// The slots keep all of these orders, so that the merged plan has no circles.
///
/// The longest sequence comes first. For each further one, dynamic programming finds the alignment with the slots so far that
/// shares most operations.
pub(super) fn slots(sequences: &[Vec<(NodeId, SharedKind)>]) -> Vec<MergedOperation> {
    let mut order: Vec<usize> = (0..sequences.len()).collect();
    order.sort_by_key(|function| std::cmp::Reverse(sequences[*function].len()));
    let mut slots: Vec<MergedOperation> = Vec::new();
    for function in order {
        slots = with_sequence(slots, function, &sequences[function], sequences.len());
    }
    slots
}

/// Returns the shared operations of a plan, in the order of its nodes. `is_shared_table` says whether a polynomial has the common
/// widths.
pub(super) fn shared_operations(
    plan: &ExpressionPlan,
    is_shared_table: &dyn Fn(NodeId) -> bool,
) -> Vec<(NodeId, SharedKind)> {
    let is_read = plan.read_nodes();
    let mut sequence = Vec::new();
    for (at, node) in plan.nodes().iter().enumerate() {
        let id = NodeId(at);
        let kind = match node.operation {
            Operation::Normalise { .. } => SharedKind::Normaliser,
            Operation::Polynomial(..) | Operation::Choose { .. }
                if TableRead::at(plan, id, is_shared_table).is_some() =>
            {
                SharedKind::Table
            }
            Operation::Multiply(..) => SharedKind::Product,
            Operation::ShiftLeft(..) | Operation::ShiftRight(..) => SharedKind::Shift,
            _ => continue,
        };
        let is_needed = is_read[at] || kind == SharedKind::Normaliser && is_read[at + 1];
        if is_needed {
            sequence.push((id, kind));
        }
    }
    sequence
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

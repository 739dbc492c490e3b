//! Estimates how long the logic of a plan takes between two registers, so that a microprogram can store a value in time.
//!
//! The slowest microinstruction of a sequential core is mostly a product: the control memory selects the factors, and the
//! multiplier computes. The estimates are nanoseconds on an ECP5 of speed grade 6.

use glint_base::fixed::Rounding;

use super::node::{NodeId, Operation};
use super::plan::ExpressionPlan;

/// The longest time of the logic in front of a factor of a product.
pub(super) const LONGEST_TO_FACTOR: f64 = 2.5;

/// The longest time of the logic in front of the address of a table.
pub(super) const LONGEST_TO_TABLE: f64 = 6.0;

/// The longest time of the logic in front of a register.
pub(super) const LONGEST_TO_REGISTER: f64 = 12.5;

/// The time of a choice, or of a look-up table behind which there is another one.
const CHOICE: f64 = 2.5;

/// The time of a choice that shares a look-up table with its neighbours.
const MERGED_CHOICE: f64 = 0.7;

/// Returns the time of each node's own logic, in nanoseconds. Products and tables have microinstructions of their own, and count
/// as 0.
pub(super) fn own_times(plan: &ExpressionPlan) -> Vec<f64> {
    let mut readers: Vec<Vec<NodeId>> = vec![Vec::new(); plan.nodes().len()];
    for (at, node) in plan.nodes().iter().enumerate() {
        for input in node.operation.inputs() {
            readers[input.0].push(NodeId(at));
        }
    }
    let mut times = Vec::with_capacity(plan.nodes().len());
    for at in 0..plan.nodes().len() {
        times.push(time_of(plan, NodeId(at), &readers));
    }
    times
}

fn time_of(plan: &ExpressionPlan, id: NodeId, readers: &[Vec<NodeId>]) -> f64 {
    let node = plan.node(id);
    let width_of = |id: NodeId| f64::from(plan.node(id).format.width());
    let carry = |width: f64| 2.0 + 0.1 * width;
    match &node.operation {
        Operation::Subtract(..) if is_chained_mirror(plan, id, readers) => 0.0,
        Operation::Add(a, b) if are_joined(plan, *a, *b) => 0.0,
        Operation::Subtract(a, b) if plan.is_inversion(*a, *b) => 0.0,
        Operation::Add(..) | Operation::Subtract(..) => carry(width_of(id)),
        Operation::Absolute(a) => carry(width_of(*a)),
        Operation::Less(a, b) => carry(width_of(*a).max(width_of(*b))),
        // The limits of a result are mostly powers of two, so that few bits are compared.
        Operation::Minimum(_, b) | Operation::Maximum(_, b)
            if matches!(plan.node(*b).operation, Operation::Constant { .. }) =>
        {
            2.0
        }
        // A comparison, and a choice with many readers.
        Operation::Minimum(..) | Operation::Maximum(..) => 3.5 + carry(width_of(id)),
        Operation::Narrow(a, Rounding::Nearest) if plan.node(*a).format.frac > node.format.frac => {
            carry(width_of(id))
        }
        // The opcode does not change, so that several such choices become one look-up table a bit.
        Operation::Choose { condition, .. } if selects_by_opcode(plan, *condition) => MERGED_CHOICE,
        Operation::Choose { cases, .. }
            if cases.iter().any(|case| is_chained_mirror(plan, *case, readers)) =>
        {
            MERGED_CHOICE
        }
        // The word of an opcode is there long before its readers.
        Operation::Lookup { address, .. } if is_opcode(plan, *address) => 0.0,
        Operation::NonZero(_) | Operation::Choose { .. } | Operation::Lookup { .. } => CHOICE,
        // Each stage finds whether half of the bits are 0, and shifts.
        Operation::Normalise { word, .. } => 1.8 * width_of(*word).log2(),
        Operation::ShiftLeft(a, _) | Operation::ShiftRight(a, _) => 1.4 * width_of(*a).log2(),
        Operation::Operand(_)
        | Operation::Constant { .. }
        | Operation::Multiply(..)
        | Operation::Polynomial(..)
        | Operation::Scale(_)
        | Operation::Narrow(..)
        | Operation::Middle(_)
        | Operation::Bit(..)
        | Operation::IntegerPart(_)
        | Operation::FractionPart(..)
        | Operation::Reverse(_)
        | Operation::Places(_) => 0.0,
    }
}

/// Returns whether a sum is a concatenation, which needs no adder: `second` has no sign, and its values are below the last place
/// of `first`.
fn are_joined(plan: &ExpressionPlan, first: NodeId, second: NodeId) -> bool {
    let [upper, lower] = [first, second].map(|summand| plan.node(summand).format);
    !lower.signed && lower.int <= -upper.frac
}

/// Returns whether `id` is the difference c − v of a mirror, which chooses between v and c − v, and another mirror or a rounding
/// follows. One adder then computes all of these.
fn is_chained_mirror(plan: &ExpressionPlan, id: NodeId, readers: &[Vec<NodeId>]) -> bool {
    let Operation::Subtract(constant, value) = plan.node(id).operation else { return false };
    let is_constant = matches!(plan.node(constant).operation, Operation::Constant { .. });
    let [mirror] = readers[id.0][..] else { return false };
    let is_mirror = match plan.node(mirror).operation {
        Operation::Choose { cases, .. } => cases.contains(&value),
        _ => false,
    };
    let is_rounded = |reader: &NodeId| match plan.node(*reader).operation {
        Operation::Narrow(_, Rounding::Nearest) | Operation::Add(..) => true,
        Operation::Subtract(constant, _) => {
            matches!(plan.node(constant).operation, Operation::Constant { .. })
        }
        _ => false,
    };
    is_constant && is_mirror && readers[mirror.0].iter().any(is_rounded)
}

/// Returns whether a condition is a bit of the opcode of a unit, or a bit of a table with the opcode as its address.
pub(super) fn selects_by_opcode(plan: &ExpressionPlan, condition: NodeId) -> bool {
    let source = match plan.node(condition).operation {
        Operation::Bit(source, _) => source,
        _ => condition,
    };
    match plan.node(source).operation {
        Operation::Lookup { address, .. } => is_opcode(plan, address),
        _ => is_opcode(plan, source),
    }
}

/// Returns whether a node is the opcode of a unit, which is operand 0.
fn is_opcode(plan: &ExpressionPlan, node: NodeId) -> bool {
    plan.is_shared() && matches!(plan.node(node).operation, Operation::Operand(0))
}

/// Returns the longest time, in nanoseconds, that the logic in front of a node may take. In a unit, a table allows as little as a
/// product, because its operand passes a choice between operands, and the multiplier also reads it.
pub(super) fn longest_to(plan: &ExpressionPlan, id: NodeId) -> f64 {
    match plan.node(id).operation {
        Operation::Multiply(..) => LONGEST_TO_FACTOR,
        Operation::Polynomial(..) if plan.is_shared() => LONGEST_TO_FACTOR,
        Operation::Polynomial(..) => LONGEST_TO_TABLE,
        _ => LONGEST_TO_REGISTER,
    }
}

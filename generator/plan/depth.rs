//! Estimates how long the logic of a plan takes between two registers, so that a microprogram can store a value in time.
//!
//! The slowest microinstruction of a sequential core is mostly a product: the control memory selects the factors, and the multiplier
//! computes. Logic in front of a factor would make it slower still. The estimates are nanoseconds on an ECP5 of speed grade 6.

use glint_base::fixed::Rounding;

use super::node::{NodeId, Operation};
use super::plan::ExpressionPlan;

/// The longest time of the logic in front of a factor of a product.
pub(super) const LONGEST_TO_FACTOR: f64 = 2.5;

/// The longest time of the logic in front of the address of a table.
pub(super) const LONGEST_TO_TABLE: f64 = 6.0;

/// The longest time of the logic in front of a register.
pub(super) const LONGEST_TO_REGISTER: f64 = 12.5;

/// Returns the time of an operation's own logic. Products and tables have microinstructions of their own, and count as 0.
pub(super) fn time_of(plan: &ExpressionPlan, id: NodeId) -> f64 {
    let node = plan.node(id);
    let width_of = |id: NodeId| f64::from(plan.node(id).format.width());
    let carry = |width: f64| 2.0 + 0.1 * width;
    match &node.operation {
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
        Operation::NonZero(_) | Operation::Choose { .. } | Operation::Lookup { .. } => 2.5,
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
        | Operation::Places(_) => 0.0,
    }
}

/// Returns the longest time that the logic in front of a node may take.
pub(super) fn longest_to(operation: &Operation) -> f64 {
    match operation {
        Operation::Multiply(..) => LONGEST_TO_FACTOR,
        Operation::Polynomial(..) => LONGEST_TO_TABLE,
        _ => LONGEST_TO_REGISTER,
    }
}

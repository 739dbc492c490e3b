//! Defines the operations of a plan and the formats of their results.

use std::mem::{Discriminant, discriminant};
use std::sync::Arc;

use glint_approximate::{Piecewise, TargetFunction};
use glint_base::fixed::{Format, Rounding};
use glint_base::interval::Interval;
use glint_formula::Enclosure;

/// A node of a plan, by its place in [`super::ExpressionPlan::nodes`]. A node reads only nodes that are before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NodeId(pub usize);

/// One integer operation with the format of its result.
#[derive(Clone, Debug)]
pub struct PlanNode {
    /// The name of the net in the hardware. No other node has it.
    pub name: String,
    /// The operation on earlier nodes.
    pub operation: Operation,
    /// The format of the result.
    pub format: Format,
    /// The smallest and the largest raw value, whatever the operands are.
    pub range: Interval,
    /// Limits of the value in real-number arithmetic, for all operands for which something is promised. The rewriting of the
    /// formula knows them, as that the smaller of two numbers divided by the larger is at most 1.
    pub limits: Enclosure,
    /// The number of the choice of fraction bits that this node's error depends on; `None` for an exact operation.
    pub source: Option<usize>,
}

/// An operation on raw values. Operands with different points are aligned first: the one with fewer fraction bits gets
/// zeros at its end.
#[derive(Clone, Debug)]
pub enum Operation {
    /// The operand of this number.
    Operand(usize),
    /// A raw constant, for a real number that lies within limits.
    Constant {
        /// The raw value.
        raw: i128,
        /// Limits of the real number.
        value: Enclosure,
    },
    /// a + b, whole.
    Add(NodeId, NodeId),
    /// a − b, whole.
    Subtract(NodeId, NodeId),
    /// a · b, whole.
    Multiply(NodeId, NodeId),
    /// |a|. The result has no sign.
    Absolute(NodeId),
    /// The smaller of two.
    Minimum(NodeId, NodeId),
    /// The larger of two.
    Maximum(NodeId, NodeId),
    /// 1 where a < b, else 0.
    Less(NodeId, NodeId),
    /// 1 where a is not 0, else 0.
    NonZero(NodeId),
    /// The second where the condition is 1, else the first.
    Choose {
        /// A bit.
        condition: NodeId,
        /// The result where the bit is 0, and where it is 1.
        cases: [NodeId; 2],
        /// Whether both cases have the same value in real numbers where the condition changes, as in |a|. A condition that
        /// rounding errors decide wrongly then does no harm.
        is_continuous: bool,
    },
    /// The same bits, read as the value times a power of two: the format of the result says which.
    Scale(NodeId),
    /// The value in the format of the result: low bits are rounded off, and high bits are dropped. The proof shows that
    /// the dropped bits are copies of the sign.
    Narrow(NodeId, Rounding),
    /// The bit of this number of an integer, 0 for the lowest.
    Bit(NodeId, u32),
    /// The greatest integer that is not above a.
    IntegerPart(NodeId),
    /// a minus its integer part, which is the second node: from 0 to below 1.
    FractionPart(NodeId, NodeId),
    /// The value, or the largest of the format of the result where the value is above it. The value is never below 0.
    Saturate(NodeId),
    /// The bits of an unsigned word, shifted left until the top one is 1, read as a fraction from 1/2 to below 1. By
    /// pairs, the shift is even, and the fraction from 1/4 to below 1. A word of zeros stays so.
    Normalise {
        /// The word.
        word: NodeId,
        /// Whether the shift is by pairs of places.
        by_pairs: bool,
    },
    /// The places, or the pairs of places, by which a [`Operation::Normalise`] shifted. For a word of zeros it is all ones.
    Places(NodeId),
    /// a · 2^places. High bits are dropped, as by [`Operation::Narrow`].
    ShiftLeft(NodeId, NodeId),
    /// a / 2^places, rounded down to the fraction bits of a, which has no sign.
    ShiftRight(NodeId, NodeId),
    /// A function of one number, by piecewise polynomials.
    Polynomial(NodeId, Box<Approximation>),
}

/// A function of one number within a plan.
#[derive(Clone, Debug)]
pub struct Approximation {
    /// The function, with its domain and the error that it may have.
    pub function: TargetFunction,
    /// The polynomials; `None` while the plan only estimates errors.
    pub polynomials: Option<Arc<Piecewise>>,
}

impl Approximation {
    /// Returns the largest error of the result, as a value: the proved one if the polynomials are known, otherwise the one
    /// that is allowed.
    pub fn error(&self) -> f64 {
        let units = self.polynomials.as_ref().map_or(self.function.error, |it| it.bound);
        units * glint_base::fixed::exp2(-(self.function.fraction as i32))
    }
}

impl Operation {
    /// Returns everything that an exact operation is known by; `None` for an operation that may round, or that has more than its
    /// inputs.
    pub(super) fn identity(&self) -> Option<(Discriminant<Self>, Vec<NodeId>, u32)> {
        let more = match self {
            Self::Operand(_) | Self::Constant { .. } | Self::Polynomial(..) => return None,
            Self::Narrow(..) | Self::ShiftRight(..) | Self::ShiftLeft(..) => return None,
            Self::Choose { is_continuous, .. } => u32::from(*is_continuous),
            Self::Normalise { by_pairs, .. } => u32::from(*by_pairs),
            Self::Bit(_, number) => *number,
            _ => 0,
        };
        Some((discriminant(self), self.inputs(), more))
    }

    /// Returns the nodes that the operation reads.
    pub fn inputs(&self) -> Vec<NodeId> {
        match self {
            Self::Operand(_) | Self::Constant { .. } => Vec::new(),
            Self::Absolute(a)
            | Self::NonZero(a)
            | Self::Scale(a)
            | Self::Narrow(a, _)
            | Self::IntegerPart(a)
            | Self::Bit(a, _)
            | Self::Saturate(a)
            | Self::Normalise { word: a, .. }
            | Self::Places(a)
            | Self::Polynomial(a, _) => vec![*a],
            Self::Add(a, b)
            | Self::Subtract(a, b)
            | Self::Multiply(a, b)
            | Self::Minimum(a, b)
            | Self::Maximum(a, b)
            | Self::Less(a, b)
            | Self::FractionPart(a, b)
            | Self::ShiftLeft(a, b)
            | Self::ShiftRight(a, b) => vec![*a, *b],
            Self::Choose { condition, cases, .. } => vec![*condition, cases[0], cases[1]],
        }
    }
}

/// Returns the shifts that normalise a word of `width` bits, the largest first, in places. For example, 8 bits have the
/// shifts 4, 2 and 1, and by pairs 4 and 2.
pub fn normalising_shifts(width: u32, by_pairs: bool) -> Vec<u32> {
    let least = if by_pairs { 2 } else { 1 };
    let mut shifts = Vec::new();
    let mut shift = (width - 1).max(1).next_power_of_two();
    while shift >= least {
        if shift < width {
            shifts.push(shift);
        }
        shift /= 2;
    }
    shifts
}

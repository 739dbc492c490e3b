//! Defines the operations of a plan, and the format of each result. For example, a plan contains sums, products, shifts and
//! tables of polynomials.

use std::mem::{Discriminant, discriminant};
use std::sync::Arc;

use glint_approximate::{Piecewise, TargetFunction};
use glint_base::fixed::{Format, Rounding};
use glint_base::interval::Interval;
use glint_formula::Enclosure;

use super::guarded::GuardedFormula;

/// The index of a node in [`super::ExpressionPlan::nodes`]. A node reads only nodes with a smaller index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NodeId(pub usize);

/// One operation of a plan, with the format of its result.
#[derive(Clone, Debug)]
pub struct PlanNode {
    /// The name of the node's net in the hardware, unique in the plan.
    pub name: String,
    /// The operation on earlier nodes.
    pub operation: Operation,
    /// The format of the result.
    pub format: Format,
    /// The smallest and the largest raw value that the node can have, for operands in their domains.
    pub range: Interval,
    /// An interval that contains the node's value in real-number arithmetic, for all operands for which a result is promised.
    /// The rewriting of the formula supplies it, and it may be infinite. For example, the smaller of two numbers divided by the
    /// larger is at most 1.
    pub limits: Enclosure,
    /// An interval that contains the value that the hardware computes, for the same operands. The interval may be infinite.
    pub actual_limits: Enclosure,
    /// The value of the node by a formula of the operands, for all operands for which the node matters. The rewriting supplies it
    /// where the nodes before this one do not show the value; `None` for the others.
    pub stated: Option<StatedValue>,
    /// The largest distance between the node's value in real-number arithmetic and the operation on the inputs' values in real-number
    /// arithmetic. The distance is 0 for most nodes. For example, a quotient whose constants were rounded before has about half a unit
    /// of these constants.
    pub deviation: f64,
    /// How near the cases of a choice are to each other where the compared numbers are nearly equal; `None` if this is not known, and
    /// for other operations.
    pub agreement: Option<CaseAgreement>,
    /// The number of the rounding operation, for which the planner chooses the fraction bits; `None` for an exact operation.
    pub source: Option<usize>,
}

/// The value of a node, stated by the formula that it computes.
#[derive(Clone, Debug)]
pub struct StatedValue {
    /// The formula, with the conditions under which its value matters.
    pub formula: Arc<GuardedFormula>,
    /// How near the hardware's value is to the formula.
    pub accuracy: ValueAccuracy,
}

/// How near the cases of a choice are to each other. If d is the distance of the numbers that the condition compares, the cases differ by
/// at most `slope` · d / `scale`. For example, the angles of a direction on both sides of a diagonal differ by at most twice the distance
/// from the diagonal, divided by the larger coordinate.
#[derive(Clone, Debug)]
pub struct CaseAgreement {
    /// The slope.
    pub slope: f64,
    /// The formula by which the distance is divided. Its values are not below 0.
    pub scale: Arc<GuardedFormula>,
}

/// How near the hardware's value of a node is to the formula that the node computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueAccuracy {
    /// The hardware has the value of the formula. For example, a node that corrects an estimate of a quotient has the quotient's
    /// integer part.
    Exact,
    /// The hardware has the value of the formula, rounded to the nearest value with the fraction bits of the node. A value in the
    /// middle of two is rounded up.
    Nearest,
    /// The accuracy follows from the errors of the inputs. The formula only gives the ideal value of a choice if the case that
    /// the hardware does not take has no limits.
    FromInputs,
}

impl PlanNode {
    /// Returns whether the stated value of the node alone limits its error, whatever the errors of its inputs are.
    pub(super) fn has_stated_error(&self) -> bool {
        let accuracy = self.stated.as_ref().map(|stated| stated.accuracy);
        matches!(accuracy, Some(ValueAccuracy::Exact | ValueAccuracy::Nearest))
    }

    /// Returns whether two nodes compute the same function of their inputs, in the same format. All operands count as the same.
    pub(super) fn is_alike(&self, other: &Self) -> bool {
        if self.format != other.format {
            return false;
        }
        match (&self.operation, &other.operation) {
            (Operation::Constant { raw: a, .. }, Operation::Constant { raw: b, .. }) => a == b,
            (Operation::Narrow(_, a), Operation::Narrow(_, b)) => a == b,
            (Operation::Bit(_, a), Operation::Bit(_, b)) => a == b,
            (
                Operation::Normalise { by_pairs: a, .. },
                Operation::Normalise { by_pairs: b, .. },
            ) => a == b,
            (Operation::Lookup { words: a, .. }, Operation::Lookup { words: b, .. }) => a == b,
            (Operation::Polynomial(_, a), Operation::Polynomial(_, b)) => {
                a.polynomials.is_some() && a.polynomials == b.polynomials
            }
            (a, b) => discriminant(a) == discriminant(b),
        }
    }
}

/// An operation on raw values. If two inputs have different numbers of fraction bits, zeros are appended to the input with
/// fewer.
#[derive(Clone, Debug)]
pub enum Operation {
    /// The operand of the expression with this index.
    Operand(usize),
    /// A constant: a real number, rounded to a raw value.
    Constant {
        /// The raw value.
        raw: i128,
        /// An interval that contains the real number.
        value: Enclosure,
    },
    /// a + b, exact.
    Add(NodeId, NodeId),
    /// a − b, exact.
    Subtract(NodeId, NodeId),
    /// a · b, exact.
    Multiply(NodeId, NodeId),
    /// The absolute value of a. The result has no sign.
    Absolute(NodeId),
    /// The smaller of two values.
    Minimum(NodeId, NodeId),
    /// The larger of two values.
    Maximum(NodeId, NodeId),
    /// 1 if a < b, else 0.
    Less(NodeId, NodeId),
    /// 1 if a is not 0, else 0.
    NonZero(NodeId),
    /// One of two values. A condition decides which one.
    Choose {
        /// The condition, a node of one bit.
        condition: NodeId,
        /// The result if the condition is 0, and the result if it is 1.
        cases: [NodeId; 2],
    },
    /// The same bits with another weight: the value times a power of two. The difference between the fraction bits of input and
    /// result is the exponent.
    Scale(NodeId),
    /// The value, converted to the format of the result: low bits are rounded off, and high bits are dropped. The proof shows
    /// that the dropped high bits are copies of the sign, except for a result that wraps.
    Narrow(NodeId, Rounding),
    /// The value, with its low bits replaced by a single 1: the middle of all values with the same upper bits. High bits are
    /// dropped, as by [`Operation::Narrow`]. For example, 0.1011 and 0.1001 become 0.101 if two bits are kept.
    Middle(NodeId),
    /// One bit of an integer as 0 or 1. The number counts from the lowest bit, which is bit 0.
    Bit(NodeId, u32),
    /// The greatest integer that is not above the input.
    IntegerPart(NodeId),
    /// The input minus its integer part, from 0 to below 1. The second node is the integer part.
    FractionPart(NodeId, NodeId),
    /// An unsigned word, shifted left until its top bit is 1, and read as a fraction from 1/2 to below 1. If `by_pairs` is
    /// true, the shift is even and the fraction goes from 1/4 to below 1. A word of zeros stays zero.
    Normalise {
        /// The word to shift.
        word: NodeId,
        /// Whether the word is shifted by pairs of bits.
        by_pairs: bool,
    },
    /// The number of bits by which an [`Operation::Normalise`] node has shifted its word, or of pairs of bits if it shifts by
    /// pairs. For a word of zeros, all bits of this number are 1. The node directly follows its [`Operation::Normalise`] node in the
    /// plan: the analysis of errors gives both their values at once, and the hardware builds them together.
    Places(NodeId),
    /// a · 2^b, where b is the value of the second node. High bits are dropped, as by [`Operation::Narrow`].
    ShiftLeft(NodeId, NodeId),
    /// a / 2^b, where b is the value of the second node, rounded down to the fraction bits of a.
    ShiftRight(NodeId, NodeId),
    /// The bits of an unsigned word in the opposite order. For example, 0b0011 gives 0b1100. Only units have this operation: their
    /// shifter to the right shifts a reversed word to the left.
    Reverse(NodeId),
    /// A table of constants. The address, an unsigned integer, selects a word; address 0 selects the first. For example, the
    /// words 5, 7 give 7 for the address 1. The value for an address without a word is not defined.
    Lookup {
        /// The node of the address.
        address: NodeId,
        /// The raw constants, for the addresses 0, 1, 2 and so on.
        words: Vec<i128>,
    },
    /// A function of one number, computed by a table of polynomials.
    Polynomial(NodeId, Box<Approximation>),
}

/// A function of one number that a plan computes by a table of polynomials.
#[derive(Clone, Debug)]
pub struct Approximation {
    /// The function, with its domain and its allowed error.
    pub function: TargetFunction,
    /// The table of polynomials; `None` while the planner only estimates errors.
    pub polynomials: Option<Arc<Piecewise>>,
}

impl Approximation {
    /// Returns the largest error of the result as a real value, not in units. The result is the proven error if the polynomials
    /// are known, and otherwise the allowed error.
    pub fn error(&self) -> f64 {
        let units = self.polynomials.as_ref().map_or(self.function.error, |it| it.bound);
        units * glint_base::fixed::exp2(-(self.function.fraction as i32))
    }
}

/// Returns a list of references to the nodes that an operation reads. The references are mutable if the operation is borrowed
/// mutably.
macro_rules! inputs_of {
    ($operation:expr) => {
        match $operation {
            Operation::Operand(_) | Operation::Constant { .. } => Vec::new(),
            Operation::Absolute(a)
            | Operation::NonZero(a)
            | Operation::Scale(a)
            | Operation::Narrow(a, _)
            | Operation::Middle(a)
            | Operation::IntegerPart(a)
            | Operation::Bit(a, _)
            | Operation::Normalise { word: a, .. }
            | Operation::Places(a)
            | Operation::Reverse(a)
            | Operation::Lookup { address: a, .. }
            | Operation::Polynomial(a, _) => vec![a],
            Operation::Add(a, b)
            | Operation::Subtract(a, b)
            | Operation::Multiply(a, b)
            | Operation::Minimum(a, b)
            | Operation::Maximum(a, b)
            | Operation::Less(a, b)
            | Operation::FractionPart(a, b)
            | Operation::ShiftLeft(a, b)
            | Operation::ShiftRight(a, b) => vec![a, b],
            Operation::Choose { condition, cases: [zero, one] } => vec![condition, zero, one],
        }
    };
}

impl Operation {
    /// Returns a key that is equal for two operations that compute the same exact value: the kind of the operation, the nodes
    /// that it reads, and a parameter. Returns `None` for an operation that may round, and for operands, constants and tables.
    pub(super) fn identity(&self) -> Option<(Discriminant<Self>, Vec<NodeId>, u32)> {
        let more = match self {
            Self::Operand(_) | Self::Constant { .. } => return None,
            Self::Lookup { .. } | Self::Polynomial(..) => return None,
            Self::Narrow(..) | Self::Middle(_) | Self::ShiftRight(..) | Self::ShiftLeft(..) => {
                return None;
            }
            Self::Normalise { by_pairs, .. } => u32::from(*by_pairs),
            Self::Bit(_, number) => *number,
            _ => 0,
        };
        Some((discriminant(self), self.inputs(), more))
    }

    /// Returns a copy of the operation in which `of_node` has replaced each node that the operation reads.
    pub(super) fn with_inputs(&self, of_node: &dyn Fn(NodeId) -> NodeId) -> Self {
        let mut operation = self.clone();
        for input in inputs_of!(&mut operation) {
            *input = of_node(*input);
        }
        operation
    }

    /// Returns the nodes that the operation reads, in the order of the operation's fields.
    pub fn inputs(&self) -> Vec<NodeId> {
        inputs_of!(self).into_iter().copied().collect()
    }

    /// Returns the nodes whose signals the hardware of the operation reads. The fraction of a number consists of its low bits,
    /// so that the hardware does not read its integer part.
    pub fn hardware_inputs(&self) -> Vec<NodeId> {
        match self {
            Self::FractionPart(a, _) => vec![*a],
            _ => self.inputs(),
        }
    }
}

/// Returns the shifts with which hardware normalises a word of `width` bits, from the largest to the smallest. The shifts are
/// powers of two below `width`, which must be at least 1. For example, 8 bits need the shifts 4, 2 and 1, and by pairs 4 and 2.
/// A word of one bit needs none.
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

/// Returns a raw value without its lowest `places` bits, and with the lowest remaining bit set to 1. The result has `places`
/// fraction bits fewer. For example, 0b10110 with 2 places gives 0b101.
pub(super) fn middle(raw: i128, places: i32) -> i128 {
    raw >> places.min(127) | 1
}

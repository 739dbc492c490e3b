//! Defines the combinational cells of a netlist, with their operands and widths.

use super::NetId;

/// A combinational cell, such as a sum or a mux. The cell drives one net. "Same width" means that the operands and the result
/// have equal widths. Operands are nets of a design, or other values of type `N`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op<N = NetId> {
    /// The bits of the operand, under another name or format; same width.
    Relabel(N),
    /// The operand with copies of its sign bit (signed operand) or zeros (unsigned operand) above it; the result is wider. For
    /// example, `10` extended to 4 bits is `1110` if signed, and `0010` if unsigned.
    Extend(N),
    /// The bits of the operand from `low` up, as many as the result is wide: `low` 2 and a result of 3 bits give the bits 2, 3
    /// and 4.
    Slice {
        of: N,
        /// The number of the lowest bit that is taken.
        low: u32,
    },
    /// The bits of all operands joined, the first operand in the top bits; the result is as wide as all operands together. For
    /// example, `10` and `011` give `10011`.
    Concat(Vec<N>),
    /// Every bit inverted; same width.
    Not(N),
    /// Bitwise and; same width.
    And(N, N),
    /// Bitwise or; same width.
    Or(N, N),
    /// Bitwise exclusive or; same width.
    Xor(N, N),
    /// Sum modulo 2^width; operands and result of the same width, the carry one bit.
    Add {
        a: N,
        b: N,
        /// The carry into the adder, one bit; `None` is a carry of 0.
        carry: Option<N>,
    },
    /// Difference `a − b` modulo 2^width; same width.
    Sub(N, N),
    /// The exact product; the operands are both signed or both unsigned, and the result is as wide as both together.
    Mul(N, N),
    /// A bit that is 1 if the operands, which have the same width, are equal.
    Equal(N, N),
    /// A bit that is 1 if the first operand is less than the second. The operands have the same width, and both are signed or
    /// both unsigned.
    Less(N, N),
    /// A bit that is 1 if any bit of the operand is 1.
    Any(N),
    /// A bit that is 1 if every bit of the operand is 1.
    All(N),
    /// The input with the number `select`, or the last input for a larger number. All inputs and the result have the same width.
    Mux {
        /// A net of enough bits to number all inputs.
        select: N,
        /// Two or more nets.
        inputs: Vec<N>,
    },
}

impl<N> Op<N> {
    /// Returns the same kind of cell with other operands, such as `x + y` for `a + b`. Calls `of` in the order of the variant's
    /// fields.
    pub fn map<M>(&self, mut of: impl FnMut(&N) -> M) -> Op<M> {
        match self {
            Self::Relabel(a) => Op::Relabel(of(a)),
            Self::Extend(a) => Op::Extend(of(a)),
            Self::Slice { of: a, low } => Op::Slice { of: of(a), low: *low },
            Self::Concat(parts) => Op::Concat(parts.iter().map(of).collect()),
            Self::Not(a) => Op::Not(of(a)),
            Self::And(a, b) => Op::And(of(a), of(b)),
            Self::Or(a, b) => Op::Or(of(a), of(b)),
            Self::Xor(a, b) => Op::Xor(of(a), of(b)),
            Self::Add { a, b, carry } => {
                Op::Add { a: of(a), b: of(b), carry: carry.as_ref().map(of) }
            }
            Self::Sub(a, b) => Op::Sub(of(a), of(b)),
            Self::Mul(a, b) => Op::Mul(of(a), of(b)),
            Self::Equal(a, b) => Op::Equal(of(a), of(b)),
            Self::Less(a, b) => Op::Less(of(a), of(b)),
            Self::Any(a) => Op::Any(of(a)),
            Self::All(a) => Op::All(of(a)),
            Self::Mux { select, inputs } => {
                Op::Mux { select: of(select), inputs: inputs.iter().map(of).collect() }
            }
        }
    }

    /// Returns the operands in the order of the variant's fields, in a mux the select first.
    pub fn operands(&self) -> Vec<N>
    where
        N: Copy,
    {
        let mut operands = Vec::new();
        self.map(|operand| operands.push(*operand));
        operands
    }

    /// Returns the short name of the cell in netlist dumps and block diagrams, such as `add`.
    pub fn mnemonic(&self) -> &'static str {
        match self {
            Self::Relabel(_) => "relabel",
            Self::Extend(_) => "extend",
            Self::Slice { .. } => "slice",
            Self::Concat(_) => "concat",
            Self::Not(_) => "not",
            Self::And(..) => "and",
            Self::Or(..) => "or",
            Self::Xor(..) => "xor",
            Self::Add { .. } => "add",
            Self::Sub(..) => "sub",
            Self::Mul(..) => "mul",
            Self::Equal(..) => "equal",
            Self::Less(..) => "less",
            Self::Any(_) => "any",
            Self::All(_) => "all",
            Self::Mux { .. } => "mux",
        }
    }
}

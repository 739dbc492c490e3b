//! Combinational cells.

use super::NetId;

/// A combinational cell. Widths are those of the nets; "same width" includes the result.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// The operand's bits under another name or format; same width.
    Relabel(NetId),
    /// The operand with copies of its sign bit (signed operand) or zeros (unsigned) above it; the
    /// result is wider.
    Extend(NetId),
    /// The bits of the operand from `low` up, as many as the result is wide.
    Slice {
        /// The operand.
        of: NetId,
        /// The lowest bit taken.
        low: u32,
    },
    /// The operands side by side, the first in the top bits; the result is as wide as all together.
    Concat(Vec<NetId>),
    /// Every bit inverted; same width.
    Not(NetId),
    /// Bitwise and; same width.
    And(NetId, NetId),
    /// Bitwise or; same width.
    Or(NetId, NetId),
    /// Bitwise exclusive or; same width.
    Xor(NetId, NetId),
    /// Sum modulo 2^width; operands and result of the same width, the carry one bit.
    Add {
        /// First operand.
        a: NetId,
        /// Second operand.
        b: NetId,
        /// Carry in.
        carry: Option<NetId>,
    },
    /// Difference `a − b` modulo 2^width; same width.
    Sub(NetId, NetId),
    /// The whole product; operands both signed or both unsigned, the result as wide as both together.
    Mul(NetId, NetId),
    /// 1 when the operands, of one width, are equal; the result is one bit.
    Equal(NetId, NetId),
    /// 1 when `a < b`; operands of one width, both signed or both unsigned; the result is one bit.
    Less(NetId, NetId),
    /// 1 when any bit of the operand is 1; the result is one bit.
    Any(NetId),
    /// 1 when every bit of the operand is 1; the result is one bit.
    All(NetId),
    /// Input number `select`; inputs of the result's width. Beyond the last input: the last input.
    Mux {
        /// As wide as the number of inputs needs.
        select: NetId,
        /// Two or more.
        inputs: Vec<NetId>,
    },
}

impl Op {
    /// Every operand, in order of writing.
    pub fn operands(&self) -> Vec<NetId> {
        match self {
            Self::Relabel(a) | Self::Extend(a) | Self::Not(a) | Self::Any(a) | Self::All(a) => {
                vec![*a]
            }
            Self::Slice { of, .. } => vec![*of],
            Self::Concat(parts) => parts.clone(),
            Self::And(a, b)
            | Self::Or(a, b)
            | Self::Xor(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Equal(a, b)
            | Self::Less(a, b) => vec![*a, *b],
            Self::Add { a, b, carry } => {
                [Some(*a), Some(*b), *carry].into_iter().flatten().collect()
            }
            Self::Mux { select, inputs } => {
                [*select].into_iter().chain(inputs.iter().copied()).collect()
            }
        }
    }

    /// Every operand, in order of writing, to be replaced by others.
    pub fn operands_mut(&mut self) -> Vec<&mut NetId> {
        match self {
            Self::Relabel(a)
            | Self::Extend(a)
            | Self::Not(a)
            | Self::Any(a)
            | Self::All(a)
            | Self::Slice { of: a, .. } => vec![a],
            Self::Concat(parts) => parts.iter_mut().collect(),
            Self::And(a, b)
            | Self::Or(a, b)
            | Self::Xor(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Equal(a, b)
            | Self::Less(a, b) => vec![a, b],
            Self::Add { a, b, carry } => {
                [Some(a), Some(b), carry.as_mut()].into_iter().flatten().collect()
            }
            Self::Mux { select, inputs } => {
                std::iter::once(select).chain(inputs.iter_mut()).collect()
            }
        }
    }

    /// The name of the cell in dumps and diagrams.
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

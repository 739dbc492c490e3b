//! What is known of the bits of a net, and what a cell makes of it.

use crate::base::fixed::mask;
use crate::hdl::netlist::{Design, Driver, NetId, Op};

/// Some bits of a pattern; the others may be anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Known {
    /// 1 where the bit is known.
    pub(super) mask: u64,
    /// The known bits; 0 elsewhere.
    pub(super) value: u64,
}

impl Known {
    /// Nothing is known.
    pub(super) const NOTHING: Self = Self { mask: 0, value: 0 };

    /// All bits of a net so wide.
    pub(super) fn all(value: u64, width: u32) -> Self {
        let mask = mask(width);
        Self { mask, value: value & mask }
    }

    /// What every value from `low` to `high` has in common, as a pattern so wide.
    pub(super) fn of_interval((low, high): (i128, i128), width: u32) -> Self {
        let (low, high) = (low as u64 & mask(width), high as u64 & mask(width));
        let differ = low ^ high;
        // From the highest bit that differs down; where the interval goes through 0 that is the sign.
        let unknown = if differ == 0 { 0 } else { u64::MAX >> differ.leading_zeros() };
        let mask = mask(width) & !unknown;
        Self { mask, value: low & mask }
    }

    /// The whole pattern, if it is known.
    pub(super) fn whole(self, width: u32) -> Option<u64> {
        (self.mask & mask(width) == mask(width)).then_some(self.value & mask(width))
    }

    /// What both have in common.
    pub(super) fn join(self, other: Self) -> Self {
        let mask = self.mask & other.mask & !(self.value ^ other.value);
        Self { mask, value: self.value & mask }
    }

    /// What either knows of the same pattern.
    pub(super) fn and_also(self, other: Self) -> Self {
        Self { mask: self.mask | other.mask, value: self.value | other.value }
    }

    /// Without these bits.
    pub(super) fn without(self, bits: u64) -> Self {
        Self { mask: self.mask & !bits, value: self.value & !bits }
    }

    /// The bits on which both are known and agree.
    pub(super) fn agree(self, other: Self) -> u64 {
        self.mask & other.mask & !(self.value ^ other.value)
    }

    /// Whether the pattern may be `value`.
    pub(super) fn may_be(self, value: u64) -> bool {
        self.mask & (self.value ^ value) == 0
    }

    /// The bits that are known to be 0.
    pub(super) fn zeros(self) -> u64 {
        self.mask & !self.value
    }

    fn of(zeros: u64, ones: u64) -> Self {
        Self { mask: zeros | ones, value: ones }
    }

    pub(super) fn not(self, width: u32) -> Self {
        Self { mask: self.mask, value: !self.value & self.mask & mask(width) }
    }

    fn bit(known: Option<bool>) -> Self {
        known.map_or(Self::NOTHING, |bit| Self::all(u64::from(bit), 1))
    }
}

/// What is known of the result of a cell so wide, when `value` says what is of its operands.
pub(super) fn cell(design: &Design, op: &Op, width: u32, value: &impl Fn(NetId) -> Known) -> Known {
    let all = mask(width);
    match op {
        Op::Relabel(a) => value(*a),
        Op::Extend(a) => extend(value(*a), design.width(*a), width, design.net(*a).format.signed),
        Op::Slice { of, low } => {
            let of = value(*of);
            Known { mask: of.mask >> low & all, value: of.value >> low & all }
        }
        Op::Concat(parts) => parts.iter().fold(Known::NOTHING, |sum, part| {
            let (part, width) = (value(*part), design.width(*part));
            let up = |bits: u64| bits.checked_shl(width).unwrap_or(0);
            Known { mask: up(sum.mask) | part.mask, value: up(sum.value) | part.value }
        }),
        Op::Not(a) => value(*a).not(width),
        Op::And(a, b) => {
            let (a, b) = (value(*a), value(*b));
            Known::of(a.zeros() | b.zeros(), a.value & b.value)
        }
        Op::Or(a, b) => {
            let (a, b) = (value(*a), value(*b));
            Known::of(a.zeros() & b.zeros(), a.value | b.value)
        }
        Op::Xor(a, b) => {
            let (a, b) = (value(*a), value(*b));
            let mask = a.mask & b.mask;
            Known { mask, value: (a.value ^ b.value) & mask }
        }
        Op::Add { a, b, carry } => {
            let carry = carry.map_or(Known::all(0, 1), value);
            sum(value(*a), value(*b), carry, width)
        }
        Op::Sub(a, b) => sum(value(*a), value(*b).not(width), Known::all(1, 1), width),
        Op::Mul(a, b) => product(design, *a, *b, width, value),
        Op::Equal(a, b) => {
            let (x, y) = (value(*a), value(*b));
            let width = design.width(*a);
            let differ = x.mask & y.mask & (x.value ^ y.value) != 0;
            let both = x.whole(width).zip(y.whole(width));
            Known::bit(if differ { Some(false) } else { both.map(|(x, y)| x == y) })
        }
        Op::Less(a, b) => {
            let format = design.net(*a).format;
            let width = format.width();
            let both = value(*a).whole(width).zip(value(*b).whole(width));
            Known::bit(both.map(|(a, b)| format.raw(a) < format.raw(b)))
        }
        Op::Any(a) => {
            let (a, width) = (value(*a), design.width(*a));
            Known::bit(if a.value != 0 { Some(true) } else { a.whole(width).map(|_| false) })
        }
        Op::All(a) => {
            let (a, width) = (value(*a), design.width(*a));
            Known::bit(if a.zeros() != 0 { Some(false) } else { a.whole(width).map(|_| true) })
        }
        Op::Mux { select, inputs } => {
            let mut possible = choices(value(*select), design.width(*select), inputs).map(value);
            let first = possible.next().unwrap_or_default();
            possible.fold(first, Known::join)
        }
    }
}

/// The inputs that a mux with `lines` select lines may take.
pub(super) fn choices(select: Known, lines: u32, inputs: &[NetId]) -> impl Iterator<Item = NetId> {
    let last = inputs.len() - 1;
    // The largest number that the select lines may carry: beyond the last input stands the last.
    let most = select.value | mask(lines) & !select.mask;
    inputs
        .iter()
        .enumerate()
        .filter(
            move |&(at, _)| if at == last { most >= last as u64 } else { select.may_be(at as u64) },
        )
        .map(|(_, &input)| input)
}

fn extend(a: Known, from: u32, to: u32, signed: bool) -> Known {
    let above = mask(to) & !mask(from);
    let sign = 1 << (from - 1);
    if !signed {
        Known { mask: a.mask | above, ..a }
    } else if a.mask & sign == 0 {
        a
    } else if a.value & sign == 0 {
        Known { mask: a.mask | above, ..a }
    } else {
        Known { mask: a.mask | above, value: a.value | above }
    }
}

/// A bit of a sum is known when both operands' are and the carry into it is.
fn sum(a: Known, b: Known, carry: Known, width: u32) -> Known {
    let mut carry = (carry.mask & 1 == 1).then_some(carry.value & 1);
    let mut known = Known::NOTHING;
    for bit in 0..width {
        let of = |it: Known| (it.mask >> bit & 1 == 1).then_some(it.value >> bit & 1);
        let (a, b) = (of(a), of(b));
        if let (Some(a), Some(b), Some(c)) = (a, b, carry) {
            known.mask |= 1 << bit;
            known.value |= (a ^ b ^ c) << bit;
        }
        // Two that agree decide.
        let among = [a, b, carry];
        let votes = |bit: u64| among.iter().filter(|it| **it == Some(bit)).count();
        carry = match (votes(0) >= 2, votes(1) >= 2) {
            (true, _) => Some(0),
            (_, true) => Some(1),
            _ => None,
        };
    }
    known
}

/// Leading and trailing zeros of an unsigned product, and of a square.
fn product(
    design: &Design,
    a: NetId,
    b: NetId,
    width: u32,
    value: &impl Fn(NetId) -> Known,
) -> Known {
    let most = |net: NetId| {
        let (known, format) = (value(net), design.net(net).format);
        let most = known.value | mask(format.width()) & !known.mask;
        let negative = format.signed && most >> (format.width() - 1) & 1 == 1;
        (!negative).then_some(most)
    };
    let trailing = |net: NetId| (value(net).zeros()).trailing_ones().min(design.width(net));
    let low = match square(design, a, b) {
        // k² is 0 or 1 modulo 4, and (2^t·k)² has 2t more zeros below.
        true => mask(2 * trailing(a)) | 2u64.checked_shl(2 * trailing(a)).unwrap_or(0),
        false => mask(trailing(a) + trailing(b)),
    } & mask(width);
    let high = match (most(a), most(b)) {
        (Some(a), Some(b)) => {
            let most = u128::from(a) * u128::from(b);
            let bits = 128 - most.leading_zeros();
            mask(width) & !mask(bits.min(width))
        }
        _ => 0,
    };
    match value(a).whole(design.width(a)).zip(value(b).whole(design.width(b))) {
        Some((x, y)) => {
            let raw = |net: NetId, bits| design.net(net).format.raw(bits);
            Known::all((raw(a, x).wrapping_mul(raw(b, y))) as u64, width)
        }
        None => Known { mask: low | high, value: 0 },
    }
}

/// Whether both are the same net, under whatever names.
pub(super) fn square(design: &Design, a: NetId, b: NetId) -> bool {
    named(design, a) == named(design, b)
}

/// What a net is another name of, if it is one.
pub(super) fn named(design: &Design, mut net: NetId) -> NetId {
    while let Driver::Op(Op::Relabel(of)) = design.net(net).driver {
        net = of;
    }
    net
}

/// The bits in which a sum may differ from the fault-free one's, when its summands, given as what is known in both
/// and where they may differ, do. A carry differs only where what makes it is not decided by bits that
/// agree.
pub(super) fn sum_differs(summands: [(Known, u64); 2], carry: (Known, u64), width: u32) -> u64 {
    let mut all = 0;
    let bit_of = |(known, differ): (Known, u64), bit: u32| {
        let agreed = known.mask & !differ;
        ((agreed >> bit & 1 == 1).then_some(known.value >> bit & 1), differ >> bit & 1 == 1)
    };
    let mut carry = bit_of(carry, 0);
    for bit in 0..width {
        let three = [bit_of(summands[0], bit), bit_of(summands[1], bit), carry];
        let differs = three.iter().any(|(_, differs)| *differs);
        all |= u64::from(differs) << bit;
        let votes = |value: u64| three.iter().filter(|(it, _)| *it == Some(value)).count();
        carry = match (votes(0) >= 2, votes(1) >= 2) {
            (true, _) => (Some(0), false),
            (_, true) => (Some(1), false),
            _ => (None, differs),
        };
    }
    all
}

//! Tracks which pairs of values each bit of a net can have, through each kind of cell. A pair has the values in the fault-free
//! design and in the mutant. If an output bit can only have equal pairs, the fault does not reach it. For example, an AND with a
//! bit that is 0 in both designs gives 0 in both.

use std::array::from_fn;

use crate::mutate::fault::BitChange;
use glint_base::fixed::{Format, mask};
use glint_base::interval::Interval;
use glint_rtl::netlist::{Design, Driver, NetId, Op};

/// The possible pairs (fault-free bit, mutant's bit) for each bit of a net. The four masks are the bits that can be 0 in both
/// designs, 1 in the fault-free design alone, 1 in the mutant alone, and 1 in both. The number of a pair is the fault-free bit
/// plus twice the mutant's bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pairs([u64; 4]);

impl Pairs {
    pub(super) fn constant(bits: u64, width: u32) -> Self {
        Self([!bits & mask(width), 0, 0, bits & mask(width)])
    }

    /// Returns the pairs of a net with any value, the same in both designs.
    pub(super) fn same(width: u32) -> Self {
        Self([mask(width), 0, 0, mask(width)])
    }

    /// Returns the pairs of a net with a value from `low` to `high`, the same in both designs. For example, the interval from 4
    /// to 6 in 4 bits has bit 2 at 1 and bit 3 at 0. Bits 0 and 1 may have any value.
    pub(super) fn of_interval((low, high): Interval, width: u32) -> Self {
        let (low, high) = (low as u64 & mask(width), high as u64 & mask(width));
        let differ = low ^ high;
        // All bits from the highest bit that differs down are open. If the interval contains −1 and 0, this is the sign.
        let open = if differ == 0 { 0 } else { u64::MAX >> differ.leading_zeros() };
        Self::constant(low, width).or(Self::same(width).cut(0, open))
    }

    /// Returns the union: for each bit, the pairs that are possible in `self` or `other`.
    pub(super) fn or(self, other: Self) -> Self {
        Self(from_fn(|pair| self.0[pair] | other.0[pair]))
    }

    /// Returns the intersection: for each bit, the pairs that are possible in `self` and `other`.
    pub(super) fn and(self, other: Self) -> Self {
        Self(from_fn(|pair| self.0[pair] & other.0[pair]))
    }

    pub(super) fn or_any(self, bits: u64) -> Self {
        Self(self.0.map(|pair| pair | bits))
    }

    /// Combines each fault-free bit that is possible in `self` with each mutant's bit that is possible in `mutant`.
    pub(super) fn across(self, mutant: Self) -> Self {
        let (sound, mutant) = (self.fault_free(), mutant.mutant());
        Self(from_fn(|pair| sound[pair & 1] & mutant[pair >> 1]))
    }

    /// Keeps the pairs whose fault-free bit is possible in `sound`.
    pub(super) fn within(self, sound: Self) -> Self {
        let sound = sound.fault_free();
        Self(from_fn(|pair| self.0[pair] & sound[pair & 1]))
    }

    pub(super) fn at_fault(self, bit: u32, how: BitChange) -> Self {
        let of_bit = self.cut(0, 1 << bit).0;
        let mut pairs = self.cut(0, !(1 << bit)).0;
        for (pair, bits) in of_bit.into_iter().enumerate() {
            pairs[how.applied(pair as u64, 1) as usize] |= bits;
        }
        Self(pairs)
    }

    /// Returns a mask of the bits that may differ between the fault-free design and the mutant.
    pub(super) fn differ(self) -> u64 {
        self.0[1] | self.0[2]
    }

    /// Returns masks of the bits that can be 0, and that can be 1, in the fault-free design.
    fn fault_free(self) -> [u64; 2] {
        [self.0[0] | self.0[2], self.0[1] | self.0[3]]
    }

    /// Returns masks of the bits that can be 0, and that can be 1, in the mutant.
    fn mutant(self) -> [u64; 2] {
        [self.0[0] | self.0[1], self.0[2] | self.0[3]]
    }

    pub(super) fn may_be(self, bits: u64) -> bool {
        let [zeros, ones] = self.mutant();
        bits & !ones == 0 && !bits & !zeros & (zeros | ones) == 0
    }

    /// Returns the bit pattern if only one is possible, the same in both designs.
    fn whole(self, width: u32) -> Option<u64> {
        let is_one_pattern = self.differ() == 0 && self.0[0] ^ self.0[3] == mask(width);
        if is_one_pattern { Some(self.0[3]) } else { None }
    }

    fn cut(self, low: u32, all: u64) -> Self {
        Self(self.0.map(|pair| pair >> low & all))
    }

    fn inverted(self, bits: u64) -> Self {
        Self(from_fn(|pair| self.0[pair] & !bits | self.0[pair ^ 3] & bits))
    }

    /// Returns the numbers of the pairs that are possible for bit number `bit`.
    fn at(self, bit: u32) -> impl Iterator<Item = usize> + Clone {
        (0..4).filter(move |&pair| self.0[pair] >> bit & 1 == 1)
    }

    /// Combines the pairs of two operands bit by bit. `result` computes the number of a pair from the numbers of the operands'
    /// pairs.
    fn bitwise(self, other: Self, result: impl Fn(usize, usize) -> usize) -> Self {
        let mut all = [0; 4];
        for (a, left) in self.0.into_iter().enumerate() {
            for (b, right) in other.0.into_iter().enumerate() {
                all[result(a, b)] |= left & right;
            }
        }
        Self(all)
    }

    /// Computes bit by bit, from the lowest of `width` bits up. In each bit, `step` takes a bit of each operand and the carry
    /// from below (`from` at the lowest bit). It gives a bit of the result and the next carry. Returns the pairs of the result
    /// and of the last carry.
    fn rippled(
        self,
        other: Self,
        width: u32,
        from: Self,
        step: impl Fn(usize, usize, usize) -> (usize, usize),
    ) -> (Self, Self) {
        let (mut result, mut carry) = (Self([0; 4]), from);
        for bit in 0..width {
            let mut next = Self([0; 4]);
            for a in self.at(bit) {
                for b in other.at(bit) {
                    for c in carry.at(0) {
                        let (one, on) = step(a, b, c);
                        result.0[one] |= 1 << bit;
                        next.0[on] |= 1;
                    }
                }
            }
            carry = next;
        }
        (result, carry)
    }

    fn plus(self, other: Self, carry: Self, width: u32) -> Self {
        self.rippled(other, width, carry, |a, b, c| (a ^ b ^ c, a & b | a & c | b & c)).0
    }

    /// Returns the last carry of a chain from the lowest bit up. `from` is the first carry.
    fn folded(
        self,
        other: Self,
        width: u32,
        from: u64,
        step: impl Fn(usize, usize, usize) -> usize,
    ) -> Self {
        self.rippled(other, width, Self::constant(from, 1), |a, b, c| (0, step(a, b, c))).1
    }
}

/// Returns the pairs of the result of the cell `op`. `value` gives an operand's pairs. `same` has, for each net, the first net
/// with the same value in the fault-free design, which matters for a mux's inputs.
pub(super) fn cell(
    design: &Design,
    op: &Op,
    width: u32,
    value: &impl Fn(NetId) -> Pairs,
    same: &[NetId],
) -> Pairs {
    let of = |net: &NetId| value(*net);
    let width_of = |net: &NetId| design.width(*net);
    let nothing = Pairs::constant(0, 1);
    match op {
        Op::Relabel(a) => of(a),
        Op::Extend(a) => {
            let above = mask(width) & !mask(width_of(a));
            let mut extended = of(a).0;
            for (pair, bits) in extended.iter_mut().enumerate() {
                let reaches_above = match design.net(*a).format.signed {
                    true => *bits >> (width_of(a) - 1) & 1 == 1,
                    false => pair == 0,
                };
                if reaches_above {
                    *bits |= above;
                }
            }
            Pairs(extended)
        }
        Op::Slice { of: a, low } => of(a).cut(*low, mask(width)),
        Op::Concat(parts) => {
            let mut joined = [0_u64; 4];
            for part in parts {
                for (bits, lower) in joined.iter_mut().zip(of(part).0) {
                    *bits = bits.checked_shl(width_of(part)).unwrap_or(0) | lower;
                }
            }
            Pairs(joined)
        }
        Op::Not(a) => of(a).inverted(mask(width)),
        Op::And(a, b) => of(a).bitwise(of(b), |a, b| a & b),
        Op::Or(a, b) => of(a).bitwise(of(b), |a, b| a | b),
        Op::Xor(a, b) => of(a).bitwise(of(b), |a, b| a ^ b),
        Op::Add { a, b, carry } => of(a).plus(of(b), carry.map_or(nothing, value), width),
        Op::Sub(a, b) => of(a).plus(of(b).inverted(mask(width)), Pairs::constant(1, 1), width),
        Op::Mul(a, b) => product(design, *a, *b, width, value),
        Op::Equal(a, b) => of(a).folded(of(b), width_of(a), 1, |a, b, c| (a ^ b ^ 3) & c),
        Op::Less(a, b) => {
            let width = width_of(a);
            let sign = if design.net(*a).format.signed { 1 << (width - 1) } else { 0 };
            let [a, b] = [a, b].map(|net| of(net).inverted(sign));
            a.folded(b, width, 0, |a, b, c| (a ^ 3) & b | (a ^ b ^ 3) & c)
        }
        Op::Any(a) => of(a).folded(of(a), width_of(a), 0, |a, _, c| a | c),
        Op::All(a) => of(a).folded(of(a), width_of(a), 1, |a, _, c| a & c),
        Op::Mux { select, inputs } => {
            let offered: Vec<_> = inputs.iter().map(|it| (of(it), same[it.index()])).collect();
            chosen(of(select), width_of(select), &offered)
        }
    }
}

/// Returns the pairs of a mux with a select of `lines` bits. Inputs with the same net have the same value in the fault-free
/// design, so the mutant may select any of them without a difference.
pub(super) fn chosen(select: Pairs, lines: u32, inputs: &[(Pairs, NetId)]) -> Pairs {
    let input = |number: u64| inputs[(number as usize).min(inputs.len() - 1)];
    let mut all = Pairs([0; 4]);
    for sound in 0..1 << lines {
        // The bits that can be 0 and 1 in the mutant if the fault-free select is this pattern.
        let beside =
            |pair: usize| (select.0[pair] & !sound | select.0[pair + 1] & sound) & mask(lines);
        let [zeros, ones] = [beside(0), beside(2)];
        if zeros | ones != mask(lines) {
            continue;
        }
        let mut either = zeros & ones;
        loop {
            let (sound, mutant) = (input(sound), input(ones & !zeros | either));
            let alike = sound.1 == mutant.1;
            all = all.or(if alike { mutant.0 } else { sound.0.across(mutant.0) });
            if either == 0 {
                break;
            }
            either = (either - 1) & zeros & ones;
        }
    }
    all
}

/// Returns the inputs that a mux with a select of `lines` bits may select in the mutant.
pub(super) fn choices(select: Pairs, lines: u32, inputs: &[NetId]) -> impl Iterator<Item = NetId> {
    let possible = (0..1 << lines).filter(move |&number| select.may_be(number));
    possible.map(|number: u64| inputs[(number as usize).min(inputs.len() - 1)])
}

/// Returns the known pairs of a product. Trailing zeros are known, and leading zeros if it is unsigned. From the lowest bit that
/// may differ in a factor on, any bit of the product may differ.
fn product(
    design: &Design,
    a: NetId,
    b: NetId,
    width: u32,
    value: &impl Fn(NetId) -> Pairs,
) -> Pairs {
    let (x, y) = (value(a), value(b));
    let (width_a, width_b) = (design.width(a), design.width(b));
    let (format_a, format_b) = (design.net(a).format, design.net(b).format);
    if let (Some(x), Some(y)) = (x.whole(width_a), y.whole(width_b)) {
        let raw = format_a.raw(x).wrapping_mul(format_b.raw(y));
        return Pairs::constant(raw as u64, width);
    }
    let bits = match (largest_unsigned(format_a, x), largest_unsigned(format_b, y)) {
        (Some(a), Some(b)) => 128 - (a * b).leading_zeros(),
        _ => width,
    };
    let low = match square(design, a, b) {
        // k² is 0 or 1 modulo 4, and (2^t·k)² has 2t more zeros below.
        true => {
            let zeros = 2 * trailing_zeros(x, width_a);
            mask(zeros) | 2u64.checked_shl(zeros).unwrap_or(0)
        }
        false => mask(trailing_zeros(x, width_a) + trailing_zeros(y, width_b)),
    };
    let ones = mask(bits.min(width)) & !low;
    let lowest = (x.differ() | y.differ()).trailing_zeros();
    let differ = u64::MAX.checked_shl(lowest).unwrap_or(0) & mask(width);
    Pairs([mask(width), differ, differ & ones, ones])
}

/// Returns an upper limit of the mutant's value, or `None` if a value may be negative.
fn largest_unsigned(format: Format, pairs: Pairs) -> Option<u128> {
    let [_, most] = pairs.mutant();
    let may_be_negative = format.signed && most >> (format.width() - 1) & 1 == 1;
    if may_be_negative { None } else { Some(u128::from(most)) }
}

fn trailing_zeros(pairs: Pairs, width: u32) -> u32 {
    let [_, ones] = pairs.mutant();
    ones.trailing_zeros().min(width)
}

/// Returns whether `a` and `b` are one net under different names, so their product is a square.
pub(super) fn square(design: &Design, a: NetId, b: NetId) -> bool {
    named(design, a) == named(design, b)
}

/// Returns the net that `net` renames, through any number of renamings.
pub(super) fn named(design: &Design, mut net: NetId) -> NetId {
    while let Driver::Op(Op::Relabel(of)) = design.net(net).driver {
        net = of;
    }
    net
}

//! Reduces wiring to a normal form: every word (the bits of a net) becomes a list of bit ranges of nets and constants.
//!
//! Slices, extensions, concatenations, renamed nets and constants need no hardware. [`Bits`] represents any mixture of them as
//! pieces of declared nets, constants, and copies of a sign bit. For example, the emitter finds `a[5:2]` behind three nets of
//! wiring.

use crate::netlist::NetId;
use glint_base::fixed::mask;

/// Adjacent bits of a word with the same origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BitRun {
    /// `width` adjacent bits of a net, from bit `low` up.
    Net {
        net: NetId,
        /// The position of the lowest bit in the net.
        low: u32,
        width: u32,
    },
    /// Adjacent bits of a constant.
    Constant {
        /// The bit pattern.
        value: u64,
        width: u32,
    },
    /// Two or more copies of one bit of a net.
    Copies {
        net: NetId,
        /// The position of the copied bit in the net.
        bit: u32,
        count: u32,
    },
}

impl BitRun {
    pub fn width(self) -> u32 {
        match self {
            Self::Net { width, .. } | Self::Constant { width, .. } => width,
            Self::Copies { count, .. } => count,
        }
    }

    /// Returns `width` bits from bit `low` up.
    fn slice(self, low: u32, width: u32) -> Self {
        match self {
            Self::Net { net, low: from, .. } => Self::Net { net, low: from + low, width },
            Self::Constant { value, .. } => {
                Self::Constant { value: value >> low & mask(width), width }
            }
            Self::Copies { net, bit, .. } if width == 1 => Self::Net { net, low: bit, width: 1 },
            Self::Copies { net, bit, .. } => Self::Copies { net, bit, count: width },
        }
    }

    /// Joins `self` above `below`, if they are adjacent bits of one net, or constants of at most 64 bits together.
    fn join(self, below: Self) -> Option<Self> {
        match (self, below) {
            (Self::Net { net, low, width }, Self::Net { net: other, low: from, width: count })
                if net == other && low == from + count =>
            {
                Some(Self::Net { net, low: from, width: width + count })
            }
            (Self::Constant { value, width }, Self::Constant { value: lower, width: count })
                if width + count <= 64 =>
            {
                Some(Self::Constant { value: value << count | lower, width: width + count })
            }
            _ => None,
        }
    }
}

/// The bits of a word as runs, the most significant first. `{a[5:2], 1'b0}` has two: four bits of net `a`, and a constant bit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bits(Vec<BitRun>);

impl Bits {
    /// Returns all bits of a net.
    pub fn net(net: NetId, width: u32) -> Self {
        Self(vec![BitRun::Net { net, low: 0, width }])
    }

    pub fn constant(value: u64, width: u32) -> Self {
        Self(vec![BitRun::Constant { value, width }])
    }

    /// Returns the runs, the most significant first.
    pub fn pieces(&self) -> &[BitRun] {
        &self.0
    }

    /// Returns the run of a word that has exactly one run, or `None`.
    pub fn single(&self) -> Option<BitRun> {
        match self.0[..] {
            [piece] => Some(piece),
            _ => None,
        }
    }

    pub fn width(&self) -> u32 {
        self.0.iter().map(|piece| piece.width()).sum()
    }

    /// Returns `width` bits from bit `low` up: the bits from 1 up of `{a[5:2], 1'b0}` are `a[5:2]`.
    pub fn slice(&self, low: u32, width: u32) -> Self {
        let mut taken = Self::default();
        let mut top = self.width();
        for piece in &self.0 {
            let bottom = top - piece.width();
            let (from, to) = (low.max(bottom), (low + width).min(top));
            if from < to {
                taken.append(piece.slice(from - bottom, to - from));
            }
            top = bottom;
        }
        taken
    }

    /// Appends the word `lower` below this one.
    pub fn followed_by(mut self, lower: &Self) -> Self {
        for piece in &lower.0 {
            self.append(*piece);
        }
        self
    }

    /// Extends the word to `width` bits, by copies of its top bit if `signed`, otherwise by zeros. A wider word stays as it is.
    pub fn extend(&self, width: u32, signed: bool) -> Self {
        let count = width.saturating_sub(self.width());
        if count == 0 {
            return self.clone();
        }
        let above = match self.0.first() {
            Some(BitRun::Net { net, low, width }) if signed => {
                let bit = low + width - 1;
                match count {
                    1 => BitRun::Net { net: *net, low: bit, width: 1 },
                    _ => BitRun::Copies { net: *net, bit, count },
                }
            }
            Some(BitRun::Copies { net, bit, count: already }) if signed => {
                let mut extended = self.clone();
                extended.0[0] = BitRun::Copies { net: *net, bit: *bit, count: count + already };
                return extended;
            }
            Some(BitRun::Constant { value, width }) if signed && value >> (width - 1) & 1 == 1 => {
                BitRun::Constant { value: mask(count), width: count }
            }
            _ => BitRun::Constant { value: 0, width: count },
        };
        Self(vec![above]).followed_by(self)
    }

    fn append(&mut self, piece: BitRun) {
        match self.0.last().and_then(|above| above.join(piece)) {
            Some(joined) => {
                self.0.pop();
                self.0.push(joined);
            }
            None => self.0.push(piece),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: NetId = NetId(1);
    const B: NetId = NetId(2);

    #[test]
    fn slices_of_slices_are_one_slice() {
        let bits = Bits::net(A, 20).slice(4, 10).slice(2, 3);
        assert_eq!(bits.pieces(), [BitRun::Net { net: A, low: 6, width: 3 }]);
    }

    #[test]
    fn neighbours_join_and_strangers_do_not() {
        let a = Bits::net(A, 8);
        assert_eq!(a.slice(4, 4).followed_by(&a.slice(0, 4)), a);
        assert_eq!(a.slice(0, 4).followed_by(&a.slice(4, 4)).pieces().len(), 2);
        assert_eq!(Bits::net(A, 4).followed_by(&Bits::net(B, 4)).pieces().len(), 2);
        let constant = Bits::constant(0b101, 3).followed_by(&Bits::constant(0b01, 2));
        assert_eq!(constant, Bits::constant(0b10101, 5));
    }

    #[test]
    fn extension_repeats_the_sign_bit() {
        let once = Bits::net(A, 8).extend(9, true);
        assert_eq!(once.pieces()[0], BitRun::Net { net: A, low: 7, width: 1 });
        let twice = Bits::net(A, 8).extend(10, true).extend(13, true);
        assert_eq!(twice.pieces()[0], BitRun::Copies { net: A, bit: 7, count: 5 });
        assert_eq!(Bits::constant(0b10, 2).extend(4, true), Bits::constant(0b1110, 4));
        assert_eq!(Bits::constant(0b10, 2).extend(4, false), Bits::constant(0b0010, 4));
    }

    #[test]
    fn a_slice_across_pieces_keeps_their_order() {
        let bits = Bits::net(A, 4).extend(8, true).slice(3, 3);
        assert_eq!(bits.width(), 3);
        assert_eq!(
            bits.pieces(),
            [BitRun::Copies { net: A, bit: 3, count: 2 }, BitRun::Net { net: A, low: 3, width: 1 }]
        );
    }
}

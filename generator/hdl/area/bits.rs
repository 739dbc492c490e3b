//! Finds the bits of a netlist that synthesis gets without logic: constants, and copies of other bits.
//!
//! For example, the sum of `x · 2^16` and a product needs an adder only above bit 15: its lower 16 bits are bits of the
//! product.

use std::collections::BTreeSet;

use crate::netlist::{Design, Driver, NetId, Op};

/// The origin of a bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BitSource {
    Constant(bool),
    /// The bit with the number `at`, from 0 for the lowest, of a net whose cell computes it.
    Bit {
        net: NetId,
        at: u32,
    },
}

impl BitSource {
    fn is_constant(self) -> bool {
        matches!(self, Self::Constant(_))
    }
}

/// The origins of the bits of all nets.
pub struct BitSources(Vec<Vec<BitSource>>);

impl BitSources {
    pub fn of(design: &Design) -> Self {
        let own = design.iter().map(|(id, _)| own_bits(design, id)).collect();
        let mut sources = Self(own);
        // A design with a loop has no order. Its bits are then taken as their own.
        for id in design.levelise().unwrap_or_default() {
            sources.0[id.index()] = sources.origins(design, id);
        }
        sources
    }

    fn bits(&self, net: NetId) -> &[BitSource] {
        &self.0[net.index()]
    }

    /// Returns the number of different bits of a net that are no constants.
    pub fn varying(&self, net: NetId) -> usize {
        let bits: BTreeSet<&BitSource> = self.bits(net).iter().collect();
        bits.into_iter().filter(|bit| !bit.is_constant()).count()
    }

    /// Returns the number of bits that the cell of a net computes itself.
    pub fn computed(&self, id: NetId) -> usize {
        let bits = self.bits(id).iter();
        bits.filter(|bit| matches!(bit, BitSource::Bit { net, .. } if *net == id)).count()
    }

    /// Returns the number of bits of a sum or difference that need an adder: all that the cell computes, without copies of the
    /// sign bit at the top.
    pub fn added(&self, id: NetId, a: NetId, b: NetId) -> usize {
        let (a, b) = (self.bits(a), self.bits(b));
        let mut copies = 0;
        for at in (1..a.len()).rev() {
            if a[at] != a[at - 1] || b[at] != b[at - 1] {
                break;
            }
            copies += 1;
        }
        self.computed(id).saturating_sub(copies)
    }

    /// Returns the number of inputs that the mux of a net chooses from, beyond the first, for all bits together. A constant input counts
    /// half, because it only adds an input to a gate.
    pub fn chosen(&self, id: NetId, inputs: &[NetId]) -> f64 {
        let mut sum = 0.0;
        for at in 0..self.bits(id).len() {
            let sources: BTreeSet<BitSource> =
                inputs.iter().map(|input| self.bits(*input)[at]).collect();
            if sources.len() > 1 {
                let constants = sources.iter().filter(|source| source.is_constant()).count();
                let choices = (sources.len() - 1) as f64;
                sum += (choices - 0.5 * constants as f64).max(0.5);
            }
        }
        sum
    }

    /// Returns the origins of the bits of a net. The origins of the nets that its cell reads must be known.
    fn origins(&self, design: &Design, id: NetId) -> Vec<BitSource> {
        let own = own_bits(design, id);
        let width = own.len();
        let Driver::Op(op) = &design.net(id).driver else { return own };
        let mut bits: Vec<BitSource> = match op {
            Op::Relabel(a) => self.bits(*a).to_vec(),
            Op::Slice { of, low } => self.bits(*of)[*low as usize..].to_vec(),
            Op::Concat(parts) => {
                parts.iter().rev().flat_map(|part| self.bits(*part)).copied().collect()
            }
            Op::Extend(a) => {
                let mut bits = self.bits(*a).to_vec();
                let sign = match bits.last() {
                    Some(top) if design.net(*a).format.signed => *top,
                    _ => BitSource::Constant(false),
                };
                bits.resize(width, sign);
                bits
            }
            Op::And(a, b) => self.gated(*a, *b, false, &own),
            Op::Or(a, b) => self.gated(*a, *b, true, &own),
            Op::Mux { inputs, .. } => self.same_in_all(inputs, &own),
            Op::Add { a, b, carry: None } => {
                let first = self.low_bits_kept(*a, *b, &own);
                if first == own { self.low_bits_kept(*b, *a, &own) } else { first }
            }
            Op::Sub(a, b) => self.low_bits_kept(*a, *b, &own),
            _ => own.clone(),
        };
        bits.truncate(width);
        // A bit of a net whose range is a single value is a constant, whatever computes it.
        for (bit, own) in bits.iter_mut().zip(&own) {
            if own.is_constant() {
                *bit = *own;
            }
        }
        bits
    }

    /// Returns the bits of an AND (`controlling` is false) or an OR (`controlling` is true). A bit with the constant
    /// `controlling` decides the result. With the opposite constant, the result is the other operand's bit.
    fn gated(&self, a: NetId, b: NetId, controlling: bool, own: &[BitSource]) -> Vec<BitSource> {
        let pairs = self.bits(a).iter().zip(self.bits(b)).zip(own);
        let gate = |((&a, &b), &own): ((&BitSource, &BitSource), &BitSource)| match (a, b) {
            (BitSource::Constant(value), _) | (_, BitSource::Constant(value))
                if value == controlling =>
            {
                BitSource::Constant(controlling)
            }
            (BitSource::Constant(_), other) | (other, BitSource::Constant(_)) => other,
            _ if a == b => a,
            _ => own,
        };
        pairs.map(gate).collect()
    }

    /// Returns the bits of a mux: a bit that is the same in all inputs needs no choice.
    fn same_in_all(&self, inputs: &[NetId], own: &[BitSource]) -> Vec<BitSource> {
        let bit = |(at, own): (usize, &BitSource)| {
            let first = self.bits(inputs[0])[at];
            let is_same = inputs.iter().all(|input| self.bits(*input)[at] == first);
            if is_same { first } else { *own }
        };
        own.iter().enumerate().map(bit).collect()
    }

    /// Returns the bits of a sum or difference. Below the lowest bit of `b` that is no constant 0, they are the bits of `a`.
    fn low_bits_kept(&self, a: NetId, b: NetId, own: &[BitSource]) -> Vec<BitSource> {
        let is_zero = |bit: &&BitSource| **bit == BitSource::Constant(false);
        let zeros = self.bits(b).iter().take_while(is_zero).count();
        let mut bits = own.to_vec();
        let kept = zeros.min(own.len());
        bits[..kept].copy_from_slice(&self.bits(a)[..kept]);
        bits
    }
}

/// Returns the bits of a net as its cell computes them. If the net has only one value, they are constants.
fn own_bits(design: &Design, id: NetId) -> Vec<BitSource> {
    let (low, high) = design.net(id).range;
    let bit = |at: u32| match low == high {
        true => BitSource::Constant(low >> at & 1 == 1),
        false => BitSource::Bit { net: id, at },
    };
    (0..design.width(id)).map(bit).collect()
}

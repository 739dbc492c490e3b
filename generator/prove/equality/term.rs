//! Stores and simplifies bit-vector terms: expressions for the values of nets when the operands are unknown.
//!
//! Equal terms are stored once. Constants are folded, so a microprogram with unknown operands still runs. Concatenations, slices
//! and extensions have one normal form, so many equal values become the same term without the solver.

use std::collections::HashMap;

use glint_base::cone;
use glint_base::fixed::{MAX_WIDTH, mask};

/// The number by which a [`VectorTerms`] identifies one of its terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VectorTermId(u32);

impl VectorTermId {
    pub fn number(self) -> u32 {
        self.0
    }
}

/// A bit-vector expression. Its operands have the width of the result unless the variant says otherwise.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum VectorTerm {
    /// An unknown value. Terms with the same number have the same value.
    Unknown(u32),
    Constant(u64),
    Not(VectorTermId),
    And(VectorTermId, VectorTermId),
    Or(VectorTermId, VectorTermId),
    Xor(VectorTermId, VectorTermId),
    /// The sum modulo 2^width.
    Add(VectorTermId, VectorTermId),
    /// The difference modulo 2^width.
    Sub(VectorTermId, VectorTermId),
    /// The product of 64 bits, modulo 2^64.
    Product(VectorTermId, VectorTermId),
    /// One bit, which is 1 if two terms of the same width are equal.
    Equal(VectorTermId, VectorTermId),
    /// One bit, which is 1 if the left operand is less, as unsigned numbers of the same width.
    Less(VectorTermId, VectorTermId),
    /// One bit, which is 1 if the left operand is less, as two's complement numbers of the same width.
    SignedLess(VectorTermId, VectorTermId),
    /// The second operand if the first operand, which has one bit, is 1, and otherwise the third.
    Choice(VectorTermId, VectorTermId, VectorTermId),
    /// A term's bits from `low` up, as many as the result has.
    Slice {
        of: VectorTermId,
        low: u32,
    },
    /// The concatenation of two terms, the first in the top bits.
    Join(VectorTermId, VectorTermId),
    /// A narrower term with copies of its top bit above it.
    SignExtend(VectorTermId),
    /// A word of a memory, by its index in [`VectorTerms::memories`]. The word is 0 for an address beyond the contents. The
    /// address has [`ADDRESS`] bits.
    Word {
        memory: usize,
        address: VectorTermId,
    },
}

/// The number of bits of a memory address.
pub const ADDRESS: u32 = 32;

/// A collection of terms, each stored once, after its operands.
#[derive(Default)]
pub struct VectorTerms {
    nodes: Vec<(VectorTerm, u32)>,
    known: HashMap<(VectorTerm, u32), VectorTermId>,
    unknowns: u32,
    /// The contents of the memories; equal contents are stored once.
    pub memories: Vec<Vec<u64>>,
    /// The unknown word that a read beyond the contents gives, for each memory and address.
    beyond: HashMap<(usize, VectorTermId), VectorTermId>,
}

impl VectorTerm {
    fn operands_mut(&mut self) -> Vec<&mut VectorTermId> {
        match self {
            Self::Unknown(_) | Self::Constant(_) => Vec::new(),
            Self::Not(a) | Self::Slice { of: a, .. } | Self::SignExtend(a) => vec![a],
            Self::Word { address, .. } => vec![address],
            Self::And(a, b)
            | Self::Or(a, b)
            | Self::Xor(a, b)
            | Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Product(a, b)
            | Self::Equal(a, b)
            | Self::Less(a, b)
            | Self::SignedLess(a, b)
            | Self::Join(a, b) => vec![a, b],
            Self::Choice(a, b, c) => vec![a, b, c],
        }
    }

    pub fn operands(&self) -> Vec<VectorTermId> {
        self.clone().operands_mut().into_iter().map(|id| *id).collect()
    }
}

/// Reads a bit pattern as a two's complement number. For example, 0b1110 of 4 bits is −2.
fn signed(bits: u64, width: u32) -> i64 {
    let drop = MAX_WIDTH - width;
    (bits << drop) as i64 >> drop
}

impl VectorTerms {
    pub fn term(&self, id: VectorTermId) -> &VectorTerm {
        &self.nodes[id.0 as usize].0
    }

    pub fn width(&self, id: VectorTermId) -> u32 {
        self.nodes[id.0 as usize].1
    }

    pub fn numbered(&self, number: u32) -> Option<VectorTermId> {
        ((number as usize) < self.nodes.len()).then_some(VectorTermId(number))
    }

    pub fn constant_of(&self, id: VectorTermId) -> Option<u64> {
        match *self.term(id) {
            VectorTerm::Constant(bits) => Some(bits),
            _ => None,
        }
    }

    /// Returns `roots` and all terms on which they depend, each after its operands.
    pub fn cone(&self, roots: impl IntoIterator<Item = VectorTermId>) -> Vec<VectorTermId> {
        let index = |id: VectorTermId| id.0 as usize;
        let operands = |at: usize| self.nodes[at].0.operands().into_iter().map(index);
        let live = cone::needed(self.nodes.len(), roots.into_iter().map(index), operands);
        (0..live.len()).filter(|&at| live[at]).map(|at| VectorTermId(at as u32)).collect()
    }

    /// Returns the values of the terms `cone`. `unknown` gives each unknown's value, by its number.
    pub fn values(
        &self,
        cone: &[VectorTermId],
        unknown: impl Fn(u32) -> u64,
    ) -> HashMap<VectorTermId, u64> {
        let mut values = HashMap::new();
        for &id in cone {
            let (term, width) = &self.nodes[id.0 as usize];
            let value = match term {
                VectorTerm::Unknown(number) => unknown(*number) & mask(*width),
                term => self.evaluate(term, *width, |operand| values[&operand]),
            };
            values.insert(id, value);
        }
        values
    }

    pub fn unknown(&mut self, width: u32) -> VectorTermId {
        self.unknowns += 1;
        self.insert(VectorTerm::Unknown(self.unknowns - 1), width)
    }

    pub fn constant(&mut self, bits: u64, width: u32) -> VectorTermId {
        self.insert(VectorTerm::Constant(bits & mask(width)), width)
    }

    /// Returns the index of a memory with the contents `words`; equal contents have the same index.
    pub fn memory(&mut self, words: &[u64]) -> usize {
        if let Some(at) = self.memories.iter().position(|other| other == words) {
            return at;
        }
        self.memories.push(words.to_vec());
        self.memories.len() - 1
    }

    /// Returns the unknown word that every read of `memory` at `address`, beyond the contents, gives.
    pub fn beyond(&mut self, memory: usize, address: VectorTermId, width: u32) -> VectorTermId {
        if let Some(&word) = self.beyond.get(&(memory, address)) {
            return word;
        }
        let word = self.unknown(width);
        self.beyond.insert((memory, address), word);
        word
    }

    /// Extends a term by zeros to `width` bits, or drops high bits. For example, the constant 0b101 becomes 0b0101 at a width of
    /// 4, and 0b01 at a width of 2.
    pub fn resized(&mut self, id: VectorTermId, width: u32) -> VectorTermId {
        let own = self.width(id);
        if width <= own {
            return self.slice(id, 0, width);
        }
        let zeros = self.constant(0, width - own);
        self.make(VectorTerm::Join(zeros, id), width)
    }

    /// Extends a term with copies of its sign bit. For example, 0b101 becomes 0b1101 at a width of 4.
    pub fn sign_extended(&mut self, id: VectorTermId, width: u32) -> VectorTermId {
        if self.width(id) == width { id } else { self.make(VectorTerm::SignExtend(id), width) }
    }

    pub fn slice(&mut self, of: VectorTermId, low: u32, width: u32) -> VectorTermId {
        self.make(VectorTerm::Slice { of, low }, width)
    }

    /// Replaces the low bits of a term. For example, the constant 0b1100 with the low bits 0b01 becomes 0b1101.
    pub fn with_low(&mut self, id: VectorTermId, low: VectorTermId) -> VectorTermId {
        let (width, at) = (self.width(id), self.width(low));
        if at == width {
            return low;
        }
        let upper = self.slice(id, at, width - at);
        self.make(VectorTerm::Join(upper, low), width)
    }

    pub fn equal(&mut self, a: VectorTermId, b: VectorTermId) -> VectorTermId {
        self.make(VectorTerm::Equal(a, b), 1)
    }

    pub fn not(&mut self, a: VectorTermId) -> VectorTermId {
        self.make(VectorTerm::Not(a), self.width(a))
    }

    pub fn choice(
        &mut self,
        condition: VectorTermId,
        then: VectorTermId,
        otherwise: VectorTermId,
    ) -> VectorTermId {
        self.make(VectorTerm::Choice(condition, then, otherwise), self.width(then))
    }

    pub fn has(&self, term: &VectorTerm, width: u32) -> bool {
        self.known.contains_key(&(ordered(term.clone()), width))
    }

    /// Replaces `condition`, a one-bit term, by the constant `value` in all of `terms`. The caller is on a path on which the
    /// condition has this value.
    pub fn assuming(&mut self, condition: VectorTermId, value: bool, terms: &mut [VectorTermId]) {
        let constant = self.constant(value.into(), 1);
        self.replace(&HashMap::from([(condition, constant)]), terms);
    }

    /// Replaces the keys of `by` by their values, everywhere in the expressions `terms`, but not in the replacements
    /// themselves.
    pub fn replace(
        &mut self,
        by: &HashMap<VectorTermId, VectorTermId>,
        terms: &mut [VectorTermId],
    ) {
        let mut new: HashMap<VectorTermId, VectorTermId> = HashMap::new();
        for id in self.cone(terms.iter().copied()) {
            let (term, width) = self.nodes[id.0 as usize].clone();
            let rebuilt = if let Some(&other) = by.get(&id) {
                other
            } else if term.operands().iter().all(|operand| new[operand] == *operand) {
                id
            } else {
                self.make(renamed(&term, |operand| new[&operand]), width)
            };
            new.insert(id, rebuilt);
        }
        terms.iter_mut().for_each(|term| *term = new[term]);
    }

    /// Adds a term after simplification. Operations on constants become constants. Terms that simple rules show to be equal have
    /// the same id: a + 0 is a.
    pub fn make(&mut self, term: VectorTerm, width: u32) -> VectorTermId {
        let constants: Option<HashMap<VectorTermId, u64>> =
            term.operands().into_iter().map(|id| Some((id, self.constant_of(id)?))).collect();
        if let Some(values) = constants
            && !matches!(term, VectorTerm::Unknown(_))
        {
            let bits = self.evaluate(&term, width, |id| values[&id]);
            return self.constant(bits, width);
        }
        match self.simpler(&term, width) {
            Some(id) => id,
            None => self.insert(ordered(term), width),
        }
    }

    fn insert(&mut self, term: VectorTerm, width: u32) -> VectorTermId {
        debug_assert!((1..=MAX_WIDTH).contains(&width));
        let nodes = &mut self.nodes;
        *self.known.entry((term.clone(), width)).or_insert_with(|| {
            nodes.push((term, width));
            VectorTermId(nodes.len() as u32 - 1)
        })
    }

    fn evaluate(&self, term: &VectorTerm, width: u32, of: impl Fn(VectorTermId) -> u64) -> u64 {
        let wide = |id: VectorTermId| self.width(id);
        let bits = match *term {
            VectorTerm::Unknown(_) => unreachable!("an unknown has no operands"),
            VectorTerm::Constant(bits) => bits,
            VectorTerm::Not(a) => !of(a),
            VectorTerm::And(a, b) => of(a) & of(b),
            VectorTerm::Or(a, b) => of(a) | of(b),
            VectorTerm::Xor(a, b) => of(a) ^ of(b),
            VectorTerm::Add(a, b) => of(a).wrapping_add(of(b)),
            VectorTerm::Sub(a, b) => of(a).wrapping_sub(of(b)),
            VectorTerm::Product(a, b) => of(a).wrapping_mul(of(b)),
            VectorTerm::Equal(a, b) => u64::from(of(a) == of(b)),
            VectorTerm::Less(a, b) => u64::from(of(a) < of(b)),
            VectorTerm::SignedLess(a, b) => {
                u64::from(signed(of(a), wide(a)) < signed(of(b), wide(b)))
            }
            VectorTerm::Choice(condition, a, b) => of(if of(condition) == 1 { a } else { b }),
            VectorTerm::Slice { of: a, low } => of(a) >> low,
            VectorTerm::Join(a, b) => of(a) << wide(b) | of(b),
            VectorTerm::SignExtend(a) => signed(of(a), wide(a)) as u64,
            VectorTerm::Word { memory, address } => {
                let word = usize::try_from(of(address)).ok();
                word.and_then(|at| self.memories[memory].get(at)).copied().unwrap_or(0)
            }
        };
        bits & mask(width)
    }

    fn simpler(&mut self, term: &VectorTerm, width: u32) -> Option<VectorTermId> {
        let ones = mask(width);
        match *term {
            VectorTerm::Not(a) => match *self.term(a) {
                VectorTerm::Not(inner) => Some(inner),
                _ => None,
            },
            VectorTerm::And(a, b) | VectorTerm::Or(a, b) | VectorTerm::Xor(a, b) => {
                if a == b {
                    return match term {
                        VectorTerm::Xor(..) => Some(self.constant(0, width)),
                        _ => Some(a),
                    };
                }
                let (value, other) = match (self.constant_of(a), self.constant_of(b)) {
                    (Some(value), _) => (value, b),
                    (_, Some(value)) => (value, a),
                    _ => return None,
                };
                match term {
                    VectorTerm::And(..) if value == 0 => Some(self.constant(0, width)),
                    VectorTerm::And(..) if value == ones => Some(other),
                    VectorTerm::Or(..) if value == ones => Some(self.constant(ones, width)),
                    VectorTerm::Or(..) | VectorTerm::Xor(..) if value == 0 => Some(other),
                    VectorTerm::Xor(..) if value == ones => Some(self.not(other)),
                    _ => None,
                }
            }
            VectorTerm::Add(a, b) => match (self.constant_of(a), self.constant_of(b)) {
                (Some(0), _) => Some(b),
                (_, Some(0)) => Some(a),
                (Some(1), _) if width == 1 => Some(self.not(b)),
                (_, Some(1)) if width == 1 => Some(self.not(a)),
                _ if self.zeros(a) > self.zeros(b) => self.passed_by(b, a, width, VectorTerm::Add),
                _ => self.passed_by(a, b, width, VectorTerm::Add),
            },
            VectorTerm::Sub(a, b) if a == b => Some(self.constant(0, width)),
            VectorTerm::Sub(a, b) => match self.constant_of(b) {
                Some(0) => Some(a),
                Some(1) if width == 1 => Some(self.not(a)),
                _ => self.passed_by(a, b, width, VectorTerm::Sub),
            },
            VectorTerm::Equal(a, b) if a == b => Some(self.constant(1, 1)),
            VectorTerm::Equal(a, b) if self.width(a) == 1 => {
                match (self.constant_of(a), self.constant_of(b)) {
                    (Some(1), _) => Some(b),
                    (_, Some(1)) => Some(a),
                    (Some(_), _) => Some(self.not(b)),
                    (_, Some(_)) => Some(self.not(a)),
                    _ => None,
                }
            }
            VectorTerm::Less(a, b) | VectorTerm::SignedLess(a, b) if a == b => {
                Some(self.constant(0, 1))
            }
            VectorTerm::Product(a, b) => {
                let zero = [a, b].into_iter().find(|&it| self.constant_of(it) == Some(0));
                let one = self.constant_of(a) == Some(1);
                zero.or(one.then_some(b)).or((self.constant_of(b) == Some(1)).then_some(a))
            }
            VectorTerm::Choice(condition, a, b) => {
                if a == b {
                    return Some(a);
                }
                if let Some(value) = self.constant_of(condition) {
                    return Some(if value == 1 { a } else { b });
                }
                if let VectorTerm::Not(inner) = *self.term(condition) {
                    return Some(self.choice(inner, b, a));
                }
                match (width, self.constant_of(a), self.constant_of(b)) {
                    (1, Some(1), Some(0)) => Some(condition),
                    (1, Some(0), Some(1)) => Some(self.not(condition)),
                    _ => None,
                }
            }
            VectorTerm::Slice { of, low } => self.simpler_slice(of, low, width),
            VectorTerm::Join(a, b) => self.simpler_join(a, b, width),
            VectorTerm::SignExtend(a) => match *self.term(a) {
                VectorTerm::SignExtend(inner) => Some(self.sign_extended(inner, width)),
                VectorTerm::Join(top, _) if self.constant_of(top) == Some(0) => {
                    Some(self.resized(a, width))
                }
                _ => None,
            },
            VectorTerm::Word { memory, address } => {
                let bits = match *self.term(address) {
                    VectorTerm::Join(top, rest) if self.constant_of(top) == Some(0) => {
                        self.width(rest)
                    }
                    _ => ADDRESS,
                };
                let words = &self.memories[memory];
                let reached = words.get(..1 << bits.min(ADDRESS))?;
                let first = reached[0];
                let same = reached.iter().all(|&word| word == first);
                same.then(|| self.constant(first, width))
            }
            _ => None,
        }
    }

    /// Simplifies `op(a, b)`, a sum or a difference, if the lowest bits of `b` are known to be 0. The lowest bits of the result
    /// are then the bits of `a`, so only the upper bits are added or subtracted.
    fn passed_by(
        &mut self,
        a: VectorTermId,
        b: VectorTermId,
        width: u32,
        op: fn(VectorTermId, VectorTermId) -> VectorTerm,
    ) -> Option<VectorTermId> {
        let low = self.zeros(b);
        if low == 0 || low >= width {
            return None;
        }
        let upper = width - low;
        let lower = self.slice(a, 0, low);
        let (a, b) = (self.slice(a, low, upper), self.slice(b, low, upper));
        let upper = self.make(op(a, b), upper);
        Some(self.make(VectorTerm::Join(upper, lower), width))
    }

    fn zeros(&self, id: VectorTermId) -> u32 {
        match *self.term(id) {
            VectorTerm::Constant(bits) => bits.trailing_zeros().min(self.width(id)),
            VectorTerm::Join(upper, lower) => match self.zeros(lower) {
                all if all == self.width(lower) => all + self.zeros(upper),
                some => some,
            },
            _ => 0,
        }
    }

    fn simpler_slice(&mut self, of: VectorTermId, low: u32, width: u32) -> Option<VectorTermId> {
        let whole = self.width(of);
        if low == 0 && width == whole {
            return Some(of);
        }
        match *self.term(of) {
            VectorTerm::Slice { of, low: inner } => Some(self.slice(of, low + inner, width)),
            VectorTerm::Join(a, b) => {
                let at = self.width(b);
                if low >= at {
                    return Some(self.slice(a, low - at, width));
                }
                if low + width <= at {
                    return Some(self.slice(b, low, width));
                }
                let (upper, lower) =
                    (self.slice(a, 0, low + width - at), self.slice(b, low, at - low));
                Some(self.make(VectorTerm::Join(upper, lower), width))
            }
            VectorTerm::SignExtend(a) => {
                let own = self.width(a);
                if low + width <= own {
                    return Some(self.slice(a, low, width));
                }
                (low < own).then(|| {
                    let rest = self.slice(a, low, own - low);
                    self.sign_extended(rest, width)
                })
            }
            // The low bits of a sum are the sum of the low bits.
            ref sum @ (VectorTerm::Add(..) | VectorTerm::Sub(..)) if low == 0 => {
                let low_bits = renamed(&sum.clone(), |id| self.slice(id, 0, width));
                Some(self.make(low_bits, width))
            }
            VectorTerm::Not(a) => {
                let a = self.slice(a, low, width);
                Some(self.not(a))
            }
            _ => None,
        }
    }

    fn simpler_join(
        &mut self,
        a: VectorTermId,
        b: VectorTermId,
        width: u32,
    ) -> Option<VectorTermId> {
        if let VectorTerm::Join(upper, lower) = *self.term(a) {
            let rest = self.width(lower) + self.width(b);
            let rest = self.make(VectorTerm::Join(lower, b), rest);
            return Some(self.make(VectorTerm::Join(upper, rest), width));
        }
        let joined = |terms: &mut Self, a: VectorTermId, b: VectorTermId| match (
            terms.term(a),
            terms.term(b),
        ) {
            (&VectorTerm::Constant(upper), &VectorTerm::Constant(lower)) => {
                let at = terms.width(b);
                Some(terms.constant(upper << at | lower, terms.width(a) + at))
            }
            (&VectorTerm::Slice { of, low: upper }, &VectorTerm::Slice { of: other, low })
                if of == other && upper == low + terms.width(b) =>
            {
                Some(terms.slice(of, low, terms.width(a) + terms.width(b)))
            }
            _ => None,
        };
        if let Some(both) = joined(self, a, b) {
            return Some(both);
        }
        if let VectorTerm::Join(first, rest) = *self.term(b)
            && let Some(both) = joined(self, a, first)
        {
            return Some(self.make(VectorTerm::Join(both, rest), width));
        }
        None
    }
}

/// Sorts a commutative term's operands, such as a sum, so equal terms have one form.
fn ordered(mut term: VectorTerm) -> VectorTerm {
    if let VectorTerm::And(a, b)
    | VectorTerm::Or(a, b)
    | VectorTerm::Xor(a, b)
    | VectorTerm::Add(a, b)
    | VectorTerm::Product(a, b)
    | VectorTerm::Equal(a, b) = &mut term
        && a > b
    {
        std::mem::swap(a, b);
    }
    term
}

fn renamed(term: &VectorTerm, mut of: impl FnMut(VectorTermId) -> VectorTermId) -> VectorTerm {
    let mut term = term.clone();
    term.operands_mut().into_iter().for_each(|id| *id = of(*id));
    term
}

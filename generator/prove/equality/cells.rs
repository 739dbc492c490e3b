//! Evaluates the cells of a module that Yosys has read from Verilog, on terms.
//!
//! A cell has the meaning that Yosys documents.

use anyhow::{Context, Result, bail, ensure};

use super::term::{ADDRESS, VectorTerm, VectorTermId, VectorTerms};
use glint_base::fixed::MAX_WIDTH;

/// A bit of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bit {
    Wire(usize),
    Known(bool),
    Any,
}

pub type Connection = Vec<Bit>;

/// The value of every wire: a bit of a term.
pub struct WireValues(Vec<Option<(VectorTermId, u32)>>);

impl WireValues {
    /// Makes the values of `wires` wires. No wire has a value yet: a caller must set the inputs and registers.
    pub fn new(wires: usize) -> Self {
        Self(vec![None; wires])
    }

    /// Has some wires carry the bits of terms, the lowest first.
    pub fn set(&mut self, bits: &Connection, columns: &[VectorTermId]) {
        for (at, bit) in bits.iter().enumerate() {
            if let Bit::Wire(wire) = *bit {
                let (column, place) = (at / MAX_WIDTH as usize, at as u32 % MAX_WIDTH);
                self.0[wire] = columns.get(column).map(|&id| (id, place));
            }
        }
    }

    /// Returns the terms of some bits, each of at most 64.
    pub fn columns(&self, terms: &mut VectorTerms, bits: &Connection) -> Vec<VectorTermId> {
        bits.chunks(MAX_WIDTH as usize).map(|bits| self.word(terms, bits)).collect()
    }

    /// Returns the term of at most 64 bits. Copies of a highest bit are an extension by a sign. For example, the wires
    /// 6, 7, 7, 7, lowest first, are the bits 6 and 7 with the sign extended to four bits.
    pub fn word(&self, terms: &mut VectorTerms, bits: &[Bit]) -> VectorTermId {
        let copies = bits.iter().rev().take_while(|bit| Some(*bit) == bits.last()).count();
        if copies > 1 && matches!(bits.last(), Some(Bit::Wire(_))) {
            let own = self.word(terms, &bits[..=bits.len() - copies]);
            return terms.sign_extended(own, bits.len() as u32);
        }
        let mut word = None;
        let mut at = 0;
        while at < bits.len() {
            let (part, width) = self.run(terms, &bits[at..]);
            word = Some(match word {
                None => part,
                Some(lower) => terms.make(VectorTerm::Join(part, lower), (at + width) as u32),
            });
            at += width;
        }
        word.unwrap_or_else(|| terms.constant(0, 1))
    }

    /// Returns the lowest bits that lie side by side in one term, and their number.
    fn run(&self, terms: &mut VectorTerms, bits: &[Bit]) -> (VectorTermId, usize) {
        let source = |bit: Bit| if let Bit::Wire(wire) = bit { self.0[wire] } else { None };
        let first = source(bits[0]);
        let follows = |&(at, bit): &(usize, &Bit)| match (bits[0], first) {
            (_, Some((id, low))) => source(*bit) == Some((id, low + at as u32)),
            (Bit::Known(_), _) => matches!(bit, Bit::Known(_)),
            _ => source(*bit).is_none() && !matches!(bit, Bit::Known(_)),
        };
        let width = bits.iter().enumerate().take_while(follows).count();
        let id = match (bits[0], first) {
            (_, Some((id, low))) => terms.slice(id, low, width as u32),
            (Bit::Known(_), _) => {
                let ones = bits[..width].iter().enumerate();
                let ones = ones.filter(|(_, bit)| **bit == Bit::Known(true));
                let pattern = ones.fold(0, |pattern, (at, _)| pattern | 1 << at);
                terms.constant(pattern, width as u32)
            }
            _ => terms.unknown(width as u32),
        };
        (id, width)
    }

    /// Returns a word of a memory that is never written.
    pub fn rom(
        &self,
        terms: &mut VectorTerms,
        at: &Connection,
        words: &[u64],
        width: u32,
    ) -> VectorTermId {
        let address = self.word(terms, at);
        let address = terms.resized(address, ADDRESS);
        let memory = terms.memory(words);
        let word = terms.make(VectorTerm::Word { memory, address }, width);
        if at.len() < 32 && words.len() >= 1 << at.len() {
            return word;
        }
        let size = terms.constant(words.len() as u64, ADDRESS);
        let inside = terms.make(VectorTerm::Less(address, size), 1);
        let beyond = terms.beyond(memory, address, width);
        terms.choice(inside, word, beyond)
    }

    /// Returns the result of a cell with the inputs A, B and S. The result has `width` bits.
    ///
    /// # Errors
    /// Fails if the cell is not known here, or wider than terms are.
    pub fn cell(
        &self,
        terms: &mut VectorTerms,
        kind: &str,
        signed: [bool; 2],
        [a, b, s]: &[Connection; 3],
        width: usize,
    ) -> Result<Vec<VectorTermId>> {
        let extended = |terms: &mut VectorTerms, bits: &Connection, signed: bool, width: usize| {
            ensure!(bits.len().max(width) <= MAX_WIDTH as usize, "it has more than 64 bits");
            let word = self.word(terms, bits);
            Ok(match signed && width > bits.len() {
                true => terms.sign_extended(word, width as u32),
                false => terms.resized(word, width as u32),
            })
        };
        let both = signed == [true; 2];
        let of = |terms: &mut VectorTerms, width: usize| -> Result<[VectorTermId; 2]> {
            Ok([extended(terms, a, both, width)?, extended(terms, b, both, width)?])
        };
        let truth = |terms: &mut VectorTerms, bits: &Connection| {
            let columns = self.columns(terms, bits);
            let any = columns.into_iter().map(|column| {
                let zero = terms.constant(0, terms.width(column));
                let none = terms.equal(column, zero);
                terms.not(none)
            });
            let any: Vec<VectorTermId> = any.collect();
            let or = |terms: &mut VectorTerms, a, b| terms.make(VectorTerm::Or(a, b), 1);
            any.into_iter().reduce(|a, b| or(terms, a, b)).context("it has no input")
        };
        let widest = a.len().max(b.len());
        let bit = match kind {
            "$mux" => {
                let condition = self.word(terms, s);
                let [a, b] = [a, b].map(|bits| self.columns(terms, bits));
                return Ok((a.into_iter().zip(b))
                    .map(|(a, b)| terms.choice(condition, b, a))
                    .collect());
            }
            "$pmux" => {
                let mut chosen = self.columns(terms, a);
                for (at, condition) in s.iter().enumerate().rev() {
                    let condition = self.word(terms, &[*condition]);
                    let input = self.columns(terms, &b[at * width..(at + 1) * width].to_vec());
                    for (chosen, input) in chosen.iter_mut().zip(input) {
                        *chosen = terms.choice(condition, input, *chosen);
                    }
                }
                return Ok(chosen);
            }
            "$not" => {
                let a = extended(terms, a, signed[0], width)?;
                return Ok(vec![terms.not(a)]);
            }
            "$pos" => return Ok(vec![extended(terms, a, signed[0], width)?]),
            "$neg" => {
                let (a, zero) =
                    (extended(terms, a, signed[0], width)?, terms.constant(0, width as u32));
                return Ok(vec![terms.make(VectorTerm::Sub(zero, a), width as u32)]);
            }
            "$and" | "$or" | "$xor" | "$xnor" | "$add" | "$sub" => {
                let [a, b] = of(terms, width)?;
                let op = match kind {
                    "$and" => VectorTerm::And,
                    "$or" => VectorTerm::Or,
                    "$add" => VectorTerm::Add,
                    "$sub" => VectorTerm::Sub,
                    _ => VectorTerm::Xor,
                };
                let word = terms.make(op(a, b), width as u32);
                return Ok(vec![if kind == "$xnor" { terms.not(word) } else { word }]);
            }
            "$mul" => {
                ensure!(width <= MAX_WIDTH as usize, "it has more than 64 bits");
                let [a, b] = of(terms, MAX_WIDTH as usize)?;
                let product = terms.make(VectorTerm::Product(a, b), MAX_WIDTH);
                return Ok(vec![terms.slice(product, 0, width as u32)]);
            }
            "$eq" | "$ne" => {
                let [a, b] = of(terms, widest)?;
                let equal = terms.equal(a, b);
                if kind == "$eq" { equal } else { terms.not(equal) }
            }
            "$lt" | "$le" | "$gt" | "$ge" => {
                let [a, b] = of(terms, widest)?;
                let [a, b] = if matches!(kind, "$lt" | "$ge") { [a, b] } else { [b, a] };
                let less = if both { VectorTerm::SignedLess(a, b) } else { VectorTerm::Less(a, b) };
                let less = terms.make(less, 1);
                if matches!(kind, "$lt" | "$gt") { less } else { terms.not(less) }
            }
            "$reduce_or" | "$reduce_bool" => truth(terms, a)?,
            "$logic_not" => {
                let any = truth(terms, a)?;
                terms.not(any)
            }
            "$logic_and" | "$logic_or" => {
                let (a, b) = (truth(terms, a)?, truth(terms, b)?);
                let op = if kind == "$logic_and" { VectorTerm::And } else { VectorTerm::Or };
                terms.make(op(a, b), 1)
            }
            "$reduce_and" => {
                let mut all = terms.constant(1, 1);
                for column in self.columns(terms, a) {
                    let ones = terms.constant(u64::MAX, terms.width(column));
                    let full = terms.equal(column, ones);
                    all = terms.make(VectorTerm::And(all, full), 1);
                }
                all
            }
            _ => bail!("is not known here"),
        };
        ensure!(width <= MAX_WIDTH as usize, "it has more than 64 bits");
        Ok(vec![terms.resized(bit, width as u32)])
    }
}

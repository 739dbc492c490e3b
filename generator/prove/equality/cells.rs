//! Computes the results of Yosys's cells on symbolic terms instead of numbers, as Yosys documents the cells.
//!
//! For example, a `$add` cell with the terms a and b has the result a + b. The module knows the cells that occur in the emitted
//! Verilog, and fails for other cells. Only multiplexers, reductions and logical operations may have more than 64 bits.

use anyhow::{Context, Result, bail, ensure};

use super::term::{ADDRESS, VectorTerm, VectorTermId, VectorTerms};
use glint_base::fixed::MAX_WIDTH;

/// A bit at a cell in a netlist from Yosys: a wire with its number, a constant, or an undetermined bit (`x` or `z`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bit {
    Wire(usize),
    Known(bool),
    Any,
}

pub type Connection = Vec<Bit>;

/// The symbolic value of every wire of a Verilog module in one clock: a bit of a term.
pub struct WireValues(Vec<Option<(VectorTermId, u32)>>);

impl WireValues {
    /// Makes a table of `wires` wires without values: a caller must set the inputs and registers.
    pub fn new(wires: usize) -> Self {
        Self(vec![None; wires])
    }

    /// Sets the wires `bits` to the bits of the terms `columns`, the lowest first. Each term except the last has 64 bits.
    pub fn set(&mut self, bits: &Connection, columns: &[VectorTermId]) {
        for (at, bit) in bits.iter().enumerate() {
            if let Bit::Wire(wire) = *bit {
                let (column, place) = (at / MAX_WIDTH as usize, at as u32 % MAX_WIDTH);
                self.0[wire] = columns.get(column).map(|&id| (id, place));
            }
        }
    }

    /// Returns the wires `bits` as terms of at most 64 bits each, the lowest bits first.
    pub fn columns(&self, terms: &mut VectorTerms, bits: &Connection) -> Vec<VectorTermId> {
        let mut columns = Vec::new();
        for column in bits.chunks(MAX_WIDTH as usize) {
            columns.push(self.word(terms, column));
        }
        columns
    }

    /// Returns at most 64 bits as one term. Copies of the highest bit become a sign extension. For example, the wires 6, 7, 7, 7,
    /// lowest first, are the bits 6 and 7 with the sign extended to four bits.
    pub fn word(&self, terms: &mut VectorTerms, bits: &[Bit]) -> VectorTermId {
        let copies = bits.iter().rev().take_while(|bit| Some(*bit) == bits.last()).count();
        if copies > 1 && matches!(bits.last(), Some(Bit::Wire(_))) {
            let narrow = self.word(terms, &bits[..=bits.len() - copies]);
            return terms.sign_extended(narrow, bits.len() as u32);
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

    /// Returns one term for the longest run of bits from `bits[0]` up that have the same source, and the number of these bits.
    /// A source is a range of neighbouring bits of one term, constants, or undetermined bits.
    fn run(&self, terms: &mut VectorTerms, bits: &[Bit]) -> (VectorTermId, usize) {
        let first = self.source(bits[0]);
        let mut width = 0;
        let mut pattern = 0;
        for &bit in bits {
            let follows = match (bits[0], first) {
                (_, Some((id, low))) => self.source(bit) == Some((id, low + width)),
                (Bit::Known(_), _) => matches!(bit, Bit::Known(_)),
                _ => self.source(bit).is_none() && !matches!(bit, Bit::Known(_)),
            };
            if !follows {
                break;
            }
            if bit == Bit::Known(true) {
                pattern |= 1 << width;
            }
            width += 1;
        }
        let id = match (bits[0], first) {
            (_, Some((id, low))) => terms.slice(id, low, width),
            (Bit::Known(_), _) => terms.constant(pattern, width),
            _ => terms.unknown(width),
        };
        (id, width as usize)
    }

    /// Returns the term that contains `bit`, and the bit's position in this term. Returns `None` if the bit is a constant or
    /// unknown.
    fn source(&self, bit: Bit) -> Option<(VectorTermId, u32)> {
        match bit {
            Bit::Wire(wire) => self.0[wire],
            Bit::Known(_) | Bit::Any => None,
        }
    }

    /// Returns a word of a memory that the module never writes. `at` is the address, and `words` are the contents. An address
    /// beyond the contents gives an unknown word.
    pub fn rom(
        &self,
        terms: &mut VectorTerms,
        at: &Connection,
        words: &[u64],
        width: u32,
    ) -> VectorTermId {
        let narrow_address = self.word(terms, at);
        let address = terms.resized(narrow_address, ADDRESS);
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

    /// Returns the result of a Yosys cell of the kind `kind`, such as `$add`, with the inputs A, B and S. `signed` says
    /// whether A and B are signed. The result has `width` bits, as terms of at most 64 bits, the lowest first.
    ///
    /// # Errors
    /// Fails if the kind is unknown, or if an input of a reduction or a logical operation such as `$logic_and` has no bits. Fails
    /// if a cell has more than 64 bits, except `$mux`, `$pmux`, a reduction and a logical operation.
    pub fn cell(
        &self,
        terms: &mut VectorTerms,
        kind: &str,
        signed: [bool; 2],
        [a, b, s]: &[Connection; 3],
        width: usize,
    ) -> Result<Vec<VectorTermId>> {
        let both = signed == [true; 2];
        let widest = a.len().max(b.len());
        let bit = match kind {
            "$mux" => {
                let condition = self.word(terms, s);
                let (a_columns, b_columns) = (self.columns(terms, a), self.columns(terms, b));
                let mut chosen = Vec::new();
                for (a, b) in a_columns.into_iter().zip(b_columns) {
                    chosen.push(terms.choice(condition, b, a));
                }
                return Ok(chosen);
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
                let a = self.extended(terms, a, signed[0], width)?;
                return Ok(vec![terms.not(a)]);
            }
            "$pos" => return Ok(vec![self.extended(terms, a, signed[0], width)?]),
            "$neg" => {
                let a = self.extended(terms, a, signed[0], width)?;
                let zero = terms.constant(0, width as u32);
                return Ok(vec![terms.make(VectorTerm::Sub(zero, a), width as u32)]);
            }
            "$and" | "$or" | "$xor" | "$xnor" | "$add" | "$sub" => {
                let (a, b) = self.both_extended(terms, [a, b], both, width)?;
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
                ensure!(width <= MAX_WIDTH as usize, "its value has more than 64 bits");
                let (a, b) = self.both_extended(terms, [a, b], both, MAX_WIDTH as usize)?;
                let product = terms.make(VectorTerm::Product(a, b), MAX_WIDTH);
                return Ok(vec![terms.slice(product, 0, width as u32)]);
            }
            "$eq" | "$ne" => {
                let (a, b) = self.both_extended(terms, [a, b], both, widest)?;
                let equal = terms.equal(a, b);
                if kind == "$eq" { equal } else { terms.not(equal) }
            }
            "$lt" | "$le" | "$gt" | "$ge" => {
                let (a, b) = self.both_extended(terms, [a, b], both, widest)?;
                let (x, y) = if matches!(kind, "$lt" | "$ge") { (a, b) } else { (b, a) };
                let comparison =
                    if both { VectorTerm::SignedLess(x, y) } else { VectorTerm::Less(x, y) };
                let less = terms.make(comparison, 1);
                if matches!(kind, "$lt" | "$gt") { less } else { terms.not(less) }
            }
            "$reduce_or" | "$reduce_bool" => self.any_one(terms, a)?,
            "$logic_not" => {
                let any = self.any_one(terms, a)?;
                terms.not(any)
            }
            "$logic_and" | "$logic_or" => {
                let (a, b) = (self.any_one(terms, a)?, self.any_one(terms, b)?);
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
            _ => bail!("Glint does not know cells of this kind"),
        };
        ensure!(width <= MAX_WIDTH as usize, "its value has more than 64 bits");
        Ok(vec![terms.resized(bit, width as u32)])
    }

    /// Returns `bits`, extended to `width` bits: by the sign if `signed`, and otherwise by zeros. A smaller `width` drops the
    /// high bits. Fails for more than 64 bits.
    fn extended(
        &self,
        terms: &mut VectorTerms,
        bits: &Connection,
        signed: bool,
        width: usize,
    ) -> Result<VectorTermId> {
        ensure!(bits.len().max(width) <= MAX_WIDTH as usize, "its value has more than 64 bits");
        let word = self.word(terms, bits);
        Ok(match signed && width > bits.len() {
            true => terms.sign_extended(word, width as u32),
            false => terms.resized(word, width as u32),
        })
    }

    fn both_extended(
        &self,
        terms: &mut VectorTerms,
        [a, b]: [&Connection; 2],
        signed: bool,
        width: usize,
    ) -> Result<(VectorTermId, VectorTermId)> {
        let a = self.extended(terms, a, signed, width)?;
        let b = self.extended(terms, b, signed, width)?;
        Ok((a, b))
    }

    fn any_one(&self, terms: &mut VectorTerms, bits: &Connection) -> Result<VectorTermId> {
        let mut any = Vec::new();
        for column in self.columns(terms, bits) {
            let zero = terms.constant(0, terms.width(column));
            let none = terms.equal(column, zero);
            any.push(terms.not(none));
        }
        let joined = any.into_iter().reduce(|a, b| terms.make(VectorTerm::Or(a, b), 1));
        joined.context("the cell has no input")
    }
}

//! Executes a netlist clock by clock on symbolic terms: every net has an expression of unknowns in place of a number.
//!
//! For example, a net that adds the operands a and b has the term a + b. The caller chooses the terms of the inputs, and calls
//! `settle` and `edge` once for each clock.

use super::term::{ADDRESS, VectorTerm, VectorTermId, VectorTerms};
use glint_base::fixed::MAX_WIDTH;
use glint_base::interval::Interval;
use glint_rtl::netlist::{Design, Driver, NetId, Op, Role};

/// A product of two factors of 64 bits, with the intervals that the design states for the factors. The solver may conclude a
/// range of the product only after it has proved that both factors lie in these intervals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Product {
    pub factors: [VectorTermId; 2],
    pub ranges: [Interval; 2],
}

/// The contents of a design's registers and synchronous ROM outputs between two clocks.
#[derive(Clone)]
pub struct SymbolicState {
    pub registers: Vec<VectorTermId>,
    words: Vec<VectorTermId>,
}

impl SymbolicState {
    pub fn assume(&mut self, terms: &mut VectorTerms, condition: VectorTermId, value: bool) {
        let mut all = [self.registers.as_slice(), &self.words].concat();
        terms.assuming(condition, value, &mut all);
        self.words = all.split_off(self.registers.len());
        self.registers = all;
    }
}

/// The symbolic execution of a design: every net carries an expression of the unknown operands in place of a number.
pub struct Execution<'a> {
    pub design: &'a Design,
    order: Vec<NetId>,
    memories: Vec<usize>,
    /// The lowest bit of each field of the control word.
    fields: Vec<u32>,
}

impl<'a> Execution<'a> {
    pub fn new(terms: &mut VectorTerms, design: &'a Design) -> Self {
        Self {
            design,
            order: design.levelise().unwrap_or_default(),
            memories: design.roms.iter().map(|rom| terms.memory(&rom.words)).collect(),
            fields: design.field_positions(),
        }
    }

    /// Returns the state at power-up: every register is unknown.
    pub fn power_up(&self, terms: &mut VectorTerms) -> SymbolicState {
        let mut state = SymbolicState { registers: Vec::new(), words: Vec::new() };
        for register in &self.design.registers {
            state.registers.push(terms.unknown(self.design.width(register.q)));
        }
        for rom in &self.design.roms {
            state.words.push(terms.unknown(self.design.width(rom.data)));
        }
        state
    }

    /// Returns the term of every net, at the net's index. `input` gives the term of each input port. Products that are new are
    /// added to `products`.
    pub fn settle(
        &self,
        terms: &mut VectorTerms,
        state: &SymbolicState,
        mut input: impl FnMut(&mut VectorTerms, NetId, Role) -> VectorTermId,
        products: &mut Vec<Product>,
    ) -> Vec<VectorTermId> {
        let design = self.design;
        let nothing = terms.constant(0, 1);
        let mut values = vec![nothing; design.nets.len()];
        for port in design.inputs() {
            values[port.net.index()] = input(terms, port.net, port.role);
        }
        for &id in &self.order {
            let width = design.width(id);
            values[id.index()] = match &design.net(id).driver {
                Driver::Undriven | Driver::Input => continue,
                Driver::Constant(bits) => terms.constant(*bits, width),
                Driver::Register(register) => state.registers[register.index()],
                Driver::Rom(rom) if design.rom(*rom).synchronous => state.words[rom.index()],
                Driver::Rom(rom) => self.word(terms, rom.index(), &values),
                Driver::Field(field) => {
                    let word = values[design.rom(design.control.rom).data.index()];
                    terms.slice(word, self.fields[field.index()], width)
                }
                Driver::Op(op) => self.cell(terms, op, width, &values, products),
            };
        }
        values
    }

    /// Returns the state after the rising edge. `state` and `values`, the terms of all nets, are before the edge.
    pub fn edge(
        &self,
        terms: &mut VectorTerms,
        state: &SymbolicState,
        values: &[VectorTermId],
    ) -> SymbolicState {
        let design = self.design;
        let reset = design.port(|role| role == Role::Reset);
        let mut next = state.clone();
        for (register, held) in design.registers.iter().zip(&mut next.registers) {
            if let Some(data) = register.data {
                let offered = values[data.index()];
                *held = match register.enable {
                    None => offered,
                    Some(enable) => terms.choice(values[enable.index()], offered, *held),
                };
            }
            if let (Some(rst_n), Some(bits)) = (reset, register.reset) {
                let reset_value = terms.constant(bits, design.width(register.q));
                *held = terms.choice(values[rst_n.net.index()], *held, reset_value);
            }
        }
        for (at, rom) in design.roms.iter().enumerate() {
            if !rom.synchronous {
                continue;
            }
            let word = self.word(terms, at, values);
            next.words[at] = match rom.enable {
                None => word,
                Some(enable) => terms.choice(values[enable.index()], word, next.words[at]),
            };
        }
        next
    }

    fn word(&self, terms: &mut VectorTerms, rom: usize, values: &[VectorTermId]) -> VectorTermId {
        let width = self.design.width(self.design.roms[rom].data);
        let unsized_address = values[self.design.roms[rom].address.index()];
        let address = terms.resized(unsized_address, ADDRESS);
        terms.make(VectorTerm::Word { memory: self.memories[rom], address }, width)
    }

    /// Computes a cell's result as [`Op`] documents it.
    fn cell(
        &self,
        terms: &mut VectorTerms,
        op: &Op,
        width: u32,
        values: &[VectorTermId],
        products: &mut Vec<Product>,
    ) -> VectorTermId {
        let of = |net: &NetId| values[net.index()];
        match op {
            Op::Relabel(a) => of(a),
            Op::Extend(a) => self.extended(terms, *a, width, values),
            Op::Slice { of: a, low } => terms.slice(of(a), *low, width),
            Op::Concat(parts) => {
                let Some((first, others)) = parts.split_first() else {
                    return terms.constant(0, width);
                };
                let mut joined = of(first);
                for lower in others.iter().map(of) {
                    let width = terms.width(joined) + terms.width(lower);
                    joined = terms.make(VectorTerm::Join(joined, lower), width);
                }
                joined
            }
            Op::Not(a) => terms.not(of(a)),
            Op::And(a, b) => terms.make(VectorTerm::And(of(a), of(b)), width),
            Op::Or(a, b) => terms.make(VectorTerm::Or(of(a), of(b)), width),
            Op::Xor(a, b) => terms.make(VectorTerm::Xor(of(a), of(b)), width),
            Op::Add { a, b, carry } => {
                let sum = terms.make(VectorTerm::Add(of(a), of(b)), width);
                match carry {
                    None => sum,
                    Some(carry) => {
                        let wide_carry = terms.resized(of(carry), width);
                        terms.make(VectorTerm::Add(sum, wide_carry), width)
                    }
                }
            }
            Op::Sub(a, b) => terms.make(VectorTerm::Sub(of(a), of(b)), width),
            Op::Mul(a, b) => {
                let factors = [*a, *b].map(|net| self.extended(terms, net, MAX_WIDTH, values));
                let ranges = [*a, *b].map(|net| self.design.net(net).range);
                let product = Product { factors, ranges };
                if !products.contains(&product) {
                    products.push(product);
                }
                let whole = terms.make(VectorTerm::Product(factors[0], factors[1]), MAX_WIDTH);
                terms.slice(whole, 0, width)
            }
            Op::Equal(a, b) => terms.equal(of(a), of(b)),
            Op::Less(a, b) if self.design.net(*a).format.signed => {
                terms.make(VectorTerm::SignedLess(of(a), of(b)), 1)
            }
            Op::Less(a, b) => terms.make(VectorTerm::Less(of(a), of(b)), 1),
            Op::Any(a) => {
                let zero = terms.constant(0, terms.width(of(a)));
                let none = terms.equal(of(a), zero);
                terms.not(none)
            }
            Op::All(a) => {
                let ones = terms.constant(u64::MAX, terms.width(of(a)));
                terms.equal(of(a), ones)
            }
            Op::Mux { select, inputs } => {
                let Some((last, others)) = inputs.split_last() else {
                    return terms.constant(0, width);
                };
                let select = of(select);
                let mut chosen = of(last);
                for (number, input) in others.iter().enumerate().rev() {
                    let number = terms.constant(number as u64, terms.width(select));
                    let is_selected = terms.equal(select, number);
                    chosen = terms.choice(is_selected, of(input), chosen);
                }
                chosen
            }
        }
    }

    /// Extends a net to `width` bits: by its sign if its format is signed, and otherwise by zeros.
    fn extended(
        &self,
        terms: &mut VectorTerms,
        net: NetId,
        width: u32,
        values: &[VectorTermId],
    ) -> VectorTermId {
        if self.design.net(net).format.signed {
            terms.sign_extended(values[net.index()], width)
        } else {
            terms.resized(values[net.index()], width)
        }
    }
}

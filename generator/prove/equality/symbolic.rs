//! Executes a design clock by clock on terms: operands are unknowns, and every net is an expression of them. For
//! example, a net that adds the operands a and b is the term a + b, and no number.

use super::term::{ADDRESS, VectorTerm, VectorTermId, VectorTerms};
use glint_base::fixed::MAX_WIDTH;
use glint_base::interval::Interval;
use glint_rtl::netlist::{Design, Driver, NetId, Op, Role};

/// A product of 64 bits, and the ranges that the design states for its factors. A range may be used only if the
/// factor is shown to keep to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Product {
    pub factors: [VectorTermId; 2],
    pub ranges: [Interval; 2],
}

/// The contents of registers and synchronous memories between two clocks.
#[derive(Clone)]
pub struct SymbolicState {
    pub registers: Vec<VectorTermId>,
    words: Vec<VectorTermId>,
}

impl SymbolicState {
    /// Replaces a condition, one bit, by `value` in the terms of the state.
    pub fn assume(&mut self, terms: &mut VectorTerms, condition: VectorTermId, value: bool) {
        let mut all: Vec<VectorTermId> =
            self.registers.iter().chain(&self.words).copied().collect();
        terms.assuming(condition, value, &mut all);
        self.words = all.split_off(self.registers.len());
        self.registers = all;
    }
}

/// A design that terms go through.
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

    /// Returns the state at power-up: every register may have any value.
    pub fn power_up(&self, terms: &mut VectorTerms) -> SymbolicState {
        let design = self.design;
        let registers = design.registers.iter().map(|it| terms.unknown(design.width(it.q)));
        let registers = registers.collect();
        let words = design.roms.iter().map(|rom| terms.unknown(design.width(rom.data))).collect();
        SymbolicState { registers, words }
    }

    /// Returns the term of every net, with these inputs. It adds the products among them to `products`.
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

    /// Returns the rising edge.
    pub fn edge(
        &self,
        terms: &mut VectorTerms,
        state: &SymbolicState,
        values: &[VectorTermId],
    ) -> SymbolicState {
        let design = self.design;
        let of = |net: NetId| values[net.index()];
        let reset = design.port(|role| role == Role::Reset).map(|port| of(port.net));
        let mut next = state.clone();
        for (register, held) in design.registers.iter().zip(&mut next.registers) {
            let width = design.width(register.q);
            if let Some(data) = register.data.map(of) {
                *held = match register.enable.map(of) {
                    None => data,
                    Some(enable) => terms.choice(enable, data, *held),
                };
            }
            if let Some((rst_n, bits)) = reset.zip(register.reset) {
                let bits = terms.constant(bits, width);
                *held = terms.choice(rst_n, *held, bits);
            }
        }
        for (at, rom) in design.roms.iter().enumerate().filter(|(_, rom)| rom.synchronous) {
            let word = self.word(terms, at, values);
            next.words[at] = match rom.enable.map(of) {
                None => word,
                Some(enable) => terms.choice(enable, word, next.words[at]),
            };
        }
        next
    }

    fn word(&self, terms: &mut VectorTerms, rom: usize, values: &[VectorTermId]) -> VectorTermId {
        let width = self.design.width(self.design.roms[rom].data);
        let address = values[self.design.roms[rom].address.index()];
        let address = terms.resized(address, ADDRESS);
        terms.make(VectorTerm::Word { memory: self.memories[rom], address }, width)
    }

    /// Returns the result of a cell as [`Op`] documents it.
    fn cell(
        &self,
        terms: &mut VectorTerms,
        op: &Op,
        width: u32,
        values: &[VectorTermId],
        products: &mut Vec<Product>,
    ) -> VectorTermId {
        let of = |net: &NetId| values[net.index()];
        let is_signed = |net: &NetId| self.design.net(*net).format.signed;
        let extended = |terms: &mut VectorTerms, net: &NetId, width: u32| {
            if is_signed(net) {
                terms.sign_extended(of(net), width)
            } else {
                terms.resized(of(net), width)
            }
        };
        match op {
            Op::Relabel(a) => of(a),
            Op::Extend(a) => extended(terms, a, width),
            Op::Slice { of: a, low } => terms.slice(of(a), *low, width),
            Op::Concat(parts) => {
                let joined = parts.iter().map(of).reduce(|upper, lower| {
                    let width = terms.width(upper) + terms.width(lower);
                    terms.make(VectorTerm::Join(upper, lower), width)
                });
                joined.unwrap_or_else(|| terms.constant(0, width))
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
                        let carry = terms.resized(of(carry), width);
                        terms.make(VectorTerm::Add(sum, carry), width)
                    }
                }
            }
            Op::Sub(a, b) => terms.make(VectorTerm::Sub(of(a), of(b)), width),
            Op::Mul(a, b) => {
                let factors = [a, b].map(|net| extended(terms, net, MAX_WIDTH));
                let ranges = [a, b].map(|net| self.design.net(*net).range);
                let product = Product { factors, ranges };
                if !products.contains(&product) {
                    products.push(product);
                }
                let product = terms.make(VectorTerm::Product(factors[0], factors[1]), MAX_WIDTH);
                terms.slice(product, 0, width)
            }
            Op::Equal(a, b) => terms.equal(of(a), of(b)),
            Op::Less(a, b) if is_signed(a) => terms.make(VectorTerm::SignedLess(of(a), of(b)), 1),
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
                let select = of(select);
                let mut chosen = None;
                for (number, input) in inputs.iter().enumerate().rev() {
                    chosen = Some(match chosen {
                        None => of(input),
                        Some(rest) => {
                            let number = terms.constant(number as u64, terms.width(select));
                            let this = terms.equal(select, number);
                            terms.choice(this, of(input), rest)
                        }
                    });
                }
                chosen.unwrap_or_else(|| terms.constant(0, width))
            }
        }
    }
}

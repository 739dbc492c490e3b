//! Evaluates a netlist: each cell as [`Op`] defines it, and a whole design clock by clock.
//!
//! This interpreter defines the meaning of a netlist, and is written to be read. The simulator ([`crate::sim`]) is written for
//! speed. Interpreter and simulator share no code that evaluates cells, and tests compare them.

use super::{Design, Driver, NetId, Op, RomId};
use glint_base::fixed::{Format, mask};

fn one<const N: usize>(a: &[u64; N], cell: impl Fn(u64) -> u64) -> [u64; N] {
    std::array::from_fn(|lane| cell(a[lane]))
}

fn two<const N: usize>(a: &[u64; N], b: &[u64; N], cell: impl Fn(u64, u64) -> u64) -> [u64; N] {
    std::array::from_fn(|lane| cell(a[lane], b[lane]))
}

/// Returns a function that reads a bit pattern of `width` bits in two's complement: `0b111` with 3 bits is −1.
fn signed(width: u32) -> impl Fn(u64) -> i64 {
    let drop = 64 - width;
    move |bits| (bits << drop) as i64 >> drop
}

/// Evaluates a cell, as [`Op`] defines it, for `N` independent sets of operands. The result has `width` bits; `of` gives the bit
/// patterns of an operand.
pub fn cell<'a, Operand: Copy, const N: usize>(
    op: &Op<Operand>,
    width: u32,
    format: &impl Fn(Operand) -> Format,
    of: &impl Fn(Operand) -> &'a [u64; N],
) -> [u64; N] {
    let all = mask(width);
    let is_signed = |operand: Operand| format(operand).signed;
    let width_of = |operand: Operand| format(operand).width();
    match op {
        Op::Relabel(a) => *of(*a),
        Op::Extend(a) if is_signed(*a) => {
            let number = signed(width_of(*a));
            one(of(*a), |a| number(a) as u64 & all)
        }
        Op::Extend(a) => *of(*a),
        Op::Slice { of: a, low } => one(of(*a), |a| a >> low & all),
        Op::Concat(parts) => parts.iter().fold([0; N], |sum, part| {
            let width = width_of(*part);
            two(&sum, of(*part), |sum, part| sum.checked_shl(width).unwrap_or(0) | part)
        }),
        Op::Not(a) => one(of(*a), |a| !a & all),
        Op::And(a, b) => two(of(*a), of(*b), |a, b| a & b),
        Op::Or(a, b) => two(of(*a), of(*b), |a, b| a | b),
        Op::Xor(a, b) => two(of(*a), of(*b), |a, b| a ^ b),
        Op::Add { a, b, carry } => {
            let sum = two(of(*a), of(*b), |a, b| a.wrapping_add(b));
            let carry_in = carry.map_or(&[0; N], of);
            two(&sum, carry_in, |sum, carry| sum.wrapping_add(carry) & all)
        }
        Op::Sub(a, b) => two(of(*a), of(*b), |a, b| a.wrapping_sub(b) & all),
        Op::Mul(a, b) if is_signed(*a) => {
            let (x, y) = (signed(width_of(*a)), signed(width_of(*b)));
            two(of(*a), of(*b), |a, b| x(a).wrapping_mul(y(b)) as u64 & all)
        }
        Op::Mul(a, b) => two(of(*a), of(*b), |a, b| a.wrapping_mul(b) & all),
        Op::Equal(a, b) => two(of(*a), of(*b), |a, b| u64::from(a == b)),
        Op::Less(a, b) if is_signed(*a) => {
            let number = signed(width_of(*a));
            two(of(*a), of(*b), |a, b| u64::from(number(a) < number(b)))
        }
        Op::Less(a, b) => two(of(*a), of(*b), |a, b| u64::from(a < b)),
        Op::Any(a) => one(of(*a), |a| u64::from(a != 0)),
        Op::All(a) => {
            let whole = mask(width_of(*a));
            one(of(*a), |a| u64::from(a == whole))
        }
        Op::Mux { select, inputs } => {
            let last = inputs.len() - 1;
            let (select, mut out) = (of(*select), *of(inputs[last]));
            for (at, &input) in (0u64..).zip(&inputs[..last]) {
                let input = of(input);
                out = std::array::from_fn(
                    |lane| {
                        if select[lane] == at { input[lane] } else { out[lane] }
                    },
                );
            }
            out
        }
    }
}

/// A simple simulator, which evaluates one net after another.
pub struct Interpreter<'a> {
    design: &'a Design,
    order: Vec<NetId>,
    values: Vec<[u64; 1]>,
    /// The words of each ROM; a memory with a write port can change them.
    words: Vec<Vec<u64>>,
}

impl<'a> Interpreter<'a> {
    /// Makes a simulator of the design at power-up: inputs, registers and the outputs of synchronous ROMs are 0.
    ///
    /// # Errors
    /// Fails if the design has a combinational loop. The error lists the nets along the loop.
    pub fn new(design: &'a Design) -> Result<Self, Vec<NetId>> {
        Ok(Self {
            design,
            order: design.levelise()?,
            values: vec![[0]; design.nets.len()],
            words: design.roms.iter().map(|rom| rom.words.clone()).collect(),
        })
    }

    /// Applies the bit patterns of all input ports, in the order of the ports, and evaluates every net. Bits above the width of a
    /// port are ignored.
    pub fn settle(&mut self, inputs: &[u64]) {
        let design = self.design;
        for (port, &bits) in design.inputs().zip(inputs) {
            self.values[port.net.index()] = [bits & mask(design.width(port.net))];
        }
        let positions = design.field_positions();
        let format = |net: NetId| design.net(net).format;
        for &id in &self.order {
            let width = design.width(id);
            let bits = match &design.net(id).driver {
                Driver::Constant(bits) => *bits,
                Driver::Field(field) => {
                    let word = self.value(design.rom(design.control.rom).data);
                    word >> positions[field.index()]
                }
                Driver::Rom(rom) if !design.rom(*rom).synchronous => self.read(*rom),
                Driver::Op(op) => cell(op, width, &format, &|net| &self.values[net.index()])[0],
                Driver::Undriven | Driver::Input | Driver::Register(_) | Driver::Rom(_) => continue,
            };
            self.values[id.index()] = [bits & mask(width)];
        }
    }

    /// Performs a rising edge after [`Interpreter::settle`]: registers, synchronous ROMs and written words load. If the input `rst_n` is 0,
    /// registers with a reset take their reset values.
    pub fn edge(&mut self) {
        let design = self.design;
        let reset_port = design.port(|role| role == super::Role::Reset);
        let is_reset = reset_port.is_some_and(|port| self.value(port.net) == 0);
        let mut next = Vec::new();
        for register in &design.registers {
            let enabled = register.enable.is_none_or(|enable| self.value(enable) == 1);
            match (register.reset, register.data) {
                (Some(bits), _) if is_reset => next.push((register.q, bits)),
                (_, Some(data)) if enabled => next.push((register.q, self.value(data))),
                _ => {}
            }
        }
        for (at, rom) in design.roms.iter().enumerate() {
            if rom.synchronous && rom.enable.is_none_or(|enable| self.value(enable) == 1) {
                next.push((rom.data, self.read(RomId(at as u32))));
            }
        }
        self.write();
        for (net, bits) in next {
            self.values[net.index()] = [bits & mask(design.width(net))];
        }
    }

    /// Returns the bit pattern of a net; for a cell, since the latest [`Interpreter::settle`].
    pub fn value(&self, net: NetId) -> u64 {
        self.values[net.index()][0]
    }

    /// Returns the addressed word, or 0 behind the last word.
    fn read(&self, rom: RomId) -> u64 {
        let address = self.value(self.design.rom(rom).address) as usize;
        self.words[rom.index()].get(address).copied().unwrap_or(0)
    }

    /// Stores the words at the write ports whose enable is 1.
    fn write(&mut self) {
        for (at, rom) in self.design.roms.iter().enumerate() {
            let Some(write) = &rom.write else { continue };
            if self.value(write.enable) == 1 {
                let word = write.word(self.design, |net| self.value(net));
                let address = self.value(write.address) as usize;
                if let Some(stored) = self.words[at].get_mut(address) {
                    *stored = word;
                }
            }
        }
    }
}

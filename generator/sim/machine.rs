//! The interpreter of simulation programs.

use std::array;
use std::sync::Arc;

use crate::netlist::NetId;
use crate::sim::program::{Instruction, Program, Slot, Span};

/// The state of `LANES` independent instances of a design, which one pass over the [`Program`]
/// advances together.
#[derive(Clone, Debug)]
pub struct Machine<const LANES: usize = 1> {
    program: Arc<Program>,
    slots: Vec<[u64; LANES]>,
}

impl<const LANES: usize> Machine<LANES> {
    /// Power-up: registers, outputs of synchronous ROMs and inputs are 0; settled.
    pub fn new(program: Arc<Program>) -> Self {
        let slots = program.initial.iter().map(|bits| [*bits; LANES]).collect();
        let mut machine = Self { program, slots };
        machine.settle();
        machine
    }

    /// The program that it runs.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// Takes the bit patterns of all input ports, in order of declaration; bits beyond the width of
    /// a port are ignored. [`Machine::settle_inputs`] is then due.
    ///
    /// # Panics
    /// When there are fewer patterns than ports.
    pub fn set_inputs(&mut self, inputs: &[[u64; LANES]]) {
        let masks = &self.program.input_masks;
        for ((slot, bits), mask) in self.slots.iter_mut().zip(&inputs[..masks.len()]).zip(masks) {
            *slot = bits.map(|bits| bits & mask);
        }
    }

    /// Brings all nets up to date.
    pub fn settle(&mut self) {
        self.program.settle(0, &mut self.slots);
    }

    /// Brings all nets up to date when only inputs have changed since they were.
    pub fn settle_inputs(&mut self) {
        self.program
            .settle(self.program.inputs_from, &mut self.slots);
    }

    /// The rising edge: registers and synchronous ROMs take what their operands carry.
    /// [`Machine::settle`] is then due.
    pub fn edge(&mut self) {
        self.program.edge(&mut self.slots);
    }

    /// The bit pattern of a net in each lane.
    pub fn lanes(&self, net: NetId) -> &[u64; LANES] {
        &self.slots[self.program.slot(net)]
    }
}

impl Program {
    fn settle<const LANES: usize>(&self, from: usize, slots: &mut [[u64; LANES]]) {
        for instruction in &self.instructions[from..] {
            execute(*instruction, &self.choices, &self.words, slots);
        }
    }

    fn edge<const LANES: usize>(&self, slots: &mut [[u64; LANES]]) {
        for edge in &self.reads {
            unary(slots, edge.to, edge.address, |address| {
                read(&self.words, edge.words, address)
            });
        }
        for edge in &self.registers {
            let data = slots[edge.data as usize];
            let enable = slots[edge.enable as usize];
            let keep = slots[edge.keep as usize];
            let q = &mut slots[edge.q as usize];
            for lane in 0..LANES {
                let loaded = if enable[lane] == 0 {
                    q[lane]
                } else {
                    data[lane]
                };
                q[lane] = if keep[lane] == 0 { edge.reset } else { loaded };
            }
        }
    }
}

/// Executes one instruction.
#[inline(always)]
pub(super) fn execute<const LANES: usize>(
    instruction: Instruction,
    choices: &[Slot],
    words: &[u64],
    slots: &mut [[u64; LANES]],
) {
    use Instruction as I;
    match instruction {
        I::Copy { to, a } => unary(slots, to, a, |a| a),
        I::Slice { to, a, low, drop } => unary(slots, to, a, |a| a >> low & mask(drop)),
        I::Concat { to, a, b, shift } => binary(slots, to, a, b, |a, b| a << shift | b),
        I::SignExtend { to, a, from, drop } => {
            unary(slots, to, a, |a| signed(a, from) as u64 & mask(drop));
        }
        I::And { to, a, b } => binary(slots, to, a, b, |a, b| a & b),
        I::Or { to, a, b } => binary(slots, to, a, b, |a, b| a | b),
        I::Xor { to, a, b } => binary(slots, to, a, b, |a, b| a ^ b),
        I::Add { to, a, b, drop } => {
            binary(slots, to, a, b, |a, b| a.wrapping_add(b) & mask(drop));
        }
        I::AddCarry {
            to,
            a,
            b,
            carry,
            drop,
        } => ternary(slots, to, [a, b, carry], |a, b, carry| {
            a.wrapping_add(b).wrapping_add(carry) & mask(drop)
        }),
        I::Sub { to, a, b, drop } => {
            binary(slots, to, a, b, |a, b| a.wrapping_sub(b) & mask(drop));
        }
        I::MulUnsigned { to, a, b } => binary(slots, to, a, b, u64::wrapping_mul),
        I::MulSigned {
            to,
            a,
            b,
            drop_a,
            drop_b,
            drop,
        } => binary(slots, to, a, b, |a, b| {
            signed(a, drop_a).wrapping_mul(signed(b, drop_b)) as u64 & mask(drop)
        }),
        I::Equal { to, a, b } => binary(slots, to, a, b, |a, b| u64::from(a == b)),
        I::Any { to, a } => unary(slots, to, a, |a| u64::from(a != 0)),
        I::LessUnsigned { to, a, b } => binary(slots, to, a, b, |a, b| u64::from(a < b)),
        I::LessSigned { to, a, b, drop } => binary(slots, to, a, b, |a, b| {
            u64::from(signed(a, drop) < signed(b, drop))
        }),
        I::Choose { to, select, a, b } => {
            ternary(
                slots,
                to,
                [select, a, b],
                |select, a, b| {
                    if select == 0 { a } else { b }
                },
            )
        }
        I::Mux {
            to,
            select,
            first,
            last,
        } => {
            let select = slots[select as usize];
            let last = u64::from(last);
            let chosen = array::from_fn(|lane| {
                let entry = select[lane].saturating_add(u64::from(first)).min(last);
                slots[choices[entry as usize] as usize][lane]
            });
            slots[to as usize] = chosen;
        }
        I::Read {
            to,
            address,
            words: span,
        } => {
            unary(slots, to, address, |address| read(words, span, address));
        }
    }
}

/// The mask of a width given as `drop`.
#[inline(always)]
fn mask(drop: u8) -> u64 {
    u64::MAX >> drop
}

/// The value of a two's complement pattern whose width is given as `drop`.
#[inline(always)]
fn signed(bits: u64, drop: u8) -> i64 {
    (bits << drop) as i64 >> drop
}

/// A word of a ROM; 0 beyond its contents.
#[inline(always)]
fn read(words: &[u64], span: Span, address: u64) -> u64 {
    if address < u64::from(span.len) {
        words[span.start as usize + address as usize]
    } else {
        0
    }
}

#[inline(always)]
fn unary<const LANES: usize>(
    slots: &mut [[u64; LANES]],
    to: Slot,
    a: Slot,
    f: impl Fn(u64) -> u64,
) {
    let a = slots[a as usize];
    let to = &mut slots[to as usize];
    for lane in 0..LANES {
        to[lane] = f(a[lane]);
    }
}

#[inline(always)]
fn binary<const LANES: usize>(
    slots: &mut [[u64; LANES]],
    to: Slot,
    a: Slot,
    b: Slot,
    f: impl Fn(u64, u64) -> u64,
) {
    let (a, b) = (slots[a as usize], slots[b as usize]);
    let to = &mut slots[to as usize];
    for lane in 0..LANES {
        to[lane] = f(a[lane], b[lane]);
    }
}

#[inline(always)]
fn ternary<const LANES: usize>(
    slots: &mut [[u64; LANES]],
    to: Slot,
    [a, b, c]: [Slot; 3],
    f: impl Fn(u64, u64, u64) -> u64,
) {
    let (a, b, c) = (slots[a as usize], slots[b as usize], slots[c as usize]);
    let to = &mut slots[to as usize];
    for lane in 0..LANES {
        to[lane] = f(a[lane], b[lane], c[lane]);
    }
}

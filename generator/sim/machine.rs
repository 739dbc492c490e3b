//! The interpreter of simulation programs.

use std::array;
use std::hint::select_unpredictable;
use std::sync::Arc;

use crate::netlist::NetId;
use crate::sim::program::{Instruction, Program, Slot, Sources, Span};

/// The state of `LANES` independent instances of a design, which one pass over the [`Program`]
/// advances together.
#[derive(Clone, Debug)]
pub struct Machine<const LANES: usize = 1> {
    program: Arc<Program>,
    slots: Vec<[u64; LANES]>,
    /// The sources that have changed since the machine was last settled.
    changed: Sources,
}

impl<const LANES: usize> Machine<LANES> {
    /// Power-up: registers, outputs of synchronous ROMs and inputs are 0; settled.
    pub fn new(program: Arc<Program>) -> Self {
        let slots = program.initial.iter().map(|bits| [*bits; LANES]).collect();
        let mut machine = Self {
            program,
            slots,
            changed: Sources::MAX,
        };
        machine.settle();
        machine
    }

    /// The program that it runs.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// Takes the bit patterns of the input ports, in order of declaration; bits beyond the width of
    /// a port are ignored. [`Machine::settle`] is then due.
    pub fn set_inputs(&mut self, inputs: &[[u64; LANES]]) {
        for (port, bits) in self.program.inputs.iter().zip(inputs) {
            let bits = bits.map(|bits| bits & port.mask);
            let slot = &mut self.slots[port.slot as usize];
            self.changed |= changed(slot, &bits, port.source);
            *slot = bits;
        }
    }

    /// Brings all nets up to date with inputs, registers and synchronous ROMs.
    pub fn settle(&mut self) {
        let Program {
            instructions,
            segments,
            choices,
            words,
            ..
        } = &*self.program;
        let mut rest = instructions.as_slice();
        for segment in segments {
            let (here, after) = rest.split_at(segment.len as usize);
            rest = after;
            if self.changed & segment.sources != 0 {
                for instruction in here {
                    execute(
                        *instruction,
                        choices,
                        words,
                        &mut self.slots,
                        &mut self.changed,
                    );
                }
            }
        }
        self.changed = 0;
    }

    /// The rising edge: registers and synchronous ROMs take what their operands carry.
    /// [`Machine::settle`] is then due.
    pub fn edge(&mut self) {
        let slots = self.slots.as_mut_slice();
        for edge in &self.program.reads {
            let address = slots[edge.address as usize];
            let word = address.map(|address| read(&self.program.words, edge.words, address));
            let to = &mut slots[edge.to as usize];
            self.changed |= changed(to, &word, edge.source);
            *to = word;
        }
        for edge in &self.program.registers {
            let data = slots[edge.data as usize];
            let enable = slots[edge.enable as usize];
            let keep = slots[edge.keep as usize];
            let q = &mut slots[edge.q as usize];
            let next = array::from_fn(|lane| {
                let loaded = select_unpredictable(enable[lane] == 0, q[lane], data[lane]);
                select_unpredictable(keep[lane] == 0, edge.reset, loaded)
            });
            self.changed |= changed(q, &next, edge.source);
            *q = next;
        }
    }

    /// The bit pattern of a net in each lane.
    ///
    /// # Panics
    /// When the net is unnamed and was optimised away.
    pub fn lanes(&self, net: NetId) -> &[u64; LANES] {
        &self.slots[self.program.slot(net)]
    }
}

/// `source` when a slot is going to change in any lane.
#[inline(always)]
fn changed<const LANES: usize>(old: &[u64; LANES], new: &[u64; LANES], source: Sources) -> Sources {
    let differences = old
        .iter()
        .zip(new)
        .fold(0, |all, (old, new)| all | (old ^ new));
    if differences == 0 { 0 } else { source }
}

/// Executes one instruction; fields that change are added to `news`.
#[inline(always)]
pub(super) fn execute<const LANES: usize>(
    instruction: Instruction,
    choices: &[Slot],
    words: &[u64],
    slots: &mut [[u64; LANES]],
    news: &mut Sources,
) {
    use Instruction as I;
    match instruction {
        I::Copy { to, a } => unary(slots, to, a, |a| a),
        I::Field {
            to,
            a,
            low,
            drop,
            source,
        } => {
            let field = slots[a as usize].map(|a| a >> low & mask(drop));
            let to = &mut slots[to as usize];
            *news |= changed(to, &field, 1 << source);
            *to = field;
        }
        I::Slice { to, a, low, drop } => unary(slots, to, a, |a| a >> low & mask(drop)),
        I::Place {
            to,
            base,
            a,
            low,
            drop,
            shift,
        } => binary(slots, to, base, a, |base, a| {
            base | (a >> low & mask(drop)) << shift
        }),
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
        I::Any { to, a, low, drop } => {
            unary(slots, to, a, |a| u64::from(a >> low & mask(drop) != 0));
        }
        I::LessUnsigned { to, a, b } => binary(slots, to, a, b, |a, b| u64::from(a < b)),
        I::LessSigned { to, a, b, drop } => binary(slots, to, a, b, |a, b| {
            u64::from(signed(a, drop) < signed(b, drop))
        }),
        I::Choose { to, select, a, b } => ternary(slots, to, [select, a, b], |select, a, b| {
            select_unpredictable(select == 0, a, b)
        }),
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

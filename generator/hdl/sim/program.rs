//! Defines the compiled form of a design for the simulator: slots, instructions, and the operations of a clock edge.
//!
//! All values are in *slots*, bit patterns with zeros above their width. A clock has two phases. *Settling* runs the steps in
//! order; each step computes one slot from earlier slots. The *edge* writes the outputs of synchronous ROMs and then the
//! registers.

use crate::netlist::NetId;
use glint_base::fixed::MAX_WIDTH;

/// The number of a slot within its bank. Nets that are mere wiring (other names, zero extensions, whole slices) share a slot. An
/// unnamed slice has no slot if all its readers take the bits from its operand themselves.
pub(super) type Slot = u32;

/// A set of sources, with one bit for each. A *source* is a value that changes outside settling: an input port, or a value that
/// the edge writes. Each field of the control word is a source too, because most fields stay the same from one control word to
/// the next. If there are too many input ports, or too many values that the edge writes, several share a bit. A field for which
/// no bit is left is no source.
pub(super) type Sources = u64;

/// A computation within one bank: the slot `to` from the slots `a`, `b` and so on, which have smaller numbers.
///
/// Widths are given as `drop`, 64 less the width: `u64::MAX >> drop` is the mask, and a shift to the left by `drop` brings the
/// sign bit to the top. For example, a width of 21 has the `drop` 43.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Instruction {
    /// The value of `a` from before the coming edge, which may overwrite `a`.
    Copy { to: Slot, a: Slot },
    /// The bits of `a` from `low` up. If they differ from the previous value, `source` has changed.
    Field { to: Slot, a: Slot, low: u8, drop: u8, source: u8 },
    /// The bits of `a` from `low` up, as many as `drop` says.
    Slice { to: Slot, a: Slot, low: u8, drop: u8 },
    /// The bits of `a` from `low` up, shifted to the left by `shift`, together with the bits of `base`.
    Place { to: Slot, base: Slot, a: Slot, low: u8, drop: u8, shift: u8 },
    /// The value of `a`, whose width is given by `from`, with copies of its sign bit up to the width given by `drop`.
    SignExtend { to: Slot, a: Slot, from: u8, drop: u8 },
    /// Bitwise and.
    And { to: Slot, a: Slot, b: Slot },
    /// Bitwise or.
    Or { to: Slot, a: Slot, b: Slot },
    /// Bitwise exclusive or. With a mask of ones as `b`, the result is the inverse of `a`.
    Xor { to: Slot, a: Slot, b: Slot },
    /// Sum modulo 2^width, with the width given by `drop`.
    Add { to: Slot, a: Slot, b: Slot, drop: u8 },
    /// Sum of bits of `a` and bits of `b`, each from its `low` up with the width that its `drop` gives, modulo 2^width of the
    /// result. For example, it adds the rounding bit to a truncated value.
    AddSlices { to: Slot, a: Slot, b: Slot, low_a: u8, drop_a: u8, low_b: u8, drop_b: u8, drop: u8 },
    /// Sum of `a`, `b` and the bit `carry`, modulo 2^width.
    AddCarry { to: Slot, a: Slot, b: Slot, carry: Slot, drop: u8 },
    /// Difference `a − b` modulo 2^width.
    Sub { to: Slot, a: Slot, b: Slot, drop: u8 },
    /// Product of unsigned factors, which always fits the slot.
    MulUnsigned { to: Slot, a: Slot, b: Slot },
    /// Product of signed factors, whose widths are given by `drop_a` and `drop_b`.
    MulSigned { to: Slot, a: Slot, b: Slot, drop_a: u8, drop_b: u8, drop: u8 },
    /// 1 if `a == b`, otherwise 0. With a mask of ones as `b`, the instruction tests whether all bits of `a` are 1.
    Equal { to: Slot, a: Slot, b: Slot },
    /// 1 if any bit of `a` from `low` up is 1, otherwise 0.
    Any { to: Slot, a: Slot, low: u8, drop: u8 },
    /// 1 if `a < b` as unsigned numbers, otherwise 0.
    LessUnsigned { to: Slot, a: Slot, b: Slot },
    /// 1 if `a < b` as signed numbers, otherwise 0.
    LessSigned { to: Slot, a: Slot, b: Slot, drop: u8 },
    /// The value of `a` if `select` is 0, otherwise `b`.
    Choose { to: Slot, select: Slot, a: Slot, b: Slot },
    /// The value of `a` if the bits of `of` from `low` up are all 0, otherwise `b`.
    ChooseAny { to: Slot, of: Slot, low: u8, drop: u8, a: Slot, b: Slot },
    /// The value of `a` if the bits of `of` from `low` up are all 0. Otherwise other bits of `of`, placed on `base` as by
    /// `Place`.
    ChoosePlace {
        to: Slot,
        of: Slot,
        low: u8,
        drop: u8,
        a: Slot,
        base: Slot,
        place_low: u8,
        place_drop: u8,
        shift: u8,
    },
    /// The value of the slot in entry `first + select` of the table of choices, or in entry `last` if that is smaller.
    Mux { to: Slot, select: Slot, first: u32, last: u32 },
    /// The word `address` of a ROM, or 0 behind the last word.
    Read { to: Slot, address: Slot, words: Span },
}

impl Instruction {
    /// Returns the slots, the result first. The inputs of a mux are not among them, because they are in the table of choices.
    pub(super) fn slots_mut(&mut self) -> Vec<&mut Slot> {
        match self {
            Self::Copy { to, a }
            | Self::Field { to, a, .. }
            | Self::Slice { to, a, .. }
            | Self::SignExtend { to, a, .. }
            | Self::Any { to, a, .. }
            | Self::Mux { to, select: a, .. }
            | Self::Read { to, address: a, .. } => vec![to, a],
            Self::Place { to, base: a, a: b, .. }
            | Self::And { to, a, b }
            | Self::Or { to, a, b }
            | Self::Xor { to, a, b }
            | Self::Add { to, a, b, .. }
            | Self::AddSlices { to, a, b, .. }
            | Self::Sub { to, a, b, .. }
            | Self::MulUnsigned { to, a, b }
            | Self::MulSigned { to, a, b, .. }
            | Self::Equal { to, a, b }
            | Self::LessUnsigned { to, a, b }
            | Self::LessSigned { to, a, b, .. } => vec![to, a, b],
            Self::AddCarry { to, a, b, carry: c, .. }
            | Self::Choose { to, select: a, a: b, b: c }
            | Self::ChooseAny { to, of: a, a: b, b: c, .. }
            | Self::ChoosePlace { to, of: a, a: b, base: c, .. } => vec![to, a, b, c],
        }
    }
}

/// An instruction within a bank, or the conversion of a value from one bank to the other.
#[derive(Clone, Copy, Debug)]
pub(super) enum SettlingStep {
    /// An instruction whose slots are all narrow.
    Narrow(Instruction),
    /// An instruction whose slots are all wide.
    Wide(Instruction),
    /// Copies a narrow slot to a wide slot.
    Widen { to: Slot, a: Slot },
    /// Copies the bits of a wide slot from `low` up to a narrow slot, as many as `drop` says.
    Cut { to: Slot, a: Slot, low: u8, drop: u8 },
    /// The wide product of narrow unsigned factors.
    Product { to: Slot, a: Slot, b: Slot },
    /// The wide product of narrow signed factors, whose widths are given by `drop_a` and `drop_b`.
    SignedProduct { to: Slot, a: Slot, b: Slot, drop_a: u8, drop_b: u8, drop: u8 },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ValueSlot {
    Narrow(Slot),
    Wide(Slot),
}

/// A range of [`CompiledDesign::words`]: the first index and the number of words of a ROM.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Span {
    pub start: u32,
    pub len: u32,
}

/// Consecutive steps that depend on the same sources. Settling skips them if none of the sources has changed.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepGroup {
    pub sources: Sources,
    pub len: u32,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct InputPort {
    /// The position among the input ports.
    pub at: u32,
    pub slot: Slot,
    pub source: Sources,
    pub mask: u64,
}

/// A synchronous ROM: at the edge, `to` gets the word at `address` if `enable` is 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReadEdge {
    pub to: Slot,
    pub source: Sources,
    pub address: Slot,
    /// `None` if the ROM reads at every edge.
    pub enable: Option<Slot>,
    pub words: Span,
}

/// A memory with a write port: at the edge, the word at the port replaces the word at `address` if `enable` is 1.
#[derive(Clone, Debug)]
pub(super) struct MemoryWrite {
    pub words: Span,
    pub enable: NetId,
    pub address: NetId,
    /// The parts of the word and their widths, the highest bits first.
    pub parts: Vec<(NetId, u32)>,
}

/// A register: at the edge, `q` gets the reset value if `rst_n` is 0, and otherwise `data` if `enable` is 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct RegisterEdge {
    pub q: Slot,
    pub source: Sources,
    pub data: Slot,
    /// `None` if the register loads at every edge.
    pub enable: Option<Slot>,
    /// The slot of `rst_n`, and the value that the register loads if it is 0.
    pub reset: Option<(Slot, u64)>,
}

/// The slots of one width that change outside settling, and the contents at power-up. The narrow bank has slots of 32 bits, the
/// wide bank of 64.
#[derive(Clone, Debug, Default)]
pub(super) struct Bank {
    pub inputs: Vec<InputPort>,
    /// An edge performs the reads before it loads `registers`. No read or load overwrites a slot that a later one uses.
    pub reads: Vec<ReadEdge>,
    pub registers: Vec<RegisterEdge>,
    /// The values at power-up, before settling.
    pub initial: Vec<u64>,
}

/// A compiled [`Design`](crate::netlist::Design), without state. Several machines may share it.
#[derive(Clone, Debug)]
pub struct CompiledDesign {
    /// Each step follows the steps that compute its operands.
    pub(super) steps: Vec<SettlingStep>,
    /// Consecutive steps with the same sources. Together the groups contain all steps, in order.
    pub(super) segments: Vec<StepGroup>,
    pub(super) narrow: Bank,
    pub(super) wide: Bank,
    /// The inputs of all muxes with more than two inputs, as slots in the bank of the mux.
    pub(super) choices: Vec<Slot>,
    /// The words of all ROMs.
    pub(super) words: Vec<u64>,
    /// The memories with a write port.
    pub(super) writes: Vec<MemoryWrite>,
    /// For each net, its slot; `None` for an unnamed net that the compiler has optimised away.
    pub(super) places: Vec<Option<ValueSlot>>,
}

impl CompiledDesign {
    pub fn inputs(&self) -> usize {
        self.narrow.inputs.len() + self.wide.inputs.len()
    }

    /// Returns the slot of a net. Panics for an unnamed net that was optimised away.
    pub(super) fn place(&self, net: NetId) -> ValueSlot {
        let place = self.places[net.index()];
        place.unwrap_or_else(|| panic!("{net:?} is unnamed and not simulated"))
    }
}

/// Returns 64 less `width`.
pub(super) fn drop_of(width: u32) -> u8 {
    (MAX_WIDTH - width) as u8
}

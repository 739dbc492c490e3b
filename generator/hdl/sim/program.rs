//! Defines the compiled form of a design for the simulator: slots, instructions, and what happens at an edge.
//!
//! All values are in *slots*, bit patterns masked to their width. A clock has two phases. *Settling* runs the steps
//! in order; each computes one slot from earlier ones. The *edge* writes the data outputs of synchronous ROMs and
//! then the registers. Nets that are mere wiring (other names, zero extensions, whole slices) share a slot, constants
//! are folded, and equal instructions are merged, so there are fewer instructions than cells. An unnamed net has no
//! slot at all if all its readers can cut it out of its operand themselves.
//!
//! There are two banks of slots. The *narrow* bank has slots of 32 bits: nearly all values fit, and a vector of the
//! processor holds twice as many lanes. The *wide* bank has slots of 64 bits for all other values. An [`Instruction`]
//! works within one bank; the other [`SettlingStep`]s lead from one bank to the other.
//!
//! A value that changes outside settling is a *source*: an input port, or a value that the edge writes. The fields of
//! the control word are sources too, because most of them stay the same from one word to the next. Instructions that
//! depend on the same sources form a segment. Settling skips segments whose sources have not changed.

use crate::netlist::NetId;
use glint_base::fixed::MAX_WIDTH;

/// The number of a slot within its bank.
pub(super) type Slot = u32;

/// A set of sources, one bit each; when there are more than 64, several share a bit.
pub(super) type Sources = u64;

/// A computation within one bank: `to` from `a`, `b`, …, which have smaller numbers.
///
/// Widths are given as `drop`, 64 less the width: `u64::MAX >> drop` is the mask, and shifting up by `drop` brings the sign bit
/// to the top. For example, a width of 21 has the `drop` 43.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Instruction {
    /// `a`, as it was before the coming edge.
    Copy { to: Slot, a: Slot },
    /// The bits of `a` from `low` up; when they are news, `source` has changed.
    Field { to: Slot, a: Slot, low: u8, drop: u8, source: u8 },
    /// The bits of `a` from `low` up.
    Slice { to: Slot, a: Slot, low: u8, drop: u8 },
    /// The bits of `a` from `low` up, shifted up, together with the bits of `base`.
    Place { to: Slot, base: Slot, a: Slot, low: u8, drop: u8, shift: u8 },
    /// `a`, whose width is given by `from`, with copies of its sign bit above it.
    SignExtend { to: Slot, a: Slot, from: u8, drop: u8 },
    /// Bitwise and.
    And { to: Slot, a: Slot, b: Slot },
    /// Bitwise or.
    Or { to: Slot, a: Slot, b: Slot },
    /// Bitwise exclusive or; with a mask, not.
    Xor { to: Slot, a: Slot, b: Slot },
    /// Sum.
    Add { to: Slot, a: Slot, b: Slot, drop: u8 },
    /// Sum of bits of `a` and bits of `b`: for example, a value and the amount by which it is rounded up.
    AddSlices { to: Slot, a: Slot, b: Slot, low_a: u8, drop_a: u8, low_b: u8, drop_b: u8, drop: u8 },
    /// Sum and carry.
    AddCarry { to: Slot, a: Slot, b: Slot, carry: Slot, drop: u8 },
    /// Difference.
    Sub { to: Slot, a: Slot, b: Slot, drop: u8 },
    /// Product of unsigned factors; it always fits.
    MulUnsigned { to: Slot, a: Slot, b: Slot },
    /// Product of signed factors, whose widths are given by `drop_a` and `drop_b`.
    MulSigned { to: Slot, a: Slot, b: Slot, drop_a: u8, drop_b: u8, drop: u8 },
    /// 1 when `a == b`; with a mask, when all bits are 1.
    Equal { to: Slot, a: Slot, b: Slot },
    /// 1 when the bits of `a` from `low` up are not all 0.
    Any { to: Slot, a: Slot, low: u8, drop: u8 },
    /// 1 when `a < b`, unsigned.
    LessUnsigned { to: Slot, a: Slot, b: Slot },
    /// 1 when `a < b`, signed.
    LessSigned { to: Slot, a: Slot, b: Slot, drop: u8 },
    /// `a` when `select` is 0, else `b`.
    Choose { to: Slot, select: Slot, a: Slot, b: Slot },
    /// `a` when the bits of `of` from `low` up are all 0, else `b`.
    ChooseAny { to: Slot, of: Slot, low: u8, drop: u8, a: Slot, b: Slot },
    /// `a` when the bits of `of` from `low` up are all 0, else other bits of it, placed as by `Place`.
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
    /// The slot that entry `first + select`, at most `last`, of the table of choices names.
    Mux { to: Slot, select: Slot, first: u32, last: u32 },
    /// Word `address` of a ROM.
    Read { to: Slot, address: Slot, words: Span },
}

impl Instruction {
    /// Returns the slots of the instruction, the result first. The inputs of a mux in the table of choices are not
    /// included.
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

/// One step of settling.
#[derive(Clone, Copy, Debug)]
pub(super) enum SettlingStep {
    /// Among the narrow slots.
    Narrow(Instruction),
    /// Among the wide slots.
    Wide(Instruction),
    /// A narrow slot as a wide one.
    Widen { to: Slot, a: Slot },
    /// The bits of a wide slot from `low` up, as a narrow one.
    Cut { to: Slot, a: Slot, low: u8, drop: u8 },
    /// The wide product of narrow unsigned factors.
    Product { to: Slot, a: Slot, b: Slot },
    /// The wide product of narrow signed factors, whose widths are given by `drop_a` and `drop_b`.
    SignedProduct { to: Slot, a: Slot, b: Slot, drop_a: u8, drop_b: u8, drop: u8 },
}

/// The place of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ValueSlot {
    Narrow(Slot),
    Wide(Slot),
}

/// The contents of a ROM in [`CompiledDesign::words`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Span {
    pub start: u32,
    pub len: u32,
}

/// Consecutive steps that depend on the same sources.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepGroup {
    pub sources: Sources,
    pub len: u32,
}

/// An input port.
#[derive(Clone, Copy, Debug)]
pub(super) struct InputPort {
    /// The position of the source among the input ports.
    pub at: u32,
    pub slot: Slot,
    pub source: Sources,
    pub mask: u64,
}

/// A synchronous ROM: at the edge, `to` takes word `address` when `enable` is 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReadEdge {
    pub to: Slot,
    pub source: Sources,
    pub address: Slot,
    /// The slot of the read enable; `None` if the ROM reads at every edge.
    pub enable: Option<Slot>,
    pub words: Span,
}

/// A register: at the edge, `q` takes the value of `reset` when its slot, `rst_n`, is 0, else `data` when `enable` is 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct RegisterEdge {
    pub q: Slot,
    pub source: Sources,
    pub data: Slot,
    /// The slot of the load enable; `None` if the register loads at every edge.
    pub enable: Option<Slot>,
    /// The slot of the reset and the value that the register takes on a reset; `None` if the register has no reset.
    pub reset: Option<(Slot, u64)>,
}

/// One of the two banks: its slots that change outside settling, and its initial contents.
#[derive(Clone, Debug, Default)]
pub(super) struct Bank {
    pub inputs: Vec<InputPort>,
    /// The reads of synchronous ROMs, which an edge performs before it loads `registers`. An earlier read or load never overwrites
    /// an operand of a later one.
    pub reads: Vec<ReadEdge>,
    pub registers: Vec<RegisterEdge>,
    /// The contents of the slots at power-up, before settling.
    pub initial: Vec<u64>,
}

/// A compiled [`Design`](crate::netlist::Design). Machines share it; it holds no state.
#[derive(Clone, Debug)]
pub struct CompiledDesign {
    /// The steps, in an order in which each follows the steps that compute its operands.
    pub(super) steps: Vec<SettlingStep>,
    /// They cover the steps.
    pub(super) segments: Vec<StepGroup>,
    pub(super) narrow: Bank,
    pub(super) wide: Bank,
    /// The inputs of all muxes that have more than two, in the bank of the mux.
    pub(super) choices: Vec<Slot>,
    /// The contents of all ROMs.
    pub(super) words: Vec<u64>,
    /// The place of each net; none for unnamed nets that have none.
    pub(super) places: Vec<Option<ValueSlot>>,
}

impl CompiledDesign {
    /// Returns the number of input ports.
    pub fn inputs(&self) -> usize {
        self.narrow.inputs.len() + self.wide.inputs.len()
    }

    /// Returns the place of a net.
    ///
    /// # Panics
    /// Panics if the net is unnamed and has none.
    pub(super) fn place(&self, net: NetId) -> ValueSlot {
        let place = self.places[net.index()];
        place.unwrap_or_else(|| panic!("{net:?} is unnamed and not simulated"))
    }
}

/// Returns how much narrower than 64 bits a width is.
pub(super) fn drop_of(width: u32) -> u8 {
    (MAX_WIDTH - width) as u8
}

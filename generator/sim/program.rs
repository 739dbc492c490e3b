//! The simulation program: what a [`Design`] is compiled to.
//!
//! All values live in *slots*, bit patterns masked to their width. A clock has two phases. *Settling*
//! runs the instructions in order; each computes one slot from earlier ones. The *edge* writes the
//! data outputs of synchronous ROMs and then the registers. Nets that are mere wiring (other names,
//! zero extensions, whole slices) share a slot, constants are folded, and equal instructions are
//! merged, so there are fewer instructions than cells. An unnamed net whose only readers can cut it
//! out of its operand themselves has no slot at all.
//!
//! What changes from outside settling, input ports and what the edge writes, is a *source*; so are
//! the fields of the control word, most of which stay as they are from one word to the next.
//! Instructions that depend on the same sources form a segment, and settling skips segments whose
//! sources have not changed.

use anyhow::Result;

use crate::netlist::{Design, NetId};
use crate::sim::compile;

/// The number of a slot.
pub(super) type Slot = u32;

/// A set of sources, one bit each; when there are more than 64, several share a bit.
pub(super) type Sources = u64;

/// One step of settling: `to` from `a`, `b`, ….
///
/// Widths are given as `drop`, 64 less the width: `u64::MAX >> drop` is the mask, and shifting up by
/// `drop` brings the sign bit to the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Instruction {
    /// `a`, as it was before the coming edge.
    Copy { to: Slot, a: Slot },
    /// The bits of `a` from `low` up; when they are news, `source` has changed.
    Field {
        to: Slot,
        a: Slot,
        low: u8,
        drop: u8,
        source: u8,
    },
    /// The bits of `a` from `low` up.
    Slice {
        to: Slot,
        a: Slot,
        low: u8,
        drop: u8,
    },
    /// The bits of `a` from `low` up, shifted up, together with the bits of `base`.
    Place {
        to: Slot,
        base: Slot,
        a: Slot,
        low: u8,
        drop: u8,
        shift: u8,
    },
    /// `a`, whose width is given by `from`, with copies of its sign bit above it.
    SignExtend {
        to: Slot,
        a: Slot,
        from: u8,
        drop: u8,
    },
    /// Bitwise and.
    And { to: Slot, a: Slot, b: Slot },
    /// Bitwise or.
    Or { to: Slot, a: Slot, b: Slot },
    /// Bitwise exclusive or; with a mask, not.
    Xor { to: Slot, a: Slot, b: Slot },
    /// Sum.
    Add {
        to: Slot,
        a: Slot,
        b: Slot,
        drop: u8,
    },
    /// Sum and carry.
    AddCarry {
        to: Slot,
        a: Slot,
        b: Slot,
        carry: Slot,
        drop: u8,
    },
    /// Difference.
    Sub {
        to: Slot,
        a: Slot,
        b: Slot,
        drop: u8,
    },
    /// Product of unsigned factors; it always fits.
    MulUnsigned { to: Slot, a: Slot, b: Slot },
    /// Product of signed factors, whose widths are given by `drop_a` and `drop_b`.
    MulSigned {
        to: Slot,
        a: Slot,
        b: Slot,
        drop_a: u8,
        drop_b: u8,
        drop: u8,
    },
    /// 1 when `a == b`; with a mask, when all bits are 1.
    Equal { to: Slot, a: Slot, b: Slot },
    /// 1 when the bits of `a` from `low` up are not all 0.
    Any {
        to: Slot,
        a: Slot,
        low: u8,
        drop: u8,
    },
    /// 1 when `a < b`, unsigned.
    LessUnsigned { to: Slot, a: Slot, b: Slot },
    /// 1 when `a < b`, signed.
    LessSigned {
        to: Slot,
        a: Slot,
        b: Slot,
        drop: u8,
    },
    /// `a` when `select` is 0, else `b`.
    Choose {
        to: Slot,
        select: Slot,
        a: Slot,
        b: Slot,
    },
    /// The slot that entry `first + select`, at most `last`, of the table of choices names.
    Mux {
        to: Slot,
        select: Slot,
        first: u32,
        last: u32,
    },
    /// Word `address` of a ROM.
    Read {
        to: Slot,
        address: Slot,
        words: Span,
    },
}

/// The contents of a ROM in [`Program::words`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Span {
    pub start: u32,
    pub len: u32,
}

/// Consecutive instructions that depend on the same sources.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub sources: Sources,
    pub len: u32,
}

/// An input port.
#[derive(Clone, Copy, Debug)]
pub(super) struct InputPort {
    pub slot: Slot,
    pub source: Sources,
    pub mask: u64,
}

/// A synchronous ROM: at the edge, `to` takes word `address`.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReadEdge {
    pub to: Slot,
    pub source: Sources,
    pub address: Slot,
    pub words: Span,
}

/// A register: at the edge, `q` takes `reset` when `keep` is 0, else `data` when `enable` is 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct RegisterEdge {
    pub q: Slot,
    pub source: Sources,
    pub data: Slot,
    /// The constant 1 when the register has no enable.
    pub enable: Slot,
    /// The slot of `rst_n`; the constant 1 when the register has no reset.
    pub keep: Slot,
    pub reset: u64,
}

/// A compiled [`Design`]. Machines share it; it holds no state.
#[derive(Debug)]
pub struct Program {
    /// In an order in which each stands after those that compute its operands.
    pub(super) instructions: Vec<Instruction>,
    /// They cover the instructions.
    pub(super) segments: Vec<Segment>,
    /// To be performed before `registers`; no operand of either is written by an earlier one.
    pub(super) reads: Vec<ReadEdge>,
    pub(super) registers: Vec<RegisterEdge>,
    /// The inputs of all muxes that have more than two.
    pub(super) choices: Vec<Slot>,
    /// The contents of all ROMs.
    pub(super) words: Vec<u64>,
    /// What the slots hold at power-up, before settling.
    pub(super) initial: Vec<u64>,
    /// The slot of each net; `Slot::MAX` for unnamed nets that have none.
    pub(super) slots: Vec<Slot>,
    /// In order of declaration.
    pub(super) inputs: Vec<InputPort>,
}

impl Program {
    /// Compiles a design that [`crate::check`] has accepted.
    ///
    /// # Errors
    /// A net, named with the place where it was written, that breaks an invariant of
    /// [`crate::netlist`] on which simulation relies: no driver, a combinational loop, wrong widths.
    pub fn new(design: &Design) -> Result<Self> {
        compile::compile(design)
    }

    /// The number of instructions that settle the design after a clock edge.
    pub fn instructions(&self) -> usize {
        self.instructions.len()
    }

    /// The number of input ports.
    pub fn inputs(&self) -> usize {
        self.inputs.len()
    }

    /// The slot of a net.
    ///
    /// # Panics
    /// When the net is unnamed and has none.
    pub(super) fn slot(&self, net: NetId) -> usize {
        let slot = self.slots[net.index()];
        assert!(slot != Slot::MAX, "{net:?} is unnamed and not simulated");
        slot as usize
    }
}

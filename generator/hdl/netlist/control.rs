//! Holds the control unit of a design: the fields of the control word, the microinstructions and their successors.

use super::{Design, NetId, RegId, RomId};
use glint_base::diagnostic::SourceLocation;

/// The control unit: an address counter, a run flag and a ROM of microinstructions.
///
/// Idle, the address is 0 and `run` is 0. `start` sets `run`; from then on every clock executes the
/// microinstruction at the address and moves on as the microinstruction's [`Sequence`] says.
#[derive(Clone, Debug)]
pub struct Control {
    /// Most significant first, as in the ROM word.
    pub fields: Vec<Field>,
    /// One for each address, from 0.
    pub microprogram: Vec<Microinstruction>,
    /// The control ROM.
    pub rom: RomId,
    /// The counter that addresses it.
    pub address: RegId,
    /// 1 while a program runs.
    pub run: RegId,
    /// Whether `start` is taken in the last clock of a computation too: operands are written into buffers.
    pub overlaps: bool,
}

/// A field of the control word. For example, `rough` has the field `operand_select` of two bits, which chooses among four pairs
/// of factors.
#[derive(Clone, Debug)]
pub struct Field {
    /// The name, which must be a legal Verilog identifier.
    pub name: String,
    /// The net that it drives in the datapath or the sequencer.
    pub net: NetId,
    /// The kind of thing that it controls.
    pub kind: FieldKind,
    /// The numbers of its lines in the source's figure, most significant first, or empty.
    pub lines: Vec<u16>,
}

/// The kind of thing that a field of the control word controls.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// Select lines of muxes; the names of the choices, by value.
    Select(Vec<String>),
    /// The enable of registers.
    Enable,
    /// An output of the device.
    Flag,
    /// Used by the sequencer itself.
    Sequence,
}

/// A microinstruction of the microprogram.
#[derive(Clone, Debug)]
pub struct Microinstruction {
    /// The name of the operation.
    pub name: String,
    /// The value of each field, in the order of [`Control::fields`].
    pub values: Vec<u64>,
    /// The rule for the next microinstruction.
    pub sequence: Sequence,
    /// The place of the microinstruction in the description.
    pub location: SourceLocation,
}

/// The rule that says which microinstruction follows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sequence {
    /// To the next microinstruction.
    Next,
    /// Stays until `start` is high, then to the next microinstruction. The device is not busy here.
    WaitStart,
    /// To microinstruction `to`, back or ahead, while `condition` is 1, else to the next microinstruction.
    LoopWhile {
        /// One bit of the datapath.
        condition: NetId,
        /// The address of that microinstruction.
        to: usize,
    },
    /// To idle: the computation ends.
    End,
}

impl Control {
    /// Makes the control of a pipeline: no microinstruction, and so neither fields nor a sequencer.
    pub fn none() -> Self {
        Self {
            fields: Vec::new(),
            microprogram: Vec::new(),
            rom: RomId(u32::MAX),
            address: RegId(u32::MAX),
            run: RegId(u32::MAX),
            overlaps: false,
        }
    }

    /// Returns the microinstructions that can follow microinstruction `at`, in ascending order. If the last microinstruction
    /// does not end, its successor is the number of microinstructions. An idle device stays in microinstruction 0. For example,
    /// microinstruction 0 has the successors 0 and 1.
    pub fn successors(&self, at: usize) -> Vec<usize> {
        let next = at + 1;
        let mut successors = match self.microprogram[at].sequence {
            Sequence::Next => vec![next],
            Sequence::WaitStart => vec![at, next],
            Sequence::LoopWhile { to, .. } => vec![to.min(next), to.max(next)],
            Sequence::End => vec![0],
        };
        if at == 0 && successors[0] != 0 {
            successors.insert(0, 0);
        }
        successors.dedup();
        successors
    }

    /// Returns the microinstructions from which control comes to microinstruction `at` in `clocks` clocks, in ascending order.
    pub fn predecessors(&self, at: usize, clocks: u32) -> Vec<usize> {
        let leads = |from: usize, after: &[usize]| {
            self.successors(from).iter().any(|to| after.contains(to))
        };
        (0..clocks).fold(vec![at], |after, _| {
            (0..self.microprogram.len()).filter(|&from| leads(from, &after)).collect()
        })
    }
}

impl Design {
    /// Returns the number of the lowest bit of each field in the control word. It is empty for a pipeline, which has no control
    /// word. For example, `rough` has 7 for `operand_select` and 0 for `go_on`.
    pub fn field_positions(&self) -> Vec<u32> {
        if self.control.fields.is_empty() {
            return Vec::new();
        }
        let mut low = self.width(self.rom(self.control.rom).data);
        self.control
            .fields
            .iter()
            .map(|field| {
                low -= self.width(field.net);
                low
            })
            .collect()
    }
}

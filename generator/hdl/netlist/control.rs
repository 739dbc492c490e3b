//! Defines the control unit of a design: the fields of the control word, the microinstructions, and the rules for their order.

use super::{Design, NetId, RegId, RomId};
use glint_base::diagnostic::SourceLocation;

/// The control unit of a device: an address counter, a run flag and a ROM of microinstructions.
///
/// An idle device has the address 0 and the run flag 0. `start` sets the flag. From then on the device executes one
/// microinstruction a clock, and the [`Sequence`] of a microinstruction determines its successor.
#[derive(Clone, Debug)]
pub struct Control {
    /// The fields of the control word, the most significant first.
    pub fields: Vec<Field>,
    /// The microinstructions, in the order of their addresses.
    pub microprogram: Vec<Microinstruction>,
    /// The ROM that stores the control words.
    pub rom: RomId,
    /// The counter that addresses the control ROM.
    pub address: RegId,
    /// The register with the run flag, which is 1 during a computation.
    pub run: RegId,
    /// Whether the device accepts `start` in the last clock of a computation too, because the operand registers have buffers.
    pub overlaps: bool,
}

/// A field of the control word: bits of a microinstruction that control one thing in the device. For example, `rough` has the
/// field `operand_select` of two bits, which chooses among four pairs of factors.
#[derive(Clone, Debug)]
pub struct Field {
    /// The name of this field of the control word, such as `operand_select`. The name must be a legal Verilog identifier.
    pub name: String,
    /// The net that the field drives.
    pub net: NetId,
    /// Whether the field selects inputs of muxes, loads registers, drives an output, or controls the sequencer.
    pub kind: FieldKind,
    /// The numbers of the field's bits (its lines) in the block diagram of the document that describes the device, the most
    /// significant first. The list is empty if the diagram does not show them.
    pub lines: Vec<u16>,
}

/// The purpose of a field of the control word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// The field drives select lines of muxes. The texts are the names of the choices, from the value 0 on.
    Select(Vec<String>),
    /// The field is the load enable of registers.
    Enable,
    /// The field is an output of the device.
    Flag,
    /// The field is a control line of the sequencer itself. For example, `go_on` of `rough` lets the program continue.
    Sequence,
}

/// A microinstruction: the values of all fields of the control word for one clock, and the rule for the next microinstruction.
#[derive(Clone, Debug)]
pub struct Microinstruction {
    /// The name that the device's description gives to the microinstruction.
    pub name: String,
    /// The value of each field, in the order of [`Control::fields`].
    pub values: Vec<u64>,
    /// The rule for the next microinstruction.
    pub sequence: Sequence,
    /// The place of the microinstruction in the Rust source.
    pub location: SourceLocation,
}

/// The rule that determines which microinstruction follows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sequence {
    /// The microinstruction at the next address follows.
    Next,
    /// The same microinstruction follows until `start` is high, and then the next microinstruction follows. The device is not
    /// busy in this microinstruction.
    WaitStart,
    /// Microinstruction `to` follows if `condition` is 1, otherwise the microinstruction at the next address. `to` may be a lower
    /// or the same address (a loop), or a higher address (a jump).
    LoopWhile {
        /// The condition of the jump, a net of one bit in the datapath.
        condition: NetId,
        /// The address of the microinstruction to which control jumps.
        to: usize,
    },
    /// The computation ends, and the device is idle.
    End,
}

impl Control {
    /// Returns the control unit of a pipeline, which has no microinstructions, fields or sequencer. Its identifiers of ROM and
    /// registers are invalid.
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

    /// Returns the addresses of the microinstructions that can follow microinstruction `at`, in ascending order. If the last
    /// microinstruction does not end the computation, its successor is the number of microinstructions. An idle device stays in
    /// microinstruction 0. For example, microinstruction 0 has the successors 0 and 1.
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

    /// Returns the addresses of the microinstructions from which control reaches microinstruction `at` in exactly `clocks`
    /// clocks, in ascending order. With 0 clocks, this is `at` itself.
    pub fn predecessors(&self, at: usize, clocks: u32) -> Vec<usize> {
        let mut after = vec![at];
        for _ in 0..clocks {
            let mut before = Vec::new();
            for from in 0..self.microprogram.len() {
                if self.successors(from).iter().any(|to| after.contains(to)) {
                    before.push(from);
                }
            }
            after = before;
        }
        after
    }
}

impl Design {
    /// Returns the position of the lowest bit of each field in the control word, in the order of the fields. The list is empty
    /// for a pipeline, which has no control word. For example, `rough` has 7 for `operand_select` and 0 for `go_on`.
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

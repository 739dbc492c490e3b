//! Defines the control unit of a design: the fields of the control word, the microinstructions, and the rules for their order.

use super::{Design, NetId, RegId, RomId};
use glint_base::diagnostic::SourceLocation;

/// The control unit of a device: an address counter, a run flag and a ROM of microinstructions.
///
/// An idle device has the address 0 and the run flag 0, which `start` sets. From then on the device executes one
/// microinstruction a clock. The microinstruction's [`Sequence`] determines the next microinstruction.
#[derive(Clone, Debug)]
pub struct Control {
    /// The fields of the control word, the most significant first.
    pub fields: Vec<Field>,
    /// The microinstructions, in the order of their addresses.
    pub microprogram: Vec<Microinstruction>,
    pub rom: RomId,
    /// The ROM with the addresses to which the microprogram dispatches; `None` if it does not dispatch.
    pub dispatch: Option<RomId>,
    /// The counter that addresses the control ROM.
    pub address: RegId,
    /// The run flag, which is 1 during a computation.
    pub run: RegId,
    /// Whether the device accepts `start` in the last clock of a computation too, because the operands have buffers.
    pub overlaps: bool,
}

/// Bits of a microinstruction that control one thing in the device. For example, `rough` has the field `operand_select` of two
/// bits, which chooses among four pairs of factors.
#[derive(Clone, Debug)]
pub struct Field {
    /// A legal Verilog identifier, such as `operand_select`.
    pub name: String,
    pub net: NetId,
    pub kind: FieldKind,
    /// The numbers of the field's bits (its lines) in the source's block diagram, the most significant first. The list is empty
    /// if the diagram does not show them.
    pub lines: Vec<u16>,
}

/// The purpose of a field of the control word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// Select lines of muxes, with the names of the choices from the value 0 on.
    Select(Vec<String>),
    /// The load enable of registers.
    Enable,
    /// An output of the device.
    Flag,
    /// A control line of the sequencer itself: `go_on` of `rough` lets the program continue.
    Sequence,
}

/// A microinstruction: the values of all fields of the control word for one clock, and the rule for the next microinstruction.
#[derive(Clone, Debug)]
pub struct Microinstruction {
    pub name: String,
    /// The values of the fields, in the order of [`Control::fields`].
    pub values: Vec<u64>,
    pub sequence: Sequence,
    pub location: SourceLocation,
}

/// The rule that determines which microinstruction follows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sequence {
    Next,
    /// The same microinstruction is repeated until `start` is high, while the device is not busy. Then the next one follows.
    WaitStart,
    /// Microinstruction `to` follows if `condition` is 1, and otherwise the next one. `to` may be a lower or the same address (a
    /// loop), or a higher one (a jump).
    LoopWhile {
        /// A net of one bit in the datapath.
        condition: NetId,
        to: usize,
    },
    /// The value of an operand register selects the next microinstruction, `to[value]`. All addresses in `to` are higher. For
    /// example, the opcode of a unit selects the microprogram of a function.
    Dispatch {
        /// The output of an operand register, which does not change during a computation.
        selector: NetId,
        /// An address for each value of the selector.
        to: Vec<usize>,
    },
    /// The computation ends, and the device is idle.
    End,
}

impl Control {
    /// Returns a placeholder for a pipeline, which has no control unit: its identifiers of ROM and registers are invalid.
    pub fn none() -> Self {
        Self {
            fields: Vec::new(),
            microprogram: Vec::new(),
            rom: RomId(u32::MAX),
            dispatch: None,
            address: RegId(u32::MAX),
            run: RegId(u32::MAX),
            overlaps: false,
        }
    }

    /// Returns the addresses that can follow address `at`, in ascending order. An idle device stays at address 0, so that 0 is
    /// among the successors of 0. A last microinstruction that does not end the computation has an invalid successor, the number of
    /// microinstructions.
    pub fn successors(&self, at: usize) -> Vec<usize> {
        let next = at + 1;
        let mut successors = match &self.microprogram[at].sequence {
            Sequence::Next => vec![next],
            Sequence::WaitStart => vec![at, next],
            Sequence::LoopWhile { to, .. } => vec![next.min(*to), next.max(*to)],
            Sequence::Dispatch { to, .. } => {
                let mut targets = to.clone();
                targets.sort_unstable();
                targets
            }
            Sequence::End => vec![0],
        };
        if at == 0 && successors[0] != 0 {
            successors.insert(0, 0);
        }
        successors.dedup();
        successors
    }

    /// Returns the addresses from which control reaches microinstruction `at` in exactly `clocks` clocks, in ascending order.
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
    /// Returns the position of the lowest bit of each field in the control word; none for a pipeline. For example, `rough` has 7
    /// for `operand_select` and 0 for `go_on`.
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

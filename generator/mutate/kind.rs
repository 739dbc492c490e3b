//! Kinds of faults.

use std::fmt;

use serde::{Deserialize, Serialize};

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// A bit is always 0.
    StuckAt0,
    /// A bit is always 1.
    StuckAt1,
    /// A bit is inverted.
    Inverted,
    /// A constant is one more or one less.
    Constant,
    /// Two inputs of a mux change places.
    MuxInputs,
    /// A mux takes the same input always.
    MuxChoice,
    /// The limit of a saturation is never taken.
    Saturation,
    /// A carry, or the bit that rounds, is left out or always there.
    Rounding,
    /// The operands of a difference or a comparison change places.
    Operands,
    /// Another operator stands in a cell's place.
    Operator,
    /// The bits beside those that are meant are taken.
    Wiring,
    /// A register takes its data always, or never.
    Enable,
    /// A register is not reset.
    Reset,
    /// A bit of the microprogram is inverted.
    ControlBit,
    /// Two microinstructions change places.
    ControlWords,
    /// A bit of the lower half of a table's word is inverted.
    RomBit,
    /// A bit of the upper half is.
    RomHighBit,
    /// Two words of a table change places.
    RomWords,
}

impl FaultKind {
    /// Every kind, in the order of tables.
    pub const ALL: [Self; 18] = [
        Self::StuckAt0,
        Self::StuckAt1,
        Self::Inverted,
        Self::Constant,
        Self::MuxInputs,
        Self::MuxChoice,
        Self::Saturation,
        Self::Rounding,
        Self::Operands,
        Self::Operator,
        Self::Wiring,
        Self::Enable,
        Self::Reset,
        Self::ControlBit,
        Self::ControlWords,
        Self::RomBit,
        Self::RomHighBit,
        Self::RomWords,
    ];
}

impl fmt::Display for FaultKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Self::StuckAt0 => "bit stuck at 0",
            Self::StuckAt1 => "bit stuck at 1",
            Self::Inverted => "bit inverted",
            Self::Constant => "constant off by one",
            Self::MuxInputs => "mux inputs swapped",
            Self::MuxChoice => "mux choice fixed",
            Self::Saturation => "saturation lost",
            Self::Rounding => "rounding wrong",
            Self::Operands => "operands swapped",
            Self::Operator => "operator wrong",
            Self::Wiring => "wiring wrong",
            Self::Enable => "enable dropped",
            Self::Reset => "reset dropped",
            Self::ControlBit => "control bit inverted",
            Self::ControlWords => "control words swapped",
            Self::RomBit => "ROM bit inverted, lower half",
            Self::RomHighBit => "ROM bit inverted, upper half",
            Self::RomWords => "ROM words swapped",
        })
    }
}

//! Lists the kinds of faults that mutation testing plants in a netlist, and their names in tables.

use std::fmt;

use serde::{Deserialize, Serialize};

macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident = $name:literal,)*) => {
        /// The kind of a planted fault, such as a stuck bit. Tables of mutation tests count the faults by kind.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum FaultKind {
            $($(#[$doc])* $kind,)*
        }

        impl FaultKind {
            /// Every kind of fault, in the order of the tables.
            pub const ALL: &[Self] = &[$(Self::$kind,)*];
        }

        impl fmt::Display for FaultKind {
            fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.pad(match self {
                    $(Self::$kind => $name,)*
                })
            }
        }
    };
}

kinds! {
    /// A bit is always 0.
    StuckAt0 = "bit stuck at 0",
    /// A bit is always 1.
    StuckAt1 = "bit stuck at 1",
    /// A bit is inverted.
    Inverted = "bit inverted",
    /// A constant is one more or one less. For example, 9 becomes 8 or 10.
    Constant = "constant off by one",
    /// Two inputs of a mux change places.
    MuxInputs = "mux inputs swapped",
    /// A mux always passes on the same input.
    MuxChoice = "mux choice fixed",
    /// A saturation's limit is never taken.
    Saturation = "saturation lost",
    /// An adder ignores its carry, or does not add the bit that rounds.
    Rounding = "rounding wrong",
    /// The operands of a difference or a comparison change places.
    Operands = "operands swapped",
    /// The cell has another operator. For example, an AND becomes an OR.
    Operator = "operator wrong",
    /// A slice takes neighbouring bits. For example, bits 1 to 4 in place of bits 2 to 5.
    Wiring = "wiring wrong",
    /// A register always takes its data, or never.
    Enable = "enable dropped",
    /// A register is not reset.
    Reset = "reset dropped",
    /// A bit of the microprogram is inverted.
    ControlBit = "control bit inverted",
    /// Two microinstructions change places.
    ControlWords = "control words swapped",
    /// A bit of the lower half of a table's word is inverted.
    RomBit = "ROM bit inverted, lower half",
    /// A bit of the upper half of a table's word is inverted.
    RomHighBit = "ROM bit inverted, upper half",
    /// Two words of a table change places.
    RomWords = "ROM words swapped",
}

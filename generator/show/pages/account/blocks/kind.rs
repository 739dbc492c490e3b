//! Names the kinds of blocks in a datapath, for example register, ROM, adder and mux.

use std::fmt;

use glint_rtl::netlist::{Driver, Op};

/// A block's kind. As text, for example, `3:1 mux`, `21 × 10 multiplier` or `2 adders, mux`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockKind {
    /// An operand register, which a port writes.
    Operand,
    Register,
    Rom,
    Constant,
    /// Rounding to fewer fraction bits.
    Rounding,
    /// Saturation to a narrower format.
    Limiter,
    /// Rounding followed by saturation.
    RoundingLimiter,
    /// A multiplexer with this number of inputs.
    Mux(usize),
    /// The widths of both operands in bits.
    Multiplier(u32, u32),
    Adder,
    Subtractor,
    Comparator,
    /// Several operators from one statement of the description: the number of each kind in `OPERATORS`.
    Several([u16; 5]),
    /// All bits inverted.
    Inverter,
    /// Logic of single bits other than an inverter.
    Gate,
    /// A rename or a concatenation of bits.
    Wiring,
    Other,
}

/// The names of operators, singular and plural.
pub const OPERATORS: [[&str; 2]; 5] = [
    ["multiplier", "multipliers"],
    ["adder", "adders"],
    ["subtractor", "subtractors"],
    ["comparator", "comparators"],
    ["mux", "muxes"],
];

impl fmt::Display for BlockKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Mux(inputs) => return write!(f, "{inputs}:1 mux"),
            Self::Multiplier(a, b) => return write!(f, "{a} × {b} multiplier"),
            Self::Several(counts) => {
                let parts = counts.iter().zip(OPERATORS).filter(|(count, _)| **count > 0);
                let parts = parts.map(|(&count, [one, several])| match count {
                    1 => one.to_owned(),
                    _ => format!("{count} {several}"),
                });
                return f.write_str(&parts.collect::<Vec<_>>().join(", "));
            }
            Self::Operand => "operand register",
            Self::Register => "register",
            Self::Rom => "ROM",
            Self::Constant => "constant",
            Self::Rounding => "rounding",
            Self::Limiter => "limiter",
            Self::RoundingLimiter => "rounding and limiter",
            Self::Adder => "adder",
            Self::Subtractor => "subtractor",
            Self::Comparator => "comparator",
            Self::Inverter => "inverter",
            Self::Gate => "gate",
            Self::Wiring => "wiring",
            Self::Other => "",
        })
    }
}

pub const MULTIPLIER: usize = 0;
pub const ADDER: usize = 1;
pub const MUX: usize = 4;

/// Returns the index in [`OPERATORS`] of the operator that drives a net, or `None` for any other driver.
pub fn operator(driver: &Driver) -> Option<usize> {
    match driver {
        Driver::Op(Op::Mul(..)) => Some(MULTIPLIER),
        Driver::Op(Op::Add { .. }) => Some(ADDER),
        Driver::Op(Op::Sub(..)) => Some(2),
        Driver::Op(Op::Equal(..) | Op::Less(..)) => Some(3),
        Driver::Op(Op::Mux { .. }) => Some(MUX),
        _ => None,
    }
}

//! What a cell gives when its operands are known.

use crate::base::fixed::{Format, mask};
use crate::hdl::netlist::Op;

/// The bit pattern of the result, of operands in the order of [`Op::operands`].
pub fn evaluate(op: &Op, format: Format, values: &[u64], formats: &[Format]) -> u64 {
    let raw = |at: usize| formats[at].raw(values[at]);
    let bits = match op {
        Op::Relabel(_) => values[0],
        Op::Extend(_) => raw(0) as u64,
        Op::Slice { low, .. } => values[0] >> low,
        Op::Concat(_) => values
            .iter()
            .zip(formats)
            .fold(0, |all: u64, (value, part)| all.checked_shl(part.width()).unwrap_or(0) | value),
        Op::Not(_) => !values[0],
        Op::And(..) => values[0] & values[1],
        Op::Or(..) => values[0] | values[1],
        Op::Xor(..) => values[0] ^ values[1],
        Op::Add { carry, .. } => {
            let carry = if carry.is_some() { values[2] } else { 0 };
            values[0].wrapping_add(values[1]).wrapping_add(carry)
        }
        Op::Sub(..) => values[0].wrapping_sub(values[1]),
        Op::Mul(..) => (raw(0) * raw(1)) as u64,
        Op::Equal(..) => u64::from(values[0] == values[1]),
        Op::Less(..) => u64::from(raw(0) < raw(1)),
        Op::Any(_) => u64::from(values[0] != 0),
        Op::All(_) => u64::from(values[0] == mask(formats[0].width())),
        Op::Mux { inputs, .. } => values[1 + (values[0] as usize).min(inputs.len() - 1)],
    };
    bits & mask(format.width())
}

//! Converts configuration keys to the operands, the register slots and the colour products of highlight devices, such as
//! `blinn` and `schlick`.

use super::Products;
use crate::frame::{Frame, Slot};
use crate::{Operand, contract};
use glint_keys::common::{ColourKeys, Domain, Intensity, Operands};

pub fn products(keys: &ColourKeys, f: &Intensity) -> Products {
    Products::colours(f.format(), keys.bits, f.output_rounding).in_turn(keys.in_turn())
}

/// Returns the control operands `cos_gamma` and `exponent`, in this order.
pub fn operands(keys: &Operands, domain: &Domain) -> Vec<Operand> {
    let one = keys.cosine.one();
    let lowest = if keys.cosine.signed { -one } else { 0 };
    vec![
        contract::cosine_operand(keys.cosine.format(), (lowest, one)),
        contract::exponent_operand(keys.exponent_format(), domain.exponents()),
    ]
}

/// Adds the operands `cos_gamma`, limited to 0 … 1.0, and `exponent` to `frame`. Returns their slots.
pub fn slots(keys: &Operands, frame: &mut Frame) -> [Slot; 2] {
    let cosine = frame.clamped("cos_gamma", keys.cosine.format(), 0, keys.cosine.one());
    [cosine, frame.operand("exponent", keys.exponent_format())]
}

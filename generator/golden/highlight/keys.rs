//! Converts configuration keys to the products, the operands and the register slots of a highlight.
//!
//! Golden models and accuracy contracts of devices with the operands cos γ, n and colours share it.

use super::Products;
use crate::frame::{Frame, Slot};
use crate::{Operand, contract};
use glint_keys::common::{ColourKeys, Domain, Intensity, Operands};

/// Returns the products of f with the colours.
pub fn products(keys: &ColourKeys, f: &Intensity) -> Products {
    Products::colours(f.format(), keys.bits, f.output_rounding).in_turn(keys.in_turn())
}

/// Returns the operands cos γ and n.
pub fn operands(keys: &Operands, domain: &Domain) -> Vec<Operand> {
    let one = keys.cosine.one();
    let lowest = if keys.cosine.signed { -one } else { 0 };
    vec![
        contract::cosine_operand(keys.cosine.format(), (lowest, one)),
        contract::exponent_operand(keys.exponent_format(), domain.exponents()),
    ]
}

/// Returns the slots of the operands cos γ, which is taken for 0 … 1.0, and n.
pub fn slots(keys: &Operands, frame: &mut Frame) -> [Slot; 2] {
    let cosine = frame.clamped("cos_gamma", keys.cosine.format(), 0, keys.cosine.one());
    [cosine, frame.operand("exponent", keys.exponent_format())]
}

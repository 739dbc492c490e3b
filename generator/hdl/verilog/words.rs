//! Writes the words of ROMs as text, in binary or hexadecimal, with comments.

use super::naming::is_control_rom;
use super::text::ascii;
use crate::netlist::{Design, RomId};
use glint_base::fixed::mask;

/// Returns the comment for the word at `address`, if it has one. A word of the control ROM without a comment gets the name of the
/// microinstruction.
pub fn word_note(design: &Design, id: RomId, address: usize) -> Option<String> {
    if let Some(comment) = design.rom(id).comments.get(address) {
        return Some(ascii(comment));
    }
    if !is_control_rom(design, id) {
        return None;
    }
    let executed = design.control.microprogram.get(address)?;
    Some(ascii(&executed.name))
}

/// Writes a word of the control ROM in binary, with `_` between its fields, the first field in front. Word 3 of `rough` is
/// `01_1_0_0_1_0_0_1`.
pub fn in_fields(design: &Design, word: u64) -> String {
    let positions = design.field_positions();
    let digits = design.control.fields.iter().zip(positions).map(|(field, low)| {
        let width = design.width(field.net);
        format!("{:0width$b}", word >> low & mask(width), width = width as usize)
    });
    digits.collect::<Vec<_>>().join("_")
}

/// Writes a word of a ROM in hexadecimal, with as many digits as `width` bits need: 9 for 35 bits.
pub fn in_hex(word: u64, width: u32) -> String {
    format!("{word:0digits$x}", digits = width.div_ceil(4) as usize)
}

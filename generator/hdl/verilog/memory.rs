//! Writes the contents of ROMs as files that the Verilog task `$readmemh` or `$readmemb` reads.

use anyhow::{Result, ensure};

use super::naming::{is_control_rom, rom_label};
use super::text::comment;
use super::words::{in_fields, in_hex, word_note};
use crate::netlist::{Design, RomId};
use glint_base::fixed::mask;

/// Returns the memory file of a ROM: comments, and one line for each word, binary for the control ROM, otherwise hexadecimal.
///
/// # Errors
/// Fails if a word is wider than its ROM, or if the words of the control ROM are not as wide as all fields together.
pub fn contents(design: &Design, id: RomId) -> Result<String> {
    let rom = design.rom(id);
    let width = design.width(rom.data);
    for (address, word) in rom.words.iter().enumerate() {
        ensure!(
            word & !mask(width) == 0,
            "word {address} of ROM `{}`, {word:#x}, is wider than {width} bits",
            rom.name
        );
    }
    let control = is_control_rom(design, id);
    let mut lines = comment(
        0,
        &format!("{}, {}: {} words of {width} bits", design.name, rom_label(rom), rom.words.len()),
    );
    if control {
        lines.extend(fields(design, width)?);
    } else {
        lines.extend(rom.doc.iter().flat_map(|line| comment(0, line)));
    }
    for (address, word) in rom.words.iter().enumerate() {
        let text = if control { in_fields(design, *word) } else { in_hex(*word, width) };
        lines.push(match word_note(design, id, address) {
            Some(note) => format!("{text} // {address} {note}").trim_end().to_owned(),
            None => text,
        });
    }
    Ok(lines.join("\n") + "\n")
}

/// Names the fields in the order of the digits of a control word. Fails if they are not `width` bits wide together.
fn fields(design: &Design, width: u32) -> Result<Vec<String>> {
    let fields = &design.control.fields;
    let total: u32 = fields.iter().map(|field| design.width(field.net)).sum();
    ensure!(
        total == width,
        "the fields of the control word have {total} bits, the control ROM {width}"
    );
    let mut names = Vec::new();
    for field in fields {
        names.push(match &field.lines[..] {
            [] => field.name.clone(),
            [line] => format!("{} (line {line})", field.name),
            lines => {
                let lines: Vec<_> = lines.iter().map(ToString::to_string).collect();
                format!("{} (lines {})", field.name, lines.join(" "))
            }
        });
    }
    Ok(comment(0, &format!("Fields from the left: {}", names.join(", "))))
}

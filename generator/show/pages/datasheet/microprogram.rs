//! Makes the datasheet's table of the microprogram in the form of the patents: a row for each microinstruction, and a column for
//! each control line.

use crate::pages::account;
use crate::pages::markup::html;
use glint_rtl::netlist::{Design, FieldKind};

pub struct Microprogram {
    /// Whether the source's figure has numbers for the control lines.
    pub numbered: bool,
    /// The fields, from the highest bits to the lowest.
    pub fields: Vec<FieldView>,
    /// The microinstructions, from address 0.
    pub rows: Vec<MicroinstructionRow>,
}

pub struct FieldView {
    pub name: String,
    /// A label for each control line: its number in the source's figure. If the figure numbers no line of any field, it is the
    /// bit in the control word. If the figure numbers only other fields, it is `–`.
    pub lines: Vec<String>,
}

pub struct MicroinstructionRow {
    pub address: usize,
    pub name: String,
    /// For each line: whether a field begins here, whether it is 1, and the meaning of the field's value. For example, the
    /// value 2 of a field of two bits has a line with `(true, true, …)` and a line with `(false, false, …)`.
    pub bits: Vec<(bool, bool, String)>,
    /// The next microinstruction, as HTML.
    pub then: String,
}

impl Microprogram {
    pub fn new(design: &Design) -> Self {
        let control = &design.control;
        let numbered = control.fields.iter().any(|field| !field.lines.is_empty());
        let positions = design.field_positions();
        let mut fields = Vec::new();
        for (field, low) in control.fields.iter().zip(positions) {
            let width = design.width(field.net);
            let lines = match (&field.lines[..], numbered) {
                ([], true) => vec!["–".to_owned(); width as usize],
                ([], false) => (low..low + width).rev().map(|bit| bit.to_string()).collect(),
                (lines, _) => lines.iter().map(u16::to_string).collect(),
            };
            fields.push(FieldView { name: field.name.clone(), lines });
        }
        let mut rows = Vec::new();
        let page_rows = account::microprogram(design).rows;
        for (address, page_row) in page_rows.into_iter().enumerate() {
            let microinstruction = &control.microprogram[address];
            // The last column of the page's table is "then", the microinstruction that follows.
            let then = page_row.last().map_or("", String::as_str);
            rows.push(MicroinstructionRow {
                address,
                name: microinstruction.name.clone(),
                bits: bits(design, &microinstruction.values),
                then: html(then),
            });
        }
        Self { numbered, fields, rows }
    }
}

/// Returns [`MicroinstructionRow::bits`] for the `values` of the fields.
fn bits(design: &Design, values: &[u64]) -> Vec<(bool, bool, String)> {
    let mut bits = Vec::new();
    for (field, &value) in design.control.fields.iter().zip(values) {
        let width = design.width(field.net);
        let meaning = match &field.kind {
            FieldKind::Select(choices) => {
                let choice = choices.get(value as usize).map_or("", String::as_str);
                format!("{}: {choice}", field.name)
            }
            _ => format!("{}: {value}", field.name),
        };
        for bit in (0..width).rev() {
            bits.push((bit + 1 == width, value >> bit & 1 == 1, meaning.clone()));
        }
    }
    bits
}

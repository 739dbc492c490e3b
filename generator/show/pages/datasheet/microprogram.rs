//! Tabulates the microprogram as the patents do: a row for each microinstruction, a column for each control line.

use crate::pages::account;
use crate::pages::markup::html;
use glint_rtl::netlist::{Design, FieldKind};

/// The table of microinstructions and lines.
pub struct Microprogram {
    /// Whether the source numbers any line.
    pub numbered: bool,
    /// The fields of the control word, from the top bits.
    pub fields: Vec<FieldView>,
    /// The microinstructions, from address 0.
    pub rows: Vec<MicroinstructionRow>,
}

/// A field.
pub struct FieldView {
    /// Its name.
    pub name: String,
    /// For each of its lines the number in the source's figure, or else the bit of the control word.
    pub lines: Vec<String>,
}

/// A microinstruction.
pub struct MicroinstructionRow {
    /// Its number.
    pub address: usize,
    /// The name of the operation.
    pub name: String,
    /// For each line: whether a field begins here, whether it is 1, and the meaning of the field's value. For example,
    /// the value 2 of a field of two bits has a line with `(true, true, …)` and a line with `(false, false, …)`.
    pub bits: Vec<(bool, bool, String)>,
    /// The successor, as HTML.
    pub then: String,
}

impl Microprogram {
    /// Tabulates the microprogram of a design.
    pub fn new(design: &Design) -> Self {
        let control = &design.control;
        let numbered = control.fields.iter().any(|field| !field.lines.is_empty());
        let positions = design.field_positions();
        let fields = control.fields.iter().zip(positions).map(|(field, low)| {
            let width = design.width(field.net);
            FieldView {
                name: field.name.clone(),
                lines: match (&field.lines[..], numbered) {
                    ([], true) => vec!["–".to_owned(); width as usize],
                    ([], false) => (low..low + width).rev().map(|bit| bit.to_string()).collect(),
                    (lines, _) => lines.iter().map(u16::to_string).collect(),
                },
            }
        });
        // The column "then" of the page's table is the last.
        let then = account::microprogram(design).rows.into_iter().map(|mut row| row.pop());
        let microprogram = control.microprogram.iter().zip(then).enumerate();
        Self {
            numbered,
            fields: fields.collect(),
            rows: microprogram
                .map(|(address, (it, then))| MicroinstructionRow {
                    address,
                    name: it.name.clone(),
                    bits: bits(design, &it.values),
                    then: html(&then.unwrap_or_default()),
                })
                .collect(),
        }
    }
}

fn bits(design: &Design, values: &[u64]) -> Vec<(bool, bool, String)> {
    let fields = design.control.fields.iter().zip(values);
    fields
        .flat_map(|(field, &value)| {
            let width = design.width(field.net);
            let meaning = match &field.kind {
                FieldKind::Select(choices) => {
                    let choice = choices.get(value as usize).map_or("", String::as_str);
                    format!("{}: {choice}", field.name)
                }
                _ => format!("{}: {value}", field.name),
            };
            (0..width)
                .rev()
                .map(move |bit| (bit + 1 == width, value >> bit & 1 == 1, meaning.clone()))
        })
        .collect()
}

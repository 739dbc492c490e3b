//! Converts tables of plain text to the HTML tables of a datasheet. On a phone, a wide table has the cells of a row below each
//! other.

use crate::pages::account::{Align, TextTable};
use crate::pages::markup::html;

/// The width of a phone in characters. On a phone, a wider table shows the cells of a row below each other.
const NARROW: usize = 36;

pub struct TableView {
    /// A description for screen readers.
    pub label: &'static str,
    /// Whether a phone shows the cells of a row below each other, for example because a cell has a sentence.
    pub stacks: bool,
    /// The class and each column's heading.
    pub columns: Vec<(&'static str, String)>,
    pub rows: Vec<Vec<CellView>>,
}

pub struct CellView {
    /// The class in the style sheet.
    pub class: &'static str,
    /// The heading of the cell's column, for a phone, where the table has no columns.
    pub label: String,
    /// The contents as HTML.
    pub text: String,
}

impl TableView {
    pub fn new(label: &'static str, table: &TextTable) -> Self {
        let class = |align| match align {
            Align::Left => "",
            Align::Right => "number",
        };
        let columns = table.columns.iter();
        let widest = |at: usize| {
            let cells = table.rows.iter().map(|row| row[at].chars().count());
            cells.max().unwrap_or(0) + 2
        };
        Self {
            label,
            stacks: (0..table.columns.len()).map(widest).sum::<usize>() > NARROW,
            columns: columns
                .clone()
                .map(|column| (class(column.align), html(&column.heading)))
                .collect(),
            rows: table
                .rows
                .iter()
                .map(|row| {
                    let cells = row.iter().zip(columns.clone());
                    let cells = cells.map(|(cell, column)| CellView {
                        class: class(column.align),
                        label: column.heading.replace('`', ""),
                        text: html(cell),
                    });
                    cells.collect()
                })
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wider_than_a_phone_stacks() {
        let mut table = TextTable::of("`key` | units:");
        table.row(["`a`", "1.5"].map(str::to_owned));
        assert!(!TableView::new("narrow", &table).stacks);
        table.row(["`b`", "a sentence of more than thirty signs"].map(str::to_owned));
        let view = TableView::new("wide", &table);
        assert!(view.stacks);
        let cell = &view.rows[1][1];
        assert_eq!((cell.class, cell.label.as_str()), ("number", "units"));
        assert_eq!(view.columns[0].1, "<code>key</code>");
        assert_eq!(view.rows[1][0].label, "key");
    }
}

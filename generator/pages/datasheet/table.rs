//! Tables and sentences as HTML.

use crate::pages::account::{Align, Table};

/// A table as the page prints it.
pub struct TableView {
    /// What a screen reader says of it.
    pub label: &'static str,
    /// Class and heading of each column.
    pub columns: Vec<(&'static str, String)>,
    /// Class and contents of each cell.
    pub rows: Vec<Vec<(&'static str, String)>>,
}

impl TableView {
    /// A table of plain text with names in backquotes.
    pub fn new(label: &'static str, table: &Table) -> Self {
        let class = |align| match align {
            Align::Left => "",
            Align::Right => "number",
        };
        let classes: Vec<_> = table.columns.iter().map(|column| class(column.align)).collect();
        Self {
            label,
            columns: table
                .columns
                .iter()
                .zip(&classes)
                .map(|(column, &class)| (class, html(&column.heading)))
                .collect(),
            rows: table
                .rows
                .iter()
                .map(|row| {
                    let cells = row.iter().zip(&classes);
                    cells.map(|(cell, &class)| (class, html(cell))).collect()
                })
                .collect(),
        }
    }
}

/// Plain text with names in backquotes as HTML.
pub fn html(text: &str) -> String {
    let mut html = String::with_capacity(text.len());
    // An odd backquote is one.
    let names = text.matches('`').count() / 2;
    let mut quotes = 0;
    for sign in text.chars() {
        match sign {
            '`' if quotes < 2 * names => {
                html += if quotes % 2 == 0 { "<code>" } else { "</code>" };
                quotes += 1;
            }
            '&' => html += "&amp;",
            '<' => html += "&lt;",
            '>' => html += "&gt;",
            '"' => html += "&quot;",
            _ => html.push(sign),
        }
    }
    html
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_code_and_signs_are_signs() {
        assert_eq!(html("`a<b` & c > `d`"), "<code>a&lt;b</code> &amp; c &gt; <code>d</code>");
        assert_eq!(html("one ` alone"), "one ` alone");
    }
}

//! Writes tables in Markdown, and escapes characters in text that Markdown would interpret.

use crate::pages::account::{Align, TextTable};

/// Returns a table without the last newline. All columns except the last are padded, so the source text is readable.
pub fn table(table: &TextTable) -> String {
    let headings: Vec<String> = table.columns.iter().map(|column| prose(&column.heading)).collect();
    let mut rows: Vec<Vec<String>> = Vec::new();
    for row in &table.rows {
        rows.push(row.iter().map(|cell| prose(cell)).collect());
    }
    let mut widths: Vec<usize> = Vec::new();
    for (at, heading) in headings.iter().enumerate() {
        let mut width = 3;
        if at + 1 < headings.len() {
            width = width.max(heading.chars().count());
            for row in &rows {
                width = width.max(row[at].chars().count());
            }
        }
        widths.push(width);
    }
    let mut rule: Vec<String> = Vec::new();
    for (column, &width) in table.columns.iter().zip(&widths) {
        rule.push(match column.align {
            Align::Left => "-".repeat(width),
            Align::Right => "-".repeat(width - 1) + ":",
        });
    }
    let mut lines = vec![line(table, &widths, &headings), line(table, &widths, &rule)];
    for row in &rows {
        lines.push(line(table, &widths, row));
    }
    lines.join("\n")
}

fn line(table: &TextTable, widths: &[usize], cells: &[String]) -> String {
    let mut padded: Vec<String> = Vec::new();
    for ((cell, column), &width) in cells.iter().zip(&table.columns).zip(widths) {
        padded.push(match column.align {
            Align::Left => format!("{cell:width$}"),
            Align::Right => format!("{cell:>width$}"),
        });
    }
    format!("| {} |", padded.join(" | "))
}

/// Escapes `|`, `*`, `[`, `\` and, where Markdown would interpret them, `_` and `<`. Inside backquotes, it escapes only `|`,
/// which would end the cell of a table. For example, `a*b` outside of backquotes becomes `a\*b`.
pub fn prose(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut name = false;
    let mut before = ' ';
    let mut signs = text.chars().peekable();
    while let Some(sign) = signs.next() {
        let after = signs.peek().copied().unwrap_or(' ');
        name ^= sign == '`';
        let markup = match sign {
            '|' => true,
            '*' | '[' | '\\' => !name,
            // Markdown does not interpret `_` between letters or digits.
            '_' => !(name || before.is_alphanumeric() && after.is_alphanumeric()),
            '<' => !name && (after.is_ascii_alphabetic() || matches!(after, '/' | '!' | '?')),
            _ => false,
        };
        if markup {
            plain.push('\\');
        }
        plain.push(sign);
        before = sign;
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_padded_and_aligned() {
        let mut table = TextTable::of("name | bits: | what");
        table.row(["`a`", "10", "short"].map(str::to_owned));
        table.row(["`bcdef`", "7", "this is longer"].map(str::to_owned));
        let expected = "\
| name    | bits | what |
| ------- | ---: | --- |
| `a`     |   10 | short |
| `bcdef` |    7 | this is longer |";
        assert_eq!(super::table(&table), expected);
    }

    #[test]
    fn markdown_leaves_formulas_alone() {
        assert_eq!(prose("a*b <- c|d `_x|*` k_s _a <b>"), "a\\*b <- c\\|d `_x\\|*` k_s \\_a \\<b>");
        assert_eq!(prose("`a|b`"), "`a\\|b`");
    }
}

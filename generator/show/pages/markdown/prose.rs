//! Writes tables in Markdown, and escapes text that Markdown would take for something else.

use crate::pages::account::{Align, TextTable};

/// Returns the lines of a table, without the last newline. Its columns are padded, so that it reads well as text too; the last
/// one is not.
pub fn table(table: &TextTable) -> String {
    let headings: Vec<String> = table.columns.iter().map(|column| prose(&column.heading)).collect();
    let rows: Vec<Vec<String>> =
        table.rows.iter().map(|row| row.iter().map(|cell| prose(cell)).collect()).collect();
    let width = |at: usize| {
        let cells = rows.iter().map(|row| row[at].chars().count());
        cells.fold(headings[at].chars().count().max(3), usize::max)
    };
    let last = table.columns.len() - 1;
    let widths: Vec<usize> = (0..=last).map(|at| if at == last { 3 } else { width(at) }).collect();
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells
            .iter()
            .zip(table.columns.iter().zip(&widths))
            .map(|(cell, (column, &width))| match column.align {
                Align::Left => format!("{cell:width$}"),
                Align::Right => format!("{cell:>width$}"),
            })
            .collect();
        format!("| {} |", cells.join(" | "))
    };
    let rule: Vec<String> = table
        .columns
        .iter()
        .zip(&widths)
        .map(|(column, &width)| match column.align {
            Align::Left => "-".repeat(width),
            Align::Right => "-".repeat(width - 1) + ":",
        })
        .collect();
    let mut lines = vec![line(&headings), line(&rule)];
    lines.extend(rows.iter().map(|row| line(row)));
    lines.join("\n")
}

/// Escapes prose so that no sign is Markdown's, except names in backquotes. For example, `a*b` outside of backquotes
/// becomes `a\*b`.
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
            // Between letters it means nothing.
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

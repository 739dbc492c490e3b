//! Markdown: tables, and text that Markdown would take for something else.

/// Where a column's cells stand.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// A table. Its columns are padded, so that it reads well as text too; the last one is not.
pub struct Table {
    columns: Vec<(String, Align)>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table of these columns.
    pub fn new(columns: &[(&str, Align)]) -> Self {
        Self {
            columns: columns
                .iter()
                .map(|&(heading, align)| (heading.to_owned(), align))
                .collect(),
            rows: Vec::new(),
        }
    }

    /// One row more, with a cell for each column.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Leaves out a column in which no row says anything.
    pub fn without_empty(mut self, heading: &str) -> Self {
        let at = self.columns.iter().position(|column| column.0 == heading);
        if let Some(at) = at
            && self.rows.iter().all(|row| row[at].is_empty())
        {
            self.columns.remove(at);
            for row in &mut self.rows {
                row.remove(at);
            }
        }
        self
    }

    /// The lines, without the last newline.
    pub fn text(&self) -> String {
        let width = |at: usize| {
            let cells = self.rows.iter().map(|row| row[at].chars().count());
            let heading = self.columns[at].0.chars().count();
            cells.fold(heading.max(3), usize::max)
        };
        let last = self.columns.len() - 1;
        let widths: Vec<usize> = (0..=last)
            .map(|at| if at == last { 3 } else { width(at) })
            .collect();
        let line = |cells: &mut dyn Iterator<Item = &str>| {
            let cells: Vec<String> = cells
                .zip(self.columns.iter().zip(&widths))
                .map(|(cell, ((_, align), &width))| match align {
                    Align::Left => format!("{cell:width$}"),
                    Align::Right => format!("{cell:>width$}"),
                })
                .collect();
            format!("| {} |", cells.join(" | "))
        };
        let rule: Vec<String> = self
            .columns
            .iter()
            .zip(&widths)
            .map(|((_, align), &width)| match align {
                Align::Left => "-".repeat(width),
                Align::Right => "-".repeat(width - 1) + ":",
            })
            .collect();
        let mut lines = vec![
            line(&mut self.columns.iter().map(|column| column.0.as_str())),
            line(&mut rule.iter().map(String::as_str)),
        ];
        for row in &self.rows {
            lines.push(line(&mut row.iter().map(String::as_str)));
        }
        lines.join("\n")
    }
}

/// A name or a number as the files write it; nothing for nothing.
pub fn code(text: &str) -> String {
    if text.is_empty() {
        return String::new();
    }
    format!("`{}`", text.replace('|', "\\|"))
}

/// Prose in which no sign is Markdown's, but for names in backquotes.
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
        let mut table = Table::new(&[
            ("name", Align::Left),
            ("bits", Align::Right),
            ("what", Align::Left),
        ]);
        table.row(["`a`", "10", "short"].map(str::to_owned));
        table.row(["`bcdef`", "7", "this is longer"].map(str::to_owned));
        let expected = "\
| name    | bits | what |
| ------- | ---: | --- |
| `a`     |   10 | short |
| `bcdef` |    7 | this is longer |";
        assert_eq!(table.text(), expected);
    }

    #[test]
    fn an_empty_column_goes() {
        let mut table = Table::new(&[("no.", Align::Right), ("name", Align::Left)]);
        table.row([String::new(), "a".to_owned()]);
        assert_eq!(
            table.without_empty("no.").text(),
            "| name |\n| --- |\n| a   |"
        );
    }

    #[test]
    fn markdown_leaves_formulas_alone() {
        assert_eq!(
            prose("a*b <- c|d `_x|*` k_s _a <b>"),
            "a\\*b <- c\\|d `_x\\|*` k_s \\_a \\<b>"
        );
        assert_eq!(code("a|b"), "`a\\|b`");
    }
}

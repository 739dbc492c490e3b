//! Defines a table of plain text with headings and column alignment, which pages print as Markdown or HTML.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Words are aligned to the left.
    Left,
    /// Numbers are aligned to the right.
    Right,
}

#[derive(Clone, Debug)]
pub struct Column {
    pub heading: String,
    pub align: Align,
}

#[derive(Clone, Debug)]
pub struct TextTable {
    pub columns: Vec<Column>,
    /// The rows from top to bottom, each with a cell for each column.
    pub rows: Vec<Vec<String>>,
}

impl TextTable {
    /// Makes a table without rows from its headings, separated by ` | `. A heading with a colon at its end belongs to a column
    /// of numbers. For example, `port | bits:` has a column of words and a column of numbers.
    pub fn of(headings: &str) -> Self {
        let column = |heading: &'_ str| match heading.strip_suffix(':') {
            Some(heading) => Column { heading: heading.to_owned(), align: Align::Right },
            None => Column { heading: heading.to_owned(), align: Align::Left },
        };
        Self { columns: headings.split(" | ").map(column).collect(), rows: Vec::new() }
    }

    /// Adds a row, which must have a cell for each column.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Leaves out the column `heading` if all of its cells are empty. For example, a device without numbers in a figure has no
    /// column "no.".
    #[must_use]
    pub fn without_empty(mut self, heading: &str) -> Self {
        let at = self.columns.iter().position(|column| column.heading == heading);
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
}

/// Puts `text` between backquotes. An empty text stays empty.
pub fn code(text: &str) -> String {
    match text {
        "" => String::new(),
        _ => format!("`{text}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_column_goes() {
        let mut table = TextTable::of("no.: | name");
        table.row([String::new(), code("a")]);
        let table = table.without_empty("no.");
        assert_eq!(table.columns.len(), 1);
        assert_eq!(table.rows, [["`a`"]]);
    }
}

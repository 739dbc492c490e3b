//! A table of text, with headings and alignment, for pages of any format.

/// The alignment of the cells of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// A column of a table.
#[derive(Clone, Debug)]
pub struct Column {
    /// The text of the column's head.
    pub heading: String,
    /// The alignment of the column.
    pub align: Align,
}

/// A table; its cells are plain text with names in backquotes.
#[derive(Clone, Debug)]
pub struct TextTable {
    /// From the left.
    pub columns: Vec<Column>,
    /// From the top, with a cell for each column.
    pub rows: Vec<Vec<String>>,
}

impl TextTable {
    /// Makes a table with these headings, which bars part, yet without rows. The cells below a heading with a colon
    /// behind it are numbers. For example, `port | bits:` has a column of words and a column of numbers.
    pub fn of(headings: &str) -> Self {
        let column = |heading: &'_ str| match heading.strip_suffix(':') {
            Some(heading) => Column { heading: heading.to_owned(), align: Align::Right },
            None => Column { heading: heading.to_owned(), align: Align::Left },
        };
        Self { columns: headings.split(" | ").map(column).collect(), rows: Vec::new() }
    }

    /// Adds one row, which must have a cell for each column.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Leaves out the column `heading` if all of its cells are empty. For example, a device without numbers in a figure
    /// has no column "no.".
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

/// Returns a name or a number as the files write it; nothing for nothing. For example, clk becomes `clk` in backquotes.
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

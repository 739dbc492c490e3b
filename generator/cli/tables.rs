//! Tables for people, JSON for scripts.

use std::io::{self, ErrorKind, Write};
use std::sync::OnceLock;

use anyhow::{Result, bail};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};
use serde_json::Value;

/// Prints rows under headings; columns named in `right` are aligned to the right.
pub fn print(headings: &[&str], right: &[&str], rows: impl IntoIterator<Item = Vec<String>>) {
    let mut table = Table::new();
    table
        .load_style(presets::ASCII_MARKDOWN)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_header(headings);
    for row in rows {
        table.add_row(row);
    }
    for (at, heading) in headings.iter().enumerate() {
        if right.contains(heading)
            && let Some(column) = table.column_mut(at)
        {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    print_line(&table.to_string());
}

/// Prints a JSON value, indented.
pub fn print_json(value: &Value) {
    print_line(&format!("{value:#}"));
}

/// The first failure to write standard output.
static FAILURE: OnceLock<io::Error> = OnceLock::new();

/// Prints a line. A failure is kept for [`finish`]; a reader that went away is none.
pub fn print_line(line: &str) {
    if let Err(error) = writeln!(io::stdout().lock(), "{line}")
        && error.kind() != ErrorKind::BrokenPipe
    {
        let _ = FAILURE.set(error);
    }
}

/// Whether everything that was printed was written.
///
/// # Errors
/// Standard output cannot be written, as on a full disk.
pub fn finish() -> Result<()> {
    match FAILURE.get() {
        Some(error) => bail!("cannot write standard output: {error}"),
        None => Ok(()),
    }
}

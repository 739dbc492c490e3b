//! Reads the rows of a CSV file. An error message has the number of the wrong line.

use std::io;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail, ensure};
use csv::{ReaderBuilder, StringRecord, Trim};

use glint_base::input;

/// Reads a CSV file, or standard input if the path is `-`. `columns` interprets the headings, and `of_row` converts a row.
/// Returns the converted rows in the file's order.
///
/// # Errors
/// Fails if the file cannot be read, has a quote that is not closed, or has no row below the headings. Fails if `columns` or
/// `of_row` fails; the error then names the first row or the row's line.
pub fn read<C, T>(
    path: &Path,
    columns: impl FnOnce(&StringRecord) -> Result<C>,
    mut of_row: impl FnMut(&C, &StringRecord) -> Result<T, String>,
) -> Result<Vec<T>> {
    let shown = path.display();
    let cannot = || format!("cannot read `{shown}`");
    let file = input::open(path).with_context(cannot)?;
    let text = io::read_to_string(file).with_context(cannot)?;
    // The CSV reader takes a quote that is never closed as the beginning of a field with the rest of the file.
    if text.matches('"').count() % 2 == 1
        && let Some(last) = text.rfind('"')
    {
        bail!(
            "`{shown}`, line {}: a quote is not closed; close it, or remove it",
            line(&text, last)
        );
    }
    let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(text.as_bytes());
    let headings = reader.headers().with_context(cannot)?;
    let columns = columns(headings).with_context(|| format!("`{shown}`, first row"))?;
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.with_context(cannot)?;
        let row = of_row(&columns, &record).map_err(|why| {
            let start = record.position().map_or(0, |it| it.byte() as usize);
            anyhow!("`{shown}`, line {}: {why}", line(&text, start))
        });
        rows.push(row?);
    }
    ensure!(
        !rows.is_empty(),
        "`{shown}` has no row of values below the row with the names; add a row"
    );
    Ok(rows)
}

/// Returns the line number of a record that begins at byte `start`, counted from 1. Empty lines before the record are skipped.
fn line(text: &str, start: usize) -> usize {
    let record = text[start..].trim_start_matches(['\r', '\n']);
    1 + text[..text.len() - record.len()].matches('\n').count()
}

//! Prints tables as text for people, and as JSON and CSV for scripts.

use std::io::{self, ErrorKind, Write};
use std::sync::OnceLock;

use anyhow::{Result, bail};
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Table, Width, presets};
use serde_json::Value;

/// The number of characters around the text of a cell: two blanks and a bar.
const FRAME: usize = 3;

#[derive(Clone, Copy)]
struct TerminalColumn<'a> {
    heading: &'a str,
    /// Whether the column has numbers, which are aligned to the right and never broken into lines.
    number: bool,
    /// The order in which columns are left out of a table that is too wide, the largest number first. A column with 0 always
    /// stays.
    dispensable: u8,
}

impl<'a> TerminalColumn<'a> {
    /// Parses `headings`, which are separated by bars. For example, `device | points:2` is a column of words and a column of
    /// numbers.
    fn all(headings: &'a str) -> Vec<Self> {
        let mut columns = Vec::new();
        for marked in headings.split(" | ") {
            let (heading, order) = marked.split_once([':', ';']).unwrap_or((marked, ""));
            columns.push(Self {
                heading,
                number: marked.contains(':'),
                dispensable: order.parse().unwrap_or(0),
            });
        }
        columns
    }
}

/// Prints rows no wider than the terminal. `headings` has the form `device | points: | clocks:2 | remark;1`. A colon marks a
/// column of numbers. A digit marks a column that may be left out of a table that is too wide, the largest digit first. If the
/// table is still too wide, a row's cells are printed below each other.
pub fn print(headings: &str, rows: impl IntoIterator<Item = Vec<String>>) {
    let rows: Vec<Vec<String>> = rows.into_iter().collect();
    print_line(&text(&TerminalColumn::all(headings), &rows, width()));
}

/// Returns the largest width of a line in characters: the environment variable `COLUMNS`, or else the terminal's width. Returns
/// `None`, for any width, if neither is known.
fn width() -> Option<usize> {
    let width = match std::env::var("COLUMNS").unwrap_or_default().parse() {
        Ok(width) => width,
        Err(_) => {
            let (_, columns) = console::Term::stdout().size_checked()?;
            usize::from(columns)
        }
    };
    if width > 0 { Some(width) } else { None }
}

fn text(columns: &[TerminalColumn<'_>], rows: &[Vec<String>], room: Option<usize>) -> String {
    let mut shown: Vec<usize> = (0..columns.len()).collect();
    loop {
        if let Some(widths) = fit(columns, rows, &shown, room) {
            let mut text = drawn(columns, rows, &shown, &widths);
            let mut gone: Vec<&str> = Vec::new();
            for (at, column) in columns.iter().enumerate() {
                if !shown.contains(&at) {
                    gone.push(column.heading);
                }
            }
            gone.dedup();
            if !gone.is_empty() {
                let note = format!(
                    "(the line has no room for {}; --json shows all columns)",
                    gone.join(", ")
                );
                text = format!("{text}\n{}", folded(&note, room));
            }
            return text;
        }
        match (0..shown.len()).max_by_key(|&at| columns[shown[at]].dispensable) {
            Some(at) if columns[shown[at]].dispensable > 0 => drop(shown.remove(at)),
            _ => return stacked(columns, rows, room),
        }
    }
}

/// Returns the widths of the columns `shown` in a table of at most `room` characters a line. Returns `None` if a number or a word
/// would have to be broken.
fn fit(
    columns: &[TerminalColumn<'_>],
    rows: &[Vec<String>],
    shown: &[usize],
    room: Option<usize>,
) -> Option<Vec<usize>> {
    let mut least: Vec<usize> = Vec::new();
    let mut widths: Vec<usize> = Vec::new();
    for &at in shown {
        let column = &columns[at];
        let mut widest = 0;
        let mut unbroken = longest_word(column.heading);
        for row in rows {
            let cell = &row[at];
            widest = widest.max(length(cell));
            unbroken = unbroken.max(if column.number { length(cell) } else { longest_word(cell) });
        }
        least.push(unbroken);
        widths.push(widest.max(length(column.heading)));
    }
    let Some(room) = room else {
        return Some(widths);
    };
    let frame = FRAME * shown.len() + 1;
    if least.iter().sum::<usize>() + frame > room {
        return None;
    }
    // The column that can shrink most shrinks first.
    while widths.iter().sum::<usize>() + frame > room {
        let at = (0..widths.len()).max_by_key(|&at| widths[at] - least[at])?;
        widths[at] -= 1;
    }
    Some(widths)
}

fn length(text: &str) -> usize {
    console::measure_text_width(text)
}

fn longest_word(text: &str) -> usize {
    text.split(' ').map(length).max().unwrap_or(0)
}

fn drawn(
    columns: &[TerminalColumn<'_>],
    rows: &[Vec<String>],
    shown: &[usize],
    widths: &[usize],
) -> String {
    let mut table = Table::new();
    table
        .load_style(presets::ASCII_MARKDOWN)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(u16::MAX)
        .set_header(shown.iter().map(|&at| columns[at].heading));
    for row in rows {
        table.add_row(shown.iter().map(|&at| &row[at]));
    }
    for ((place, &at), &width) in shown.iter().enumerate().zip(widths) {
        let Some(column) = table.column_mut(place) else {
            continue;
        };
        let width = u16::try_from(width + FRAME - 1).unwrap_or(u16::MAX);
        column.set_constraint(ColumnConstraint::Absolute(Width::Fixed(width)));
        if columns[at].number {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table.to_string()
}

/// Lays out a table for a narrow terminal. Each row becomes its first cell, followed by one line with heading and text for each
/// further cell. Lines are broken at `room` characters, or not at all without `room`.
fn stacked(columns: &[TerminalColumn<'_>], rows: &[Vec<String>], room: Option<usize>) -> String {
    let mut lines = Vec::new();
    for row in rows {
        lines.push(format!("{}:", row[0]));
        for (column, cell) in columns.iter().zip(row).skip(1) {
            lines.push(folded(&format!("  {}: {cell}", column.heading), room));
        }
    }
    lines.join("\n")
}

/// Breaks a line between words if it is wider than `room` characters. The second and later parts are indented.
fn folded(line: &str, room: Option<usize>) -> String {
    let Some(room) = room else {
        return line.to_owned();
    };
    let indent = line.len() - line.trim_start().len() + 2;
    let mut text = String::new();
    let mut at = 0;
    for (number, word) in line.split(' ').enumerate() {
        if number > 0 && at + 1 + length(word) > room && at > indent {
            text += &format!("\n{}{word}", " ".repeat(indent));
            at = indent + length(word);
            continue;
        }
        if number > 0 {
            text.push(' ');
            at += 1;
        }
        text += word;
        at += length(word);
    }
    text
}

pub fn print_json(value: &Value) {
    print_line(&format!("{value:#}"));
}

/// Prints CSV by RFC 4180.
///
/// # Errors
/// Fails if a row has more or fewer fields than the first row.
pub fn print_csv(rows: impl IntoIterator<Item = Vec<String>>) -> Result<()> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    for row in rows {
        csv.write_record(row)?;
    }
    print_line(String::from_utf8_lossy(&csv.into_inner()?).trim_end());
    Ok(())
}

static FAILURE: OnceLock<io::Error> = OnceLock::new();

/// Prints a line to standard output. An error is kept for [`finish`], unless the pipe's reader, such as `head`, has closed it.
pub fn print_line(line: &str) {
    if let Err(error) = writeln!(io::stdout().lock(), "{line}")
        && error.kind() != ErrorKind::BrokenPipe
    {
        let _ = FAILURE.set(error);
    }
}

/// Formats its arguments, and prints the line with [`print_line`].
macro_rules! say {
    ($($text:tt)*) => { $crate::tables::print_line(&format!($($text)*)) };
}
pub(crate) use say;

/// Reports the first failure to write to standard output.
///
/// # Errors
/// Fails if a line could not be written, for example because the disk is full.
pub fn finish() -> Result<()> {
    match FAILURE.get() {
        Some(error) => bail!("cannot write standard output: {error}"),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADINGS: &str = "device | clocks, all of them:1 | points:2 | what it computes";

    fn rows() -> Vec<Vec<String>> {
        let row = ["rough", "1 305 235", "100 000", "a rough surface's highlight"];
        vec![row.map(str::to_owned).to_vec()]
    }

    fn widest(text: &str) -> usize {
        text.lines().map(length).max().expect("a line")
    }

    #[test]
    fn a_table_takes_what_room_there_is() {
        for room in 36..100 {
            let text = text(&TerminalColumn::all(HEADINGS), &rows(), Some(room));
            assert!(widest(&text) <= room, "{room}:\n{text}");
            for (column, number) in [("points", "100 000"), ("clocks", "1 305 235")] {
                let said = text.contains(number) || text.contains("no room for");
                assert!(said, "{column} at {room}:\n{text}");
            }
        }
        let all = text(&TerminalColumn::all(HEADINGS), &rows(), None);
        assert_eq!(all.lines().count(), 3, "{all}");
    }

    #[test]
    fn the_least_important_column_goes_first_and_is_named() {
        let text = text(&TerminalColumn::all(HEADINGS), &rows(), Some(40));
        assert!(text.contains("(the line has no room for points; --json"), "{text}");
        assert!(text.contains("1 305 235"), "{text}");
    }

    #[test]
    fn without_room_for_a_table_rows_are_stacked() {
        let columns =
            TerminalColumn::all("device | clocks, all of them: | points: | what it computes");
        let text = text(&columns, &rows(), Some(40));
        assert_eq!(
            text,
            "rough:\n  clocks, all of them: 1 305 235\n  points: 100 000\n  \
             what it computes: a rough surface's\n    highlight"
        );
    }
}

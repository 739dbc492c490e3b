//! Formats Verilog declarations and port lists in columns.

use super::plan::Plan;
use super::text::{COLUMNS, annotated, range};
use crate::netlist::{Design, NetId};

/// Appends a comma to each text except the last.
pub fn separated(mut texts: Vec<String>) -> Vec<String> {
    let last = texts.len().saturating_sub(1);
    for text in texts.iter_mut().take(last) {
        text.push(',');
    }
    texts
}

/// Returns the connections of an instance to nets with the same names, such as `.clk(clk),`, the clock first.
pub fn connections(design: &Design) -> Vec<String> {
    let ports = design.ports.iter().map(|port| design.net(port.net).name.as_str());
    separated(std::iter::once("clk").chain(ports).map(|name| format!(".{name}({name})")).collect())
}

/// Declares each port except the clock: a `reg` for each input, a `wire` for each output. Only `with_signs` declares signed ports
/// as signed.
pub fn variables(design: &Design, with_signs: bool) -> Vec<String> {
    let mut rows = Vec::new();
    for port in &design.ports {
        let net = design.net(port.net);
        let kind = if port.role.is_input() { "reg" } else { "wire" };
        let signed = with_signs && net.format.signed;
        rows.push(Row::port("", kind, net.format.width(), signed, &net.name, ""));
    }
    Row::declarations(&rows)
}

/// The declaration of one net or port, or of several nets whose declarations differ only in their names. The parts are aligned
/// in columns with the declarations around it.
pub struct Row {
    head: String,
    range: String,
    name: String,
    note: String,
}

impl Row {
    /// Declares a net, with the comment from the plan. `direction` is `input` or `output` for a port, otherwise empty; `kind` is
    /// `wire` or `reg`.
    pub fn net(plan: &Plan, direction: &str, kind: &str, id: NetId) -> Self {
        let net = plan.design.net(id);
        let format = net.format;
        let note = plan.remark(id);
        Self::port(direction, kind, format.width(), format.signed, &net.name, &note)
    }

    /// Makes a declaration from its parts; `note` is the comment behind it.
    pub fn port(
        direction: &str,
        kind: &str,
        width: u32,
        signed: bool,
        name: &str,
        note: &str,
    ) -> Self {
        let direction = match direction {
            "" => String::new(),
            _ => format!("{direction:6} "),
        };
        let sign = if signed { " signed" } else { "" };
        Self {
            head: format!("{direction}{kind:4}{sign}"),
            range: range(width),
            name: name.to_owned(),
            note: note.to_owned(),
        }
    }

    #[must_use]
    pub fn without_note(mut self) -> Self {
        self.note.clear();
        self
    }

    /// Merges declarations without a comment that differ only in their names into one line, such as `wire [7:0] a, b;`.
    /// Declarations with a comment come first.
    pub fn together(rows: Vec<Self>) -> Vec<Self> {
        let (mut all, plain): (Vec<_>, Vec<_>) =
            rows.into_iter().partition(|row| !row.note.is_empty());
        let first = all.len();
        let widest = |part: fn(&Self) -> &String| {
            all.iter().chain(&plain).map(|row| part(row).len()).max().unwrap_or(0)
        };
        let indent = 4 + widest(|row| &row.head) + 1 + widest(|row| &row.range) + 1;
        for row in plain {
            let alike = |other: &&mut Self| {
                (&other.head, &other.range) == (&row.head, &row.range)
                    && indent + other.name.len() + 2 + row.name.len() < COLUMNS
            };
            match all[first..].iter_mut().rev().find(alike) {
                Some(other) => other.name = format!("{}, {}", other.name, row.name),
                None => all.push(row),
            }
        }
        all
    }

    /// Returns a port list, aligned in columns, with commas.
    pub fn ports(rows: &[Self]) -> Vec<String> {
        Self::set(rows, |at| if at + 1 < rows.len() { "," } else { "" })
    }

    /// Returns declarations, aligned in columns, with semicolons.
    pub fn declarations(rows: &[Self]) -> Vec<String> {
        Self::set(rows, |_| ";")
    }

    fn set(rows: &[Self], end: impl Fn(usize) -> &'static str) -> Vec<String> {
        let head = rows.iter().map(|row| row.head.len()).max().unwrap_or(0);
        let range = rows.iter().map(|row| row.range.len()).max().unwrap_or(0);
        // A row with several names has no comment behind it, so that its length does not count.
        let single = rows.iter().filter(|row| !row.name.contains(' '));
        let name = single.map(|row| row.name.len() + 1).max().unwrap_or(0);
        let mut lines = Vec::new();
        for (at, row) in rows.iter().enumerate() {
            let gap = if range == 0 { "" } else { " " };
            let named = format!("{}{}", row.name, end(at));
            let code = format!("{:head$}{gap}{:range$} {named:name$}", row.head, row.range);
            lines.extend(annotated(&code, 4, &row.note));
        }
        for line in &mut lines {
            line.truncate(line.trim_end().len());
        }
        lines
    }
}

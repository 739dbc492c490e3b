//! Formats Verilog text: ASCII characters, identifiers, literals, comments, and lines of limited length.

use std::collections::HashSet;

use crate::netlist::Design;

/// The largest number of columns in a line of Verilog.
pub const COLUMNS: usize = 100;

/// Returns `text` in ASCII: `cos²γ ≤ ½` becomes `cos^2gamma <= 1/2`, and unknown characters become `?`.
pub fn ascii(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for sign in text.chars() {
        match sign {
            ' '..='~' => plain.push(sign),
            '\t' | '\n' | '\r' | '\u{a0}' | '\u{202f}' => plain.push(' '),
            'α' => plain.push_str("alpha"),
            'β' => plain.push_str("beta"),
            'γ' => plain.push_str("gamma"),
            'δ' | 'Δ' => plain.push_str("delta"),
            'ζ' => plain.push_str("zeta"),
            'θ' => plain.push_str("theta"),
            'λ' => plain.push_str("lambda"),
            'π' => plain.push_str("pi"),
            'ψ' => plain.push_str("psi"),
            '·' | '∙' | '×' => plain.push('*'),
            '−' | '–' | '—' | '‑' => plain.push('-'),
            '±' => plain.push_str("+/-"),
            '∓' => plain.push_str("-/+"),
            '√' => plain.push_str("sqrt"),
            '¬' => plain.push('~'),
            '⊕' => plain.push_str("xor"),
            '½' => plain.push_str("1/2"),
            '°' => plain.push_str(" deg"),
            '≤' => plain.push_str("<="),
            '≥' => plain.push_str(">="),
            '≠' => plain.push_str("!="),
            '≈' => plain.push('~'),
            '←' => plain.push_str("<-"),
            '→' | '↦' => plain.push_str("->"),
            '…' => plain.push_str("..."),
            '′' | '‘' | '’' => plain.push('\''),
            '“' | '”' | '„' => plain.push('"'),
            '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' | '⁻' | 'ⁿ' | 'ᵏ' | 'ᵐ' | 'ᶠ' | 'ˢ' | 'ˣ' =>
            {
                let after_power = matches!(plain.chars().last(), Some('^' | '-' | '0'..='9'))
                    && plain.contains('^');
                if !after_power {
                    plain.push('^');
                }
                plain.push(match sign {
                    '¹' => '1',
                    '²' => '2',
                    '³' => '3',
                    '⁻' => '-',
                    'ⁿ' => 'n',
                    'ᵏ' => 'k',
                    'ᵐ' => 'm',
                    'ᶠ' => 'F',
                    'ˢ' => 's',
                    'ˣ' => 'x',
                    digit => char::from(b'0' + (digit as u32 - '⁰' as u32) as u8),
                });
            }
            '₀'..='₉' => plain.push(char::from(b'0' + (sign as u32 - '₀' as u32) as u8)),
            _ => plain.push('?'),
        }
    }
    plain
}

/// Returns `text` as an upper-case identifier; each run of other characters becomes one underscore: `cos γ` becomes `COS_GAMMA`.
pub fn constant_name(text: &str) -> String {
    let mut name = String::new();
    for sign in ascii(text).chars() {
        if sign.is_ascii_alphanumeric() {
            name.push(sign.to_ascii_uppercase());
        } else if !name.is_empty() && !name.ends_with('_') {
            name.push('_');
        }
    }
    name.trim_end_matches('_').to_owned()
}

/// Returns a literal with its width: binary for one bit, decimal below 1024, and otherwise hexadecimal. 9 in 4 bits is `4'd9`,
/// and 1048576 in 21 bits is `21'h100000`.
pub fn literal(value: u64, width: u32) -> String {
    match (width, value) {
        (1, _) => format!("1'b{value}"),
        (_, 0..1024) => format!("{width}'d{value}"),
        _ => format!("{width}'h{value:x}"),
    }
}

/// Returns the only text, or the concatenation of several, the first in the top bits: `a` and `b` give `{a, b}`.
pub fn together(words: Vec<String>) -> String {
    match &words[..] {
        [only] => only.clone(),
        _ => format!("{{{}}}", words.join(", ")),
    }
}

/// Returns the range of a declaration, such as `[7:0]`, or an empty text for one bit.
pub fn range(width: u32) -> String {
    match width {
        1 => String::new(),
        _ => format!("[{}:0]", width - 1),
    }
}

/// Returns the lines of a statement, broken at spaces to at most [`COLUMNS`]; further lines are indented by 8 more.
pub fn statement(indent: usize, text: &str) -> Vec<String> {
    broken(&" ".repeat(indent), &" ".repeat(indent + 8), text)
}

/// Returns `text` as the lines of a comment; none for an empty text.
pub fn comment(indent: usize, text: &str) -> Vec<String> {
    // Some tools read a comment that begins with their name as a command.
    let text = ascii(text).replace("verilator", "Verilator").replace("synopsys", "Synopsys");
    if text.trim().is_empty() {
        return Vec::new();
    }
    let margin = format!("{}// ", " ".repeat(indent));
    broken(&margin, &margin, &text)
}

/// Returns the lines of a declaration with the comment `note` behind it, or above it if the line would exceed [`COLUMNS`].
pub fn annotated(code: &str, indent: usize, note: &str) -> Vec<String> {
    let code = format!("{}{code}", " ".repeat(indent));
    let note = ascii(note);
    if note.trim().is_empty() {
        return vec![code];
    }
    let line = format!("{code}  // {note}");
    if line.len() <= COLUMNS {
        return vec![line];
    }
    let mut lines = comment(indent, &note);
    lines.push(code);
    lines
}

/// Breaks `text` at spaces into lines of at most [`COLUMNS`] columns. The first line begins with `first`, all others with
/// `further`. A single longer word is not broken.
fn broken(first: &str, further: &str, text: &str) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = first.to_owned();
    let mut empty = true;
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        if !empty && line.len() + 1 + word.len() > COLUMNS {
            lines.push(std::mem::replace(&mut line, further.to_owned()));
            empty = true;
        }
        if !empty {
            line.push(' ');
        }
        line.push_str(word);
        empty = false;
    }
    lines.push(line);
    lines
}

/// The identifiers that one module already uses.
#[derive(Clone, Debug, Default)]
pub struct Names(HashSet<String>);

impl Names {
    pub fn new<'a>(taken: impl IntoIterator<Item = &'a str>) -> Self {
        Self(taken.into_iter().map(str::to_owned).collect())
    }

    /// The names of a design's ports and its clock `clk`.
    pub fn of_ports(design: &Design) -> Self {
        let ports = design.ports.iter().map(|port| design.net(port.net).name.as_str());
        Self::new(ports.chain(["clk"]))
    }

    /// Adds a name that the module does not use yet: `wish`, or `wish_2`, `wish_3` and so on.
    pub fn fresh(&mut self, wish: &str) -> String {
        let mut name = wish.to_owned();
        let mut number = 1;
        while !self.0.insert(name.clone()) {
            number += 1;
            name = format!("{wish}_{number}");
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_survive_in_ascii() {
        assert_eq!(ascii("(n/2·(cos(γ±dγ) − 1) + 1)²"), "(n/2*(cos(gamma+/-dgamma) - 1) + 1)^2");
        assert_eq!(ascii("2⁻¹⁶ x₁₀"), "2^-16 x10");
        assert_eq!(ascii("ї"), "?");
    }

    #[test]
    fn choices_become_constants() {
        assert_eq!(constant_name("cos γ"), "COS_GAMMA");
        assert_eq!(constant_name("adder15 − 1"), "ADDER15_1");
    }

    #[test]
    fn literals_are_sized() {
        assert_eq!(literal(1, 1), "1'b1");
        assert_eq!(literal(9, 4), "4'd9");
        assert_eq!(literal(1 << 20, 21), "21'h100000");
    }

    #[test]
    fn no_line_is_too_long() {
        let words = "abcdefg ".repeat(60);
        for line in statement(4, &words).iter().chain(&comment(4, &words)) {
            assert!(line.len() <= COLUMNS, "{line}");
        }
        let read: Vec<_> = statement(4, &words).iter().map(|line| line.trim().to_owned()).collect();
        assert_eq!(read.join(" "), words.trim());
    }

    #[test]
    fn a_taken_name_is_numbered() {
        let mut names = Names::new(["control"]);
        assert_eq!(names.fresh("control"), "control_2");
        assert_eq!(names.fresh("control"), "control_3");
        assert_eq!(names.fresh("datapath"), "datapath");
    }
}

//! Reads the faults of `faults.txt` and plants them in emitted files.

use std::path::Path;

use glint::tools::prove;

use crate::common::files::{put, read};
use crate::common::tools::LIMIT;

/// A fault of `faults.txt`.
#[derive(Clone)]
pub struct Fault {
    /// Its subject; the heading says of which kind.
    pub of: String,
    /// The text that stands there.
    pub right: String,
    /// The text that takes its place.
    pub wrong: String,
}

/// Returns the faults under a heading.
///
/// # Panics
/// There are none.
pub fn faults(heading: &str) -> Vec<Fault> {
    let text = include_str!("faults.txt").split("\n## ");
    let section = text.filter_map(|section| section.split_once('\n'));
    let section = section.filter(|(title, _)| *title == heading).map(|(_, lines)| lines);
    let lines = section.flat_map(str::lines).filter(|line| !line.starts_with('#'));
    let fault = |line: &str| {
        let (of, rest) = line.split_once(": ")?;
        let (right, wrong) = rest.split_once(" =>")?;
        let text = |part: &str| part.replace("\\n", "\n");
        let wrong = wrong.strip_prefix(' ').unwrap_or(wrong);
        Some(Fault { of: of.to_owned(), right: text(right), wrong: text(wrong) })
    };
    let all = lines.filter(|line| !line.is_empty());
    let all: Vec<Fault> = all.map(|line| fault(line).expect("a fault")).collect();
    assert!(!all.is_empty(), "no faults of {heading}");
    all
}

impl Fault {
    /// Returns a text with the fault, wherever it can be.
    ///
    /// # Panics
    /// It can be nowhere.
    pub fn in_text(&self, text: &str) -> String {
        assert!(text.contains(&self.right), "`{}` is not there, of {}", self.right, self.of);
        text.replace(&self.right, &self.wrong)
    }

    /// Plants it in a file.
    ///
    /// # Panics
    /// It can be nowhere in it.
    pub fn plant(&self, path: &Path) {
        put(path, self.in_text(&read(path)));
    }

    /// # Panics
    /// The proof of a module holds with the fault in a file beside it.
    pub fn assert_breaks(&self, place: &Path, module: &str, file: &str) {
        self.plant(&place.join(file));
        let proof = prove(place, &format!("{module}_formal.sv"), LIMIT);
        assert!(proof.is_err(), "`{}` in {file} is proved", self.wrong);
    }
}

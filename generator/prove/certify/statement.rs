//! Collects the Gappa statements of a proof, and keeps equal statements only once.
//!
//! Statements are equal if their scripts are the same except for names. For example, the outputs red and green often share a
//! statement.

use std::collections::HashMap;

use super::script;
use super::terms::number;

/// The end of a script's goal that asks for a bound.
pub(super) const ASKED: &str = "| in ? }";

/// A statement for Gappa. For example, an output differs from the formula by at most the error bound.
#[derive(Clone, Debug)]
pub struct Statement {
    /// The output, or the intermediate value, that the statement is about.
    pub output: String,
    pub number: usize,
    /// The outputs with a statement that differs from this one only in names.
    pub also: Vec<String>,
    /// Gappa must accept one of these scripts. A formula that jumps has two scripts, one for the right value on each side of the
    /// jump.
    pub scripts: Vec<String>,
}

impl Statement {
    /// Replaces the question for a bound by `bound`. For example, `|difference_7| in ? }` becomes `|difference_7| <= 0.5 }`.
    #[must_use]
    pub fn within(&self, bound: f64) -> Self {
        let stated = format!("| <= {} }}", number(bound));
        let scripts = self.scripts.iter().map(|script| script.replace(ASKED, &stated));
        Self { scripts: scripts.collect(), ..self.clone() }
    }
}

/// A collection of Gappa statements in which equal statements occur only once.
#[derive(Default)]
pub(super) struct Statements {
    pub(super) list: Vec<Statement>,
    /// The index of each statement in `list`. The key is the statement's scripts with all names replaced.
    known: HashMap<Vec<String>, usize>,
}

impl Statements {
    /// Adds a statement about `output`. If a statement with the same scripts except for names exists, adds `output` to it
    /// instead.
    pub(super) fn push(&mut self, output: &str, scripts: Vec<String>) {
        let nameless = scripts.iter().map(|script| script::nameless(script)).collect();
        if let Some(&at) = self.known.get(&nameless) {
            let Statement { output: own, also, .. } = &mut self.list[at];
            if own != output && !also.iter().any(|other| other == output) {
                also.push(output.to_owned());
            }
            return;
        }
        self.known.insert(nameless, self.list.len());
        let before = self.list.iter().filter(|other| other.output == output).count();
        let (output, number) = (output.to_owned(), before + 1);
        self.list.push(Statement { output, number, also: Vec::new(), scripts });
    }
}

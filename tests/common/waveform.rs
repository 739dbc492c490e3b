//! Reads the variables and the values of a waveform file (VCD).

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use vcd::{Parser, ScopeItem, Var};

/// The values of a waveform, behind its header.
pub type Values = Parser<BufReader<File>>;

/// Returns the variables of a waveform with their scopes, joined by dots, and what follows.
///
/// # Panics
/// It is no waveform.
pub fn waveform(path: &Path) -> (Vec<(String, Var)>, Values) {
    let mut values = Parser::new(BufReader::new(File::open(path).expect("a file")));
    let header = values.parse_header().expect("a header");
    let mut found = Vec::new();
    variables(&header.items, "", &mut found);
    (found, values)
}

fn variables(items: &[ScopeItem], path: &str, found: &mut Vec<(String, Var)>) {
    for item in items {
        match item {
            ScopeItem::Scope(scope) => {
                variables(&scope.children, &format!("{path}{}.", scope.identifier), found)
            }
            ScopeItem::Var(var) => found.push((format!("{path}{}", var.reference), var.clone())),
        }
    }
}

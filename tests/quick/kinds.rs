//! Tests the list of the kinds of checks of which a run takes some cases, `tests/kinds.toml`: the test of each kind exists, and
//! CONTRIBUTING.md has the list as a table.

use crate::common::files::read;
use crate::common::sample::{CheckKind, FixedCases, kinds};

/// Returns the row of a kind in the table of CONTRIBUTING.md.
fn row(name: &str, kind: &CheckKind) -> String {
    let CheckKind { test, checks, fixed, drawn } = kind;
    let fixed = match fixed {
        FixedCases::Count(count) => count.to_string(),
        FixedCases::Names(names) => names.join(", "),
    };
    format!("| {name} | {checks} | {fixed} | {drawn} | `{test}` |\n")
}

#[test]
fn contributing_has_the_kinds() {
    let mut table = "| kind | what is checked of each case | default | `--draw` | test |\n|---|---|---|--:|---|\n".to_owned();
    for (name, kind) in kinds() {
        table += &row(&name, &kind);
    }
    let page = read("CONTRIBUTING.md");
    assert!(page.contains(&table), "CONTRIBUTING.md must have this table:\n{table}");
}

#[test]
fn the_test_of_each_kind_exists() {
    for (name, CheckKind { test, .. }) in kinds() {
        let (binary, path) = test.split_once(' ').expect("a binary and a path");
        let (module, function) = path.rsplit_once("::").expect("a module and a function");
        let file = format!("tests/{binary}/{}", module.replace("::", "/"));
        let mut text = String::new();
        for candidate in [format!("{file}.rs"), format!("{file}/mod.rs")] {
            if std::path::Path::new(&candidate).exists() {
                text += &read(candidate);
            }
        }
        let head = format!("#[test]\nfn {function}() {{");
        assert!(text.contains(&head), "{name}: {file} has no test {function}");
        // The test of the page is a program in Python.
        text += &read("bindings/playground/test.py");
        assert!(text.contains(&format!("\"{name}\"")), "{name}: {file} takes no such cases");
    }
}

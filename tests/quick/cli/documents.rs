//! Runs the commands on the pages `docs/composing.md` and `docs/tutorial.md`, with the configurations that these pages show.
//! The module also tests that `docs/SUMMARY.md` lists every page.

use std::collections::BTreeSet;

use super::workspace::Workspace;
use crate::common::files::{paths, read};

/// Returns the blocks of a page: language and text.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let fenced = page.split("\n```").skip(1).step_by(2);
    fenced.filter_map(|block| block.split_once('\n')).collect()
}

/// Runs the commands of a page; a configuration begins with its name, `# core.toml`.
fn run_all(page: &str) {
    let text = read(page);
    let mut dir: Option<Workspace> = None;
    let mut run = 0;
    for (language, block) in blocks(&text) {
        match language {
            "toml" => {
                let name = block.strip_prefix("# ").and_then(|it| it.lines().next());
                let name = name.unwrap_or_else(|| panic!("{page}: a name before\n{block}"));
                match &dir {
                    Some(dir) => dir.write(name, block),
                    None => dir = Some(Workspace::with(name, block)),
                }
            }
            "sh" => {
                let dir = dir.as_ref().expect("a configuration before the commands");
                for line in block.lines() {
                    let (command, remark) = line.split_once('#').unwrap_or((line, ""));
                    let arguments: Vec<&str> = command.split_whitespace().skip(1).collect();
                    let of = dir.glint(&arguments);
                    let code = i32::from(remark.contains("exit code 1"));
                    assert_eq!(of.code, code, "{page}: {command}\n{}{}", of.out, of.err);
                    run += 1;
                }
            }
            _ => {}
        }
    }
    assert!(run > 3, "{page}: {run} commands");
}

#[test]
fn commands_on_composing_run() {
    run_all("docs/composing.md");
}

#[test]
fn commands_of_the_tutorial_run() {
    run_all("docs/tutorial.md");
}

#[test]
fn every_page_is_in_the_book() {
    let summary = read("docs/SUMMARY.md");
    let links = summary.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    let listed: BTreeSet<String> =
        links.map(|it| format!("docs/{}", it.0)).filter(|it| it != "docs/").collect();
    let pages =
        ["docs", "docs/design", "docs/devices", "docs/evidence", "docs/flows", "docs/images"]
            .map(|folder| paths(folder, ".md"))
            .concat();
    let pages = pages.into_iter().filter(|it| it != "docs/SUMMARY.md");
    assert_eq!(listed, pages.collect());
}

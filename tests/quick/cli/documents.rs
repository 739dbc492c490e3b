//! Runs the commands on the pages `README.md`, `docs/shading.md`, `docs/tutorial.md` and `docs/units.md`, with the configurations that these
//! pages show. The module also tests that `docs/SUMMARY.md` lists every page.

use std::collections::BTreeSet;

use super::workspace::Workspace;
use crate::common::files::{paths, read};

/// Returns the blocks of a page: language and text.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let fenced = page.split("\n```").skip(1).step_by(2);
    fenced.filter_map(|block| block.split_once('\n')).collect()
}

/// Runs the commands of a page; a configuration begins with its name, `# core.toml`. A box with the language `text` after
/// commands has lines of their output.
fn run_all(page: &str) {
    let text = read(page);
    let mut dir: Option<Workspace> = None;
    let (mut run, mut output) = (0, String::new());
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
                output.clear();
                for line in block.lines() {
                    let (command, remark) = line.split_once('#').unwrap_or((line, ""));
                    let arguments: Vec<&str> = command.split_whitespace().skip(1).collect();
                    let of = dir.glint(&arguments);
                    let code = i32::from(remark.contains("exit code 1"));
                    assert_eq!(of.code, code, "{page}: {command}\n{}{}", of.out, of.err);
                    output += &of.out;
                    run += 1;
                }
            }
            "text" if !output.is_empty() => assert_shown(page, block, &output),
            _ => {}
        }
    }
    assert!(run > 3, "{page}: {run} commands");
}

/// Asserts that the lines of a box are lines of the output, in order. A line `…` is in place of further lines of the output;
/// any other line follows directly on the line before it.
fn assert_shown(page: &str, shown: &str, output: &str) {
    let mut rest: Vec<&str> = output.lines().collect();
    let mut may_skip = false;
    for line in shown.lines() {
        if line == "…" {
            may_skip = true;
            continue;
        }
        let at = rest.iter().position(|other| other.trim_end() == line);
        let at = at.unwrap_or_else(|| panic!("{page}: no line\n{line}\nin\n{}", rest.join("\n")));
        assert!(at == 0 || may_skip, "{page}: `…` is missing before\n{line}");
        rest.drain(..=at);
        may_skip = false;
    }
    assert!(rest.is_empty() || may_skip, "{page}: `…` is missing at the end of\n{shown}");
}

/// A file that `glint new` writes has the name of its core, so that the page can speak of the core by this name.
#[test]
fn new_files_on_pages_have_the_names_of_their_cores() {
    let mut count = 0;
    let pages = paths("docs", ".md").into_iter().chain(["README.md".to_owned()]);
    for page in pages {
        let text = read(&page);
        let lines = blocks(&text).into_iter().flat_map(|(_, block)| block.lines());
        for line in lines.filter(|line| line.starts_with("glint new ")) {
            let command = line.split('#').next().unwrap_or(line);
            let Some((command, file)) = command.split_once('>') else { continue };
            let arguments: Vec<&str> = command.split_whitespace().skip(1).collect();
            let core = file.trim().trim_end_matches(".toml");
            let name = format!("name = \"{core}\"");
            let written = Workspace::new().done(arguments);
            assert!(written.lines().any(|line| line == name), "{page}: {line}\n{written}");
            count += 1;
        }
    }
    assert!(count > 3, "{count} commands");
}

/// The README has a file `angle.toml`, whose first line is its name. Directories in the remarks exist afterwards. A box with the
/// language `text` has lines of the output of the commands above it.
#[test]
fn commands_of_the_readme_run() {
    let text = read("README.md");
    let dir = Workspace::new();
    let mut run = 0;
    let mut output = String::new();
    for (language, block) in blocks(&text) {
        if language == "toml" && block.starts_with("# angle.toml") {
            dir.write("angle.toml", block);
        }
        if language == "text" {
            assert_shown("README.md", &format!("…\n{}", block.trim_end()), &output);
        }
        if !language.is_empty() {
            continue;
        }
        output.clear();
        // Icarus Verilog is an outside tool.
        let commands = block.lines().filter(|line| line.starts_with("glint "));
        for line in commands.filter(|line| !line.contains("--simulator")) {
            let (command, remark) = line.split_once(" # ").unwrap_or((line, ""));
            let (command, file) = command.split_once('>').unwrap_or((command, ""));
            let arguments: Vec<&str> = command.split_whitespace().skip(1).collect();
            let of = dir.glint(&arguments);
            assert_eq!(of.code, 0, "{line}\n{}{}", of.out, of.err);
            assert!(of.err.is_empty(), "{line}\n{}", of.err);
            if !file.is_empty() {
                dir.write(file.trim(), &of.out);
            }
            output += &of.out;
            for path in remark.split([' ', ',']).filter(|word| word.ends_with('/')) {
                assert!(dir.at(path).is_dir(), "{line}: no {path}");
            }
            run += 1;
        }
    }
    assert!(run > 4, "{run} commands");
}

#[test]
fn commands_on_shading_run() {
    run_all("docs/shading.md");
}

#[test]
fn commands_on_units_run() {
    run_all("docs/units.md");
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

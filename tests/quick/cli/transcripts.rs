//! Runs of the program as files: what stands in a directory, commands, and what comes of each.
//!
//! `transcripts/README.md` has the form.
#![cfg(unix)]

use std::fs;

use rayon::prelude::*;
use regex::Regex;
use serde_json::Value;

use crate::workspace::{COSINE_POWER, Run, Workspace};

/// Directory of the transcripts.
const TRANSCRIPTS: &str = "tests/quick/cli/transcripts";

/// A command, the exit code that it is to have, and the lines below it.
struct Step<'t> {
    code: i32,
    arguments: Vec<String>,
    expected: Vec<&'t str>,
}

#[test]
fn commands_do_as_their_transcripts_say() {
    let entries = fs::read_dir(TRANSCRIPTS).expect(TRANSCRIPTS);
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let texts: Vec<(String, String)> = paths
        .filter(|path| path.extension().is_some_and(|it| it == "txt"))
        .map(|path| (path.display().to_string(), fs::read_to_string(path).expect("a transcript")))
        .collect();
    let cases = texts.iter().flat_map(|(path, text)| {
        let cases = text.split("\n## ").skip(1);
        cases.map(move |case| (path, case.split_once('\n').expect("a title and steps")))
    });
    let cases: Vec<_> = cases.collect();
    assert!(cases.len() > 50, "{} cases", cases.len());
    let wrong: Vec<String> = cases
        .par_iter()
        .flat_map(|(path, (title, text))| {
            let wrong = played(text);
            wrong.into_iter().map(|it| format!("{path}: {title}: {it}")).collect::<Vec<_>>()
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// Plays a case in a directory of its own, and returns what is not as it says.
fn played(text: &str) -> Vec<String> {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    let mut wrong = Vec::new();
    let mut lines = text.lines().peekable();
    let begins = |line: &str| line.starts_with("== ") || line.get(1..3) == Some("$ ");
    while let Some(line) = lines.next() {
        let mut below = Vec::new();
        while let Some(line) = lines.next_if(|line| !begins(line)) {
            below.push(line);
        }
        if let Some(name) = line.strip_prefix("== ") {
            place(&dir, name, below.join("\n").trim_end());
        } else if begins(line) {
            let code = line[..1].parse().expect("an exit code");
            below.retain(|line| !line.is_empty() && !line.starts_with("# "));
            let step = Step { code, arguments: words(&line[3..]), expected: below };
            wrong.extend(step.run(&dir).into_iter().map(|it| format!("{line}\n  {it}")));
        } else {
            assert!(line.is_empty() || line.starts_with("# "), "{line}");
        }
    }
    wrong
}

/// Writes a file; those in `tools/` are shell scripts.
fn place(dir: &Workspace, name: &str, text: &str) {
    match name.strip_prefix("tools/") {
        Some(_) => dir.script(name, text),
        None => dir.write(name, format!("{text}\n")),
    }
}

/// Words with blanks between, or with quotes around.
fn words(text: &str) -> Vec<String> {
    let word = Regex::new(r"'([^']*)'|(\S+)").expect("a pattern");
    let words = word.captures_iter(text);
    words.map(|it| it.get(1).or(it.get(2)).map_or("", |word| word.as_str()).to_owned()).collect()
}

impl Step<'_> {
    fn run(&self, dir: &Workspace) -> Vec<String> {
        let before = dir.files();
        let run = dir.with_own_tools(&self.arguments);
        let mut wrong = Vec::new();
        let mut check = |holds: bool, what: &str| {
            if !holds {
                wrong.push(format!("{what}\n{}{}", run.out, run.err));
            }
        };
        check(run.code == self.code, &format!("the exit code is {}", run.code));
        let is_json = self.arguments.iter().any(|it| it == "--json");
        let told = self.expected.iter().any(|line| line.starts_with("! "));
        check(told || self.code != 0 || run.err.is_empty(), "it says something on standard error");
        let writes = self.expected.iter().any(|line| line.starts_with("+ "));
        check(self.code == 0 || writes || dir.files() == before, "files have changed");
        check(self.code != 2 || is_json || run.out.is_empty(), "it prints something");
        for line in &self.expected {
            let (kind, text) = line.split_once(' ').unwrap_or((line, ""));
            let text = &text.replace("\\n", "\n");
            let holds = match kind {
                ">" => run.out.contains(text),
                "x>" => !run.out.contains(text),
                ">=" => run.out.lines().any(|line| line == text),
                "!" => run.err.contains(text),
                "x!" => !Regex::new(text).expect("a pattern").is_match(&run.err),
                "=" => is_at(&run.json(), text),
                "+=" => {
                    let (name, text) = text.split_once(' ').expect("a file, a pointer, a value");
                    is_at(&dir.json(name), text)
                }
                "+" => has(dir, text),
                "-" => !dir.at(text).exists(),
                "files" => dir.files().keys().eq(text.split(' ')),
                _ => false,
            };
            check(holds, line);
        }
        dir.assert_no_staging();
        if let (1.., false, Some(told)) = (self.code, is_json, self.told()) {
            wrong.extend(self.as_json(dir, told).map(|it| format!("--json: {it}")));
        }
        wrong
    }

    /// The first text that standard error is to have.
    fn told(&self) -> Option<&str> {
        self.expected.iter().find_map(|line| line.strip_prefix("! "))
    }

    /// Runs a refused command again for scripts, which find the message in JSON; returns what is wrong.
    fn as_json(&self, dir: &Workspace, told: &str) -> Option<String> {
        let json = "--json".to_owned();
        let at = self.arguments.iter().position(|it| it == "--").unwrap_or(self.arguments.len());
        let (before, after) = self.arguments.split_at(at);
        let run: Run = dir.with_own_tools(before.iter().chain([&json]).chain(after));
        let value: Value = run.json();
        let found = value["problems"].as_array().expect("problems").iter();
        let mut found = found.flat_map(|problem| problem.as_object().expect("a problem").values());
        let is_told = found.any(|text| text.as_str().is_some_and(|text| text.contains(told)));
        let is_right = run.code == self.code && run.err.is_empty() && value["ok"] == false;
        (!is_right || !is_told).then(|| format!("no `{told}` in {run:?}"))
    }
}

/// Returns whether JSON has a value at the pointer that stands before it.
fn is_at(json: &Value, text: &str) -> bool {
    let (pointer, value) = text.split_once(' ').expect("a pointer and a value");
    json.pointer(pointer) == Some(&serde_json::from_str(value).expect("JSON"))
}

/// Returns whether a file has the text that stands behind its name.
fn has(dir: &Workspace, text: &str) -> bool {
    let (name, part) = text.split_once(' ').unwrap_or((text, ""));
    dir.at(name).exists() && (part.is_empty() || dir.read(name).contains(part))
}

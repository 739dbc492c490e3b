//! Runs the test cases of `transcripts/`: text files with the files of a directory, commands, and their expected output and
//! exit code.
//!
//! `transcripts/README.md` describes the format of these files.
#![cfg(unix)]

use std::fs;

use rayon::prelude::*;
use regex::Regex;
use serde_json::Value;

use crate::common::files::{paths, read};
use crate::common::json::Json;
use crate::workspace::{COSINE_POWER, Run, Workspace};

/// Directory of the transcripts.
const TRANSCRIPTS: &str = "tests/quick/cli/transcripts";

/// A command with its environment and standard input, the exit code that it is to have, and the lines below it.
struct Step<'t> {
    code: i32,
    environment: Vec<(String, String)>,
    arguments: Vec<String>,
    input: Option<String>,
    expected: Vec<&'t str>,
}

/// Declares a test for each transcript by the name of its file, and a test that no file is without one.
macro_rules! transcripts {
    ($($name:ident)*) => {
        $(
            #[test]
            fn $name() {
                assert_played(stringify!($name));
            }
        )*

        #[test]
        fn every_transcript_has_a_test() {
            let files = paths(TRANSCRIPTS, ".txt");
            let tests = [$(stringify!($name)),*].map(|name| format!("{TRANSCRIPTS}/{name}.txt"));
            assert_eq!(files, tests);
        }
    };
}

transcripts! {
    certify
    compare
    configurations
    cosim
    datasheet
    describe
    estimate
    eval
    generate
    new_device
    render
    schedule
    setup
    synth
    table
    tune
    usage
    verify
}

/// Plays every case of the transcript of that name.
///
/// # Panics
/// Some output or exit code is not as the transcript says.
fn assert_played(name: &str) {
    let text = read(format!("{TRANSCRIPTS}/{name}.txt"));
    let cases: Vec<&str> = text.split("\n## ").skip(1).collect();
    assert!(!cases.is_empty(), "{name}: no cases");
    let played_case = |case: &&str| {
        let (title, steps) = case.split_once('\n').expect("a title and steps");
        let wrong = played(steps).into_iter().map(|it| format!("{title}: {it}"));
        wrong.collect::<Vec<String>>()
    };
    let wrong: Vec<String> = cases.par_iter().flat_map(played_case).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// Plays a case in a directory of its own, and returns what is not as it says.
fn played(text: &str) -> Vec<String> {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    let mut wrong = Vec::new();
    let mut lines = text.lines().peekable();
    let begins = |line: &str| {
        ["== ", "=: ", "~~ "].iter().any(|it| line.starts_with(it)) || line.get(1..3) == Some("$ ")
    };
    while let Some(line) = lines.next() {
        let mut below = Vec::new();
        while let Some(line) = lines.next_if(|line| !begins(line)) {
            below.push(line);
        }
        if let Some(name) = line.strip_prefix("== ") {
            place(&dir, name, below.join("\n").trim_end());
        } else if let Some((name, source)) = line.strip_prefix("=: ").and_then(halves) {
            let here = Some(dir.at(source)).filter(|it| it.exists());
            dir.write(name, fs::read(here.unwrap_or_else(|| source.into())).expect(source));
        } else if let Some((name, change)) = line.strip_prefix("~~ ").and_then(halves) {
            let (old, new) = change.split_once(" => ").expect("a text and another");
            assert!(dir.read(name).contains(old), "no `{old}` in {name}");
            dir.write(name, dir.read(name).replace(old, new));
        } else if begins(line) {
            below.retain(|line| !line.is_empty() && !line.starts_with("# "));
            let step = Step::new(line, below);
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
        None => dir.write(name, format!("{text}\n").replace("\\r", "\r")),
    }
}

/// Returns a name, and what stands behind it.
fn halves(text: &str) -> Option<(&str, &str)> {
    text.split_once(' ')
}

/// Returns words with blanks between, or with quotes around.
fn words(text: &str) -> Vec<String> {
    let word = Regex::new(r"'([^']*)'|(\S+)").expect("a pattern");
    let words = word.captures_iter(text);
    words.map(|it| it.get(1).or(it.get(2)).map_or("", |word| word.as_str()).to_owned()).collect()
}

impl<'t> Step<'t> {
    fn new(line: &str, expected: Vec<&'t str>) -> Self {
        let code = line[..1].parse().expect("an exit code");
        let mut arguments = words(&line[2..]);
        let is_variable = |word: &&String| {
            let name = word.split_once('=').map_or("", |(name, _)| name);
            !name.is_empty() && name.chars().all(|it| it.is_ascii_uppercase() || it == '_')
        };
        let variables = arguments.iter().take_while(is_variable).count();
        let variable = |word: String| {
            let (name, value) = word.split_once('=').expect("a variable");
            (name.to_owned(), value.to_owned())
        };
        let environment = arguments.drain(..variables).map(variable).collect();
        let input = arguments.iter().position(|it| it == "<");
        let input = input.map(|at| arguments.split_off(at).remove(1));
        Self { code, environment, arguments, input, expected }
    }

    /// Runs the command with these arguments.
    fn glint(&self, dir: &Workspace, arguments: &[String]) -> Run {
        let mut command = dir.command();
        command.env("PATH", dir.at("tools")).envs(self.environment.iter().cloned());
        if let Some(input) = &self.input {
            command.stdin(fs::File::open(dir.at(input)).expect("an input"));
        }
        Run::of(command.args(arguments).output())
    }

    fn run(&self, dir: &Workspace) -> Vec<String> {
        let before = dir.files();
        let run = self.glint(dir, &self.arguments);
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
                ">==" => run.out == dir.read(text),
                "x>==" => run.out != dir.read(text),
                "|<" => {
                    let most = text.parse().expect("a number");
                    let mut rows = run.out.lines().filter(|line| line.starts_with('|'));
                    rows.all(|line| line.chars().count() <= most)
                }
                "@" => {
                    dir.write(text, &run.out);
                    true
                }
                "!" => run.err.contains(text),
                "x!" => !Regex::new(text).expect("a pattern").is_match(&run.err),
                "=" => is_at(&run.json(), text),
                "=@" => {
                    let (pointer, name) = halves(text).expect("a pointer and a file");
                    at(&run.json(), pointer) == Some(&dir.read(name).into())
                }
                "+=" => {
                    let (name, text) = text.split_once(' ').expect("a file, a pointer, a value");
                    is_at(&dir.json(name), text)
                }
                "+==" => is_same(dir, text),
                "x+==" => !is_same(dir, text),
                "+" => has(dir, text),
                "x+" => !has(dir, text),
                "xml" => {
                    let (name, tag) = halves(text).expect("a file and an element");
                    let text = dir.read(name);
                    let document = roxmltree::Document::parse(&text).expect("XML");
                    document.descendants().any(|it| it.tag_name().name() == tag)
                }
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

    /// Returns the first text that standard error is to have.
    fn told(&self) -> Option<&str> {
        self.expected.iter().find_map(|line| line.strip_prefix("! "))
    }

    /// Runs a refused command again for scripts, which find the message in JSON; returns what is wrong.
    fn as_json(&self, dir: &Workspace, told: &str) -> Option<String> {
        let json = "--json".to_owned();
        let at = self.arguments.iter().position(|it| it == "--").unwrap_or(self.arguments.len());
        let mut arguments = self.arguments.clone();
        arguments.insert(at, json);
        let run = self.glint(dir, &arguments);
        let value: Value = run.json();
        let found = value["problems"].list().iter();
        let mut found = found.flat_map(|problem| problem.object().values());
        let is_told = found.any(|text| text.as_str().is_some_and(|text| text.contains(told)));
        let is_right = run.code == self.code && run.err.is_empty() && value["ok"] == false;
        (!is_right || !is_told).then(|| format!("no `{told}` in {run:?}"))
    }
}

/// Returns the value at a pointer; in a list, a step that is no number is a text in the element, as its name.
fn at<'j>(json: &'j Value, pointer: &str) -> Option<&'j Value> {
    let has = |element: &Value, text: &str| {
        element.as_object().is_some_and(|it| it.values().any(|value| value == text))
    };
    pointer.split('/').skip(1).try_fold(json, |value, step| match (value, step.parse::<usize>()) {
        (Value::Array(list), Ok(at)) => list.get(at),
        (Value::Array(list), Err(_)) => list.iter().find(|it| has(it, step)),
        (value, _) => value.get(step),
    })
}

/// Returns whether JSON has, at the pointer that stands before it, a value or a number within a limit.
fn is_at(json: &Value, text: &str) -> bool {
    let (pointer, wanted) = halves(text).expect("a pointer and a value");
    let found = at(json, pointer);
    let limit = |text: &str| text.parse::<f64>().expect("a number");
    let number = || found.and_then(Value::as_f64).expect("a number");
    match halves(wanted) {
        Some((">=", least)) => number() >= limit(least),
        Some(("<=", most)) => number() <= limit(most),
        _ => found == Some(&serde_json::from_str(wanted).expect("JSON")),
    }
}

/// Returns whether two files have the same bytes.
fn is_same(dir: &Workspace, names: &str) -> bool {
    let (one, other) = halves(names).expect("two files");
    let bytes = |name| fs::read(dir.at(name)).expect(name);
    bytes(one) == bytes(other)
}

/// Returns whether a file has the text that stands behind its name.
fn has(dir: &Workspace, text: &str) -> bool {
    let (name, part) = text.split_once(' ').unwrap_or((text, ""));
    dir.at(name).exists() && (part.is_empty() || dir.read(name).contains(part))
}

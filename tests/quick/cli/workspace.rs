//! Provides a temporary directory in which a test runs the built program, and the result of such a run.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use regex::Regex;
use serde_json::Value;
use tempfile::TempDir;

use crate::common::files::{below, json, put, read};

/// The least configuration: all defaults.
pub const COSINE_POWER: &str = "device = \"cosine-power\"\n";

/// A temporary directory.
pub struct Workspace(TempDir);

/// The result of a run of the program.
#[derive(Debug)]
pub struct Run {
    /// The exit code.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Workspace {
    pub fn new() -> Self {
        Self(TempDir::new().expect("a temporary directory"))
    }

    /// A directory with one file.
    pub fn with(name: &str, text: impl AsRef<[u8]>) -> Self {
        let dir = Self::new();
        dir.write(name, text);
        dir
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn at(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// Writes a file, with the directories that it needs.
    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        put(self.at(name), text);
    }

    /// Writes an executable shell script, with the directories that it needs.
    #[cfg(unix)]
    pub fn script(&self, name: &str, text: &str) {
        fs::create_dir_all(self.at(name).parent().expect("a parent")).expect("a directory");
        let text = format!("#!/bin/sh\n{text}\n");
        shell("printf %s \"$2\" >\"$1\" && chmod 755 \"$1\"", &self.at(name), text.as_ref());
    }

    pub fn read(&self, name: &str) -> String {
        read(self.at(name))
    }

    /// Returns a file that is JSON.
    pub fn json(&self, name: &str) -> Value {
        json(self.at(name))
    }

    /// Returns the program, to be run here.
    pub fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_glint"));
        command.current_dir(self.path());
        command
    }

    pub fn glint<A: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = A>) -> Run {
        Run::of(self.command().args(arguments).output())
    }

    /// Runs the program, which is expected to succeed.
    #[track_caller]
    pub fn done<A: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = A>) -> String {
        let run = self.glint(arguments).good();
        run.out
    }

    /// Returns every file below this directory, with its contents.
    pub fn files(&self) -> BTreeMap<String, Vec<u8>> {
        let file = |path: PathBuf| {
            let name = path.strip_prefix(self.path()).expect("a path below");
            (name.to_str().expect("UTF-8").to_owned(), fs::read(&path).expect("a file"))
        };
        below(self.path()).into_iter().map(file).collect()
    }

    /// Nothing that Glint makes on the way is left.
    #[track_caller]
    pub fn assert_no_staging(&self) {
        for entry in fs::read_dir(self.path()).expect("a directory") {
            let name = entry.expect("an entry").file_name();
            assert!(!name.to_string_lossy().starts_with(".glint-"), "{name:?} is left");
        }
    }
}

/// Returns standard error without the lines about progress, which a slow machine adds: `evaluations: 12 of 34, about 1 s left`.
fn without_progress(text: &str) -> String {
    let progress = Regex::new(r"(?m)^[^\n]+: \d+ of \d+(, about [^\n]+ left)?\n");
    progress.expect("a pattern").replace_all(text, "").into_owned()
}

impl Run {
    pub fn of(output: std::io::Result<Output>) -> Self {
        let output = output.expect("the program runs");
        let run = Self {
            code: output.status.code().unwrap_or(-1),
            out: String::from_utf8(output.stdout).expect("UTF-8"),
            err: without_progress(&String::from_utf8(output.stderr).expect("UTF-8")),
        };
        assert!(!run.err.contains("panicked"), "{run:?}");
        run
    }

    /// It succeeded.
    #[track_caller]
    pub fn good(self) -> Self {
        assert_eq!(self.code, 0, "{self:?}");
        self
    }

    /// It succeeded, and said nothing on standard error.
    #[track_caller]
    pub fn quiet(self) -> Self {
        assert_eq!((self.code, self.err.as_str()), (0, ""), "{self:?}");
        self
    }

    /// It failed with this exit code, and standard error has all of these.
    #[track_caller]
    pub fn refused(&self, code: i32, parts: &[&str]) {
        assert_eq!(self.code, code, "{self:?}");
        for part in parts {
            assert!(self.err.contains(part), "no `{part}` in\n{}", self.err);
        }
    }

    /// Standard output as JSON; nothing but JSON is there.
    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}

/// Runs shell commands with two arguments. What is to be executed is written so: while this process
/// has a file open for writing, a child that another test starts has it too, and then it is "busy".
#[cfg(unix)]
pub fn shell(commands: &str, first: &Path, second: &OsStr) {
    let mut shell = Command::new("sh");
    shell.args(["-c", commands, "sh"]).arg(first).arg(second);
    assert!(shell.status().expect("a shell").success(), "{commands}");
}

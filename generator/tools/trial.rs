//! Tests an outside tool before Glint trusts it: the tool must reject a wrong input.
//!
//! A lint counts as passed if the tool reports nothing, so a broken tool that never reports anything would accept every file.

use std::fs;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use serde::Deserialize;

use super::Tool;
use crate::transient::Directory;

/// A test of a tool: an input, and the text that the tool must print about it.
#[derive(Deserialize)]
struct Trial {
    tool: String,
    /// The input in words, for the error message.
    what: String,
    file: String,
    contents: String,
    arguments: Vec<String>,
    /// Whether the tool must exit with status 0.
    succeeds: bool,
    says: String,
}

#[derive(Deserialize)]
struct Trials {
    trial: Vec<Trial>,
}

impl Tool {
    /// Tests a tool with an input that it must reject. For example, `yosys` gets a false claim, and must print `proof did fail`.
    /// A tool that answers only by its exit status also gets an input that it must accept. Each run may take at most `limit`. A
    /// tool without such a test in `trials.toml` is not tested.
    ///
    /// # Errors
    /// Fails if the tool accepts a wrong input, rejects a correct one, or does not print the expected text. Fails if the tool
    /// does not start or takes too long.
    pub fn ensure_works(&self, limit: Duration) -> Result<()> {
        let Trials { trial: trials } = toml::from_str(include_str!("trials.toml"))?;
        for trial in trials.iter().filter(|trial| trial.tool == self.name) {
            let dir = Directory::new().context("cannot make a temporary directory")?;
            fs::write(dir.path().join(&trial.file), &trial.contents)
                .context("cannot write the test file for a tool")?;
            let run = self.run(&trial.arguments, dir.path(), limit)?;
            let does = match (run.status.success(), trial.succeeds) {
                (true, false) => "accepts",
                (false, true) => "refuses",
                _ if !says(&run.output, &trial.says) => "does not report",
                _ => continue,
            };
            let said = run.output.lines().next().map_or_else(String::new, |it| format!(": {it}"));
            bail!("`{self}` {does} {}, so this {self} does not work{said}", trial.what);
        }
        Ok(())
    }
}

/// Returns whether `output` contains `words`, but not as the end of a longer word. For example, `unsat` does not contain `sat`.
fn says(output: &str, words: &str) -> bool {
    let before = |at: usize| output[..at].chars().next_back();
    let mut found = output.match_indices(words);
    found.any(|(at, _)| !before(at).is_some_and(char::is_alphanumeric))
}

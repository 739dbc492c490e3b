//! Writes Verilog and memory files into a temporary directory, and runs Yosys on them there.

use std::fs;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::Value;

use super::Tool;
use crate::file_names::is_verilog;
use crate::transient::Directory;

/// Verilog and memory files in a temporary directory, with the Yosys that reads the files.
pub struct YosysSources<'a> {
    directory: Directory,
    yosys: &'a Tool,
    verilog: String,
    limit: Duration,
}

impl<'a> YosysSources<'a> {
    /// Writes `files` to a new temporary directory. Each run of Yosys may take at most `limit`.
    ///
    /// # Errors
    ///
    /// Fails if the directory or a file cannot be written.
    pub fn new(yosys: &'a Tool, files: &[(String, String)], limit: Duration) -> Result<Self> {
        let directory = Directory::new().context("cannot make a directory for synthesis")?;
        let names = files.iter().map(|(name, _)| name.as_str());
        let verilog: Vec<&str> = names.filter(|name| is_verilog(name)).collect();
        let sources = Self { directory, yosys, verilog: verilog.join(" "), limit };
        files.iter().try_for_each(|(name, contents)| sources.write(name, contents))?;
        Ok(sources)
    }

    /// Writes a further file, whose `name` must not contain a path. [`YosysSources::run`] does not read this file by itself, even
    /// if it is Verilog.
    ///
    /// # Errors
    ///
    /// Fails if the file cannot be written.
    pub fn write(&self, name: &str, contents: &str) -> Result<()> {
        fs::write(self.path().join(name), contents)
            .with_context(|| format!("cannot write `{name}` for synthesis"))
    }

    pub fn path(&self) -> &Path {
        self.directory.path()
    }

    /// Lets Yosys read the Verilog files of [`YosysSources::new`] and then run `commands`. For example, the commands `proc; opt`
    /// become the script `read_verilog rsqrt.v; proc; opt`.
    ///
    /// # Errors
    /// Fails if Yosys exits with an error, does not start, or takes longer than the limit.
    pub fn run(&self, commands: &str) -> Result<()> {
        let script = format!("read_verilog {}; {commands}", self.verilog);
        self.yosys.run_to_success(["-q", "-p", &script], self.path(), self.limit)?;
        Ok(())
    }

    /// Returns the text of a file that a tool has written into the directory, such as `statistics.json`.
    ///
    /// # Errors
    /// Fails if the file does not exist or is not UTF-8.
    pub fn text(&self, name: &str) -> Result<String> {
        fs::read_to_string(self.path().join(name))
            .with_context(|| format!("the tool did not write `{name}`"))
    }

    /// Parses a JSON file that a tool has written into the directory.
    ///
    /// # Errors
    /// Fails if the file does not exist, or is no JSON.
    pub fn json(&self, name: &str) -> Result<Value> {
        let text = self.text(name)?;
        serde_json::from_str(&text)
            .with_context(|| format!("the file `{name}`, which the tool wrote, is not JSON"))
    }
}

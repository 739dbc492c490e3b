//! Formal proofs.

use std::fs;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, ensure};

use super::Tool;

/// Runs the commands that the head of the wrapper `<name>_formal.sv` gives, in the directory that has it and
/// the files of its device: what users are told to run is what is run.
///
/// # Errors
/// The proof does not succeed; a tool is missing, or a command takes longer than `limit`.
pub fn prove(directory: &Path, name: &str, limit: Duration) -> Result<()> {
    let file = directory.join(format!("{name}_formal.sv"));
    let wrapper =
        fs::read_to_string(&file).with_context(|| format!("cannot read `{}`", file.display()))?;
    let commands: Vec<Vec<&str>> = wrapper
        .lines()
        .filter_map(|line| line.trim_start().strip_prefix("//   $ "))
        // Another way to the same proof is SymbiYosys.
        .filter(|line| line.starts_with("yosys"))
        .map(|line| line.split(' ').collect())
        .collect();
    ensure!(
        commands.len() == 3,
        "`{}` does not say how to make the problem, prove the base case, and prove the induction",
        file.display()
    );
    for command in commands {
        Tool::find(command[0])?
            .run_to_success(&command[1..], directory, limit)
            .with_context(|| command.join(" "))?;
    }
    Ok(())
}

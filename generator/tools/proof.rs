//! Runs the formal proof of a core or a wrapper, with the commands in the first lines of the generated proof file. Users can copy
//! these commands.

use std::fs;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};

use super::{LimitReached, Limits, Tool, capture};

/// The default limits of each command of a proof.
pub const PROOF_LIMITS: Limits = Limits { time: Duration::from_secs(300), memory: Some(4 << 30) };

/// Runs the commands in the first lines of the proof `file`. `directory` must contain the proof and the files of its device.
/// Three commands must begin with `$ yosys`: they make the problem, prove the base case, and prove the induction. `limits` apply
/// to each command.
///
/// # Errors
///
/// Fails if the file does not list three commands, if the proof does not succeed, or if a tool is missing. Fails with
/// [`LimitReached`] if a command takes more time or memory than its limits. This error says nothing about the properties.
pub fn prove(directory: &Path, file: &str, limits: impl Into<Limits>) -> Result<()> {
    let limits = limits.into();
    let file = directory.join(file);
    let wrapper =
        fs::read_to_string(&file).with_context(|| format!("cannot read `{}`", file.display()))?;
    let commands: Vec<Vec<&str>> = wrapper
        .lines()
        .filter_map(|line| line.trim_start().strip_prefix("//   $ "))
        // The file also lists SymbiYosys, another tool for the same proof.
        .filter(|line| line.starts_with("yosys"))
        .map(|line| line.split(' ').collect())
        .collect();
    ensure!(
        commands.len() == 3,
        "`{}` does not have the three commands that make the problem, prove the base case and prove the \
         induction",
        file.display()
    );
    for command in commands {
        let tool = Tool::find(command[0])?;
        let run = tool.run(&command[1..], directory, limits).with_context(|| command.join(" "))?;
        // Yosys only writes the problem. The front end of the solver says whether the proof succeeded.
        let says = command[0] == "yosys" || run.output.contains("Status: PASSED");
        if run.status.success() && says {
            continue;
        }
        let what = format!("{}{}", command.join(" "), capture::quote(&run.output));
        ensure!(!run.status.success(), "the output has no line `Status: PASSED`: {what}");
        match limits.memory.filter(|_| ran_out_of_memory(&run.output)) {
            Some(bytes) => {
                bail!(LimitReached(format!("a process took more than {} MB: {what}", bytes >> 20)))
            }
            None => bail!("{what}"),
        }
    }
    Ok(())
}

/// Returns whether `output` has a message of Yosys, Python or Z3 about missing memory.
fn ran_out_of_memory(output: &str) -> bool {
    const SIGNS: [&str; 5] = [
        "out of memory",
        "bad_alloc",
        "MemoryError",
        "Unexpected EOF response from solver",
        "BrokenPipeError",
    ];
    SIGNS.iter().any(|words| output.contains(words))
}

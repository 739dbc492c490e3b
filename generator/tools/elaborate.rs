//! Verilog as Yosys understands it: a flat netlist in its JSON format.

use std::fs;
use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::Value;

use super::Tool;
use crate::base::transient::Directory;

/// Reads Verilog and memory files, pairs of a plain name and contents, and returns the module `top` with everything that it
/// instantiates: word-level cells, registers and memories, nothing optimised but what nothing reads.
///
/// # Errors
/// Yosys refuses the files, takes longer than `limit`, or writes no netlist.
pub fn elaborate(
    yosys: &Tool,
    files: &[(String, String)],
    top: &str,
    limit: Duration,
) -> Result<Value> {
    const NETLIST: &str = "netlist.json";
    let dir = Directory::new().context("cannot make a directory for the text")?;
    for (name, contents) in files {
        fs::write(dir.path().join(name), contents)
            .with_context(|| format!("cannot write `{name}` for `{yosys}`"))?;
    }
    let sources: Vec<&str> =
        files.iter().map(|(name, _)| name.as_str()).filter(|name| name.ends_with(".v")).collect();
    let script = format!(
        "read_verilog {}; hierarchy -check -top {top}; proc; flatten; memory_collect; opt_clean; write_json {NETLIST}",
        sources.join(" ")
    );
    yosys.run_to_success(["-q", "-p", &script], dir.path(), limit)?;
    let text = fs::read_to_string(dir.path().join(NETLIST))
        .with_context(|| format!("`{yosys}` wrote no netlist"))?;
    let mut netlist: Value = serde_json::from_str(&text)
        .with_context(|| format!("the netlist of `{yosys}` is no JSON"))?;
    Ok(netlist["modules"][top].take())
}

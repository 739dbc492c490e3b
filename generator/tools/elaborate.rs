//! Elaborates Verilog with Yosys: reads the files, and returns the flat netlist in Yosys's JSON format.

use std::time::Duration;

use anyhow::Result;
use serde_json::Value;

use super::Tool;
use super::sources::YosysSources;

/// Returns the module `top` with everything that it instantiates, as Yosys's JSON object of the module. The cells are under the
/// key `cells`, and the nets under `netnames`. The netlist has word-level cells, registers and memories, without logic that
/// nothing reads. The 1-bit inputs `held_low` become constants of 0.
///
/// # Errors
///
/// Fails if a file cannot be written, or if Yosys refuses the files, takes longer than `limit`, or writes no netlist.
pub fn elaborate(
    yosys: &Tool,
    files: &[(String, String)],
    top: &str,
    held_low: &[&str],
    limit: Duration,
) -> Result<Value> {
    const NETLIST: &str = "netlist.json";
    let sources = YosysSources::new(yosys, files, limit)?;
    let mut hold = String::new();
    for input in held_low {
        hold += &format!("delete -input {top}/w:{input}; connect -set {input} 1'b0; opt_expr; ");
    }
    sources.run(&format!(
        "hierarchy -check -top {top}; proc; flatten; {hold}memory_collect; opt_clean; write_json {NETLIST}"
    ))?;
    Ok(sources.json(NETLIST)?["modules"][top].take())
}

//! Elaborates Verilog with Yosys: reads the files, and returns the flat netlist in Yosys's JSON format.

use std::time::Duration;

use anyhow::Result;
use serde_json::Value;

use super::Tool;
use super::sources::YosysSources;

/// Reads Verilog and memory files, pairs of a plain name and contents, and returns the module `top` with everything
/// that it instantiates. The result has word-level cells, registers and memories. Only logic that nothing reads is
/// optimised away. The caller finds the cells under the key `cells` of the result, and the nets under `netnames`.
///
/// # Errors
/// Fails if Yosys refuses the files, takes longer than `limit`, or writes no netlist.
pub fn elaborate(
    yosys: &Tool,
    files: &[(String, String)],
    top: &str,
    limit: Duration,
) -> Result<Value> {
    const NETLIST: &str = "netlist.json";
    let sources = YosysSources::new(yosys, files, limit)?;
    sources.run(&format!(
        "hierarchy -check -top {top}; proc; flatten; memory_collect; opt_clean; write_json {NETLIST}"
    ))?;
    Ok(sources.json(NETLIST)?["modules"][top].take())
}

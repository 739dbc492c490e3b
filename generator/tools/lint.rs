//! Runs the linters `iverilog` and `verilator` on Verilog files, and returns their warnings.

use std::path::Path;
use std::time::Duration;

use anyhow::{Result, bail};

use super::Tool;

/// Runs the linter `tool` with its strictest warnings on the Verilog files `sources` in `directory`. The result is empty if there
/// are no warnings. Verilator refuses sources with warnings, so the error contains its warnings.
///
/// # Errors
///
/// Fails if `tool` is neither `iverilog` nor `verilator`, if the tool rejects the sources, or if it takes longer than `limit`.
pub fn lint(
    tool: &Tool,
    directory: &Path,
    sources: &[String],
    top: &str,
    limit: Duration,
) -> Result<String> {
    let options: &[&str] = match tool.name() {
        "iverilog" => &["-g2005", "-Wall", "-t", "null", "-s", top],
        "verilator" => &["--lint-only", "-Wall", "--top-module", top],
        other => bail!("Glint does not know the linter `{other}`"),
    };
    let sources = sources.iter().map(String::as_str);
    let arguments = options.iter().copied().chain(sources);
    tool.run_to_success(arguments, directory, limit)
}

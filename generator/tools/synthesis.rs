//! Synthesises a design for an FPGA family with Yosys, and counts the cells: LUTs, flip-flops, DSP blocks and block RAMs.

use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::Value;

use super::Tool;
use super::sources::YosysSources;
pub use glint_base::target::Usage;
use glint_base::target::{Family, Kinds};

/// Synthesises the module `top` of Verilog and memory files, pairs of a plain name and contents.
///
/// # Errors
/// Fails if the files cannot be written, if Yosys fails or takes longer than `limit`, or if it does not say which
/// cells the design takes.
pub fn synthesise(
    yosys: &Tool,
    files: &[(String, String)],
    top: &str,
    family: &Family,
    limit: Duration,
) -> Result<Usage> {
    let sources = YosysSources::new(yosys, files, limit)?;
    sources.run(&format!("{}; {STATISTICS_COMMAND}", family.script(top)))?;
    usage(&sources, top, family)
        .with_context(|| format!("`{}` for {}", family.command, family.title))
}

/// The command of Yosys whose result [`usage`] reads. It must come after the synthesis in a script.
pub const STATISTICS_COMMAND: &str = "tee -q -o statistics.json stat -json";

/// Reads the statistics that [`STATISTICS_COMMAND`] has written.
///
/// # Errors
/// Fails if the file is not there, or does not tell the cells of the module `top`.
pub fn usage(sources: &YosysSources, top: &str, family: &Family) -> Result<Usage> {
    let text = sources.text("statistics.json").context("`yosys` wrote no statistics")?;
    let statistics: Value =
        serde_json::from_str(&text).context("the statistics of `yosys` are no JSON")?;
    // The netlist is flat: the top module is all of it.
    let cells = statistics["modules"][format!("\\{top}")]["num_cells_by_type"]
        .as_object()
        .with_context(|| format!("the statistics of `yosys` do not tell the cells of `{top}`"))?;
    let count = |kinds: Kinds| {
        let of = |kind: &str| cells.get(kind).and_then(Value::as_u64).unwrap_or(0);
        kinds.iter().map(|(kind, weight)| of(kind) * weight).sum()
    };
    Ok(Usage {
        luts: count(family.luts),
        dsps: count(family.dsps),
        block_rams: count(family.block_rams),
        flip_flops: count(family.flip_flops),
    })
}

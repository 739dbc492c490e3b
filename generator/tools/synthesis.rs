//! Synthesis by Yosys: what a design takes of an FPGA.

use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::Value;

use super::Tool;
use super::sources::Sources;

/// Kinds of cells, each with what one of them counts for.
pub type Kinds = &'static [(&'static str, u64)];

/// A family of FPGAs.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// For scripts: `ice40`.
    pub name: &'static str,
    /// For people.
    pub title: &'static str,
    /// The command of Yosys that reads the cells which a core may instantiate, or nothing.
    pub library: &'static str,
    /// The Yosys commands before `command`.
    prepare: &'static str,
    /// The command of Yosys, without the top module.
    pub command: &'static str,
    /// Look-up tables. A carry cell that takes the place of two counts for two.
    pub luts: Kinds,
    /// DSP blocks.
    pub dsps: Kinds,
    /// Block RAMs: of 4 kbit in iCE40, of 18 kbit in the others.
    pub block_rams: Kinds,
    /// Flip-flops.
    pub flip_flops: Kinds,
}

impl Family {
    /// The commands of Yosys that map the module `top`, and what it instantiates, to cells of the family.
    pub fn script(&self, top: &str) -> String {
        format!(
            "{}hierarchy -check -top {top}; {}{} -top {top}",
            self.library,
            self.prepare.replace("{top}", top),
            self.command
        )
    }
}

/// Products in DSP blocks of iCE40 that are multipliers and nothing else. `synth_ice40 -dsp` would move registers and adders
/// into the blocks too, and no tool knows the delays of those: `icetime` takes such a block for the end of
/// every path into it.
const PURE_MULTIPLIERS: &str = "synth_ice40 -top {top} -run begin:coarse; opt; wreduce; peepopt; opt_clean; memory_dff; \
    wreduce t:$mul; techmap -map +/mul2dsp.v -map +/ice40/dsp_map.v -D DSP_A_MAXWIDTH=16 \
    -D DSP_B_MAXWIDTH=16 -D DSP_A_MINWIDTH=2 -D DSP_B_MINWIDTH=2 -D DSP_Y_MINWIDTH=11 -D DSP_NAME=$__MUL16X16; \
    select a:mul2dsp; setattr -unset mul2dsp; opt_expr -fine; wreduce; select -clear; \
    chtype -set $mul t:$__soft_mul; ";

/// The families that Glint's Verilog is meant for.
pub const FAMILIES: [Family; 3] = [
    Family {
        name: "ice40",
        title: "iCE40",
        library: "",
        prepare: PURE_MULTIPLIERS,
        command: "synth_ice40 -run coarse:",
        luts: &[("SB_LUT4", 1)],
        dsps: &[("SB_MAC16", 1)],
        block_rams: &[("SB_RAM40_4K", 1)],
        flip_flops: &[
            ("SB_DFF", 1),
            ("SB_DFFE", 1),
            ("SB_DFFSR", 1),
            ("SB_DFFSS", 1),
            ("SB_DFFESR", 1),
            ("SB_DFFESS", 1),
        ],
    },
    Family {
        name: "ecp5",
        title: "ECP5",
        library: "read_verilog -lib +/ecp5/cells_sim.v +/ecp5/cells_bb.v; ",
        prepare: "",
        command: "synth_ecp5",
        // 16 words of 4 bits are four tables, and two for what writes them.
        luts: &[("LUT4", 1), ("CCU2C", 2), ("TRELLIS_DPR16X4", 6)],
        dsps: &[("MULT18X18D", 1)],
        block_rams: &[("DP16KD", 1), ("PDPW16KD", 1)],
        flip_flops: &[("TRELLIS_FF", 1)],
    },
    Family {
        name: "xilinx7",
        title: "Xilinx 7",
        library: "",
        prepare: "",
        // Not -abc9: Yosys 0.23 crashes in it.
        command: "synth_xilinx -flatten",
        luts: &[("LUT1", 1), ("LUT2", 1), ("LUT3", 1), ("LUT4", 1), ("LUT5", 1), ("LUT6", 1)],
        dsps: &[("DSP48E1", 1)],
        block_rams: &[("RAMB18E1", 1), ("RAMB36E1", 2)],
        flip_flops: &[("FDRE", 1), ("FDSE", 1)],
    },
];

/// The resources that a design takes, before placement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    /// Look-up tables.
    pub luts: u64,
    /// DSP blocks.
    pub dsps: u64,
    /// Block RAMs.
    pub block_rams: u64,
    /// Flip-flops.
    pub flip_flops: u64,
}

impl Usage {
    /// Look-up tables, DSP blocks and block RAMs.
    pub fn taken(&self) -> [u64; 3] {
        [self.luts, self.dsps, self.block_rams]
    }
}

/// Synthesises the module `top` of Verilog and memory files, pairs of a plain name and contents.
///
/// # Errors
/// The files cannot be written; Yosys fails, or takes longer than `limit`; it does not say what the
/// design takes.
pub fn synthesise(
    yosys: &Tool,
    files: &[(String, String)],
    top: &str,
    family: &Family,
    limit: Duration,
) -> Result<Usage> {
    let sources = Sources::new(yosys, files, limit)?;
    sources.run(&format!("{}; {STATISTICS_COMMAND}", family.script(top)))?;
    usage(&sources, top, family)
        .with_context(|| format!("`{}` for {}", family.command, family.title))
}

/// The command of Yosys whose result [`usage`] reads.
pub const STATISTICS_COMMAND: &str = "tee -q -o statistics.json stat -json";

/// Reads what [`STATISTICS_COMMAND`] has written.
///
/// # Errors
/// It is not there, or does not tell the cells of the module `top`.
pub fn usage(sources: &Sources, top: &str, family: &Family) -> Result<Usage> {
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

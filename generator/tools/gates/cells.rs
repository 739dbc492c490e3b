//! Makes netlists of standard cells with Yosys, and the Verilog models of the cells.

use std::fs;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};

use super::super::sources::YosysSources;
use crate::Tool;

/// The library of Oklahoma State University for 0.18 µm, at the path in Debian's `qflow-tech-osu018`.
pub const LIBERTY: &str = "/usr/share/qflow/tech/osu018/osu018_stdcells.lib";

/// How Yosys maps to the cells of `cells.lib`, without the top module.
pub const MAPPING: &str =
    "dfflibmap -liberty cells.lib; abc -liberty cells.lib -constr cells.constr; opt_clean -purge";

/// The load of a port, in pF. That there are constraints makes Yosys buffer nets and size cells.
pub const LOAD: &str = "set_load 0.1 [all_outputs]\n";

/// The contents of the registers before the first clock. No output may depend on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// An unknown value.
    Unknown,
    /// 0.
    Zeros,
    /// 1.
    Ones,
}

impl Start {
    /// Returns the starts from which a bench must pass. A pipeline knows its state by the reset and the points alone,
    /// so that it may begin unknown. In gates around the registers of a microprogram, unknown values can stay that no
    /// circuit has.
    pub fn of(pipelined: bool) -> &'static [Self] {
        if pipelined { &[Self::Unknown] } else { &[Self::Zeros, Self::Ones] }
    }
}

/// Returns the flat netlist of the module `top` in cells of [`LIBERTY`], as Verilog. Its flip-flops, for example, are
/// instances of the cell `DFFPOSX1`.
///
/// # Errors
/// Fails if the library cannot be read, or if Yosys fails or takes longer than `limit`.
pub fn netlist(
    yosys: &Tool,
    files: &[(String, String)],
    top: &str,
    limit: Duration,
) -> Result<String> {
    const NETLIST: &str = "netlist.v";
    let mut files = files.to_vec();
    files.push(("cells.lib".to_owned(), read(Path::new(LIBERTY))?));
    files.push(("cells.constr".to_owned(), LOAD.to_owned()));
    let commands =
        format!("synth -flatten -top {top}; {MAPPING}; write_verilog -noattr -noexpr {NETLIST}");
    let sources = YosysSources::new(yosys, &files, limit)?;
    sources.run(&commands)?;
    sources.text(NETLIST)
}

/// Returns the models of the cells, without their delays and with a flip-flop that begins as `start` says. The
/// library's own flip-flop becomes unknown by the first value on its constant inputs.
///
/// # Errors
/// Fails if the models are not beside the library, or have no flip-flop.
pub fn models(start: Start) -> Result<Vec<(String, String)>> {
    let text = read(&Path::new(LIBERTY).with_extension("v"))?;
    let mut parts = text.split("   specify\n");
    let mut models = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        models += part.split_once("   endspecify\n").map_or("", |(_, rest)| rest);
    }
    let flip_flop = models.split_once("module DFFPOSX1 ");
    let (before, after) = flip_flop
        .and_then(|(before, rest)| Some((before, rest.split_once("endmodule\n")?.1)))
        .with_context(|| format!("the models beside `{LIBERTY}` have no DFFPOSX1"))?;
    let initial = match start {
        Start::Unknown => "",
        Start::Zeros => "initial Q = 1'b0;",
        Start::Ones => "initial Q = 1'b1;",
    };
    let own = format!(
        "module DFFPOSX1 (input CLK, input D, output reg Q);\n    {initial}\n    \
         always @(posedge CLK) Q <= D;\nendmodule\n"
    );
    Ok(vec![("cells_sim.v".to_owned(), format!("{before}{own}{after}"))])
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("cannot read `{}`", path.display()))
}

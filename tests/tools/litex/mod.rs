//! Tests the module for LiteX: LiteX builds systems with a core, and the Verilog of these systems computes the right results in
//! simulation.

use std::path::Path;

use crate::common::Sure;
use crate::common::cores::{Emitted, configuration_between, write};
use crate::common::files::{read, replaced, root};
use crate::common::tools::{LIMIT, benched, ran, tool};
use glint::tools::VerilogSimulator;
use rayon::prelude::*;

const PACKAGE: &str = "[package]\nmemories = \"inline\"\nlitex = true\n";

/// Returns the Verilog of a system and its bench, pairs of a plain name and its text.
fn system(name: &str, keys: &str, face: &str) -> Vec<(String, String)> {
    let keys = format!("{keys}{PACKAGE}");
    let core = configuration_between(&format!("configs/{name}.toml"), &keys);
    let dir = Emitted::new(&core, 1, 1).tree();
    let script = root().join("tests/tools/litex/system.py").display().to_string();
    let run = tool("python").run_to_success([&script, ".", name, face], dir.path(), LIMIT);
    run.sure_of(format_args!("{name}, {face}"));
    let sources = read(dir.path().join("sources.txt"));
    let file = |path: &Path| {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        (name, read(path))
    };
    let own = ["soc.v", "tb.v"].map(|name| dir.path().join(name));
    own.iter()
        .map(|path| file(path))
        .chain(sources.lines().map(|line| file(&dir.path().join(line))))
        .collect()
}

#[test]
fn litex_builds_systems_that_compute() {
    [
        ("threshold_levels", "", "core"),
        ("cosine_power", "registers = \"wishbone\"\n", "registers"),
        ("cosine_power", "registers = \"wishbone\"\n", "cpu"),
        ("cosine_power", "stream = true\n", "stream"),
        ("cosine_power_pipelined", "stream = true\n", "stream"),
    ]
    .into_par_iter()
    .for_each(|(name, keys, face)| {
        let files = system(name, keys, face);
        let outcome = benched(VerilogSimulator::Icarus, &files, "tb");
        assert!(outcome.passed, "{name}, {face}: {}", outcome.transcript);
        // Before it Icarus warns of the processor's memory, which the program does not fill.
        assert!(outcome.transcript.contains("PASS: 12 points"), "{}", outcome.transcript);
    });
}

/// Icarus never settles in the adapter from Wishbone to AXI4-Lite that LiteX writes.
#[test]
fn litex_reaches_registers_on_axi4_lite() {
    let files = system("threshold_levels", "registers = \"axi-lite\"\n", "registers");
    let dir = tempfile::tempdir().expect("a directory");
    write(dir.path(), &files);
    let options =
        ["--binary", "--timing", "-Wno-fatal", "-Wno-lint", "-Wno-style", "--top-module", "tb"];
    let names = files.iter().map(|(name, _)| name.as_str());
    ran("verilator", options.into_iter().chain(names), dir.path());
    let bench = dir.path().join("obj_dir/Vtb").display().to_string();
    let told = ran("env", [&bench], dir.path());
    assert!(told.starts_with("PASS: 12 points"), "{told}");
}

#[test]
fn a_faulty_core_is_noticed_in_litex() {
    let mut files = system("threshold_levels", "", "core");
    let datapath = files.iter_mut().find(|(name, _)| name == "threshold_levels_datapath.v");
    let (_, text) = datapath.expect("a datapath");
    *text = replaced(text, "assign red_out = ", "assign red_out = 1 ^ ");
    let outcome = benched(VerilogSimulator::Icarus, &files, "tb");
    assert!(!outcome.passed, "{}", outcome.transcript);
}

//! Faults in the text of wrappers: lint, a shipped bench or a proof notices all but those that change nothing.

use std::fs;
use std::path::Path;
use std::time::Duration;

use super::{BUSES, STREAM};
use crate::common::Sure;
use crate::common::cores::{Files, configuration_between, write};
use crate::common::sample::sampled;
use crate::common::tools::{LIMIT, tool, verilog_files};
use glint::mutate::{TextFault, VerilogText};
use glint::tools::{VerilogSimulator, lint, prove, run_bench};
use rayon::prelude::*;

/// Faults of each configuration that are planted by default.
const FAULTS: usize = 4;

/// A bench takes seconds; with a fault it may go round in no time for ever.
const PATIENCE: Duration = Duration::from_secs(120);

/// Faults that change nothing, or nothing that is promised, each with the reason.
const HARMLESS: &str = include_str!("harmless.txt");

#[test]
fn planted_faults_are_noticed() {
    let [(axi_lite, _), (wishbone, _)] = BUSES;
    for (name, keys) in [
        ("cosine_power", format!("{STREAM}{wishbone}")),
        ("lyon", axi_lite.to_owned()),
        ("cosine_power_pipelined", STREAM.to_owned()),
        ("quad_cosine", STREAM.to_owned()),
    ] {
        let core = configuration_between(&format!("configs/{name}.toml"), &keys);
        let text = VerilogText::of_wrappers(&core).sure_of(name);
        let is_harmless = |fault: &TextFault| {
            HARMLESS.lines().any(|line| line.split(' ').next() == Some(fault.id.as_str()))
        };
        let harmful = text.faults().into_iter().filter(|fault| !is_harmless(fault));
        let faults = sampled(name, harmful, FAULTS);
        assert!(!faults.is_empty(), "{name}: no faults");
        let missed: Vec<&str> = faults
            .par_iter()
            .filter(|fault| !is_noticed(name, &text.planted(fault)))
            .map(|fault| fault.id.as_str())
            .collect();
        assert!(missed.is_empty(), "{name}: nothing notices {missed:?}");
    }
}

/// Returns whether lint, a bench or a proof notices what is wrong with some files.
fn is_noticed(name: &str, files: &Files) -> bool {
    let dir = tempfile::tempdir().expect("a directory");
    let dir = dir.path();
    write(dir, files);
    let sources: Vec<String> =
        verilog_files(dir).into_iter().filter(|file| !file.ends_with("_tb.v")).collect();
    let tops = ["_axis", "_axil", "_wb"].map(|top| format!("{name}{top}"));
    let tops = || tops.iter().filter(|top| dir.join(format!("{top}.v")).exists());
    let simulated: Files =
        files.iter().filter(|(file, _)| !file.ends_with(".sv")).cloned().collect();
    let warns = |top: &String| {
        let told = lint(&tool("verilator"), dir, &sources, top, LIMIT);
        told.map_or(true, |told| !told.is_empty())
    };
    let fails = |top: &String| {
        let outcome =
            run_bench(VerilogSimulator::Icarus, &simulated, &format!("{top}_tb"), PATIENCE);
        !outcome.is_ok_and(|outcome| outcome.passed)
    };
    tops().any(warns)
        || tops().any(fails)
        || proofs(dir, name).any(|it| prove(dir, &it, LIMIT).is_err())
}

/// Returns the wrappers whose proofs are in a directory.
fn proofs(dir: &Path, core: &str) -> impl Iterator<Item = String> + use<> {
    let core = core.to_owned();
    let files = fs::read_dir(dir).expect("a directory");
    let names = files.map(|file| file.expect("a file").file_name().to_string_lossy().into_owned());
    let modules = names.filter_map(|file| Some(file.strip_suffix("_formal.sv")?.to_owned()));
    modules.filter(move |module| *module != core)
}

#[test]
fn benches_pass_without_a_fault() {
    let [(axi_lite, _), (wishbone, _)] = BUSES;
    for (name, keys) in [
        // Operands of more than 32 bits, and results that fill several registers, too.
        ("cosine_power", format!("{STREAM}{wishbone}")),
        ("rough", axi_lite.to_owned()),
        ("lyon", format!("stream = true\nuser_bits = 70\n{axi_lite}[operands]\nbuffered = true\n")),
        ("quadratic_pipelined", STREAM.to_owned()),
        ("quad_cosine", STREAM.to_owned()),
    ] {
        let core = configuration_between(&format!("configs/{name}.toml"), &keys);
        let text = VerilogText::of_wrappers(&core).sure_of(name);
        let files: Files =
            text.files().iter().filter(|(file, _)| !file.ends_with(".sv")).cloned().collect();
        for top in ["_axis", "_axil", "_wb"] {
            let top = format!("{name}{top}_tb");
            if files.iter().any(|(file, _)| *file == format!("{top}.v")) {
                for simulator in [VerilogSimulator::Icarus, VerilogSimulator::Verilator] {
                    crate::common::tools::assert_bench_passes(simulator, &files, &top);
                }
            }
        }
    }
}

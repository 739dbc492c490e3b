//! Tests faults in the text of wrappers: lint, a shipped bench or a proof notices each of them, except the faults listed as
//! harmless in `harmless.txt`. A run takes some of the faults.

use std::time::Duration;

use super::{BUSES, STREAM};
use crate::common::Sure;
use crate::common::cores::{Files, configuration_between};
use crate::common::files::put;
use crate::common::sample::{sampled_by_name, sampled_for};
use crate::common::tools::{LIMIT, tool};
use glint::mutate::{TextFault, VerilogText};
use glint::package::{FileKind, OutputFile};
use glint::tools::{VerilogSimulator, lint, prove, run_bench};
use rayon::prelude::*;

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
        ("cosine_power_pipelined", format!("{STREAM}{wishbone}")),
        ("quad_cosine", STREAM.to_owned()),
    ] {
        let core = configuration_between(&format!("configs/{name}.toml"), &keys);
        let text = VerilogText::of_wrappers(&core).sure_of(name);
        let is_harmless = |fault: &TextFault| {
            HARMLESS.lines().any(|line| line.split(' ').next() == Some(fault.id.as_str()))
        };
        let harmful = text.faults().into_iter().filter(|fault| !is_harmless(fault));
        let faults = sampled_for(name, "faults of wrappers", harmful);
        assert!(!faults.is_empty(), "{name}: no faults");
        let missed: Vec<&str> = faults
            .par_iter()
            .filter(|fault| !is_noticed(&text.planted(fault)))
            .map(|fault| fault.id.as_str())
            .collect();
        assert!(missed.is_empty(), "{name}: nothing notices {missed:?}");
    }
}

/// Returns whether lint, a bench or a proof notices what is wrong with some files.
fn is_noticed(files: &[OutputFile]) -> bool {
    let dir = tempfile::tempdir().expect("a directory");
    let dir = dir.path();
    for file in files {
        put(dir.join(file.name()), &file.contents);
    }
    let simulated = simulated(files);
    let mut sources = Vec::new();
    for file in files {
        if file.kind.is_verilog() && file.kind != FileKind::Bench {
            sources.push(file.name().to_owned());
        }
    }
    let warns = |top: &&str| {
        let told = lint(&tool("verilator"), dir, &sources, top, LIMIT);
        told.map_or(true, |told| !told.is_empty())
    };
    let fails = |bench: &&str| {
        let outcome = run_bench(VerilogSimulator::Icarus, &simulated, bench, PATIENCE);
        !outcome.is_ok_and(|outcome| outcome.passed)
    };
    let is_broken = |file: &OutputFile| {
        file.kind == FileKind::WrapperProof && prove(dir, file.name(), LIMIT).is_err()
    };
    wrappers(files).iter().any(warns)
        || wrapper_benches(files).iter().any(fails)
        || files.iter().any(is_broken)
}

/// Returns the files that a simulator reads, pairs of a plain name and its text.
fn simulated(files: &[OutputFile]) -> Files {
    let mut simulated = Files::new();
    for file in files {
        if FileKind::SIMULATED.contains(&file.kind) {
            let (name, text) = file.source();
            simulated.push((name.to_owned(), text.to_owned()));
        }
    }
    simulated
}

/// Returns the main module of each wrapper.
fn wrappers(files: &[OutputFile]) -> Vec<&str> {
    let mut tops = Vec::new();
    for kind in [FileKind::StreamWrapper, FileKind::BusWrapper] {
        tops.extend(files.iter().find(|file| file.kind == kind).map(OutputFile::main_module));
    }
    tops
}

/// Returns the modules of the benches of wrappers. The bench of the core comes before them.
fn wrapper_benches(files: &[OutputFile]) -> Vec<&str> {
    let benches = files.iter().filter(|file| file.kind == FileKind::Bench);
    benches.map(OutputFile::main_module).skip(1).collect()
}

#[test]
fn benches_pass_without_a_fault() {
    let [(axi_lite, _), (wishbone, _)] = BUSES;
    let cores = [
        // Operands of more than 32 bits, and results that fill several registers, too.
        ("cosine_power", format!("{STREAM}{wishbone}")),
        ("rough", axi_lite.to_owned()),
        ("lyon", format!("stream = true\nuser_bits = 70\n{axi_lite}[operands]\nbuffered = true\n")),
        ("quadratic_pipelined", format!("{STREAM}{axi_lite}")),
        ("quad_cosine", STREAM.to_owned()),
    ];
    let name_of = |(name, _): &(&str, String)| (*name).to_owned();
    for (name, keys) in sampled_by_name("benches of wrappers", cores, name_of) {
        let core = configuration_between(&format!("configs/{name}.toml"), &keys);
        let text = VerilogText::of_wrappers(&core).sure_of(name);
        let files = simulated(text.files());
        for bench in wrapper_benches(text.files()) {
            for simulator in [VerilogSimulator::Icarus, VerilogSimulator::Verilator] {
                crate::common::tools::assert_bench_passes(simulator, &files, bench);
            }
        }
    }
}

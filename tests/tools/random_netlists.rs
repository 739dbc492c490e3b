//! Tests the emitted Verilog of random netlists against an interpreter, which is written from the documentation of
//! [`glint::hdl::netlist::Op`].
//!
//! The devices of the catalogue use only a few of the possible combinations of cells. Random netlists combine cells, signs and
//! widths of up to 20 bits at random. Icarus Verilog simulates the text, and both linters must be silent.

use crate::common::cores::Emitted;
use crate::common::random_netlist::{Random, SMALL, design};
use crate::common::tools::{assert_bench_passes, assert_files_are_clean};
use glint::hdl::netlist::{Design, Interpreter, Role};
use glint::package::{EmitInputs, FileKind, OutputFile, Vectors, emit};
use glint::tools::VerilogSimulator;

const DESIGNS: u64 = 60;
const CLOCKS: usize = 120;

/// By then every register has been reset or has taken something known.
const KNOWN_FROM: usize = 40;

#[test]
fn emitted_verilog_means_what_the_netlist_means() {
    for seed in 0..DESIGNS {
        let design = design(seed, SMALL);
        let inputs = EmitInputs {
            regenerate: "glint generate random.toml".to_owned(),
            vectors: Some(vectors(&design, seed)),
            ..EmitInputs::default()
        };
        let files = emit(&design, &inputs).unwrap_or_else(|error| panic!("{error:?}\n{design}"));
        files.iter().for_each(check_text);
        let emitted = Emitted { files, name: design.name };
        assert_files_are_clean(&emitted.rtl(), &emitted.name);
        assert_bench_passes(VerilogSimulator::Icarus, &emitted.simulated(), &emitted.bench());
    }
}

fn check_text(file: &OutputFile) {
    let (name, text) = file.source();
    assert!(text.ends_with('\n'), "{name} ends without a newline");
    if file.kind == FileKind::Manifest {
        return;
    }
    assert!(text.is_ascii(), "{name} is not ASCII");
    for line in text.lines() {
        assert!(line.len() <= 100 || file.kind == FileKind::BenchVectors, "{name}: {line}");
        assert_eq!(line, line.trim_end(), "{name}");
    }
}

fn vectors(design: &Design, seed: u64) -> Vectors {
    let mut random = Random::new(!seed);
    let mut interpreter = Interpreter::new(design).expect("no loop");
    let mut vectors = Vectors { known_from: KNOWN_FROM, ..Vectors::default() };
    for clock in 0..CLOCKS {
        let row: Vec<u64> = design
            .inputs()
            .map(|port| match port.role {
                Role::Reset => u64::from(clock >= 4 && clock % 50 != 0),
                _ => random.bits(design.width(port.net)),
            })
            .collect();
        interpreter.settle(&row);
        let outputs = design.outputs().map(|port| interpreter.value(port.net));
        vectors.expected.push(outputs.collect());
        vectors.inputs.push(row);
        interpreter.edge();
    }
    vectors
}

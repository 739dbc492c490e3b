//! The system of `examples/soc`: its pictures are those of `glint render`, the cores are worth their place, and the span engine is
//! proved.

use std::fs;
use std::path::Path;
use std::time::Duration;

use anyhow::Result;
use glint::tools::prove;
use rayon::prelude::*;

use crate::common::tools::{LIMIT, tool};
use crate::faults::faults;

/// Verilator builds a processor, and simulates 132 million clocks of it: more than other tools need.
const RUN_LIMIT: Duration = Duration::from_secs(900);

#[test]
fn a_processor_renders_through_its_cores() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dir = tempfile::tempdir().expect("a directory");
    let glint = format!("GLINT={}", env!("CARGO_BIN_EXE_glint"));
    let script = root.join("examples/soc/run");
    let arguments = [glint.as_ref(), script.as_os_str(), dir.path().as_os_str()];
    let output = tool("env")
        .run_to_success(arguments, root, RUN_LIMIT)
        .unwrap_or_else(|error| panic!("{error:#}"));
    for core in ["shade", "grain"] {
        let equal = format!("{core}: the pictures are equal, 6912 bytes");
        assert!(output.contains(&equal), "{output}");
    }
    // Clocks are counted in simulation, so that they are the same on every machine.
    let fewer = output.lines().filter(|line| line.trim().starts_with("span engine:"));
    let times: Vec<f64> = fewer
        .map(|line| {
            let word = line.split_whitespace().rev().nth(3).expect("a ratio");
            word.parse().expect("a number")
        })
        .collect();
    assert_eq!(times.len(), 3, "{output}");
    assert!(times.iter().all(|&times| times >= 6.0), "{output}");
}

#[test]
fn the_span_engine_is_proved() {
    for words in [1, 2] {
        proof(words, |engine| engine).unwrap_or_else(|error| panic!("{words} words: {error:#}"));
    }
}

#[test]
fn faults_of_the_span_engine_break_its_proof() {
    faults("span engine").par_iter().for_each(|fault| {
        let proof = proof(2, |engine| fault.in_text(&engine));
        assert!(proof.is_err(), "`{}` in span.v is proved", fault.wrong);
    });
}

/// Proves the engine for so many words of operands a pixel, with what is made of its Verilog.
fn proof(words: u32, change: impl Fn(String) -> String) -> Result<()> {
    let soc = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/soc");
    let dir = tempfile::tempdir()?;
    let read = |name: &str| fs::read_to_string(soc.join(name)).expect("a file");
    let problem = read("span_formal.sv")
        .replace("parameter WORDS = 1", &format!("parameter WORDS = {words}"));
    fs::write(dir.path().join("span_formal.sv"), problem)?;
    fs::write(dir.path().join("span_formal.ys"), read("span_formal.ys"))?;
    fs::write(dir.path().join("span.v"), change(read("span.v")))?;
    prove(dir.path(), "span", LIMIT)
}

//! Tests the system of `examples/soc`: its pictures equal the pictures of `glint render`, the span engine makes it at least six
//! times as fast, and 20 times where a core computes colours from normals, the processor computes functions by instructions, and the proof of the span engine holds and notices faults.

use std::path::Path;

use anyhow::Result;
use glint::tools::prove;
use rayon::prelude::*;

use crate::common::Sure;
use crate::common::files::{put, read};
use crate::common::tools::{LIMIT, example};
use crate::faults::faults;

#[test]
fn a_processor_renders_through_its_cores() {
    let dir = tempfile::tempdir().expect("a directory");
    let output = example("soc/run", &[dir.path().as_os_str()]);
    for core in ["shade", "grain", "lit"] {
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
    let [highlights @ .., lit] = times.as_slice() else { panic!("no ratios: {output}") };
    assert_eq!(highlights.len(), 3, "{output}");
    assert!(highlights.iter().all(|&times| times >= 6.0), "{output}");
    assert!(*lit >= 20.0, "{output}");
    for (function, least) in [("rcp", 1.4), ("rsqrt", 5.0), ("atan2", 6.0)] {
        let line = output.lines().find(|line| line.starts_with(&format!("{function}, 100 values")));
        let line = line.unwrap_or_else(|| panic!("no {function}: {output}"));
        let (_, ratio) = line.split_once("C by hand ").expect("C by hand");
        let ratio = ratio.split([',', ' ']).nth(2).expect("a ratio");
        assert!(ratio.parse::<f64>().expect("a number") >= least, "{line}");
    }
}

#[test]
fn the_span_engine_is_proved() {
    for words in [1, 2] {
        proof(words, |engine| engine).sure_of(format_args!("{words} words"));
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
    let dir = tempfile::tempdir()?;
    let read = |name: &str| read(Path::new("examples/soc").join(name));
    let problem = read("span_formal.sv")
        .replace("parameter WORDS = 1", &format!("parameter WORDS = {words}"));
    put(dir.path().join("span_formal.sv"), problem);
    put(dir.path().join("span_formal.ys"), read("span_formal.ys"));
    put(dir.path().join("span.v"), change(read("span.v")));
    prove(dir.path(), "span_formal.sv", LIMIT)
}

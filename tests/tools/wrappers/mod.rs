//! Wrappers around cores: clean Verilog, proved, and with the bus models of others.

use std::fs;
use std::path::Path;

use crate::common::tools::{LIMIT, assert_lint_clean, tool};
use crate::common::units::{Emitted, all_configurations, configuration_between, write};
use glint::core::Unit;
use glint::tools::prove;
use rayon::prelude::*;

/// Bits of tuser in these tests.
const STREAM: &str = "stream = true\nuser_bits = 9\n";

/// Configurations of which the wrapper is proved: a core of each kind that a wrapper knows.
const PROVED: [&str; 3] = ["cosine_power", "quad_cosine", "cosine_power_pipelined"];

/// Every configuration with these keys in its table `interface`.
fn with_interface(keys: &str) -> Vec<(String, Unit)> {
    let with = |(path, _): (String, Unit)| {
        let unit = configuration_between(&path, keys);
        (path, unit)
    };
    all_configurations().into_iter().map(with).collect()
}

#[test]
fn streams_are_clean_verilog() {
    with_interface(STREAM).par_iter().for_each(|(path, unit)| {
        let emitted = Emitted::new(unit, 1, 1);
        let place = tempfile::tempdir().expect("a directory");
        write(place.path(), &emitted.rtl());
        assert_lint_clean(place.path(), &format!("{}_axis", emitted.name));
        for file in emitted.files.iter().filter(|file| file.path.contains("_axis")) {
            let long = file.contents.lines().find(|line| line.len() > 100);
            assert_eq!(long, None, "{path}: {}", file.path);
        }
    });
}

#[test]
fn streams_are_proved() {
    PROVED.par_iter().for_each(|name| {
        let place = proof(name);
        prove(place.path(), &format!("{name}_axis"), LIMIT)
            .unwrap_or_else(|error| panic!("{name}: {error:#}"));
    });
}

/// A fault: of which configuration, what stands in the wrapper, and what stands there instead.
type Fault = (&'static str, &'static str, &'static str);

const FAULTS: [Fault; 16] = [
    // Taken without room, begun twice, never begun.
    ("cosine_power", "s_axis_tready <= ~still_waiting;", "s_axis_tready <= 1'b1;"),
    ("cosine_power", "waiting <= still_waiting;", "waiting <= accept | waiting;"),
    ("cosine_power", "wire start = waiting & ~busy & room;", "wire start = waiting & room;"),
    ("cosine_power", "assign room = ~held;", "assign room = 1'b1;"),
    // Offers that change, that vanish, and that overtake.
    ("cosine_power", "wire offer = m_axis_tready | ~m_axis_tvalid;", "wire offer = 1'b1;"),
    ("cosine_power", "m_axis_tvalid <= held | valid;", "m_axis_tvalid <= valid;"),
    ("cosine_power", "held ? held_results : results;", "results;"),
    // A side channel of another point, and one of a packet.
    ("cosine_power", "held ? held_user : user;", "user;"),
    ("cosine_power", "last <= operands_last;", "last <= s_axis_tlast;"),
    // Lines: one that has no room, points over others, a last point that is not.
    (
        "quad_cosine",
        "assign room = free > {1'b0, length};",
        "assign room = free >= {1'b0, length};",
    ),
    ("quad_cosine", "wire last = following == next_line;", "wire last = write_at == next_line;"),
    ("quad_cosine", "if (read) read_at <=", "if (offer) read_at <="),
    // Pipelines.
    ("cosine_power_pipelined", "wire ready = ~held;", "wire ready = m_axis_tready;"),
    (
        "cosine_power_pipelined",
        "if (!held) begin\n            held_results",
        "if (valid) begin\n            held_results",
    ),
    (
        "cosine_power_pipelined",
        "if (s_axis_tready) begin\n            side",
        "if (1'b1) begin\n            side",
    ),
    (
        "cosine_power_pipelined",
        ".in_valid(s_axis_tvalid)",
        ".in_valid(s_axis_tvalid & m_axis_tready)",
    ),
];

#[test]
fn faults_break_the_proofs() {
    FAULTS.par_iter().for_each(|(name, right, wrong)| {
        let place = proof(name);
        let path = place.path().join(format!("{name}_axis.v"));
        let text = fs::read_to_string(&path).expect("a file");
        assert!(text.contains(right), "`{right}` is not in {name}_axis.v");
        fs::write(&path, text.replace(right, wrong)).expect("written");
        let proof = prove(place.path(), &format!("{name}_axis"), LIMIT);
        assert!(proof.is_err(), "`{wrong}` in {name}_axis.v is proved");
    });
}

/// The wrapper of a configuration, and what is proved of it, in a directory of their own.
fn proof(name: &str) -> tempfile::TempDir {
    let unit = configuration_between(&format!("configs/{name}.toml"), STREAM);
    let place = tempfile::tempdir().expect("a directory");
    for file in Emitted::new(&unit, 1, 1).files {
        fs::write(place.path().join(file.name()), &file.contents).expect("written");
    }
    place
}

/// Source and sink of cocotbext-axi.
#[test]
fn streams_carry_every_point() {
    with_interface(STREAM).par_iter().for_each(|(path, unit)| {
        let place = emitted(unit);
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/tools/wrappers/stream.py");
        let run = tool("python").run([script, &unit.config.name], place.path(), LIMIT);
        let run = run.unwrap_or_else(|error| panic!("{error:#}"));
        let says = format!("PASS {}: 6 tests, 0 failed", unit.config.name);
        assert!(run.status.success() && run.output.contains(&says), "{path}:\n{}", run.output);
    });
}

/// The files of a configuration below a directory of their own.
fn emitted(unit: &Unit) -> tempfile::TempDir {
    let place = tempfile::tempdir().expect("a directory");
    for file in Emitted::new(unit, 1, 1).files {
        let path: &Path = &place.path().join(&file.path);
        fs::create_dir_all(path.parent().expect("a directory")).expect("a directory");
        fs::write(path, &file.contents).expect("written");
    }
    place
}

//! The benches in Python: every one passes, and each of their tests notices a fault.
//!
//! cocotb 2.1 refuses Verilator 5.006, so that they run under Icarus Verilog.

use std::fs;
use std::path::Path;

use crate::common::bench::with_flipped_bit;
use crate::common::cores::{Emitted, all_configurations, configuration, configuration_with};
use crate::common::tools::{LIMIT, tool};
use glint::core::Core;
use glint::package;
use glint::tools::Run;
use rayon::prelude::*;

const EXACT: &str = "computations_are_exact";
const IGNORED: &str = "writes_and_starts_while_busy_are_ignored";
const AHEAD: &str = "writes_while_busy_are_for_the_next_computation";
const HELD: &str = "held_start_repeats";
const RESET: &str = "reset_ends_a_computation";
const FORMULA: &str = "formula_holds_at_random_points";

/// The tests of a pipeline.
const POINTS: &str = "points_are_exact";
const STALLS: &str = "bubbles_and_stalls_change_nothing";
const DROPS: &str = "reset_drops_every_point";
const FOLLOWS: &str = "random_points_follow_the_formula";

const OF_SEQUENTIAL: [&str; 6] = [EXACT, IGNORED, HELD, RESET, FORMULA, "worked_example"];
const OF_BUFFERED: [&str; 6] = [EXACT, AHEAD, HELD, RESET, FORMULA, "worked_example"];
const OF_PIPELINE: [&str; 5] = [POINTS, STALLS, DROPS, FOLLOWS, "worked_example"];

/// Its tests.
fn tests(core: &Core) -> &'static [&'static str] {
    match &core.design {
        design if design.pipeline.is_some() => &OF_PIPELINE,
        design if design.control.overlaps => &OF_BUFFERED,
        _ => &OF_SEQUENTIAL,
    }
}

#[test]
fn every_bench_passes() {
    all_configurations().par_iter().for_each(|(path, core)| assert_passes(path, core));
}

#[test]
fn benches_of_pipelines_with_and_without_stalls_and_a_side_channel_pass() {
    for more in ["side = 64\n", "stall = \"none\"\n", "stall = \"none\"\nside = 1\n"] {
        let core = configuration_with("configs/schlick_pipelined.toml", more);
        assert_passes(more, &core);
    }
}

/// A line of one point, which has fewer clocks than operands, writes the rest in the clock of `done`.
#[test]
fn a_bench_of_a_line_with_buffers_passes() {
    let core = configuration_with("configs/quad_cosine.toml", "\n[operands]\nbuffered = true\n");
    assert_passes("a line", &core);
}

fn assert_passes(what: &str, core: &Core) {
    let place = place(core);
    let run = run(place.path(), &core.config.name);
    let passed = |test: &&str| run.output.contains(&format!("{test} passed"));
    let tests = tests(core);
    let says = format!("PASS {}: {} tests, 0 failed", core.config.name, tests.len());
    assert!(
        run.status.success() && tests.iter().all(passed) && run.output.contains(&says),
        "{what}:\n{}",
        run.output
    );
}

/// A fault: in which file of which configuration, what stands there, what stands there instead, and a test
/// that notices.
type Fault = (&'static str, &'static str, &'static str, &'static str, &'static str);

const FAULTS: [Fault; 20] = [
    // The handshake: late, early, forgotten.
    (
        "rough",
        "_control.v",
        "assign valid = valid_word;",
        "reg late; always @(posedge clk) late <= valid_word; assign valid = late;",
        EXACT,
    ),
    ("rough", "_control.v", "done = run &", "done = valid_word & run &", EXACT),
    ("rough", "_control.v", "assign busy = run;", "assign busy = run & ~done;", HELD),
    ("rough", "_control.v", "run ? go_on : start", "go_on | start", IGNORED),
    ("rough", "_control.v", "run <= 1'b0;", "run <= run;", RESET),
    ("schlick", "_control.v", "word_address <= 2'd0;", "word_address <= word_address;", RESET),
    // Operands that are taken while busy.
    ("rough", "_datapath.v", "exponent_write & idle", "exponent_write", IGNORED),
    ("quad_cosine", "_datapath.v", "length_write & idle", "length_write", IGNORED),
    // Loops that end a turn early or late.
    ("lyon", "_datapath.v", "more_shifts = |remaining;", "more_shifts = remaining > 4'd1;", EXACT),
    ("quad_cosine", "_datapath.v", "more = intervals > 12'd1;", "more = |intervals;", EXACT),
    ("quad_cosine", "_control.v", "valid_in_1 <= angle_load;", "valid_in_1 <= run;", HELD),
    // A manifest that says something else than the core does.
    ("rough", ".json", "\"start_to_done\": 10", "\"start_to_done\": 11", EXACT),
    ("rough", ".json", "max(exponent / 2", "max(exponent / 3", FORMULA),
    ("threshold", ".json", "levels[int(exponent)]", "0.25 + levels[int(exponent)]", FORMULA),
    // A pipeline: results that come late, or change while they wait; points that stay after a reset.
    ("cosine_power_pipelined", ".json", "\"latency\": ", "\"latency\": 1", POINTS),
    (
        "cosine_power_pipelined",
        ".v",
        "advance = out_ready | ~",
        "advance = out_ready | ~valid_s2 | ~",
        STALLS,
    ),
    (
        "cosine_power_pipelined",
        ".v",
        "assign red_out = ",
        "assign red_out = {8{out_ready}} & ",
        STALLS,
    ),
    ("cosine_power_pipelined", ".v", "valid_s4 <= 1'b0;", "valid_s4 <= valid_s3;", DROPS),
    ("threshold_pipelined", ".v", "green_out = green_", "green_out = 8'd1 ^ green_", POINTS),
    ("cosine_power_pipelined", ".json", "max(exponent / 16", "max(exponent / 15", FOLLOWS),
];

#[test]
fn every_test_notices_a_fault() {
    FAULTS.par_iter().for_each(|(name, file, right, wrong, test)| {
        let core = configuration(&format!("configs/{name}.toml"));
        let place = place(&core);
        let path = place.path().join(format!("rtl_out/{name}/{name}{file}"));
        let text = fs::read_to_string(&path).expect("a file");
        assert!(text.contains(right), "`{right}` is not in {name}{file}");
        fs::write(&path, text.replace(right, wrong)).expect("written");
        assert_noticed(place.path(), &core, test, &format!("`{wrong}` in {file}"));
    });
}

/// A bit of a word that is read often; a seldom read one is for the co-simulation to find.
#[test]
fn wrong_memories_are_noticed() {
    let faults = [
        ("rough", "control", 5, 2),
        ("quad_cosine", "root", 236, 9),
        ("quadratic", "coefficient", 1, 17),
        ("threshold", "levels", 1, 15),
    ];
    faults.par_iter().for_each(|&(name, rom, word, bit)| {
        let wrong = |text: &str| with_flipped_bit(text, word, bit);
        memory_is_noticed(name, rom, wrong);
    });
}

#[test]
fn wrong_order_of_words_is_noticed() {
    [3, 5, 8].into_par_iter().for_each(|word| {
        memory_is_noticed("rough", "control", |text| {
            let mut lines: Vec<&str> = text.lines().collect();
            let first = lines.iter().position(|line| !line.starts_with("//"));
            let first = first.expect("words") + word;
            lines.swap(first, first + 1);
            lines.join("\n")
        });
    });
}

fn memory_is_noticed(name: &str, rom: &str, wrong: impl Fn(&str) -> String) {
    let core = configuration(&format!("configs/{name}.toml"));
    let place = place(&core);
    let file = format!("rtl_out/{name}/{name}_{rom}.mem");
    let text = fs::read_to_string(place.path().join(&file)).expect("a memory");
    fs::write(place.path().join(&file), wrong(&text)).expect("written");
    assert_noticed(place.path(), &core, EXACT, &file);
}

/// The files of a configuration where the bench expects them.
fn place(core: &Core) -> tempfile::TempDir {
    let place = tempfile::tempdir().expect("a directory");
    let emitted = Emitted::new(core, 1, 1);
    for file in emitted.files.iter().chain([&package::driver()]) {
        let path = place.path().join(&file.path);
        fs::create_dir_all(path.parent().expect("a directory")).expect("a directory");
        fs::write(path, &file.contents).expect("written");
    }
    place
}

/// Runs the command that the head of the bench gives.
fn run(place: &Path, name: &str) -> Run {
    let bench = format!("testbench/{name}/test_{name}.py");
    let text = fs::read_to_string(place.join(&bench)).expect("a bench");
    assert!(text.contains(&format!("    $ python {bench}\n")), "{text}");
    tool("python").run([bench], place, LIMIT).unwrap_or_else(|error| panic!("{error:#}"))
}

fn assert_noticed(place: &Path, core: &Core, test: &str, what: &str) {
    let (name, count) = (&core.config.name, tests(core).len());
    let run = run(place, name);
    let says = |word: &str| run.output.lines().any(|line| line.starts_with(word));
    assert!(
        !run.status.success()
            && says(&format!("FAIL {name}: {count} tests"))
            && !says("PASS")
            && run.output.contains(&format!("{test} failed")),
        "{test} does not notice {what} in {name}:\n{}",
        run.output
    );
}

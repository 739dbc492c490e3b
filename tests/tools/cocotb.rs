//! Tests the emitted benches in Python: the benches pass, and a planted fault fails the test that must notice it.
//!
//! A default run draws five configurations and eight faults. The benches run under Icarus Verilog only, because cocotb 2.1
//! refuses Verilator 5.006.

use std::path::Path;

use crate::common::Sure;
use crate::common::bench::with_flipped_bit;
use crate::common::cores::{Emitted, all_configurations, configuration, configuration_with};
use crate::common::files::{put, read};
use crate::common::sample::{sampled, sampled_by_name};
use crate::common::tools::{LIMIT, tool};
use crate::faults::faults;
use glint::core::Core;
use glint::tools::Run;
use rayon::prelude::*;

const OF_SEQUENTIAL: &str = "computations_are_exact writes_and_starts_while_busy_are_ignored held_start_repeats \
    reset_ends_a_computation formula_holds_at_random_points worked_example";

const OF_BUFFERED: &str = "computations_are_exact writes_while_busy_are_for_the_next_computation held_start_repeats \
    reset_ends_a_computation formula_holds_at_random_points worked_example";

const OF_PIPELINE: &str = "points_are_exact bubbles_and_stalls_change_nothing reset_drops_every_point \
    random_points_follow_the_formula worked_example";

/// Returns its tests.
fn tests(core: &Core) -> Vec<&'static str> {
    let tests = match &core.design {
        design if design.pipeline.is_some() => OF_PIPELINE,
        design if design.control.overlaps => OF_BUFFERED,
        _ => OF_SEQUENTIAL,
    };
    tests.split(' ').collect()
}

#[test]
fn every_bench_passes() {
    let some = sampled_by_name("benches in Python", all_configurations(), |(path, _)| path.clone());
    some.par_iter().for_each(|(path, core)| assert_passes(path, core));
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
    let dir = dir(core);
    let run = run(dir.path(), &core.config().name, &core.config().name);
    let passed = |test: &&str| run.output.contains(&format!("{test} passed"));
    let tests = tests(core);
    let says = format!("PASS {}: {} tests, 0 failed", core.config().name, tests.len());
    assert!(
        run.status.success() && tests.iter().all(passed) && run.output.contains(&says),
        "{what}:\n{}",
        run.output
    );
}

#[test]
fn every_test_notices_a_fault() {
    sampled("faults for benches in Python", faults("benches in Python")).par_iter().for_each(
        |fault| {
            let parts: Vec<&str> = fault.of.split(' ').collect();
            let [name, file, test] = parts[..] else { panic!("{}", fault.of) };
            let core = configuration(&format!("configs/{name}.toml"));
            let dir = dir(&core);
            fault.plant(&dir.path().join(format!("rtl_out/{name}/{name}{file}")));
            assert_noticed(dir.path(), &core, test, &format!("`{}` in {file}", fault.wrong));
        },
    );
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
    let dir = dir(&core);
    let file = format!("rtl_out/{name}/{name}_{rom}.mem");
    let path = dir.path().join(&file);
    put(&path, wrong(&read(&path)));
    assert_noticed(dir.path(), &core, "computations_are_exact", &file);
}

/// Benches of wrappers run by the commands that their heads give.
#[test]
fn benches_of_wrappers_pass() {
    let wrappers = [
        ("cosine_power", "axis"),
        ("cosine_power", "wb"),
        ("threshold_levels", "axil"),
        ("quad_cosine", "axis"),
        ("cosine_power_pipelined", "axis"),
    ];
    wrappers.par_iter().for_each(|&(name, wrapper)| {
        let core = configuration(&format!("configs/{name}.toml"));
        let emitted = Emitted::new(&core, 20, 1);
        let run = run(emitted.tree().path(), &format!("{name}_{wrapper}"), name);
        let passed = format!("PASS {name}_{wrapper}: ");
        assert!(run.status.success() && run.output.contains(&passed), "{}", run.output);
    });
}

/// Returns the files of a configuration where the bench expects them.
fn dir(core: &Core) -> tempfile::TempDir {
    Emitted::new(core, 1, 1).tree()
}

/// Runs the command that the head of the bench of a module gives, in the directory of its core.
fn run(dir: &Path, module: &str, name: &str) -> Run {
    let bench = format!("testbench/{name}/test_{module}.py");
    let text = read(dir.join(&bench));
    assert!(text.contains(&format!("    $ python {bench}\n")), "{text}");
    tool("python").run([bench], dir, LIMIT).sure()
}

fn assert_noticed(dir: &Path, core: &Core, test: &str, what: &str) {
    let (name, count) = (&core.config().name, tests(core).len());
    let run = run(dir, name, name);
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

//! Tests the emitted bench of a small device under Icarus Verilog and Verilator: it passes with right vectors, and fails with a
//! wrong expected output.
//!
//! The bench must print the clock, the microinstruction and the output that differs.

use crate::common::Sure;
use crate::common::tools::{LIMIT, benched};
use glint::dsl::{Designer, end, step, valid};
use glint::fixed::{Format, Overflow, Rounding};
use glint::hdl::netlist::Design;
use glint::package::{EmitInputs, FileKind, Vectors, emit};
use glint::tools::{BenchDifference, BenchOutcome, VerilogSimulator, bench_waveform};

/// y = x², of an operand of four bits, to four bits.
fn squarer() -> Design {
    let d = Designer::new("squarer");
    let x = d.operand("x", Format::unsigned(0, 4));
    let square = d.mul("square", x.q(), x.q());
    let y = d.register("y", Format::unsigned(0, 4));
    y.takes(d.narrow("y_rounded", square, y.format(), Rounding::Truncate, Overflow::Saturate));
    d.output("y_out", y.q());
    d.microprogram([
        step("idle 100%", []),
        step("say \"square\"", [y.load()]),
        step("result", [valid(), end()]),
    ]);
    d.finish().sure()
}

/// Returns a reset, one point with x = 12/16, and what comes of it: floor(144/16) = 9.
fn vectors() -> Vectors {
    // Inputs rst_n, start, x, x_write; outputs valid, busy, done, y_out.
    let clocks = [
        ([0, 0, 0, 0], [0, 0, 0, 0]),
        ([1, 1, 12, 1], [0, 0, 0, 0]),
        ([1, 0, 0, 0], [0, 1, 0, 0]),
        ([1, 0, 0, 0], [0, 1, 0, 0]),
        ([1, 0, 0, 0], [1, 1, 1, 9]),
        ([1, 0, 0, 0], [0, 0, 0, 9]),
    ];
    Vectors {
        inputs: clocks.iter().map(|(inputs, _)| inputs.to_vec()).collect(),
        expected: clocks.iter().map(|(_, outputs)| outputs.to_vec()).collect(),
        known_from: 4,
        word_stride: 0,
    }
}

fn files(vectors: Vectors) -> Vec<(String, String)> {
    let inputs = EmitInputs { vectors: Some(vectors), ..EmitInputs::default() };
    emit(&squarer(), &inputs).sure().sources(FileKind::SIMULATED)
}

fn run(simulator: VerilogSimulator, vectors: Vectors) -> BenchOutcome {
    benched(simulator, &files(vectors), "squarer_tb")
}

#[test]
fn the_clocks_before_a_difference_can_be_seen_in_both_simulators() {
    let mut wrong = vectors();
    wrong.expected[5][3] ^= 1;
    // Clock 3 begins at 30 units of time, clock 5 ends at 60; a unit is 1 s in Icarus, 1 ns in Verilator.
    for (simulator, unit) in [(VerilogSimulator::Icarus, 1), (VerilogSimulator::Verilator, 1000)] {
        let transcript = run(simulator, wrong.clone()).transcript;
        let found = BenchDifference::first(&transcript).expect("a difference");
        assert_eq!((found.clock, found.during.as_str()), (5, "microinstruction `idle 100%`"));
        let values = (found.signal.as_str(), found.simulated.as_str(), found.expected.as_str());
        assert_eq!(values, ("y_out", "9", "8"));
        let files = files(wrong.clone());
        let waveform = bench_waveform(simulator, &files, "squarer_tb", (3, 5), LIMIT).sure();
        let text = String::from_utf8(waveform).expect("a VCD is text");
        assert!(text.contains(" y_out "), "{simulator}:\n{text}");
        let times = text.lines().filter_map(|line| line.strip_prefix('#')?.parse::<u64>().ok());
        let times: Vec<u64> = times.collect();
        let inside = |time: &u64| (30 * unit..=60 * unit).contains(time);
        let all = times.len() > 2 && times.iter().all(inside);
        assert!(all, "{simulator}: {times:?}");
    }
}

#[test]
fn true_vectors_pass_and_every_wrong_output_fails_in_both_simulators() {
    for simulator in [VerilogSimulator::Icarus, VerilogSimulator::Verilator] {
        let outcome = run(simulator, vectors());
        assert!(outcome.passed, "{simulator}:\n{}", outcome.transcript);
        let outputs = [
            ("valid", 1, "0 (idle 100%)"),
            ("done", 3, "1 (say 'square')"),
            ("y_out", 5, "0 (idle 100%)"),
        ];
        for (output, clock, executed) in outputs {
            let mut wrong = vectors();
            let at = ["valid", "busy", "done", "y_out"].iter().position(|name| *name == output);
            wrong.expected[clock][at.unwrap_or_default()] ^= 1;
            let outcome = run(simulator, wrong);
            assert!(!outcome.passed, "{simulator}, {output}:\n{}", outcome.transcript);
            let dir = format!("clock {clock}, microinstruction {executed}: {output} is ");
            assert!(outcome.transcript.contains(&dir), "{dir}\n{}", outcome.transcript);
            assert!(outcome.transcript.contains("FAIL squarer: 1 differences in 6 clocks"));
        }
    }
}

#[test]
fn results_are_not_compared_before_they_are_known() {
    let mut early = vectors();
    early.expected[3][3] ^= 1;
    assert!(run(VerilogSimulator::Icarus, early).passed);
}

#[test]
fn vectors_that_do_not_fit_are_refused() {
    let refused = |spoil: fn(&mut Vectors)| {
        let mut vectors = vectors();
        spoil(&mut vectors);
        let inputs = EmitInputs { vectors: Some(vectors), ..EmitInputs::default() };
        emit(&squarer(), &inputs).expect_err("vectors that do not fit").to_string()
    };
    let message = refused(|vectors| vectors.inputs[2][2] = 16);
    assert_eq!(message, "clock 2 of the stimulus: 0x10 does not fit the 4 bits of `x`");
    let message = refused(|vectors| vectors.expected[0].truncate(3));
    assert_eq!(message, "clock 0 of the expected outputs has 3 values for 4 ports");
    let message = refused(|vectors| vectors.expected.truncate(3));
    assert_eq!(message, "the stimulus has 6 clocks, but the expected outputs have 3");
    let message = refused(|vectors| vectors.known_from = 7);
    assert_eq!(message, "the outputs are compared from clock 7 on, but there are only 6 clocks");
}

//! Tests the delay lines of the emitted Verilog, which are memories in place of registers. The bench of `threshold_pipelined`
//! fails if a delay line is one clock too long or too short, or if it does not wait while the points of the pipeline wait. A
//! default run draws four wrong lengths, and one of two simulators for the other tests.

use glint::package::FileKind;
use glint::tools::VerilogSimulator;

use crate::common::cores::{Emitted, Files, configuration, configuration_with};
use crate::common::sample::{sampled, sampled_by_name};
use crate::common::tools::benched;

/// Points with pauses and stalls.
const POINTS: u64 = 60;

const CONFIG: &str = "configs/threshold_pipelined.toml";

fn passes(simulator: VerilogSimulator, files: &Files, bench: &str) -> bool {
    benched(simulator, files, bench).passed
}

/// Returns the files with a change in the text of the module, which the change must find.
fn changed(emitted: &Emitted, change: &dyn Fn(&str) -> String) -> Files {
    let mut files = emitted.simulated();
    let module = format!("{}.v", emitted.name);
    let text = &mut files.iter_mut().find(|(name, _)| *name == module).expect("the module").1;
    let wrong = change(text);
    assert_ne!(*text, wrong);
    *text = wrong;
    files
}

/// Returns the words of every memory.
fn slots(text: &str) -> Vec<usize> {
    let counts = text.split("_delay #(").skip(1).filter_map(|it| it.split(".WORDS(").nth(1));
    let digits = counts.filter_map(|it| it.split(')').next());
    digits.map(|it| it.parse().expect("a number")).collect()
}

/// Returns the text with another number of words in memories of `words`, of as many bits.
fn with_words(text: &str, words: usize, other: usize) -> String {
    let most = words.next_power_of_two();
    assert!(other <= most, "{other} words need more bits than {words}");
    text.replace(&format!(".WORDS({words})"), &format!(".WORDS({other})"))
}

#[test]
fn a_line_that_is_too_long_or_too_short_is_noticed() {
    let emitted = Emitted::new(&configuration(CONFIG), POINTS, 1);
    let slots = slots(&emitted.files.of(&[FileKind::CoreVerilog])[0].contents);
    assert!(!slots.is_empty(), "no delay lines");
    let mut cases = Vec::new();
    for simulator in [VerilogSimulator::Icarus, VerilogSimulator::Verilator] {
        assert!(passes(simulator, &emitted.simulated(), &emitted.bench()), "{simulator}");
        for &words in &slots {
            cases.extend([words - 1, words + 1].map(|other| (simulator, words, other)));
        }
    }
    for (simulator, words, other) in sampled("lengths of delay lines", cases) {
        let files = changed(&emitted, &|text| with_words(text, words, other));
        let passed = passes(simulator, &files, &emitted.bench());
        assert!(!passed, "{simulator}: {other} words for {words}");
    }
}

/// Returns the simulators that a run takes for a kind of check.
fn simulators(kind: &str) -> Vec<VerilogSimulator> {
    let both = [VerilogSimulator::Icarus, VerilogSimulator::Verilator];
    sampled_by_name(kind, both, VerilogSimulator::to_string)
}

#[test]
fn a_line_that_does_not_wait_is_noticed() {
    let emitted = Emitted::new(&configuration(CONFIG), POINTS, 1);
    let forgets = |text: &str| {
        let (stages, lines) = text.split_once("    // Delay lines").expect("a section");
        let lines = lines.replace(".enable(advance)", ".enable(1'b1)");
        format!("{stages}    // Delay lines{lines}")
    };
    for simulator in simulators("delay lines that do not wait") {
        let files = changed(&emitted, &forgets);
        assert!(!passes(simulator, &files, &emitted.bench()), "{simulator}");
    }
}

/// Without stalls there is nothing to wait for, and with `pipeline.delays = "registers"` nothing but registers.
#[test]
fn lines_without_stalls_and_registers_in_their_place_do_the_same() {
    for (keys, lines) in [("stall = \"none\"\n", true), ("delays = \"registers\"\n", false)] {
        let core = configuration_with(CONFIG, &format!("[pipeline]\n{keys}"));
        let emitted = Emitted::new(&core, POINTS, 2);
        let has = emitted.rtl().iter().any(|(_, text)| text.contains("// Delay lines"));
        assert_eq!(has, lines, "{keys}");
        for simulator in simulators("forms of delay lines") {
            assert!(
                passes(simulator, &emitted.simulated(), &emitted.bench()),
                "{simulator} {keys}"
            );
        }
    }
}

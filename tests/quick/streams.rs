//! Tests that the result of a co-simulation depends only on its seed and its number of points, and not on the number of
//! threads.
//!
//! A difference that it finds can be reproduced with its seed, with a waveform.

use std::fs::File;

use crate::common::cores::configuration;
use crate::common::waveform::waveform;
use glint::core::Core;
use glint::cosim::{Lockstep, Outcome};
use glint::hdl::netlist::Design;

/// Enough for streams of many lanes and several simulators.
const POINTS: u64 = 70_000;

fn lockstep<'a>(core: &'a Core, design: &'a Design, seed: u64) -> Lockstep<'a> {
    let model = core.opened.golden();
    Lockstep::new(design, model, core.contract.as_ref(), seed).expect("they fit")
}

fn run(core: &Core, design: &Design, points: u64, threads: usize) -> Outcome {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.build().expect("threads");
    let lockstep = lockstep(core, design, 5);
    pool.install(|| lockstep.run(points, &|_| ())).expect("it can be simulated")
}

/// Returns the design with one bit inverted in a word of the sine that is seldom read.
fn rarely_wrong(core: &Core) -> Design {
    let mut design = core.design.clone();
    let sine = design.roms.iter_mut().find(|rom| rom.name.contains("sine"));
    // Low bits may be of a slope that is not used; this one is of the sine itself.
    sine.expect("a sine").words[550] ^= 1 << 20;
    design
}

#[test]
fn threads_have_no_influence() {
    let core = configuration("configs/rough.toml");
    let one = run(&core, &core.design, POINTS, 1);
    let three = run(&core, &core.design, POINTS, 3);
    assert_eq!((one.points, one.mismatch.is_none()), (POINTS, true));
    assert_eq!(one.clocks, three.clocks);
    assert_eq!(one.worst, three.worst);

    let wrong = rarely_wrong(&core);
    let one = run(&core, &wrong, POINTS, 1);
    let three = run(&core, &wrong, POINTS, 3);
    assert!(one.mismatch.is_some(), "it is never read");
    assert_eq!(one.mismatch, three.mismatch);
    assert_eq!((one.points, one.clocks), (three.points, three.clocks));
    assert_eq!(one.worst, three.worst);
}

#[test]
fn every_point_is_counted() {
    let core = configuration("configs/rough.toml");
    // One stream, a few lanes, lanes that do not fill two simulators, and many.
    for points in [1, 511, 515, 3_000, 4_096, 5_001] {
        assert_eq!(run(&core, &core.design, points, 2).points, points);
    }
}

#[test]
fn what_differs_can_be_had_again_with_its_waveform() {
    let core = configuration("configs/rough.toml");
    let wrong = rarely_wrong(&core);
    let found = run(&core, &wrong, POINTS, 2).mismatch.expect("it differs");
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("window.vcd");
    let file = File::create(&path).expect("a file");
    let from = found.clock.saturating_sub(10);
    let again =
        lockstep(&core, &wrong, found.seed).trace(u64::MAX, from, file).expect("it can be traced");
    assert_eq!(again.mismatch.as_ref(), Some(&found));
    assert_eq!(again.clocks, found.clock);

    // The signal ends with what was simulated, and ten clocks of two edges were written.
    let (variables, values) = waveform(&path);
    let signal = format!(".{}", found.signal);
    let signal = variables.iter().find(|(name, _)| name.ends_with(&signal)).expect("the signal");
    let (mut last, mut times) = (None, 0);
    for command in values {
        match command.expect("a command") {
            vcd::Command::ChangeVector(id, bits) if id == signal.1.code => {
                let bit = |all: u64, bit: &vcd::Value| all << 1 | u64::from(*bit == vcd::Value::V1);
                last = Some(bits.iter().fold(0, bit));
            }
            vcd::Command::Timestamp(_) => times += 1,
            _ => {}
        }
    }
    assert_eq!(last, Some(found.simulated));
    assert!(times >= 20, "{times}");
}

/// For people: no structures of Rust.
#[test]
fn what_differs_is_told_in_words() {
    let core = configuration("configs/rough.toml");
    let mut wrong = core.design.clone();
    let sine = wrong.roms.iter_mut().find(|rom| rom.name.contains("sine"));
    sine.expect("a sine").words.reverse();
    let told = lockstep(&core, &wrong, 5).record(200, &[]).expect_err("it differs").to_string();
    for part in ["(seed 5, after clock ", "in the simulated hardware and 0x", "in the golden model"]
    {
        assert!(told.contains(part), "{told}");
    }
    assert!(!told.contains('{') && !told.contains("Some("), "{told}");
}

//! Tests the formal proofs of the handshake: the emitted properties are proved for every configuration in `configs/` and
//! `configs/studies/` by k-induction, from any state and for all inputs, and faults in the emitted files break the proof.
//!
//! The emitted tasks for SymbiYosys have the same commands and the same depth; no test runs SymbiYosys.

use std::time::Duration;

use crate::common::Sure;
use crate::common::bench::with_flipped_bit;
use crate::common::cores::{Emitted, all_configurations, configuration, parsed};
use crate::common::files::{put, read};
use crate::common::tools::{EFFORT, LIMIT, finding};
use crate::faults::{Fault, faults};
use glint::core::Core;
use glint::tools::{LimitReached, Limits, PROOF_LIMITS, prove};
use glint::verify::CheckVerdict;
use rayon::prelude::*;

#[test]
fn every_configuration_is_proved() {
    all_configurations().par_iter().for_each(|(path, core)| assert_proved(core, path));
}

#[test]
fn pipelines_with_and_without_stalls_and_a_side_channel_are_proved() {
    for more in
        ["side = 8", "stall = \"none\"", "stall = \"none\"\nside = 3", "stages = 1\nside = 2"]
    {
        assert_proved(&pipeline(more), more);
    }
}

#[test]
fn starts_in_the_last_clock_are_proved() {
    let devices = ["lyon", "quad-cosine"];
    devices.par_iter().for_each(|device| assert_proved(&buffered(device), device));
    let core = buffered("quad-cosine");
    faults("buffered").par_iter().for_each(|fault| assert_breaks(&core, fault));
}

/// Returns a device whose operands have buffers.
fn buffered(device: &str) -> Core {
    parsed("test.toml", &format!("device = \"{device}\"\n[operands]\nbuffered = true\n"))
}

#[test]
fn faults_of_a_pipeline_break_the_proof() {
    faults("pipeline").par_iter().for_each(|fault| {
        assert_breaks(&pipeline("stages = 6\nside = 8"), fault);
    });
}

/// Returns the pipeline of `cosine-power` with these keys.
fn pipeline(keys: &str) -> Core {
    let text = "device = \"cosine-power\"\narchitecture = \"pipelined\"\n[pipeline]\n";
    parsed("test.toml", &format!("{text}{keys}\n"))
}

#[test]
fn faults_break_the_proof() {
    for (config, headings) in [
        ("rough", &["control", "operands"][..]),
        ("lyon", &["control", "lyon"]),
        ("quad_cosine", &["control", "operands", "quad_cosine"]),
    ] {
        let core = configuration(&format!("configs/{config}.toml"));
        let faults: Vec<Fault> = headings.iter().flat_map(|heading| faults(heading)).collect();
        faults.par_iter().for_each(|fault| assert_breaks(&core, fault));
    }
}

fn assert_proved(core: &Core, what: &str) {
    let (dir, name) = emitted(core);
    prove(dir.path(), &proof_of(&name), LIMIT).sure_of(what);
}

fn assert_breaks(core: &Core, fault: &Fault) {
    let (dir, name) = emitted(core);
    fault.assert_breaks(dir.path(), &name, &format!("{name}{}", fault.of));
}

/// The lowest bit of a control word lets the program go on; the one above it is `valid` in `rough`.
#[test]
fn a_wrong_bit_of_sequencing_breaks_the_proof() {
    let bits = [("rough", 0), ("rough", 1), ("lyon", 0), ("quad_cosine", 0)];
    bits.par_iter().for_each(|&(config, bit)| {
        let core = configuration(&format!("configs/{config}.toml"));
        (0..core.design.control.microprogram.len()).into_par_iter().for_each(|word| {
            let (dir, name) = emitted(&core);
            let path = dir.path().join(format!("{name}_control.mem"));
            put(&path, with_flipped_bit(&read(&path), word, bit));
            let proof = prove(dir.path(), &proof_of(&name), LIMIT);
            assert!(proof.is_err(), "{name}: word {word} without bit {bit}");
        });
    });
}

/// The property says only what holds for every operand that the ports take: here the domain holds a single shift,
/// and the port takes every one.
#[test]
fn a_domain_narrower_than_its_port_is_proved() {
    let text = "device = \"lyon\"\n[domain]\nexponent_min = 100\nexponent_max = 150\n";
    let core = parsed("test.toml", text);
    let (dir, name) = emitted(&core);
    prove(dir.path(), &proof_of(&name), PROOF_LIMITS).sure();
}

#[test]
fn a_proof_that_takes_too_much_says_so() {
    let (dir, name) = emitted(&configuration("configs/rough.toml"));
    let time = Limits { time: Duration::from_millis(50), memory: None };
    // Enough for Yosys and Python, not for the solver.
    let memory = Limits { time: LIMIT, memory: Some(40 << 20) };
    for limits in [time, memory] {
        let error = prove(dir.path(), &proof_of(&name), limits).expect_err("a limit");
        assert!(error.downcast_ref::<LimitReached>().is_some(), "{limits:?}: {error:#}");
    }
}

/// Returns the files of a configuration in a directory of their own, and its name.
fn emitted(core: &Core) -> (tempfile::TempDir, String) {
    let emitted = Emitted::new(core, 1, 1);
    (emitted.all_beside(), emitted.name)
}

/// Returns the file of the proof of a core.
fn proof_of(name: &str) -> String {
    format!("{name}_formal.sv")
}

/// `glint verify` proves, lints and simulates what is emitted around a core too.
#[test]
fn verify_covers_the_wrappers() {
    let core = configuration("configs/cosine_power.toml");
    let found = finding(&core, "formal", EFFORT);
    assert_eq!(found.verdict, CheckVerdict::Proved, "{}", found.words);
    for wrapper in ["axis", "registers", "wb"] {
        let file = format!("cosine_power_{wrapper}_formal.sv");
        assert!(found.words.contains(&file), "{}", found.words);
    }
    for id in ["lint", "icarus", "verilator"] {
        let found = finding(&core, id, EFFORT);
        assert_eq!(found.verdict, CheckVerdict::Passed, "{id}: {:?}", found.failures);
    }
}

//! Formal proof of the handshake: for every configuration the emitted properties are proved by
//! k-induction, from any state and for all inputs; and faults in the emitted text break the proof.
//!
//! The tasks for SymbiYosys have the same commands and the same depth; it is no part of the tools here.

use std::fs;
use std::path::Path;
use std::time::Duration;

use crate::common::bench::with_flipped_bit;
use crate::common::cores::{Emitted, all_configurations, configuration, write};
use crate::common::tools::LIMIT;
use glint::tools::{LimitReached, Limits, PROOF_LIMITS, prove};
use glint::verify::{CHECKS, Effort, Subject, Verdict};
use rayon::prelude::*;

#[test]
fn every_configuration_is_proved() {
    all_configurations().par_iter().for_each(|(path, core)| {
        let (place, name) = emitted(core);
        prove(place.path(), &name, LIMIT).unwrap_or_else(|error| panic!("{path}: {error:#}"));
    });
}

/// A fault, and the file of which it is: what stands there, and what stands there instead.
type Fault = (&'static str, &'static str, &'static str);

/// Of every device, whatever its microprogram.
const OF_ALL: [Fault; 9] = [
    // A start that is not remembered, and one that is taken while busy.
    ("_control.v", "run ? go_on : start", "run ? go_on : 1'b0"),
    ("_control.v", "run ? go_on : start", "go_on | start"),
    // The initial set leaves the address, or the run, as it was.
    (
        "_control.v",
        "        if (!rst_n) begin\n            word_address",
        "        if (1'b0) begin\n            word_address",
    ),
    ("_control.v", "run <= 1'b0;", "run <= run;"),
    // A microinstruction that is not there.
    ("_control.v", "following_word = word_address + ", "following_word = word_address - "),
    // A handshake that says something else.
    ("_control.v", "assign busy = run;", "assign busy = run | start;"),
    ("_control.v", "done = run & last_word", "done = run | last_word"),
    // Operands can be written at any time.
    ("_datapath.v", "exponent_write & idle", "exponent_write"),
    ("_datapath.v", "exponent_write & idle", "exponent_write | idle"),
];

/// Of a device whose loops turn as often as an operand says.
const OF_LYON: [Fault; 4] = [
    // A result that is shown while idle.
    ("_control.v", "assign valid = valid_word;", "assign valid = valid_word | ~run;"),
    // Loops without end: a counter that stands, one that goes past its end, one that is loaded again.
    ("_datapath.v", "remaining_less_one = remaining - 4'd1", "remaining_less_one = remaining"),
    ("_datapath.v", "more_shifts = |remaining;", "more_shifts = 1'b1;"),
    ("_datapath.v", "remaining_next = remaining_load ?", "remaining_next = 1'b1 ?"),
];

/// Of a device that walks a line.
const OF_QUAD_COSINE: [Fault; 6] = [
    // Results that come late, stop early, or begin before there is one.
    (
        "_control.v",
        "assign valid = valid_in_0;",
        "reg late; always @(posedge clk) late <= valid_in_0; assign valid = late;",
    ),
    ("_control.v", "valid_in_1 <= angle_load;", "valid_in_1 <= angle_load & ~loop_back;"),
    ("_control.v", "valid_in_0 <= valid_in_1;", "valid_in_0 <= angle_load;"),
    // Those of the line before are left over.
    ("_control.v", "valid_in_0 <= 1'b0;", "valid_in_0 <= valid_in_1;"),
    // Lines without end.
    (
        "_datapath.v",
        "intervals_less_one = intervals - 12'd1",
        "intervals_less_one = intervals + 12'd1",
    ),
    ("_datapath.v", "more = intervals > 12'd1;", "more = 1'b1;"),
];

/// Of a pipeline with a side channel.
const OF_PIPELINE: [Fault; 9] = [
    // A point that is lost, one that is doubled, one that overtakes.
    (".v", "valid_s3 <= valid_s2;", "valid_s3 <= valid_s2 & ~valid_s3;"),
    (".v", "valid_s3 <= valid_s2;", "valid_s3 <= valid_s2 | valid_s3;"),
    (".v", "valid_s3 <= valid_s2;", "valid_s3 <= valid_s1;"),
    // A reset that leaves a point on its way.
    (".v", "            valid_s2 <= 1'b0;", "            valid_s2 <= valid_s1;"),
    // Stages that move while a result waits, and stages that do not move when none does.
    (".v", "advance = out_ready | ~valid_s6", "advance = out_ready | ~valid_s5"),
    (".v", "assign in_ready = advance;", "assign in_ready = out_ready;"),
    // A result, and a side value, of another point.
    (
        ".v",
        "        if (advance) begin\n            side_s6",
        "        if (1'b1) begin\n            side_s6",
    ),
    (".v", "side_s4 <= side_s3;", "side_s4 <= side_s2;"),
    (".v", "assign side_out = side_s6;", "assign side_out = side_s5;"),
];

#[test]
fn pipelines_with_and_without_stalls_and_a_side_channel_are_proved() {
    for more in
        ["side = 8", "stall = \"none\"", "stall = \"none\"\nside = 3", "stages = 1\nside = 2"]
    {
        let core = pipeline(more);
        let (place, name) = emitted(&core);
        prove(place.path(), &name, LIMIT).unwrap_or_else(|error| panic!("{more}: {error:#}"));
    }
}

/// What the sequencer of a device whose operands have buffers must not do.
const OF_BUFFERED: [Fault; 3] = [
    // A start that is heard in the middle, one that is not heard at the end, and one that never ends.
    ("_control.v", "wire goes_on = run & go_on;", "wire goes_on = run & go_on & ~start;"),
    ("_control.v", "wire next_run = goes_on | start;", "wire next_run = run ? goes_on : start;"),
    ("_control.v", "wire next_run = goes_on | start;", "wire next_run = run | start;"),
];

#[test]
fn starts_in_the_last_clock_are_proved() {
    ["lyon", "quad-cosine"].par_iter().for_each(|device| {
        let (place, name) = emitted(&buffered(device));
        prove(place.path(), &name, LIMIT).unwrap_or_else(|error| panic!("{device}: {error:#}"));
    });
    let core = buffered("quad-cosine");
    OF_BUFFERED.par_iter().for_each(|fault| assert_breaks(&core, fault));
}

/// A device whose operands have buffers.
fn buffered(device: &str) -> glint::core::Core {
    with_text(device, &format!("device = \"{device}\"\n[operands]\nbuffered = true\n"))
}

#[test]
fn faults_of_a_pipeline_break_the_proof() {
    OF_PIPELINE.par_iter().for_each(|fault| {
        assert_breaks(&pipeline("stages = 6\nside = 8"), fault);
    });
}

/// The pipeline of `cosine-power` with these keys.
fn pipeline(keys: &str) -> glint::core::Core {
    let text = "device = \"cosine-power\"\narchitecture = \"pipelined\"\n[pipeline]\n";
    with_text("cosine-power", &format!("{text}{keys}\n"))
}

fn with_text(device: &str, text: &str) -> glint::core::Core {
    let device = *glint::registry::Registry::catalogue().device(device).expect("a device");
    let config = glint::config::parse("test.toml", text, &[(device.schema)()]);
    let config = config.unwrap_or_else(|problems| panic!("{problems}"));
    glint::core::Core::new(device, config).expect("a design")
}

#[test]
fn faults_break_the_proof() {
    let faults = |config, faults: &'static [Fault]| faults.iter().map(move |fault| (config, fault));
    let faults: Vec<(&str, &Fault)> = faults("rough", &OF_ALL)
        .chain(faults("lyon", &OF_ALL[..7]))
        .chain(faults("quad_cosine", &OF_ALL))
        .chain(faults("lyon", &OF_LYON))
        .chain(faults("quad_cosine", &OF_QUAD_COSINE))
        .collect();
    faults.par_iter().for_each(|(config, fault)| {
        assert_breaks(&configuration(&format!("configs/{config}.toml")), fault);
    });
}

fn assert_breaks(core: &glint::core::Core, (file, right, wrong): &Fault) {
    let (place, name) = emitted(core);
    let path = place.path().join(format!("{name}{file}"));
    let text = fs::read_to_string(&path).expect("a file");
    assert!(text.contains(right), "`{right}` is not in {name}{file}");
    fs::write(&path, text.replace(right, wrong)).expect("written");
    let proof = prove(place.path(), &name, LIMIT);
    assert!(proof.is_err(), "`{wrong}` in {name} is proved");
}

/// The lowest bit of a control word lets the program go on; the one above it is `valid` in `rough`.
#[test]
fn a_wrong_bit_of_sequencing_breaks_the_proof() {
    let bits = [("rough", 0), ("rough", 1), ("lyon", 0), ("quad_cosine", 0)];
    bits.par_iter().for_each(|&(config, bit)| {
        let core = configuration(&format!("configs/{config}.toml"));
        (0..core.design.control.microprogram.len()).into_par_iter().for_each(|word| {
            let (place, name) = emitted(&core);
            let path = place.path().join(format!("{name}_control.mem"));
            let text = fs::read_to_string(&path).expect("a file");
            fs::write(&path, with_flipped_bit(&text, word, bit)).expect("written");
            let proof = prove(place.path(), &name, LIMIT);
            assert!(proof.is_err(), "{name}: word {word} without bit {bit}");
        });
    });
}

/// The property says only what holds for every operand that the ports take: here the domain holds a single shift,
/// and the port takes every one.
#[test]
fn a_domain_narrower_than_its_port_is_proved() {
    let text = "device = \"lyon\"\n[domain]\nexponent_min = 100\nexponent_max = 150\n";
    let core = with_text("lyon", text);
    let (place, name) = emitted(&core);
    prove(place.path(), &name, PROOF_LIMITS).unwrap_or_else(|error| panic!("{error:#}"));
}

#[test]
fn a_proof_that_takes_too_much_says_so() {
    let (place, name) = emitted(&configuration("configs/rough.toml"));
    let time = Limits { time: Duration::from_millis(50), memory: None };
    // Enough for Yosys and Python, not for the solver.
    let memory = Limits { time: LIMIT, memory: Some(40 << 20) };
    for limits in [time, memory] {
        let error = prove(place.path(), &name, limits).expect_err("a limit");
        assert!(error.downcast_ref::<LimitReached>().is_some(), "{limits:?}: {error:#}");
    }
}

/// The files of a configuration in a directory of their own, and its name.
fn emitted(core: &glint::core::Core) -> (tempfile::TempDir, String) {
    let emitted = Emitted::new(core, 1, 1);
    let place = tempfile::tempdir().expect("a directory");
    // The form of a file for one target has the name of the portable one.
    let files = emitted.files.iter().filter(|file| !file.path.contains("/ecp5/"));
    let files = files.map(|file| (file.name().to_owned(), file.contents.clone()));
    let files = files.collect();
    write(place.path(), &files);
    (place, emitted.name)
}

/// `glint verify` proves what is emitted around a core too.
#[test]
fn verify_proves_the_wrappers() {
    let core = configuration("configs/cosine_power.toml");
    let check = CHECKS.iter().find(|check| check.id == "formal").expect("the check");
    let effort = Effort { full: false, without_tools: false, time_limit: LIMIT };
    let subject = Subject { path: "core.toml", core: &core, effort, proofs: Path::new("proofs") };
    let finding = check.run(&subject, &|_| ()).finding;
    assert_eq!(finding.verdict, Verdict::Proved, "{}", finding.words);
    for wrapper in ["axis", "registers", "wb"] {
        let file = format!("cosine_power_{wrapper}_formal.sv");
        assert!(finding.words.contains(&file), "{}", finding.words);
    }
}

//! Formal proof of the handshake: for every configuration the emitted properties are proved by
//! k-induction, from any state and for all inputs; and faults in the emitted text break the proof.

mod common;

use std::fs;
use std::path::Path;

use common::bench::with_flipped_bit;
use common::tools::{LIMIT, tool};
use common::units::{Emitted, configuration, configurations, write};
use rayon::prelude::*;

#[test]
fn every_configuration_is_proved() {
    configurations().par_iter().for_each(|(path, unit)| {
        let (place, name) = emitted(unit);
        if let Err(transcript) = prove(place.path(), &name) {
            panic!("{path}:\n{transcript}");
        }
    });
}

/// A fault, and the file of which it is: what stands there, and what stands there instead.
type Fault = (&'static str, &'static str, &'static str);

const FAULTS: [Fault; 5] = [
    // A start that is not remembered, and one that is taken while busy.
    ("_control.v", "run ? go_on : start", "run ? go_on : 1'b0"),
    ("_control.v", "run ? go_on : start", "go_on | start"),
    // The initial set leaves the word where it was.
    (
        "_control.v",
        "word_address <= 4'd0;",
        "word_address <= word_address;",
    ),
    // Operands can be written at any time.
    ("_datapath.v", "exponent_write & idle", "exponent_write"),
    ("_datapath.v", "blue_write & idle", "blue_write | idle"),
];

#[test]
fn faults_break_the_proof() {
    let unit = configuration("configs/rough.toml");
    FAULTS.par_iter().for_each(|(file, right, wrong)| {
        let (place, name) = emitted(&unit);
        let path = place.path().join(format!("{name}{file}"));
        let text = fs::read_to_string(&path).expect("a file");
        assert!(text.contains(right), "`{right}` is not in {name}{file}");
        fs::write(&path, text.replace(right, wrong)).expect("written");
        assert!(prove(place.path(), &name).is_err(), "`{wrong}` is proved");
    });
}

#[test]
fn a_wrong_bit_of_sequencing_breaks_the_proof() {
    let unit = configuration("configs/rough.toml");
    // The lowest bit lets the program go on, the one above it is `valid`.
    (0..unit.design.control.words.len() * 2)
        .into_par_iter()
        .for_each(|at| {
            let (place, name) = emitted(&unit);
            let path = place.path().join(format!("{name}_control.mem"));
            let text = fs::read_to_string(&path).expect("a file");
            fs::write(&path, with_flipped_bit(&text, at / 2, at as u32 % 2)).expect("written");
            let proof = prove(place.path(), &name);
            assert!(proof.is_err(), "word {} without bit {}", at / 2, at % 2);
        });
}

/// The files of a configuration in a directory of their own, and its name.
fn emitted(unit: &glint::flow::Unit) -> (tempfile::TempDir, String) {
    let emitted = Emitted::new(unit, 1, 1);
    let place = tempfile::tempdir().expect("a directory");
    let files: Vec<(String, String)> = emitted
        .files
        .iter()
        .map(|file| {
            let name = file.path.rsplit('/').next().expect("a name").to_owned();
            (name, file.contents.clone())
        })
        .collect();
    write(place.path(), &files);
    (place, emitted.name)
}

/// Runs the commands that the head of the wrapper gives.
fn prove(directory: &Path, name: &str) -> Result<(), String> {
    let wrapper = fs::read_to_string(directory.join(format!("{name}_formal.sv"))).expect("a file");
    let commands: Vec<Vec<&str>> = wrapper
        .lines()
        .filter_map(|line| line.trim_start().strip_prefix("//   $ "))
        .map(|line| line.split(' ').collect())
        .collect();
    assert_eq!(
        commands.len(),
        3,
        "{name}: make the problem, base case, induction"
    );
    for command in commands {
        let run = tool(command[0]).run_to_success(&command[1..], directory, LIMIT);
        if let Err(error) = run {
            return Err(format!("{}\n{error:#}", command.join(" ")));
        }
    }
    Ok(())
}

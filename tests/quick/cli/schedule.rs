//! `glint schedule`: clocks that can be reached, constraints, and drawings.

use crate::workspace::{Run, Workspace};

#[test]
fn what_is_proposed_can_be_reached() {
    let text = |clock: &str| {
        format!(
            "device = \"schlick\"\narchitecture = \"pipelined\"\npipeline.clock_mhz = {clock}\n"
        )
    };
    let dir = Workspace::with("core.toml", text("1900"));
    let refused = dir.glint(["schedule", "core.toml"]);
    let nearest = refused.err.split("set pipeline.clock_mhz to ").nth(1).expect("a remedy");
    let nearest = nearest.split(' ').next().expect("a number");
    let dir = Workspace::with("core.toml", text(nearest));
    dir.glint(["schedule", "core.toml", "--json"]).good();
}

/// The clock follows the target where the file leaves it out, and only there.
#[test]
fn a_clock_that_is_left_out_follows_the_target() {
    let text = "device = \"schlick\"\narchitecture = \"pipelined\"\npipeline.target = \"ice40\"\n";
    let dir = Workspace::with("core.toml", text);
    let value = dir.glint(["schedule", "core.toml", "--json"]).quiet().json();
    let clock = value["schedules"][0]["clock_mhz"].as_f64().expect("a clock");
    dir.write("core.toml", format!("{text}pipeline.clock_mhz = 130\n"));
    let refused = dir.glint(["schedule", "core.toml"]);
    refused.refused(1, &[&format!("set pipeline.clock_mhz to {clock} or less"), "core.toml:4:"]);
}

/// At 80 columns what a stage computes stays, and what can be spared goes.
#[test]
fn stages_fit_a_narrow_terminal() {
    let text =
        "device = \"cosine-power\"\narchitecture = \"pipelined\"\npipeline.target = \"ice40\"\n";
    let dir = Workspace::with("core.toml", text);
    let run = Run::of(dir.command().args(["schedule", "core.toml"]).env("COLUMNS", "80").output());
    assert!(run.out.contains("| computes "), "{}", run.out);
    assert!(run.out.lines().all(|line| line.chars().count() <= 80), "{}", run.out);
}

#[test]
fn constraints_have_the_clock_of_the_schedule() {
    for (pipeline, clock, expected) in [
        ("stages = 4", "", None),
        ("clock_mhz = 60", "", Some(60.0)),
        ("clock_mhz = 60", "clock_mhz = 48", Some(48.0)),
    ] {
        let text = format!(
            "device = \"schlick\"\narchitecture = \"pipelined\"\n[pipeline]\n{pipeline}\n[package]\n\
             constraints = true\n{clock}\n"
        );
        let dir = Workspace::with("core.toml", &text);
        let schedule = dir.glint(["schedule", "core.toml", "--json"]).json();
        let stated = schedule["schedules"][0]["clock_mhz"].as_f64().expect("a clock");
        dir.done(["generate", "core.toml"]);
        let constraints = dir.read("rtl_out/core/core.sdc");
        let period = constraints.split("-period ").nth(1).expect("a period");
        let period: f64 = period.split(' ').next().expect("a number").parse().expect("a number");
        // Whole picoseconds.
        let wanted = 1000.0 / expected.unwrap_or(stated);
        assert!(period <= wanted && wanted - period < 0.001, "{text}: {period} ns, not {wanted}");
    }
}

#[test]
fn the_drawing_is_a_file_of_its_own_and_no_other_is_overwritten() {
    let text = "device = \"schlick\"\narchitecture = \"pipelined\"\n";
    let dir = Workspace::with("core.toml", text);
    let draw = ["schedule", "core.toml", "--svg", "out"];
    dir.done(draw);
    let drawn = dir.read("out/core.svg");
    let document = roxmltree::Document::parse(&drawn).expect("XML");
    assert_eq!(document.root_element().tag_name().name(), "svg");
    for load in ["url(", "@import", "href"] {
        assert!(!drawn.contains(load), "{load}");
    }
    dir.done(draw);
    assert_eq!(dir.read("out/core.svg"), drawn);
}

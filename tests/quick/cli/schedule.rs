//! Tests the clock that `glint schedule` shows: without `pipeline.clock_mhz`, it follows the target. The emitted constraints
//! state the same clock, or `package.clock_mhz` if the file has this key.

use crate::common::json::Json;
use crate::workspace::Workspace;

/// The clock follows the target where the file leaves it out, and only there.
#[test]
fn a_clock_that_is_left_out_follows_the_target() {
    let text = "device = \"schlick\"\narchitecture = \"pipelined\"\npipeline.target = \"ice40\"\n";
    let dir = Workspace::with("core.toml", text);
    let value = dir.glint(["schedule", "core.toml", "--json"]).quiet().json();
    let clock = value["schedules"][0]["clock_mhz"].number();
    dir.write("core.toml", format!("{text}pipeline.clock_mhz = 130\n"));
    let refused = dir.glint(["schedule", "core.toml"]);
    refused.refused(1, &[&format!("set pipeline.clock_mhz to {clock} or less"), "core.toml:4:"]);
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
        let stated = schedule["schedules"][0]["clock_mhz"].number();
        dir.done(["generate", "core.toml"]);
        let constraints = dir.read("rtl_out/core/core.sdc");
        let period = constraints.split("-period ").nth(1).expect("a period");
        let period: f64 = period.split(' ').next().expect("a number").parse().expect("a number");
        // Whole picoseconds.
        let wanted = 1000.0 / expected.unwrap_or(stated);
        assert!(period <= wanted && wanted - period < 0.001, "{text}: {period} ns, not {wanted}");
    }
}

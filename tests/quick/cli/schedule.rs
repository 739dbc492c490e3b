//! `glint schedule`, and what is said of pipelines that cannot be made.

use crate::place::Place;

/// A pipeline with these keys, and what is said of it: message, place and remedy.
type Refusal = (&'static str, [&'static str; 3]);

#[test]
fn what_cannot_be_a_pipeline_is_refused_with_line_key_and_remedy() {
    let refusals: [Refusal; 8] = [
        (
            "device = \"rough\"\narchitecture = \"pipelined\"\n[pipeline]\nclock_mhz = 900\n",
            ["`core` cannot run at 900 MHz: `", "core.toml:4:13", "set pipeline.clock_mhz to "],
        ),
        (
            "device = \"rough\"\narchitecture = \"pipelined\"\n[pipeline]\nstages = 1000\n",
            ["`core` has no use for 1000 stages", "core.toml:4:10", "set pipeline.stages to "],
        ),
        (
            "device = \"rough\"\narchitecture = \"pipelined\"\n[pipeline]\nstages = 1\n",
            ["`core` cannot have 1 stage: its block memories", "core.toml:4:10", "or more"],
        ),
        (
            "device = \"quad-cosine\"\narchitecture = \"pipelined\"\n",
            ["`core` cannot be a pipeline", "core.toml:2:16", "set architecture = \"sequential\""],
        ),
        (
            "device = \"schlick\"\narchitecture = \"pipelined\"\npipeline.clock_mhz = 60\n[package]\n\
             constraints = true\nclock_mhz = 61\n",
            [
                "`package.clock_mhz` = 61.0 is above the 60 MHz that the pipeline is made for",
                "core.toml:6:13",
                "set pipeline.clock_mhz to 61, or set package.clock_mhz to 60 or less",
            ],
        ),
        (
            "device = \"schlick\"\narchitecture = \"pipelined\"\npipeline.stages = 4\n[package]\n\
             constraints = true\nclock_mhz = 100\n",
            [
                "MHz that 4 stages allow on ecp5",
                "core.toml:6:13",
                "help: raise pipeline.stages, or set package.clock_mhz to ",
            ],
        ),
        // Neither a clock nor stages are proposed where none are enough.
        (
            "device = \"schlick\"\narchitecture = \"pipelined\"\npipeline.clock_mhz = 60\n[package]\n\
             constraints = true\nclock_mhz = 900\n",
            [
                "`package.clock_mhz` = 900.0 is above the 60 MHz that the pipeline is made for",
                "core.toml:6:13",
                "help: set package.clock_mhz to 60 or less",
            ],
        ),
        (
            "device = \"schlick\"\narchitecture = \"pipelined\"\npipeline.stages = 1\n[package]\n\
             constraints = true\nclock_mhz = 900\n",
            [
                "MHz that 1 stage allows on ecp5",
                "core.toml:6:13",
                "help: set package.clock_mhz to ",
            ],
        ),
    ];
    for (text, says) in refusals {
        let place = Place::with("core.toml", text);
        for command in ["schedule", "generate", "cosim"] {
            place.glint([command, "core.toml"]).refused(1, &says);
        }
        assert!(!place.at("rtl_out").exists(), "{text}");
    }
}

#[test]
fn what_is_proposed_can_be_reached() {
    let text = |clock: &str| {
        format!(
            "device = \"schlick\"\narchitecture = \"pipelined\"\npipeline.clock_mhz = {clock}\n"
        )
    };
    let place = Place::with("core.toml", text("1900"));
    let refused = place.glint(["schedule", "core.toml"]);
    let nearest = refused.err.split("set pipeline.clock_mhz to ").nth(1).expect("a remedy");
    let nearest = nearest.split(' ').next().expect("a number");
    let place = Place::with("core.toml", text(nearest));
    place.glint(["schedule", "core.toml", "--json"]).good();
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
        let place = Place::with("core.toml", &text);
        let schedule = place.glint(["schedule", "core.toml", "--json"]).json();
        let stated = schedule["schedules"][0]["clock_mhz"].as_f64().expect("a clock");
        place.done(["generate", "core.toml"]);
        let constraints = place.read("rtl_out/core/core.sdc");
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
    let place = Place::with("core.toml", text);
    let draw = ["schedule", "core.toml", "--svg", "out"];
    place.done(draw);
    let drawn = place.read("out/core.svg");
    let document = roxmltree::Document::parse(&drawn).expect("XML");
    assert_eq!(document.root_element().tag_name().name(), "svg");
    for load in ["url(", "@import", "href"] {
        assert!(!drawn.contains(load), "{load}");
    }
    place.done(draw);
    assert_eq!(place.read("out/core.svg"), drawn);
    place.write("out/core.svg", "mine");
    place.glint(draw).refused(1, &["core.svg", "--force"]);
    assert_eq!(place.read("out/core.svg"), "mine");
}

//! `glint schedule`, and what is said of pipelines that cannot be made.

use crate::place::Place;

/// A pipeline with these keys, and what is said of it: message, place and remedy.
type Refusal = (&'static str, [&'static str; 3]);

#[test]
fn what_cannot_be_a_pipeline_is_refused_with_line_key_and_remedy() {
    let refusals: [Refusal; 4] = [
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
            ["`core` cannot have 1 stages: its block memories", "core.toml:4:10", "or more"],
        ),
        (
            "device = \"quad-cosine\"\narchitecture = \"pipelined\"\n",
            ["`core` cannot be a pipeline", "core.toml:2:16", "set architecture = \"sequential\""],
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
    let shown = place.glint(["schedule", "core.toml", "--json"]);
    assert_eq!(shown.code, 0, "{shown:?}");
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

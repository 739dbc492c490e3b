//! `worst`: the largest error that is found, and its record.

use serde_json::Value;

use crate::workspace::{COSINE_POWER, Workspace};

fn dir() -> Workspace {
    Workspace::with("core.toml", COSINE_POWER)
}

#[test]
fn an_error_is_found_within_the_bound_and_eval_shows_it() {
    let dir = dir();
    let text = dir.done(["worst", "core.toml", "--starts", "3"]);
    assert!(text.contains("within the bound of 0.6206, by 3 climbs from seed 1"), "{text}");
    let run = dir.glint(["worst", "core.toml", "--starts", "3", "--json"]);
    let json = &run.json()["configurations"][0];
    assert_eq!((&json["holds"], &json["recorded"]), (&Value::Bool(true), &Value::Null));
    let units = json["units"].as_f64().expect("a number");
    // Rounding alone makes half a unit.
    assert!(units > 0.5 && units <= json["bound"].as_f64().expect("a number"), "{json}");
    let (_, operands) = text.split_once(" at ").expect("operands");
    let mut arguments = vec!["eval", "core.toml", "--json"];
    arguments.extend(operands.split_whitespace());
    let point = dir.glint(arguments).json();
    let output = json["output"].as_str().expect("a name");
    let shown = point["signals"].as_array().expect("signals");
    let shown = shown.iter().find(|it| it["name"] == output).expect("the output");
    assert_eq!(shown["raw"], json["raw"], "{point}");
}

#[test]
fn a_record_of_a_larger_error_stays() {
    let dir = dir();
    let worst = |starts: &str, seed: &str| {
        let arguments = ["worst", "core.toml", "--starts", starts, "--seed", seed, "--out", "r"];
        dir.done(arguments)
    };
    worst("6", "1");
    let record = dir.read("r/core.json");
    let text = worst("1", "1");
    assert!(text.contains("the record stays: "), "{text}");
    assert_eq!(dir.read("r/core.json"), record);
    // Of another configuration it says nothing.
    dir.write("core.toml", "device = \"cosine-power\"\noutput.rounding = \"truncate\"\n");
    let text = worst("1", "1");
    assert!(!text.contains("stays"), "{text}");
    let units = |text: &str| -> f64 {
        let record: Value = serde_json::from_str(text).expect("JSON");
        record["units"].as_f64().expect("a number")
    };
    assert!(units(&dir.read("r/core.json")) > units(&record));
    dir.assert_no_staging();
}

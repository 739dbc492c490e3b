//! Tests `glint mutate`: the list of faults, the scores, the record, and that Glint does not overwrite a record that somebody
//! edited.

use crate::common::json::Json;
use crate::workspace::{COSINE_POWER, Workspace};

/// A fault that every computation shows.
const SHOWS: &str = "accumulator[3]:inverted";

fn dir() -> Workspace {
    Workspace::with("core.toml", COSINE_POWER)
}

#[test]
fn faults_are_named_and_none_is_planted() {
    let dir = dir();
    let text = dir.done(["mutate", "core.toml", "--list"]);
    assert!(text.starts_with("core.toml: "), "{text}");
    assert!(text.contains(SHOWS), "{text}");
    let json = dir.glint(["mutate", "core.toml", "--list", "--json"]);
    let json = json.json();
    let faults = json["configurations"][0]["faults"].as_array();
    let faults = faults.expect("faults");
    assert_eq!(faults.len(), text.lines().count() - 1);
    let named = faults.iter().find(|fault| fault["id"] == SHOWS);
    assert_eq!(named.expect("the fault")["kind"], "inverted");
    assert_eq!(dir.files().len(), 1);
}

#[test]
fn scores_are_recorded_and_nothing_else_is_overwritten() {
    let dir = dir();
    let run = dir.glint(["mutate", "core.toml", "--json", "--out", "scores"]).quiet();
    let printed = run.json();
    assert_eq!(printed["ok"], true);
    let record = dir.json("scores/core.json");
    // The record has one member more, the digest of the others.
    let mut others = record.clone();
    others.as_object_mut().expect("an object").remove("sha256").expect("a digest");
    assert_eq!(printed["configurations"][0], others);
    let all = &record["netlist"]["all"];
    let undecided = record["netlist"]["undecided"].list().len();
    assert_eq!(all["undecided"], undecided);
    // What the shipped bench notices and what it misses are all that is caught, and perhaps some that are undecided.
    let number = |value: &serde_json::Value| value.count() as usize;
    let caught: usize = all["caught"].object().values().map(number).sum();
    let [shipped, missed] = ["shipped", "missed"].map(|key| number(&all[key]));
    assert!((caught..=caught + undecided).contains(&(shipped + missed)), "{all}");
    assert!(all["planted"].as_u64() > Some(2000), "{all}");
    // Over its own record it writes.
    dir.done(["mutate", "core.toml", "--out", "scores"]);
    let edited = dir.read("scores/core.json").replacen("\"planted\": ", "\"planted\": 1", 1);
    dir.write("scores/core.json", &edited);
    let run = dir.glint(["mutate", "core.toml", "--out", "scores"]);
    run.refused(1, &["core.json", "was not written by Glint, or was edited since", "--out"]);
    dir.write("scores/core.json", "mine");
    let run = dir.glint(["mutate", "core.toml", "--out", "scores"]);
    run.refused(1, &["core.json", "was not written by Glint, or was edited since", "--out"]);
    assert_eq!(dir.read("scores/core.json"), "mine");
}

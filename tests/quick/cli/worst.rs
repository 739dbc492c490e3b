//! Tests `glint worst`: the error that it finds is within the bound, and `glint eval` shows the same output at the operands of
//! this error.

use serde_json::Value;

use crate::common::json::Json;
use crate::workspace::{COSINE_POWER, Workspace};

#[test]
fn an_error_is_found_within_the_bound_and_eval_shows_it() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    let text = dir.done(["worst", "core.toml", "--starts", "3"]);
    assert!(text.contains("within the bound of 0.6206, found by 3 climbs from seed 1"), "{text}");
    let run = dir.glint(["worst", "core.toml", "--starts", "3", "--json"]);
    let json = &run.json()["configurations"][0];
    assert_eq!((&json["holds"], &json["recorded"]), (&Value::Bool(true), &Value::Null));
    let units = json["units"].number();
    // Rounding alone makes half a unit.
    assert!(units > 0.5 && units <= json["bound"].number(), "{json}");
    let (_, operands) = text.split_once(" at ").expect("operands");
    let mut arguments = vec!["eval", "core.toml", "--json"];
    arguments.extend(operands.split_whitespace());
    let point = dir.glint(arguments).json();
    let output = json["output"].text();
    let shown = point["signals"].list();
    let shown = shown.iter().find(|it| it["name"] == output).expect("the output");
    assert_eq!(shown["raw"], json["raw"], "{point}");
}

//! The largest errors that are known where a proof does not cover all operands, `proofs/worst/<name>.json`.

use std::fs;

use crate::common::cores::configuration;
use glint::cosim::search;
use serde_json::Value;

/// By the formula of the claim, in f64, and by hand: the square of n/2·(cos(γ − dγ) − 1) + 1.
#[test]
fn the_worst_known_error_of_rough_is_what_its_record_says() {
    let text = fs::read_to_string("proofs/worst/rough.json").expect("a record");
    let record: Value = serde_json::from_str(&text).expect("JSON");
    let unit = configuration("configs/rough.toml");
    let raw = |name: &str| record["operands"][name].as_i64().expect("a raw operand");
    let control = ["cos_gamma", "cos_dgamma", "exponent", "dgamma_negative"].map(raw);
    let (colour, output) = (raw("red"), record["output"].as_i64().expect("a raw output"));
    let [cos_gamma, cos_dgamma] = [control[0], control[1]].map(|raw| raw as f64 / 1_048_576.0);
    let sines = ((1.0 - cos_gamma * cos_gamma) * (1.0 - cos_dgamma * cos_dgamma)).sqrt();
    let base = control[2] as f64 / 2.0 * (cos_gamma * cos_dgamma + sines - 1.0) + 1.0;
    let units = (output as f64 - colour as f64 * base * base).abs();
    let highlight = unit.contract.highlight().expect("a highlight");
    assert_eq!(highlight.colour(highlight.f(&control), colour), output);
    assert!((record["units"].as_f64().expect("a number") - units).abs() < 1e-9, "{units}");
    assert!(units > 0.9428 && units <= unit.contract.bound().units, "{units}");
    assert!((search::error(highlight, &control, colour) - units).abs() < 1e-9);
}

/// A short climb comes beyond all that was drawn at random, and to the same place every time.
#[test]
fn what_is_climbed_to_is_beyond_what_is_drawn() {
    let unit = configuration("configs/rough.toml");
    let highlight = unit.contract.highlight().expect("a highlight");
    let found = search::worst(highlight, 16, 1).expect("starts");
    assert_eq!(search::worst(highlight, 16, 1), Some(found.clone()));
    assert!(found.units > 0.85 && found.units <= unit.contract.bound().units, "{found:?}");
    assert_eq!(search::error(highlight, &found.control, found.colour), found.units);
}

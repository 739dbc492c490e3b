//! Tests the records of the largest known errors, `records/proofs/worst/<name>.json`, and the search that finds such errors.
//!
//! The records are of configurations of `rough`.

use crate::common::cores::configuration;
use crate::common::files::{json, paths};
use crate::common::json::Json;
use glint::cosim::search;

/// By the formula of the claim, in f64, and by hand: the square of n/2·(cos(γ − dγ) − 1) + 1.
#[test]
fn the_worst_known_error_of_rough_is_what_its_record_says() {
    let record = json("records/proofs/worst/rough.json");
    let unit = configuration("configs/rough.toml");
    let raw = |name: &str| record["operands"][name].integer();
    let control = ["cos_gamma", "cos_dgamma", "exponent", "dgamma_negative"].map(raw);
    assert_eq!(control[3], 1, "the formula below is that of γ − dγ");
    let name = record["output"].text().trim_end_matches("_out").to_owned();
    let (colour, output) = (raw(&name), record["raw"].integer());
    let [cos_gamma, cos_dgamma] = [control[0], control[1]].map(|raw| raw as f64 / 1_048_576.0);
    let sines = ((1.0 - cos_gamma * cos_gamma) * (1.0 - cos_dgamma * cos_dgamma)).sqrt();
    let base = control[2] as f64 / 2.0 * (cos_gamma * cos_dgamma + sines - 1.0) + 1.0;
    let units = (output as f64 - colour as f64 * base * base).abs();
    let highlight = unit.contract.highlight().expect("a highlight");
    assert_eq!(highlight.colour(highlight.f(&control), colour), output);
    assert!((record["units"].number() - units).abs() < 1e-9, "{units}");
    assert!(units > 0.9428 && units <= unit.contract.bounds().governing().units, "{units}");
}

/// A record that `glint worst --out records/proofs/worst` would not take for another configuration's.
#[test]
fn records_are_of_todays_contracts() {
    for file in paths("records/proofs/worst", ".json") {
        let record = json(&file);
        let core = configuration(record["config"].text());
        assert_eq!(record["contract"], core.contract_digest(), "{file}");
        let operands = core.contract.operands().iter();
        let operands: Vec<i64> =
            operands.map(|operand| record["operands"][&operand.name].integer()).collect();
        let units = core.contract.largest_error(&operands);
        assert_eq!(record["units"].as_f64(), Some(units), "{file}");
    }
}

/// A short climb comes beyond all that was drawn at random, and to the same place every time.
#[test]
fn search_beats_random_points() {
    let unit = configuration("configs/rough.toml");
    let contract = unit.contract.as_ref();
    let found = search::worst(contract, 16, 1, &|| ()).expect("starts");
    assert_eq!(search::worst(contract, 16, 1, &|| ()), Some(found.clone()));
    assert!(found.units > 0.85 && found.units <= contract.bounds().governing().units, "{found:?}");
    assert_eq!(contract.largest_error(&found.operands), found.units);
    assert!((found.raw as f64 - found.exact).abs() == found.units, "{found:?}");
}

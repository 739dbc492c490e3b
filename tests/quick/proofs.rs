//! The recorded proofs of the accuracy contract, `proofs/<name>.json`.
//!
//! A proof goes through every place of a contract's sweep, which takes minutes. `glint cosim
//! --exhaustive --json CONFIG` makes it; here its record is held against the program of today: the
//! same places, the same error where it is largest, the same colour multipliers, and no larger error in
//! a part of the places that is spread evenly over them.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::common::cores::{configuration, configurations};
use crate::common::sample::sampled_alone;
use glint::cosim::exhaustive::{Places, Proof, Record};
use glint::registry::Registry;
use serde_json::{Value, json};

/// Places that are checked again of each proof, about.
const AGAIN: u64 = 20_000_000;

/// The records, by configuration.
fn records() -> Vec<Value> {
    let mut paths: Vec<_> = fs::read_dir("proofs")
        .expect("proofs/")
        .map(|entry| entry.expect("a directory entry").path())
        .filter(|path| path.is_file())
        .collect();
    paths.sort();
    let mut records = Vec::new();
    for path in paths {
        let text = fs::read_to_string(&path).expect("a record");
        let value: Value = serde_json::from_str(&text).expect("JSON");
        records.extend(value["configurations"].as_array().expect("a list").clone());
    }
    records
}

#[test]
fn the_default_of_every_device_is_proven_below_one_unit() {
    let proven: BTreeSet<String> = records()
        .iter()
        .filter(|record| record["together"].as_f64().expect("a number") < 1.0)
        .map(|record| record["config"].as_str().expect("a path").to_owned())
        .collect();
    for device in Registry::catalogue().devices() {
        let path = format!("configs/{}.toml", device.name.replace('-', "_"));
        assert!(proven.contains(&path), "no proof of {path} in proofs/");
    }
    // Whatever is within the contract by its bound is proven as well.
    for (path, unit) in configurations() {
        assert!(
            unit.contract.bound().units >= 1.0 || proven.contains(&path),
            "no proof of {path} in proofs/"
        );
    }
}

#[test]
fn the_records_hold_today() {
    for record in sampled_alone("records of proofs", records(), 8) {
        let path = record["config"].as_str().expect("a path");
        let unit = configuration(path);
        let contract = unit.contract.as_ref();
        let found = Record::find(Path::new("proofs"), &unit.contract_digest(), contract);
        let found = found.expect("readable records").expect("its record");
        let places = Places::of_sweep(contract, found.sweep(contract));
        let stale = format!("the record of {path} is not of today's program");
        assert_eq!(record["configuration"], json!(unit.contract_digest()), "{stale}");
        assert_eq!(record["evaluations"], json!(places.count()), "{stale}");
        assert!(
            record["together"].as_f64().expect("a number") <= contract.bound().units,
            "{stale}"
        );
        assert_eq!(record["holds"], json!(true));

        let largest = record["f"]["error"].as_f64().expect("a number");
        let place = record["f"]["place"].as_u64().expect("a number");
        assert_eq!(places.error(place), largest, "{stale}");
        let stride = (places.count() / AGAIN).max(1);
        let peak = places.check(every(&places, stride), &|_| ());
        assert!(peak.error <= largest, "{stale}: {} at {:?}", peak.error, places.place(peak.place));

        let colours = Places::of_colours(contract);
        let colour = colours.check(every(&colours, 1), &|_| ());
        assert_eq!(record["colour_units"], json!(colour.error), "{stale}");
        let proof = Proof::new(contract, peak, colour);
        assert_eq!(proof.failures, Vec::<String>::new(), "{path}");
    }
}

/// Every `stride`-th block.
fn every(places: &Places<'_>, stride: u64) -> Vec<u64> {
    (0..places.blocks()).step_by(stride as usize).collect()
}

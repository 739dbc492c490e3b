//! Tests the recorded proofs of error bounds, `records/proofs/<name>.json`, against the program of today.
//!
//! A proof visits every place of a contract's sweep, which takes minutes; `glint cosim --exhaustive --json CONFIG` makes the
//! record. The test compares the record's digest, its number of places and its largest errors. The test visits an evenly spread
//! part of the places again. `tests/kinds.toml` says which records a run takes.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use crate::common::cores::{configuration, configurations};
use crate::common::files::{json, paths, put, read, replaced};
use crate::common::json::Json;
use crate::common::sample::sampled_by_name;
use glint::config::Config;
use glint::core::Core;
use glint::cosim::exhaustive::{Backing, Places, Proof, Record};
use glint::devices;
use glint::golden::{Bounds, Contract, Highlight, Operand, Output, Sweep, cosine_power};
use glint::registry::{Device, KeyParts, PartsResult, Registry};
use serde_json::{Value, json};

/// Places that are checked again of each proof, about.
const AGAIN: u64 = 20_000_000;

/// Returns the records, by configuration.
fn records() -> Vec<Value> {
    let records = paths("records/proofs", ".json").into_iter().map(json);
    records.flat_map(|record| record["configurations"].list().clone()).collect()
}

#[test]
fn the_default_of_every_device_is_proven_below_one_unit() {
    let proven: BTreeSet<String> = records()
        .iter()
        .filter(|record| record["together"].number() < 1.0)
        .map(|record| record["config"].text().to_owned())
        .collect();
    for device in Registry::catalogue().devices() {
        let path = format!("configs/{}.toml", device.name.replace('-', "_"));
        assert!(proven.contains(&path), "no proof of {path} in proofs/");
    }
    // Whatever is within the contract by its bound is proven as well.
    for (path, unit) in configurations() {
        assert!(
            unit.contract.bounds().governing().units >= 1.0 || proven.contains(&path),
            "no proof of {path} in proofs/"
        );
    }
}

#[test]
fn the_records_hold_today() {
    let path_of = |record: &Value| record["config"].text().to_owned();
    for record in sampled_by_name("records of proofs", records(), path_of) {
        let path = record["config"].text();
        let unit = configuration(path);
        let contract = unit.contract.as_ref();
        let found = Record::find(Path::new("records/proofs"), &unit.contract_digest(), contract);
        let found = found.expect("readable records").expect("its record");
        let places = Places::of_sweep(contract, found.sweep(contract));
        let stale = format!("the record of {path} is not of today's program");
        assert_eq!(record["configuration"], json!(unit.contract_digest()), "{stale}");
        assert_eq!(record["evaluations"], json!(places.count()), "{stale}");
        assert!(record["together"].number() <= contract.bounds().governing().units, "{stale}");
        assert_eq!(record["holds"], json!(true));

        let largest = record["f"]["error"].number();
        let place = record["f"]["place"].count();
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

/// Returns every `stride`-th block.
fn every(places: &Places<'_>, stride: u64) -> Vec<u64> {
    (0..places.blocks()).step_by(stride as usize).collect()
}

/// The contract of `cosine-power`, as somebody else's device has it: with its bound, or a third of it.
struct Foreign(Box<dyn Contract>, f64);

impl Contract for Foreign {
    fn operands(&self) -> &[Operand] {
        self.0.operands()
    }

    fn outputs(&self) -> &[Output] {
        self.0.outputs()
    }

    fn results(&self, operands: &[i64], index: u64, raw: &mut Vec<i64>) {
        self.0.results(operands, index, raw);
    }

    fn exact(&self, operands: &[i64], index: u64, values: &mut Vec<[f64; 2]>) {
        self.0.exact(operands, index, values);
    }

    fn bounds(&self) -> Bounds {
        let mut bounds = self.0.bounds();
        bounds.f *= self.1;
        for bound in &mut bounds.outputs {
            bound.units *= self.1;
        }
        bounds
    }

    fn highlight(&self) -> Option<&Highlight> {
        self.0.highlight()
    }

    fn sweep(&self) -> Sweep {
        self.0.sweep()
    }

    fn sweep_error(&self, place: &[i64]) -> f64 {
        self.0.sweep_error(place)
    }
}

/// Returns the parts of `cosine-power` with another contract.
fn foreign_parts(contract: fn(&Config) -> Box<dyn Contract>) -> PartsResult {
    let (describe, model) = (devices::cosine_power::describe, cosine_power::model);
    Ok(Arc::new(KeyParts { describe, model, contract }))
}

#[test]
fn a_bound_is_proven_where_somebody_proved_it() {
    let own = configuration("configs/cosine_power.toml");
    let foreign = |parts| {
        let device = Device { parts, proved: false, ..*own.device() };
        Core::new(device, own.config().clone()).expect("a design")
    };
    let honest =
        foreign(|_| foreign_parts(|config| Box::new(Foreign(cosine_power::contract(config), 1.0))));
    let wrong = foreign(|_| {
        foreign_parts(|config| Box::new(Foreign(cosine_power::contract(config), 1.0 / 3.0)))
    });
    let backing = |core: &Core, proofs: &Path| core.backing(proofs).expect("readable records");
    let record = Backing::Exhaustive("records/proofs/cosine_power.json".to_owned());
    assert_eq!(backing(&own, Path::new("nowhere")), Backing::Catalogue);
    assert_eq!(backing(&honest, Path::new("nowhere")), Backing::Author);
    assert_eq!(backing(&honest, Path::new("records/proofs")), record);
    assert_eq!(backing(&wrong, Path::new("records/proofs")), Backing::Author);
    let page = glint::pages::of(&wrong, "mine.toml", Path::new("records/proofs")).expect("a page");
    assert!(
        page.contains("The bound is stated by its author") && !page.contains("proven"),
        "{page}"
    );

    let proofs = tempfile::tempdir().expect("a directory");
    let certificate = proofs.path().join("certificates/mine.json");
    let text = read("records/proofs/certificates/cosine_power.json");
    put(&certificate, &text);
    let certified = backing(&honest, proofs.path());
    assert!(
        matches!(&certified, Backing::Certificate(path) if path.ends_with("mine.json")),
        "{certified:?}"
    );
    assert_eq!(backing(&wrong, proofs.path()), Backing::Author);
    // Not all statements were accepted; half a file.
    let open = replaced(&text, "\"certified\": true", "\"certified\": false");
    put(&certificate, open);
    assert_eq!(backing(&honest, proofs.path()), Backing::Author);
    put(&certificate, &text[..text.len() / 2]);
    let damaged = format!("{:#}", honest.backing(proofs.path()).expect_err("half a file"));
    assert!(damaged.contains("mine.json` is damaged: restore the record"), "{damaged}");
}

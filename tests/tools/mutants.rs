//! Tests the records of mutation testing in `records/mutation/`: plants a sample of the faults again, in the netlist and in the
//! Verilog, and compares the verdicts with the record.
//!
//! A fault must be noticed, or proved to change nothing, unless the record calls it undecided.

use std::collections::BTreeSet;

use crate::common::Sure;
use crate::common::cores::{all_configurations, configuration, configurations, run};
use crate::common::files::json;
use crate::common::json::Json;
use crate::common::sample::sampled_for;
use crate::common::tools::LIMIT;
use glint::core::{Core, TEST_POINTS};
use glint::cosim::Lockstep;
use glint::mutate::{
    self, FaultResult, Faults, MutantVerdict, ShippedBench, TextMutantVerdict, VerilogText,
};
use glint::registry::Registry;
use serde_json::Value;

/// About the number of faults of a device that are proved equivalent and given another test.
const PROVED: usize = 40;

/// The seed of that test.
const SEED: u64 = 77;

/// Returns the default configuration of every device, with its path.
fn defaults() -> Vec<(String, Core)> {
    let registry = Registry::catalogue();
    let devices = registry.devices().iter();
    let paths = devices.map(|device| format!("configs/{}.toml", device.name.replace('-', "_")));
    paths.map(|path| (path.clone(), configuration(&path))).collect()
}

/// Their pipelines.
fn pipelines() -> Vec<(String, Core)> {
    let is_pipeline = |(path, _): &(String, Core)| {
        path.strip_prefix("configs/").is_some_and(|name| name.ends_with("_pipelined.toml"))
    };
    all_configurations().into_iter().filter(is_pipeline).collect()
}

fn record(core: &Core) -> Value {
    json(format!("records/mutation/{}.json", core.config().name))
}

/// Proofs are of the whole design; another test must not find what they exclude.
fn assert_unnoticed(path: &str, core: &Core, found: &[FaultResult]) {
    let proved = |it: &&FaultResult| matches!(it.verdict, MutantVerdict::Equivalent(_));
    let proved: Vec<&FaultResult> = found.iter().filter(proved).collect();
    let step = (proved.len() / PROVED).max(1);
    for one in proved.into_iter().step_by(step) {
        let mutant = one.fault.planted(&core.design);
        let model = core.opened.golden();
        let outcome = Lockstep::new(&mutant, model, core.contract.as_ref(), SEED)
            .and_then(|lockstep| lockstep.run(TEST_POINTS / 5, &|_| ()))
            .sure_of(format_args!("{path}: {}", one.fault.id));
        assert_eq!(outcome.mismatch, None, "{path}: {}", one.fault.id);
    }
}

#[test]
fn the_records_hold_today() {
    let pipelines = pipelines();
    assert_eq!(pipelines.len(), 12);
    let all = defaults().into_iter().map(|it| (it, "faults of the records"));
    let pipelines = pipelines.into_iter().map(|it| (it, "faults of the records of pipelines"));
    for ((path, core), kind) in all.chain(pipelines) {
        let record = record(&core);
        let netlist = &record["netlist"];
        let stale = format!("{path}: `glint mutate --out mutation {path}` makes another record");
        let faults = Faults::of(&core.design);
        let all = &netlist["all"];
        assert_eq!(all["planted"], faults.len(), "{stale}");
        let undecided = netlist["undecided"].list().len();
        assert_eq!(all["undecided"], undecided, "{stale}");
        assert!(undecided * 100 <= faults.len(), "{path}: {undecided} are undecided");
        let planted = sampled_for(&path, kind, faults.iter());
        let found = mutate::run(&core, planted, &|| ()).sure_of(&path);
        let open: BTreeSet<&str> =
            netlist["undecided"].list().iter().filter_map(Value::as_str).collect();
        for FaultResult { fault, verdict, .. } in &found {
            let is_open = open.contains(fault.id.as_str());
            assert_eq!(*verdict == MutantVerdict::Undecided, is_open, "{}: {stale}", fault.id);
        }
        assert_unnoticed(&path, &core, &found);
    }
}

#[test]
fn faults_have_names_of_their_own() {
    for (path, core) in configurations() {
        let faults = Faults::of(&core.design);
        let ids: BTreeSet<&str> = faults.iter().map(|fault| fault.id.as_str()).collect();
        assert_eq!(ids.len(), faults.len(), "{path}");
        assert!(faults.len() > 500, "{path}: a kind of fault is missing");
    }
    for (path, core) in defaults() {
        let faults = VerilogText::of(&core).sure_of(&path).faults();
        let ids: BTreeSet<&str> = faults.iter().map(|fault| fault.id.as_str()).collect();
        assert_eq!(ids.len(), faults.len(), "{path}: the Verilog");
    }
}

#[test]
fn without_a_fault_nothing_is_noticed() {
    for (path, core) in configurations() {
        let outcome = run(&core, TEST_POINTS, 3, &path);
        assert_eq!(outcome.mismatch, None, "{path}");
    }
}

/// A fault that a record does not call undecided is noticed by lint or by a bench, by the shipped one if the record says so, or it is
/// proved equivalent. Of undecided faults nothing is said here: a better bench may notice them.
#[test]
fn faults_of_the_verilog_are_noticed() {
    for (path, core) in defaults() {
        let verilog = &record(&core)["verilog"];
        let stale = format!("{path}: `glint mutate --full --out mutation {path}` makes another");
        let named = |list: &str| -> BTreeSet<&str> {
            let ids = verilog[list].as_array().unwrap_or_else(|| panic!("{stale}"));
            ids.iter().filter_map(Value::as_str).collect()
        };
        let [undecided, missed] = ["undecided", "missed"].map(named);
        let text = VerilogText::of(&core).sure_of(&path);
        let all = text.faults();
        assert_eq!(verilog["planted"], all.len(), "{stale}");
        let ids: BTreeSet<&str> = all.iter().map(|fault| fault.id.as_str()).collect();
        for id in undecided.union(&missed) {
            assert!(ids.contains(id), "{id}: {stale}");
        }
        let decided = all.into_iter().filter(|fault| !undecided.contains(fault.id.as_str()));
        let faults = sampled_for(&path, "faults of the Verilog", decided);
        let found = text.run(&faults, LIMIT, &|| ()).sure_of(&path);
        for (fault, found) in faults.iter().zip(found) {
            let id = fault.id.as_str();
            assert_ne!(found.verdict, TextMutantVerdict::Undecided, "{id}: {found:?}: {stale}");
            let was_missed = found.shipped == ShippedBench::Missed;
            assert_eq!(was_missed, missed.contains(id), "{id}: {found:?}: {stale}");
        }
    }
}

//! `cosim --exhaustive`.

use std::path::PathBuf;

use anyhow::Result;
use serde_json::{Value, json};

use super::{Loaded, load};
use crate::cli::{Output, progress, tables};
use crate::cosim::exhaustive::{self, Places, Proof};
use crate::golden::{Axis, Values};
use crate::registry::Registry;

/// `glint cosim --exhaustive`: the factored proof of the accuracy contract.
pub fn exhaustive(registry: &Registry, output: Output, configs: &[PathBuf]) -> Result<bool> {
    let loaded = load(registry, configs)?;
    let mut list = Vec::new();
    let mut holds = true;
    for one in &loaded {
        let contract = one.unit.contract.as_ref();
        let places = Places::new(contract);
        if !output.json {
            announce(one, &places);
        }
        let bar = progress::bar(output, places.count(), "evaluations of f");
        let peak = places.check(0..places.blocks(), &|done| bar.inc(done));
        bar.finish_and_clear();
        let bar = progress::bar(
            output,
            exhaustive::colour_products(contract),
            "colour products",
        );
        let colour = exhaustive::colour_error(contract, &|done| bar.inc(done));
        bar.finish_and_clear();
        let proof = Proof::new(contract, peak, colour);
        holds &= proof.faults.is_empty();
        if output.json {
            list.push(as_json(one, &places, &proof));
        } else {
            print(one, &places, &proof);
        }
    }
    if output.json {
        tables::print_json(&json!({ "ok": holds, "configurations": list }));
    }
    Ok(holds)
}

/// What is about to be done, and what is not.
fn announce(one: &Loaded, places: &Places<'_>) {
    let axes: Vec<String> = places.sweep().axes.iter().map(axis_text).collect();
    tables::print_line(&format!(
        "{}: {} evaluations of f ({}), {} colour products",
        one.path,
        tables::grouped(places.count()),
        axes.join(" x "),
        tables::grouped(exhaustive::colour_products(one.unit.contract.as_ref()))
    ));
    if !places.sweep().omits.is_empty() {
        tables::print_line(&format!("  not covered: {}", places.sweep().omits));
    }
}

fn axis_text(axis: &Axis) -> String {
    match &axis.values {
        Values::Range(low, high) => format!("{} = {low} to {high}", axis.name),
        Values::List(values) => format!("{} settings of {}", values.len(), axis.name),
    }
}

fn print(one: &Loaded, places: &Places<'_>, proof: &Proof) {
    let bound = one.unit.contract.bound();
    let at: Vec<String> = places
        .sweep()
        .axes
        .iter()
        .zip(places.place(proof.f.place))
        .map(|(axis, value)| format!("{}={value}", axis.name))
        .collect();
    tables::print_line(&format!(
        "  f is off by {:.3e} at most, {:.3} units, at raw {}; a colour multiplier by {:.3}; together {:.3} (bound {:.3}): {}",
        proof.f.error,
        proof.f_units,
        at.join(" "),
        proof.colour_units,
        proof.together(),
        bound.units,
        if proof.faults.is_empty() {
            "holds"
        } else {
            "FAILS"
        }
    ));
    for fault in &proof.faults {
        tables::print_line(&format!("  FAILS: {fault}"));
    }
}

/// A proof for scripts, and for the record.
fn as_json(one: &Loaded, places: &Places<'_>, proof: &Proof) -> Value {
    let axes: Vec<Value> = places
        .sweep()
        .axes
        .iter()
        .map(|axis| match &axis.values {
            Values::Range(low, high) => json!({ "name": axis.name, "from": low, "to": high }),
            Values::List(values) => json!({ "name": axis.name, "values": values }),
        })
        .collect();
    let contract = one.unit.contract.as_ref();
    json!({
        "config": one.path,
        "device": one.unit.device.name,
        "axes": axes,
        "not_covered": places.sweep().omits,
        "evaluations": places.count(),
        "colour_products": exhaustive::colour_products(contract),
        "f": {
            "error": proof.f.error,
            "units": proof.f_units,
            "place": proof.f.place,
            "at": places.place(proof.f.place),
        },
        "colour_units": proof.colour_units,
        "together": proof.together(),
        "bound": contract.bound().units,
        "holds": proof.faults.is_empty(),
        "faults": proof.faults,
    })
}

//! Finds the configuration keys that would reduce the error bound of a core.
//!
//! If the core does not keep its accuracy contract, the module looks for changes with which the core keeps it, in at most 40
//! steps. Otherwise, or without such changes, it names the one key that reduces the bound most. For example, it suggests
//! `intensity.fraction = 17` in place of 16. It never changes keys of the table `domain`, because a narrower domain promises
//! less.

use std::fmt;

use glint_base::fixed::Format;
use glint_base::text::rounded_up;
use glint_config::{Config, KeyKind, Schema, Value};
use glint_core::core::Core;
use glint_core::registry::Device;
use glint_golden::{Bound, Contract};

/// The steps of an integer key. A larger step is tried only if no smaller one reduces the bound.
const STEPS: [i64; 4] = [1, 2, 4, 8];

/// The smallest reduction of the bound that counts, in output units.
const GAIN: f64 = 1e-6;

/// The largest number of changes that are tried one after the other until the core keeps its contract.
const MOST: usize = 40;

/// Changes of keys that make the error bound smaller. For example, as text: "`intensity.fraction = 17` in place of 16 would
/// bring the bound to 0.812 units".
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// Each key's name, its present value, and the value that helps. The values are in TOML.
    pub changes: Vec<(&'static str, String, String)>,
    /// The error bound with all of these changes, in output units.
    pub units: f64,
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, (key, from, to)) in self.changes.iter().enumerate() {
            let and = if at > 0 { " and " } else { "" };
            write!(f, "{and}`{key} = {to}` in place of {from}")?;
        }
        write!(f, " would bring the bound to {} units", rounded_up(self.units, 3))
    }
}

/// A changed configuration and its error bound, which is smaller than the bound before the change.
struct Better {
    config: Config,
    bound: Bound,
}

/// Returns changes that reduce the error bound of a core, or `None` if no change does. If the core violates its accuracy
/// contract, the function looks for changes that keep it, in at most 40 steps. Otherwise only one key changes: among the smallest
/// steps that help any key, the key that reduces the bound most.
pub fn of(core: &Core) -> Option<Advice> {
    let device = core.device();
    let bound = core.contract.bounds().governing().clone();
    // A smaller bound of outputs with other formats is in other units, and need not be a smaller error.
    let formats = output_formats(core.contract.as_ref());
    let first = better(device, core.config(), &bound, &formats)?;
    let single = advice(device, core.config(), &first);
    if bound.keeps() {
        return Some(single);
    }
    let mut here = first;
    for _ in 0..MOST {
        if here.bound.keeps() {
            return Some(advice(device, core.config(), &needed(device, core.config(), here)));
        }
        match better(device, &here.config, &here.bound, &formats) {
            Some(next) => here = next,
            None => break,
        }
    }
    Some(single)
}

/// Changes the key that reduces the bound most, by the smallest of [`STEPS`] that reduces it at all. The outputs keep their `formats`.
fn better(device: &Device, config: &Config, bound: &Bound, formats: &[Format]) -> Option<Better> {
    let schema = (device.schema)();
    for step in STEPS {
        let mut best: Option<Better> = None;
        for (key, value) in candidates(&schema, config, bound, step) {
            let Some(changed) = with(&schema, config, key, &value) else { continue };
            let Some(contract) = contract_of(device, &changed) else { continue };
            if output_formats(contract.as_ref()) != formats {
                continue;
            }
            let bound = contract.bounds().governing().clone();
            let is_best = match &best {
                Some(best) => bound.units.total_cmp(&best.bound.units).is_lt(),
                None => true,
            };
            if is_best {
                best = Some(Better { config: changed, bound });
            }
        }
        if let Some(best) = best
            && best.bound.units < bound.units - GAIN
        {
            return Some(best);
        }
    }
    None
}

fn contract_of(device: &Device, config: &Config) -> Option<Box<dyn Contract>> {
    let opened = device.open(config.clone()).ok()?;
    Some(opened.contract())
}

fn output_formats(contract: &dyn Contract) -> Vec<Format> {
    contract.outputs().iter().map(|output| output.format).collect()
}

/// Undoes changes, one key after the other, as long as the core keeps its contract. `config` is the configuration before all
/// changes.
fn needed(device: &Device, config: &Config, mut kept: Better) -> Better {
    let schema = (device.schema)();
    for (key, ..) in changes(device, config, &kept.config) {
        if let Some(without) = with(&schema, &kept.config, key, config.value(key)) {
            let Some(contract) = contract_of(device, &without) else { continue };
            let bound = contract.bounds().governing().clone();
            if bound.keeps() {
                kept = Better { config: without, bound };
            }
        }
    }
    kept
}

fn advice(device: &Device, config: &Config, better: &Better) -> Advice {
    Advice { changes: changes(device, config, &better.config), units: better.bound.units }
}

/// Returns the keys with different values in two configurations, with both values in TOML.
fn changes(
    device: &Device,
    config: &Config,
    other: &Config,
) -> Vec<(&'static str, String, String)> {
    let mut changes = Vec::new();
    for key in (device.schema)().keys {
        let (from, to) = (config.value(key.name), other.value(key.name));
        if from != to {
            changes.push((key.name, from.toml(), to.toml()));
        }
    }
    changes
}

/// Returns the keys on which the bound depends, each with the values that differ from its own by `step`. A term of the bound must
/// name the key, or the key must be a choice or a flag in the table of a key that a term names.
fn candidates(
    schema: &Schema,
    config: &Config,
    bound: &Bound,
    step: i64,
) -> Vec<(&'static str, Value)> {
    let mut candidates = Vec::new();
    for key in &schema.keys {
        let table = table_of(key.name);
        let is_choice = matches!(key.kind, KeyKind::Choice(_) | KeyKind::Flag);
        let is_governing = bound.terms.iter().any(|term| {
            term.key == key.name || is_choice && !table.is_empty() && table_of(term.key) == table
        });
        if is_governing && table != "domain" && config.applies(schema, key.name) {
            for value in neighbours(&key.kind, config.value(key.name), step) {
                candidates.push((key.name, value));
            }
        }
    }
    candidates
}

/// Returns a key's table, for example `exponent` for `exponent.bits`. A key outside of all tables gives an empty text.
fn table_of(key: &str) -> &str {
    match key.split_once('.') {
        Some((table, _)) => table,
        None => "",
    }
}

/// Returns the values that differ from `value` by `step`. For example, the integer 8 and the step 2 give 6 and 10. A choice or a
/// flag gives all its remaining values. A list gives each list in which one entry differs by `step`.
fn neighbours(kind: &KeyKind, value: &Value, step: i64) -> Vec<Value> {
    match (kind, value) {
        (_, Value::Integer(value)) => [value - step, value + step].map(Value::Integer).to_vec(),
        (KeyKind::Choice(options), Value::Text(text)) => {
            let others = options.iter().filter(|option| *option != text);
            others.map(|option| Value::Text((*option).to_owned())).collect()
        }
        (_, Value::Flag(flag)) => vec![Value::Flag(!flag)],
        (_, Value::Integers(values)) => {
            let mut neighbours = Vec::new();
            for at in 0..values.len() {
                for by in [-step, step] {
                    let mut changed = values.clone();
                    changed[at] += by;
                    neighbours.push(Value::Integers(changed));
                }
            }
            neighbours
        }
        _ => Vec::new(),
    }
}

/// Returns `config` with a new value of `key`, or `None` if the schema refuses it.
fn with(schema: &Schema, config: &Config, key: &str, value: &Value) -> Option<Config> {
    let mut given = Vec::new();
    for (name, before) in config.values() {
        if config.applies(schema, name) {
            let chosen = if name == key { value } else { before };
            given.push((name.to_owned(), chosen.clone()));
        }
    }
    Config::from_values(schema, &config.name, given).ok()
}

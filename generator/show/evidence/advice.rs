//! Finds the keys of a configuration that would keep the accuracy contract, or bring its error bound down most.

use std::fmt;

use glint_base::fixed::Format;
use glint_base::text::rounded_up;
use glint_config::{Config, KeyKind, Schema, Value};
use glint_core::core::Core;
use glint_core::registry::Device;
use glint_golden::{Bound, Contract};

/// Steps by which an integer is changed. A larger step is tried only if no smaller one helps.
const STEPS: [i64; 4] = [1, 2, 4, 8];

/// The least gain that counts, in output units.
const GAIN: f64 = 1e-6;

/// How many changes are tried one after the other to keep the contract.
const MOST: usize = 40;

/// Changes of keys that make the error bound smaller. For example, as text: "`intensity.fraction = 17` in place of 16
/// would bring the bound to 0.812 units".
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// Each key with its value, and the value that helps, as TOML.
    pub changes: Vec<(&'static str, String, String)>,
    /// The bound with all of them, in output units.
    pub units: f64,
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let changes = self.changes.iter();
        let changes = changes.map(|(key, from, to)| format!("`{key} = {to}` in place of {from}"));
        let changes = changes.collect::<Vec<_>>().join(" and ");
        write!(f, "{changes} would bring the bound to {} units", rounded_up(self.units, 3))
    }
}

/// A configuration with a smaller bound.
struct Better {
    config: Config,
    bound: Bound,
}

/// Returns the changes that keep the accuracy contract, if the configuration does not keep it. If it does, or if no
/// changes help, returns the change of one key that would bring the error bound down most.
pub fn of(core: &Core) -> Option<Advice> {
    let (device, bound) = (&core.device, core.contract.bound());
    let first = better(device, &core.config, &bound)?;
    let single = advice(device, &core.config, &first);
    if bound.keeps() {
        return Some(single);
    }
    let next = |it: &Better| better(device, &it.config, &it.bound);
    let mut walk = std::iter::successors(Some(first), next).take(MOST);
    let kept = walk.find(|it| it.bound.keeps());
    Some(kept.map_or(single, |it| advice(device, &core.config, &needed(device, &core.config, it))))
}

/// Returns the change of one key that the bound depends on, by as little as helps, that brings the bound down most.
/// Returns `None` if no change does. Domains stay as they are: to narrow a domain is to ask for less.
fn better(device: &Device, config: &Config, bound: &Bound) -> Option<Better> {
    let schema = (device.schema)();
    STEPS.into_iter().find_map(|step| {
        let tried = candidates(&schema, config, bound, step).into_iter();
        let better = tried.filter_map(|(key, value)| {
            let changed = with(&schema, config, key, &value)?;
            has_same_units(device, config, &changed).then(|| {
                let bound = (device.contract)(&changed).bound();
                Better { config: changed, bound }
            })
        });
        let best = better.min_by(|a, b| a.bound.units.total_cmp(&b.bound.units))?;
        (best.bound.units < bound.units - GAIN).then_some(best)
    })
}

/// Returns whether the outputs of two configurations have the same formats. Otherwise their bounds are in different units, and a
/// smaller number need not be a smaller error.
fn has_same_units(device: &Device, config: &Config, other: &Config) -> bool {
    let [one, other] = [config, other].map(|config| (device.contract)(config));
    let formats = |contract: &dyn Contract| -> Vec<Format> {
        contract.outputs().iter().map(|output| output.format).collect()
    };
    formats(one.as_ref()) == formats(other.as_ref())
}

/// Leaves out the changes without which the contract is kept too. For example, of two changes it keeps one, if that one
/// is enough.
fn needed(device: &Device, config: &Config, kept: Better) -> Better {
    let schema = (device.schema)();
    let changed = changes(device, config, &kept.config);
    changed.into_iter().fold(kept, |kept, (key, ..)| {
        let without = with(&schema, &kept.config, key, config.value(key));
        let bound = without.map(|config| ((device.contract)(&config).bound(), config));
        match bound.filter(|(bound, _)| bound.keeps()) {
            Some((bound, config)) => Better { config, bound },
            None => kept,
        }
    })
}

fn advice(device: &Device, config: &Config, better: &Better) -> Advice {
    Advice { changes: changes(device, config, &better.config), units: better.bound.units }
}

fn changes(
    device: &Device,
    config: &Config,
    other: &Config,
) -> Vec<(&'static str, String, String)> {
    let keys = (device.schema)()
        .keys
        .into_iter()
        .map(|key| (key.name, config.value(key.name), other.value(key.name)));
    let changed = keys.filter(|(_, from, to)| from != to);
    changed.map(|(key, from, to)| (key, from.toml(), to.toml())).collect()
}

/// Returns the keys that the bound's terms name and the choices beside them, each with the values next to its own.
fn candidates(
    schema: &Schema,
    config: &Config,
    bound: &Bound,
    step: i64,
) -> Vec<(&'static str, Value)> {
    let table = |key: &'static str| key.split_once('.').map_or("", |(table, _)| table);
    let governs = |key: &'static str| bound.terms.iter().any(|term| term.key == key);
    let is_beside = |key: &'static str| {
        !table(key).is_empty() && bound.terms.iter().any(|term| table(term.key) == table(key))
    };
    let mut candidates = Vec::new();
    for key in &schema.keys {
        let is_choice = matches!(key.kind, KeyKind::Choice(_) | KeyKind::Flag);
        let is_asked = governs(key.name) || is_choice && is_beside(key.name);
        if is_asked && table(key.name) != "domain" && config.applies(schema, key.name) {
            let values = neighbours(&key.kind, config.value(key.name), step);
            candidates.extend(values.into_iter().map(|value| (key.name, value)));
        }
    }
    candidates
}

/// Returns the values that differ from `value` by `step`. For example, the integer 8 and the step 2 give 6 and 10.
fn neighbours(kind: &KeyKind, value: &Value, step: i64) -> Vec<Value> {
    match (kind, value) {
        (_, Value::Integer(value)) => [value - step, value + step].map(Value::Integer).to_vec(),
        (KeyKind::Choice(options), Value::Text(text)) => {
            let others = options.iter().filter(|option| *option != text);
            others.map(|option| Value::Text((*option).to_owned())).collect()
        }
        (_, Value::Flag(flag)) => vec![Value::Flag(!flag)],
        (_, Value::Integers(values)) => {
            let changed = |at: usize, by: i64| {
                let mut values = values.clone();
                values[at] += by;
                Value::Integers(values)
            };
            (0..values.len()).flat_map(|at| [changed(at, -step), changed(at, step)]).collect()
        }
        _ => Vec::new(),
    }
}

/// Returns the configuration with another value for a key; `None` if the device does not accept it.
fn with(schema: &Schema, config: &Config, key: &str, value: &Value) -> Option<Config> {
    let given = config.values().filter(|(name, _)| config.applies(schema, name));
    let given = given.map(|(name, own)| {
        let value = if name == key { value } else { own };
        (name.to_owned(), value.clone())
    });
    Config::from_values(schema, &config.name, given.collect()).ok()
}

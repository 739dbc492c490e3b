//! Which key of a configuration would bring its error bound down most.

use std::fmt;

use crate::config::{Config, Kind, Schema, Value};
use crate::core::Core;
use crate::golden::Bound;
use crate::registry::Device;

/// Steps by which an integer is changed. A larger one is tried only where no smaller one helps.
const STEPS: [i64; 4] = [1, 2, 4, 8];

/// What counts as a gain, in output units.
const GAIN: f64 = 1e-6;

/// A change of one key that makes the error bound smaller.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// The key.
    pub key: &'static str,
    /// Its value, as TOML.
    pub from: String,
    /// The value that helps, as TOML.
    pub to: String,
    /// The bound with it, in output units.
    pub units: f64,
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, from, to, units } = self;
        write!(f, "`{key} = {to}` in place of {from} would bring the bound to {units:.3} units")
    }
}

impl Core {
    /// The change of one key that would bring the error bound down most.
    pub fn advice(&self) -> Option<Advice> {
        advise(&self.device, &self.config, &self.contract.bound())
    }
}

/// The change of one key that the bound depends on, by as little as helps, that brings the bound down most; `None`
/// where none does. Domains stay as they are: to narrow one is to ask for less.
pub fn advise(device: &Device, config: &Config, bound: &Bound) -> Option<Advice> {
    let schema = (device.schema)();
    STEPS.into_iter().find_map(|step| {
        let tried = candidates(&schema, config, bound, step).into_iter();
        let advice = tried.filter_map(|(key, value)| {
            let changed = with(&schema, config, key, &value)?;
            let units = (device.contract)(&changed).bound().units;
            let from = config.value(key).toml();
            Some(Advice { key, from, to: value.toml(), units })
        });
        let best = advice.min_by(|a, b| a.units.total_cmp(&b.units))?;
        (best.units < bound.units - GAIN).then_some(best)
    })
}

/// The keys that the bound's terms name and the choices beside them, each with the values next to its own.
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
        let is_choice = matches!(key.kind, Kind::Choice(_) | Kind::Flag);
        let is_asked = governs(key.name) || is_choice && is_beside(key.name);
        if is_asked && table(key.name) != "domain" && config.applies(schema, key.name) {
            let values = neighbours(&key.kind, config.value(key.name), step);
            candidates.extend(values.into_iter().map(|value| (key.name, value)));
        }
    }
    candidates
}

/// The values next to one.
fn neighbours(kind: &Kind, value: &Value, step: i64) -> Vec<Value> {
    match (kind, value) {
        (_, Value::Integer(value)) => [value - step, value + step].map(Value::Integer).to_vec(),
        (Kind::Choice(options), Value::Text(text)) => {
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

/// The configuration with another value for a key; `None` where the device does not accept that.
fn with(schema: &Schema, config: &Config, key: &str, value: &Value) -> Option<Config> {
    let given = config.values().filter(|(name, _)| config.applies(schema, name));
    let given = given.map(|(name, own)| {
        let value = if name == key { value } else { own };
        (name.to_owned(), value.clone())
    });
    Config::from_values(schema, &config.name, given.collect()).ok()
}

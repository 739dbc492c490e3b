//! Finds the keys that `glint tune` may change, and the steps from a configuration to its neighbours.
//!
//! A key is free if each value that is tried for it makes a design, and none changes the ports of the core or its formula. The
//! number of microinstructions must also stay the same, unless the search may make slower cores. The keys of the tables `domain`
//! and `function` are never free, because they are part of the user's question.
//!
//! A step gives one free key a neighbouring value. For example, the integer 8 becomes 7, 9, 6, 10, 4 or 12, if the key allows it.

use anyhow::{Context, Result};

use glint_config::{Config, Key, KeyKind, Schema, Value};
use glint_core::cosim::{PointSource, Random};
use glint_core::registry::Device;
use glint_golden::Contract;
use glint_rtl::netlist::Design;

/// The steps by which the value of an integer key is changed.
const STEPS: [i64; 3] = [1, 2, 4];

/// The tables of keys that define the computation and its domain.
const STATEMENT: [&str; 2] = ["domain", "function"];

/// The number of points at which formulas are compared. Like a test's points, they mostly lie where the formula is neither 0 nor
/// flat.
const POINTS: u32 = 600;

/// The keys that `glint tune` may change. The core keeps its ports and its formula with every value of these keys.
pub struct SearchSpace {
    schema: Schema,
    free: Vec<&'static str>,
    outside: CoreInterface,
    /// Whether a changed configuration may have more microinstructions than the base.
    slower: bool,
}

impl SearchSpace {
    /// Finds the free keys. Keys that add microinstructions are free only if `slower` is set, and keys in `fixed` never are.
    ///
    /// # Errors
    ///
    /// Fails if `base` makes no design.
    pub fn new(device: &Device, base: &Config, fixed: &[&str], slower: bool) -> Result<Self> {
        let schema = (device.schema)();
        let opened = device.open(base.clone())?;
        let design = opened.design().context("no design can be made of this configuration")?;
        let outside = CoreInterface::new(&design, opened.contract().as_ref());
        let mut space = Self { schema, free: Vec::new(), outside, slower };
        let mut free = Vec::new();
        for key in &space.schema.keys {
            if !fixed.contains(&key.name) && space.is_free(device, base, key) {
                free.push(key.name);
            }
        }
        space.free = free;
        Ok(space)
    }

    /// Returns whether each value that is tried for `key` makes a design with the same interface. A number with a fraction is
    /// never free.
    fn is_free(&self, device: &Device, base: &Config, key: &Key) -> bool {
        let (table, _) = key.table_and_leaf();
        if STATEMENT.contains(&table) {
            return false;
        }
        let values = alternatives(key, base.value(key.name));
        if values.is_empty() {
            return false;
        }
        for value in values {
            // A value that is invalid together with the other values says nothing about the key.
            let Some(config) = self.with(base, &[(key.name, value)]) else { continue };
            let Ok(opened) = device.open(config) else { return false };
            let Ok(design) = opened.design() else { return false };
            if !self.holds(&design, opened.contract().as_ref()) {
                return false;
            }
        }
        true
    }

    /// Returns whether a core has the same ports and formula as the base configuration. Unless the core may be slower, it must
    /// also have the same number of microinstructions.
    pub fn holds(&self, design: &Design, contract: &dyn Contract) -> bool {
        let own = &self.outside;
        own.ports == ports(design)
            && (self.slower || own.microinstructions == design.control.microprogram.len())
            && own.has_formula(contract)
    }

    pub fn free(&self) -> &[&'static str] {
        &self.free
    }

    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// Returns the possible steps from a configuration: each is a free key that applies, and a neighbouring value.
    pub fn moves(&self, config: &Config) -> Vec<(&'static str, Value)> {
        let mut moves = Vec::new();
        for key in &self.schema.keys {
            if self.free.contains(&key.name) && config.applies(&self.schema, key.name) {
                for value in neighbours(&key.kind, config.value(key.name)) {
                    moves.push((key.name, value));
                }
            }
        }
        moves
    }

    /// Returns `config` with some values replaced. Returns `None` if the schema refuses the result, or if a replaced key does not
    /// apply.
    pub fn with(&self, config: &Config, values: &[(&'static str, Value)]) -> Option<Config> {
        with(&self.schema, config, values)
    }
}

fn with(schema: &Schema, config: &Config, values: &[(&'static str, Value)]) -> Option<Config> {
    let mut all: Vec<(String, Value)> = Vec::new();
    for (name, before) in config.values() {
        let value = match values.iter().find(|(key, _)| *key == name) {
            Some((_, value)) => value,
            None => before,
        };
        all.push((name.to_owned(), value.clone()));
    }
    // A choice decides which other keys apply. The draft must not have keys that no longer apply.
    let mut draft = all.clone();
    draft.retain(|(name, _)| applies(schema, &all, name));
    // Two keys of the table `pipeline` may set the same thing, and only one of them may be given. Keys with their default are
    // left out.
    draft.retain(|(name, value)| {
        schema.key(name).is_none_or(|key| !name.starts_with("pipeline.") || *value != key.default)
    });
    let mut config = Config::from_values(schema, &config.name, draft).ok()?;
    // `strict` is no key, although a file may set it.
    config.strict = false;
    values.iter().all(|(key, value)| config.value(key) == value).then_some(config)
}

/// Returns whether the key `name` applies if the keys have the values `values`.
fn applies(schema: &Schema, values: &[(String, Value)], name: &str) -> bool {
    let mut key = schema.key(name);
    while let Some(condition) = key.and_then(|key| key.condition) {
        match values.iter().find(|(other, _)| other == condition.key) {
            Some((_, value)) if condition.holds(value) => key = schema.key(condition.key),
            _ => return false,
        }
    }
    true
}

/// A core's interface: its ports, its number of microinstructions, and the values of its formula at 600 random points.
struct CoreInterface {
    ports: Vec<String>,
    microinstructions: usize,
    points: Vec<Vec<i64>>,
    formula: Vec<[f64; 2]>,
}

impl CoreInterface {
    fn new(design: &Design, contract: &dyn Contract) -> Self {
        let (drawn, mut random) = (PointSource::new(contract), Random::new(1));
        let points: Vec<Vec<i64>> = (0..POINTS).map(|_| drawn.of_domain(&mut random)).collect();
        Self {
            ports: ports(design),
            microinstructions: design.control.microprogram.len(),
            formula: formula(contract, &points),
            points,
        }
    }

    /// Returns whether the contract has the same formula. At a jump of a formula, two values are right, and the widths decide
    /// which one the hardware computes. It is enough that one of the two is also right for the second formula.
    fn has_formula(&self, contract: &dyn Contract) -> bool {
        let others = formula(contract, &self.points);
        if others.len() != self.formula.len() {
            return false;
        }
        for (values, others) in self.formula.iter().zip(&others) {
            if !values.iter().any(|value| others.contains(value)) {
                return false;
            }
        }
        true
    }
}

/// Returns a text with name and format for each port, for example `cos_gamma u0.20`.
fn ports(design: &Design) -> Vec<String> {
    let mut ports = Vec::new();
    for port in &design.ports {
        let net = design.net(port.net);
        ports.push(format!("{} {}", net.name, net.format));
    }
    ports
}

/// Returns the exact values at each point. Each result is a pair of values, which differ at a jump of the formula.
fn formula(contract: &dyn Contract, points: &[Vec<i64>]) -> Vec<[f64; 2]> {
    let mut values = Vec::new();
    for point in points {
        contract.exact(point, 0, &mut values);
    }
    values
}

/// Returns the values that are tried to find a key's effect: the neighbours of `value`, and the ends of the key's range.
fn alternatives(key: &Key, value: &Value) -> Vec<Value> {
    let mut values = neighbours(&key.kind, value);
    match (&key.kind, value) {
        (KeyKind::Integer { min, max }, _) => {
            values.extend([*min, *max].map(Value::Integer));
        }
        (KeyKind::Integers { min, max, .. }, Value::Integers(list)) => {
            values.extend([*min, *max].map(|end| Value::Integers(vec![end; list.len()])));
        }
        _ => {}
    }
    values
}

/// Returns the values next to `value` that lie in the key's range. For example, the list `[6, 6]` has `[5, 6]`, `[7, 6]`, `[6,
/// 5]`, `[6, 7]`, `[6, 6, 6]` and `[6]`. A choice or a flag has all its remaining values. A number with a fraction has no
/// neighbours.
fn neighbours(kind: &KeyKind, value: &Value) -> Vec<Value> {
    match (kind, value) {
        (KeyKind::Integer { min, max }, Value::Integer(value)) => {
            let mut values = Vec::new();
            for step in STEPS {
                for neighbour in [value - step, value + step] {
                    if (*min..=*max).contains(&neighbour) {
                        values.push(Value::Integer(neighbour));
                    }
                }
            }
            values
        }
        (KeyKind::Choice(options), Value::Text(text)) => {
            let others = options.iter().filter(|option| *option != text);
            others.map(|option| Value::Text((*option).to_owned())).collect()
        }
        (KeyKind::Flag, Value::Flag(flag)) => vec![Value::Flag(!flag)],
        (KeyKind::Integers { min, max, len_min, len_max }, Value::Integers(list)) => {
            let mut lists = Vec::new();
            for at in 0..list.len() {
                for by in [-1, 1] {
                    let mut changed = list.clone();
                    changed[at] += by;
                    lists.push(changed);
                }
            }
            let mut longer = list.clone();
            longer.extend(list.last());
            lists.push(longer);
            lists.push(list[..list.len().saturating_sub(1)].to_vec());
            lists.retain(|list| {
                (len_min..=len_max).contains(&&list.len())
                    && list.iter().all(|entry| (min..=max).contains(&entry))
            });
            lists.into_iter().map(Value::Integers).collect()
        }
        _ => Vec::new(),
    }
}

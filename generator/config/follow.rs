//! Adjusts the defaults of keys that the user left out.
//!
//! If the user's values and a default are invalid together, the default moves to the nearest value with which the fewest
//! conditions fail. For example, `exponent.bits = 8` lowers the default of `domain.exponent_max` from 1000 to 255. Only integers
//! and lists of integers are adjusted. Keys with a [`Key::drawn`] range and the keys that every device shares keep their
//! defaults.

use std::collections::BTreeSet;

use super::problems::Problems;
use super::schema::{Key, KeyKind, Schema};
use super::values::{Config, Value};

/// Adjusts defaults. Each step moves one key that is not in `given` to the value with which the device's fewest conditions fail.
/// A key moves at most once. The function stops if no condition fails, or if no move of a single key helps.
pub fn follow(schema: &Schema, config: &Config, given: &BTreeSet<&str>) -> Config {
    let mut config = config.clone();
    let mut left = complaints(schema, &config);
    let own = schema.keys.iter().filter(|key| key.drawn.is_none());
    let mut free: Vec<&Key> = own.filter(|key| !given.contains(key.name)).collect();
    while !left.is_empty() {
        // If several keys would help equally, the key under which the device reports the problem comes first.
        free.sort_by_key(|key| !left.contains(&key.name.to_owned()));
        let applying = free.iter().filter(|key| config.applies(schema, key.name));
        let moves = applying.filter_map(|key| best(schema, &config, key, left.len()));
        let Some((_, key, moved)) = moves.min_by_key(|(count, ..)| *count) else {
            break;
        };
        config = moved;
        free.retain(|other| other.name != key);
        left = complaints(schema, &config);
    }
    config
}

/// Finds the value of `key` with which the fewest conditions fail, and among several the nearest to the default. Returns the
/// number of failing conditions, the key, and the configuration. Returns `None` if `limit` or more conditions fail with every
/// value.
fn best<'k>(
    schema: &Schema,
    config: &Config,
    key: &'k Key,
    limit: usize,
) -> Option<(usize, &'k str, Config)> {
    let mut best: Option<(usize, &str, Config)> = None;
    for value in neighbours(key) {
        let mut moved = config.clone();
        moved.set(key.name, value);
        let count = complaints(schema, &moved).len();
        if count < best.as_ref().map_or(limit, |(count, ..)| *count) {
            best = Some((count, key.name, moved));
            if count == 0 {
                break;
            }
        }
    }
    best
}

/// Returns the key of each condition that fails, in the report's order.
fn complaints(schema: &Schema, config: &Config) -> Vec<String> {
    let mut problems = Problems::default();
    (schema.check)(config, &mut problems);
    problems.iter().map(|problem| problem.error.key.clone()).collect()
}

/// Returns the values of an integer key without the default, or the lists of [`lists`] for a list of integers. The nearest to the
/// default comes first, and the smaller of two equally near ones. The result is empty for keys of other types.
fn neighbours(key: &Key) -> Vec<Value> {
    match (&key.kind, &key.default) {
        (KeyKind::Integer { min, max }, Value::Integer(default)) => {
            let farthest = (default - min).max(max - default);
            let pairs = (1..=farthest).flat_map(|by| [default - by, default + by]);
            pairs.filter(|value| (min..=max).contains(&value)).map(Value::Integer).collect()
        }
        (KeyKind::Integers { min, max, len_min, len_max }, Value::Integers(default)) => {
            let lists = lists(default, (*min, *max), (*len_min, *len_max));
            lists.into_iter().map(Value::Integers).collect()
        }
        _ => Vec::new(),
    }
}

/// Returns lists that are similar to `default`, the nearest first. A list has the first entries of `default` with a limit on
/// large entries, or all entries with the last one repeated. The distance is the sum of the differences of the entries. A missing
/// entry counts as 0.
fn lists(
    default: &[i64],
    (min, max): (i64, i64),
    (shortest, longest): (usize, usize),
) -> Vec<Vec<i64>> {
    let own = default.len();
    let most = default.iter().copied().max().unwrap_or(max);
    let last = default.last().copied().unwrap_or(min);
    let shrunk = (shortest..=own.min(longest)).flat_map(|len| {
        (min..=most).map(move |cap| default[..len].iter().map(|entry| *entry.min(&cap)).collect())
    });
    let grown = (own + 1..=longest).map(|len| {
        let more = std::iter::repeat_n(last, len - own);
        default.iter().copied().chain(more).collect()
    });
    let distance = |list: &Vec<i64>| -> i64 {
        let entry = |list: &[i64], at: usize| list.get(at).copied().unwrap_or(0);
        (0..longest.max(own)).map(|at| (entry(list, at) - entry(default, at)).abs()).sum()
    };
    let mut lists: Vec<Vec<i64>> = shrunk.chain(grown).collect();
    lists.sort_by_key(distance);
    lists
}

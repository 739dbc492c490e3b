//! Adjusts the defaults of keys that the user left out.
//!
//! If the user's values and a default are invalid together, the default moves to the nearest valid value. For example,
//! `exponent.bits = 8` lowers the default of `domain.exponent_max` from 1000 to 255. Widths and counts are adjusted; choices,
//! flags and the keys that every device shares never are.

use std::collections::BTreeSet;

use super::problems::Problems;
use super::schema::{Key, KeyKind, Schema};
use super::values::{Config, Value};

/// Returns the configuration with adjusted defaults. Each key that is not in `given` moves, one after the other, to the value
/// that satisfies the most conditions of the device. If a condition still fails afterwards, only a change of a key in `given` can
/// satisfy it.
pub fn follow(schema: &Schema, config: &Config, given: &BTreeSet<&str>) -> Config {
    let mut config = config.clone();
    let mut left = complaints(schema, &config);
    let own = schema.keys.iter().filter(|key| key.drawn.is_none());
    let mut free: Vec<&Key> = own.filter(|key| !given.contains(key.name)).collect();
    while !left.is_empty() {
        // The key that the device complains of comes first where several would do.
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

/// Returns the nearest value of a key that leaves the fewest complaints, if those are fewer than `limit`: their number, the key
/// and the configuration.
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

/// Returns the keys under which the device complains, one for each complaint.
fn complaints(schema: &Schema, config: &Config) -> Vec<String> {
    let mut problems = Problems::default();
    (schema.check)(config, &mut problems);
    problems.iter().map(|problem| problem.error.key.clone()).collect()
}

/// Returns the other values of a key, the value nearest to its default first. If two integers are equally near, the smaller comes
/// first.
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

/// Makes lists of one: its first entries with the large ones cut down, or all of them with the last repeated. The
/// nearest first, by the sum of the differences; an entry that is not there counts as 0.
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

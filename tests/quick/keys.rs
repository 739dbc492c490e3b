//! Tests that every configuration key has an effect: setting it changes an emitted file, or Glint refuses the configuration.
//!
//! Each key is tested together with another key that chooses a form of the core, for example `architecture`. A run takes
//! some of these pairs. Three keys are exempt, because a core may already be as they demand. Keys for lists and tables are
//! not tested here.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use rayon::prelude::*;

use crate::common::Sure;
use crate::common::files::{paths, read};
use crate::common::sample::sampled;
use glint::config::{self, Key, KeyKind, Schema, TextPattern, shared_keys};
use glint::core::Core;
use glint::registry::{Device, Registry};

/// Keys that ask for something that a core may have anyway: no register behind logic of operands, one behind every result, and
/// memories, where it has any, in a form.
const MAY_HOLD_ANYWAY: [&str; 3] = ["operands.logic", "output.registered", "package.memories"];

/// A key with a value, as TOML writes it.
type Setting = (&'static str, String);

/// Returns values of a key other than its default.
fn others(key: &Key) -> Vec<String> {
    let default = key.default.toml();
    let candidates: Vec<String> = match &key.kind {
        KeyKind::Flag => vec!["true".to_owned(), "false".to_owned()],
        KeyKind::Choice(options) if key.kind.is_integer_choice() => {
            options.iter().map(|option| (*option).to_owned()).collect()
        }
        KeyKind::Choice(options) => options.iter().map(|option| format!("{option:?}")).collect(),
        KeyKind::Integer { min, max } => {
            let default: i64 = default.parse().sure();
            [default - 1, default + 1, *min, *max]
                .into_iter()
                .filter(|value| (min..=max).contains(&value))
                .map(|value| value.to_string())
                .collect()
        }
        KeyKind::Number { min, max, .. } => {
            let default: f64 = default.parse().sure();
            [default + 1.0, default / 2.0, *min, *max]
                .into_iter()
                .filter(|value| (min..=max).contains(&value))
                .map(|value| format!("{value:?}"))
                .collect()
        }
        KeyKind::Text(TextPattern::Formula) => {
            vec!["\"3 / 2 + x / 16 - x / 16\"".to_owned(), "3".to_owned()]
        }
        KeyKind::Text(TextPattern::Version) => vec!["\"9.8.7\"".to_owned()],
        KeyKind::Text(TextPattern::Name | TextPattern::Licence | TextPattern::Remark) => {
            vec!["\"Another\"".to_owned()]
        }
        KeyKind::Text(TextPattern::Samples) => vec!["\"1,0 4,1\"".to_owned()],
        KeyKind::Integers { .. } | KeyKind::Table { .. } => Vec::new(),
    };
    candidates
        .into_iter()
        .filter(|value| value.trim_matches('"') != default.trim_matches('"'))
        .collect()
}

/// Returns whether a key chooses between forms of a core.
fn is_choice(key: &Key) -> bool {
    matches!(key.kind, KeyKind::Flag | KeyKind::Choice(_))
}

/// Returns the emitted files, without the digest of the configuration; `None` if it is refused.
fn emitted(device: Device, settings: &[&Setting]) -> Option<String> {
    let mut text = format!("device = {:?}\nname = \"core\"\n", device.name);
    for (key, value) in settings {
        writeln!(text, "{key} = {value}").sure();
    }
    let registry = Registry::shipped();
    let config = config::parse("core.toml", &text, &registry.schemas()).ok()?;
    let files = Core::new(device, config).ok()?.files("core.toml", None).ok()?;
    let mut all = String::new();
    for file in files {
        let lines = file.contents.lines().filter(|line| !line.contains("\"configuration\""));
        let digests = |line: &&str| !line.contains("sha256");
        all +=
            &format!("{}\n{}\n", file.path, lines.filter(digests).collect::<Vec<_>>().join("\n"));
    }
    Some(all)
}

/// A choice of a device, and another key of it.
struct Pair {
    device: Device,
    choice: Setting,
    key: &'static str,
    /// Values of the other key.
    values: Vec<String>,
}

impl Pair {
    /// Returns whether no value of the other key changes a file or is refused.
    fn is_ignored(&self) -> bool {
        let Some(before) = emitted(self.device, &[&self.choice]) else { return false };
        self.values.iter().all(|value| {
            let setting = (self.key, value.clone());
            emitted(self.device, &[&self.choice, &setting]).is_some_and(|after| after == before)
        })
    }
}

/// Returns all pairs of a choice and another key of a device.
fn pairs(device: Device) -> Vec<Pair> {
    let schema: Schema = (device.schema)();
    let keys: Vec<&Key> = schema.keys.iter().chain(shared_keys()).collect();
    let mut pairs = Vec::new();
    for choice in keys.iter().filter(|key| is_choice(key)) {
        for value in others(choice) {
            for other in keys.iter().filter(|other| other.name != choice.name) {
                let (choice, values) = ((choice.name, value.clone()), others(other));
                if !values.is_empty() && !MAY_HOLD_ANYWAY.contains(&other.name) {
                    pairs.push(Pair { device, choice, key: other.name, values });
                }
            }
        }
    }
    pairs
}

#[test]
fn every_key_changes_what_is_emitted_or_is_refused() {
    let registry = Registry::shipped();
    let all = registry.devices().iter().flat_map(|device| pairs(*device));
    let drawn = sampled("keys with a choice", all);
    let ignored: Vec<String> = drawn
        .par_iter()
        .filter(|pair| pair.is_ignored())
        .map(|Pair { device, choice, key, .. }| {
            format!("{}: {key} with {} = {}", device.name, choice.0, choice.1)
        })
        .collect();
    assert!(ignored.is_empty(), "keys without effect:\n{}", ignored.join("\n"));
}

/// The comments of the shipped configurations state the ranges that the schemas have.
#[test]
fn comments_of_configurations_state_the_ranges_of_today() {
    let registry = Registry::shipped();
    let range = regex::Regex::new(r"n integer\s+from (-?\d+) to (-?\d+)").sure();
    let mut checked = BTreeSet::new();
    for path in ["configs", "configs/studies"].iter().flat_map(|folder| paths(folder, ".toml")) {
        let device = config::read(Path::new(&path), &registry.schemas()).sure().device;
        let schema = (registry.device(&device).expect("a device").schema)();
        let (mut table, mut comment) = (String::new(), String::new());
        for line in read(&path).lines() {
            if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
                table = format!("{name}.");
            }
            if let Some(text) = line.strip_prefix('#') {
                comment += text;
                continue;
            }
            let key = line.split(" = ").next().map(|leaf| format!("{table}{leaf}"));
            let known = key.and_then(|name| schema.keys.iter().find(|key| key.name == name));
            if let (Some(key), Some(stated)) = (known, range.captures(&comment)) {
                let stated = format!("an integer from {} to {}", &stated[1], &stated[2]);
                assert_eq!(stated, key.accepts(), "`{}` in {path}", key.name);
                checked.insert(key.name);
            }
            comment.clear();
        }
    }
    assert!(checked.len() > 20, "{checked:?}");
}

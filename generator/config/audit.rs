//! Finds mistakes in a device's schema, the list of its configuration keys, for tests of devices.

use super::problems::Problems;
use super::schema::{Condition, Key, KeyKind, Schema};
use super::shared::shared_keys;
use super::values::Config;

impl Schema {
    /// Returns a sentence for each mistake in the schema. A name must be plain lower-case words, must be unique, and must not
    /// name both a table and a value. A default must be inside its range. A condition's key must be declared before, and must be
    /// able to have the value. If the schema has no such mistake, the device's `check` must accept the defaults.
    pub fn mistakes(&self) -> Vec<String> {
        let mut mistakes = Vec::new();
        for (index, key) in self.keys.iter().enumerate() {
            let name = key.name;
            if !name.split('.').all(is_plain) {
                mistakes.push(format!("`{name}` is not made of plain lower-case words"));
            }
            let shared = shared_keys().iter().map(|key| key.name);
            let mut common = super::COMMON.iter().map(|(common, _)| *common).chain(shared);
            if common.any(|common| common == name) {
                mistakes.push(format!("`{name}` is a key of every device"));
            }
            if self.keys[..index].iter().any(|other| other.name == name) {
                mistakes.push(format!("`{name}` is declared twice"));
            }
            let table = format!("{name}.");
            if self.all_keys().any(|other| other.name.starts_with(&table)) {
                mistakes.push(format!("`{name}` is both a key and a table"));
            }
            for violation in key.violations_of(&key.default) {
                mistakes.push(format!("default of `{name}`: {}", violation.error.message));
            }
            if let Some(Condition { key: other, value, .. }) = key.condition {
                // The other key must be declared earlier, so chains of conditions end.
                match self.keys[..index].iter().find(|key| key.name == other) {
                    None => mistakes.push(format!(
                        "`{name}` depends on `{other}`, which is not declared before it"
                    )),
                    Some(other) if !other.can_be(value) => mistakes.push(format!(
                        "`{name}` depends on `{}` = {value}, a value that the key cannot have",
                        other.name
                    )),
                    Some(_) => {}
                }
            }
        }
        if mistakes.is_empty() {
            let mut problems = Problems::default();
            (self.check)(&Config::defaults(self, self.device), &mut problems);
            mistakes.extend(
                problems.iter().map(|problem| format!("defaults: {}", problem.error.message)),
            );
        }
        mistakes
    }
}

impl Key {
    /// Returns whether the key accepts a value that [`super::Value::bare`] displays as `bare`. Only choices, flags and integers
    /// can be a condition's subject.
    fn can_be(&self, bare: &str) -> bool {
        match &self.kind {
            KeyKind::Choice(options) => options.contains(&bare),
            KeyKind::Flag => bare == "true" || bare == "false",
            KeyKind::Integer { min, max } => {
                bare.parse().is_ok_and(|value: i64| (*min..=*max).contains(&value))
            }
            // Conditions on fractions, lists and texts would depend on the way in which they are written.
            KeyKind::Number { .. }
            | KeyKind::Integers { .. }
            | KeyKind::Text(_)
            | KeyKind::Table { .. } => false,
        }
    }
}

fn is_plain(part: &str) -> bool {
    part.starts_with(|c: char| c.is_ascii_lowercase())
        && part.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

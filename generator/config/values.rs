//! Holds the values of keys, and a configuration of them.

use serde::Serialize;

use super::records::Records;

/// The value of a key. It is serialised as the value alone. For example, `Value::Integer(20)` is serialised as `20`.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A value of [`super::KeyKind::Integer`].
    Integer(i64),
    /// A value of [`super::KeyKind::Number`].
    Number(f64),
    /// A value of [`super::KeyKind::Choice`] and [`super::KeyKind::Text`].
    Text(String),
    /// A value of [`super::KeyKind::Flag`].
    Flag(bool),
    /// A value of [`super::KeyKind::Integers`].
    Integers(Vec<i64>),
    /// A value of [`super::KeyKind::Records`].
    Records(Records),
}

impl Value {
    /// Returns the text that [`super::Key::condition`] compares with: the value without quotes.
    pub fn bare(&self) -> String {
        match self {
            Value::Integer(value) => value.to_string(),
            // The shortest text that reads back as the same number; `1e300` in place of 300 zeros.
            Value::Number(value) => format!("{value:?}"),
            Value::Text(value) => value.clone(),
            Value::Flag(value) => value.to_string(),
            Value::Integers(values) => {
                let values: Vec<String> = values.iter().map(i64::to_string).collect();
                format!("[{}]", values.join(", "))
            }
            Value::Records(records) => records.toml(),
        }
    }

    /// Returns the value as TOML: [`Value::bare`], with quotes around a word. For example, the text `truncate` becomes
    /// `"truncate"`, and the text `16` stays `16`.
    pub fn toml(&self) -> String {
        match self {
            Value::Text(text) if !is_integer(text) => format!("\"{text}\""),
            other => other.bare(),
        }
    }
}

/// A configuration whose every value is in range and whose combination the device accepts.
///
/// Keys that do not apply (see [`super::Key::condition`]) hold their defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// The name of the Verilog module and of its files: a legal identifier.
    pub name: String,
    /// The name of the device.
    pub device: String,
    /// Whether Glint must refuse a configuration outside the accuracy contract, rather than warn of it.
    pub strict: bool,
    /// In the order of the schema.
    pub(super) values: Vec<(&'static str, Value)>,
}

impl Config {
    /// Returns the value of an integer key, or of a choice among integers.
    ///
    /// # Panics
    /// Panics if the device has no such key, or if the key is of another kind. The caller must know both.
    pub fn integer(&self, key: &str) -> i64 {
        match self.value(key) {
            Value::Integer(value) => *value,
            Value::Text(text) => {
                text.parse().unwrap_or_else(|_| self.wrong_kind(key, "an integer"))
            }
            _ => self.wrong_kind(key, "an integer"),
        }
    }

    /// Returns the value of a number key.
    ///
    /// # Panics
    /// Panics as [`Config::integer`] does.
    pub fn number(&self, key: &str) -> f64 {
        match self.value(key) {
            Value::Number(value) => *value,
            _ => self.wrong_kind(key, "a number"),
        }
    }

    /// Returns the value of a choice.
    ///
    /// # Panics
    /// Panics as [`Config::integer`] does.
    pub fn choice(&self, key: &str) -> &str {
        match self.value(key) {
            Value::Text(value) => value,
            _ => self.wrong_kind(key, "a choice"),
        }
    }

    /// Returns the value of a text.
    ///
    /// # Panics
    /// Panics as [`Config::integer`] does.
    pub fn text(&self, key: &str) -> &str {
        match self.value(key) {
            Value::Text(value) => value,
            _ => self.wrong_kind(key, "a text"),
        }
    }

    /// Returns the value of a flag.
    ///
    /// # Panics
    /// Panics as [`Config::integer`] does.
    pub fn flag(&self, key: &str) -> bool {
        match self.value(key) {
            Value::Flag(value) => *value,
            _ => self.wrong_kind(key, "a flag"),
        }
    }

    /// Returns the value of a list of integers.
    ///
    /// # Panics
    /// Panics as [`Config::integer`] does.
    pub fn integers(&self, key: &str) -> &[i64] {
        match self.value(key) {
            Value::Integers(values) => values,
            _ => self.wrong_kind(key, "a list of integers"),
        }
    }

    /// Returns the entries of a table of records.
    ///
    /// # Panics
    /// Panics as [`Config::integer`] does.
    pub fn records(&self, key: &str) -> &Records {
        match self.value(key) {
            Value::Records(records) => records,
            _ => self.wrong_kind(key, "a table of records"),
        }
    }

    /// Returns every key with its value, in the order of the schema.
    pub fn values(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.values.iter().map(|(name, value)| (*name, value))
    }

    /// Returns the value of a key of any kind.
    ///
    /// # Panics
    /// Panics if the device has no such key. The caller must know the keys.
    pub fn value(&self, key: &str) -> &Value {
        match self.values.iter().find(|(name, _)| *name == key) {
            Some((_, value)) => value,
            None => panic!("device `{}` has no key `{key}`", self.device),
        }
    }

    /// Replaces a value. The caller must make sure that the value is in the range of its key.
    pub fn set(&mut self, key: &str, value: Value) {
        if let Some(slot) = self.values.iter_mut().find(|(name, _)| *name == key) {
            slot.1 = value;
        }
    }

    fn wrong_kind(&self, key: &str, asked: &str) -> ! {
        panic!("key `{key}` of device `{}` is {:?}, not {asked}", self.device, self.value(key))
    }
}

/// Returns whether a word is an integer as it is displayed: `007` and `+7` are not.
pub(super) fn is_integer(word: &str) -> bool {
    word.parse::<i64>().is_ok_and(|value| value.to_string() == word)
}

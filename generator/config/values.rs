//! A validated configuration.

use super::problems::Problems;
use super::schema::{Schema, Value};

/// A configuration whose every value is in range and whose combination the device accepts.
///
/// Keys that do not apply (see [`super::Key::only_when`]) hold their defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// The name of the Verilog module and of its files: a legal identifier.
    pub name: String,
    /// The name of the device.
    pub device: String,
    /// Whether a configuration outside the accuracy contract is refused rather than warned about.
    pub strict: bool,
    /// In the order of the schema.
    values: Vec<(&'static str, Value)>,
}

impl Config {
    /// The defaults of a device.
    pub fn defaults(schema: &Schema, name: &str) -> Self {
        Config {
            name: name.to_owned(),
            device: schema.device.to_owned(),
            strict: false,
            values: schema.all_keys().map(|key| (key.name, key.default.clone())).collect(),
        }
    }

    /// The defaults with some values replaced, under the same rules as a file.
    ///
    /// # Errors
    /// The problems that a file with these values would have, without positions.
    pub fn from_values(
        schema: &Schema,
        name: &str,
        values: Vec<(String, Value)>,
    ) -> Result<Self, Problems> {
        super::validate::from_values(schema, name, values)
    }

    /// The value of an integer key, or of a choice among integers.
    ///
    /// # Panics
    /// If the device has no such key, or it is of another kind: a mistake in the caller.
    pub fn integer(&self, key: &str) -> i64 {
        match self.value(key) {
            Value::Integer(value) => *value,
            Value::Text(text) => match text.parse() {
                Ok(value) => value,
                Err(_) => self.wrong_kind(key, "an integer"),
            },
            _ => self.wrong_kind(key, "an integer"),
        }
    }

    /// The value of a number key.
    ///
    /// # Panics
    /// As [`Config::integer`].
    pub fn number(&self, key: &str) -> f64 {
        match self.value(key) {
            Value::Number(value) => *value,
            _ => self.wrong_kind(key, "a number"),
        }
    }

    /// The value of a choice.
    ///
    /// # Panics
    /// As [`Config::integer`].
    pub fn choice(&self, key: &str) -> &str {
        match self.value(key) {
            Value::Text(value) => value,
            _ => self.wrong_kind(key, "a choice"),
        }
    }

    /// The value of a flag.
    ///
    /// # Panics
    /// As [`Config::integer`].
    pub fn flag(&self, key: &str) -> bool {
        match self.value(key) {
            Value::Flag(value) => *value,
            _ => self.wrong_kind(key, "a flag"),
        }
    }

    /// The value of a list of integers.
    ///
    /// # Panics
    /// As [`Config::integer`].
    pub fn integers(&self, key: &str) -> &[i64] {
        match self.value(key) {
            Value::Integers(values) => values,
            _ => self.wrong_kind(key, "a list of integers"),
        }
    }

    /// Every key with its value, in the order of the schema.
    pub fn values(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.values.iter().map(|(name, value)| (*name, value))
    }

    /// Whether the key of this name has an effect with the other values as they are.
    pub fn applies(&self, schema: &Schema, key: &str) -> bool {
        match schema.key(key).and_then(|key| key.only_when) {
            None => true,
            Some((other, value)) => {
                self.value(other).bare() == value && self.applies(schema, other)
            }
        }
    }

    /// The configuration as a TOML file that reads back as the same: every key of the device that
    /// applies, and of those that every device shares the ones that differ from their defaults.
    pub fn to_toml(&self, schema: &Schema) -> String {
        super::write::plain(schema, self)
    }

    /// The value of a key of any kind.
    ///
    /// # Panics
    /// If the device has no such key: a mistake in the caller.
    pub fn value(&self, key: &str) -> &Value {
        match self.values.iter().find(|(name, _)| *name == key) {
            Some((_, value)) => value,
            None => panic!("device `{}` has no key `{key}`", self.device),
        }
    }

    /// Replaces a value. The caller answers for its range.
    pub(super) fn set(&mut self, key: &str, value: Value) {
        if let Some(slot) = self.values.iter_mut().find(|(name, _)| *name == key) {
            slot.1 = value;
        }
    }

    fn wrong_kind(&self, key: &str, asked: &str) -> ! {
        panic!("key `{key}` of device `{}` is {:?}, not {asked}", self.device, self.value(key))
    }
}

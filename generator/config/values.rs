//! Defines configurations and the values of their keys.
//!
//! The value of most keys is a number, a word or a text. The value of some keys, such as `operands` of the device `expression`,
//! is a table whose entries have names that the user chooses. For example:
//!
//! ```toml
//! [operands]
//! x = { from = -1, to = 1, fraction = 15 }
//! y = { bits = 16, fraction = 15, signed = true }
//! ```

use serde::ser::{Serialize, SerializeMap, Serializer};

/// The value of a configuration key. `Value::Integer(20)` is serialised as `20`.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A value of [`super::KeyKind::Integer`].
    Integer(i64),
    /// A value of [`super::KeyKind::Number`].
    Number(f64),
    /// A value of [`super::KeyKind::Choice`] or [`super::KeyKind::Text`].
    Text(String),
    /// A value of [`super::KeyKind::Flag`].
    Flag(bool),
    /// A value of [`super::KeyKind::Integers`].
    Integers(Vec<i64>),
    /// A value of [`super::KeyKind::Table`].
    Table(TableEntries),
}

impl Value {
    /// Returns the value as text without quotes, with which [`super::Key::condition`] compares.
    pub fn bare(&self) -> String {
        match self {
            Value::Integer(value) => value.to_string(),
            // The shortest text that is read as the same number, for example `1e300` instead of 300 zeros.
            Value::Number(value) => format!("{value:?}"),
            Value::Text(value) => value.clone(),
            Value::Flag(value) => value.to_string(),
            Value::Integers(values) => {
                let values: Vec<String> = values.iter().map(i64::to_string).collect();
                format!("[{}]", values.join(", "))
            }
            Value::Table(records) => records.toml(),
        }
    }

    /// Returns the value in TOML syntax. The text is the result of [`Value::bare`], with quotes around a text that is no integer.
    /// For example, `truncate` becomes `"truncate"`, and `16` stays `16`.
    pub fn toml(&self) -> String {
        match self {
            Value::Text(text) if !is_integer(text) => format!("\"{text}\""),
            other => other.bare(),
        }
    }
}

/// An entry of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct TableEntry {
    /// The name that the user chose.
    pub name: String,
    /// The fields that the user gave.
    pub fields: Vec<(&'static str, Value)>,
}

/// A table's entries, in the file's order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableEntries(pub Vec<TableEntry>);

impl TableEntry {
    /// Returns an entry with the name `name`. For example, `TableEntry::new("x", &[("fraction", Value::Integer(15))])`.
    pub fn new(name: &str, fields: &[(&'static str, Value)]) -> Self {
        Self { name: name.to_owned(), fields: fields.to_vec() }
    }

    /// Returns the value of the field `name`, or `None` if the user did not give the field.
    pub fn field(&self, name: &str) -> Option<&Value> {
        self.fields.iter().find(|(own, _)| *own == name).map(|(_, value)| value)
    }

    /// Returns the text in the field `name`, or `None` if the user gave no text.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.field(name)? {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Returns the number of bits in the field `name`, or `None` if the user gave no integer of 0 or more.
    pub fn bits(&self, name: &str) -> Option<u32> {
        match self.field(name)? {
            Value::Integer(value) => u32::try_from(*value).ok(),
            _ => None,
        }
    }

    /// Returns the number in the field `name`, or `None` if the user gave no [`Value::Number`]. An integer is not a
    /// [`Value::Number`].
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.field(name)? {
            Value::Number(value) => Some(*value),
            _ => None,
        }
    }

    /// Returns whether the user gave the field `name` as `true`.
    pub fn flag(&self, name: &str) -> bool {
        self.field(name) == Some(&Value::Flag(true))
    }

    /// Returns the entry in TOML syntax, such as `{ from = -1, to = 1 }`. If the field `shorthand` is the only field, returns
    /// only its value.
    pub(super) fn toml(&self, shorthand: Option<&str>) -> String {
        if let [(name, value)] = self.fields.as_slice()
            && Some(*name) == shorthand
        {
            return value.toml();
        }
        let mut fields = Vec::new();
        for (name, value) in &self.fields {
            fields.push(format!("{name} = {}", value.toml()));
        }
        format!("{{ {} }}", fields.join(", "))
    }
}

impl TableEntries {
    /// Returns the entries as a TOML table on one line, such as `{ x = { fraction = 15 } }`.
    pub(super) fn toml(&self) -> String {
        let mut entries = Vec::new();
        for record in &self.0 {
            entries.push(format!("{} = {}", record.name, record.toml(None)));
        }
        if entries.is_empty() { "{}".to_owned() } else { format!("{{ {} }}", entries.join(", ")) }
    }
}

impl Serialize for TableEntries {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for record in &self.0 {
            map.serialize_entry(&record.name, record)?;
        }
        map.end()
    }
}

impl Serialize for TableEntry {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.fields.len()))?;
        for (name, value) in &self.fields {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}

/// The values of all keys of one device. [`super::read()`], [`super::parse()`], [`super::sample()`] and [`Config::from_values`]
/// return valid configurations: every value is in the range of its key, and the device accepts the combination.
/// [`Config::defaults`] and [`Config::set`] do not check this.
///
/// In a valid configuration, keys that do not apply (see [`super::Key::condition`]) have their defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// The name of the Verilog module and of its files, a legal Verilog identifier.
    pub name: String,
    pub device: String,
    /// Whether Glint must refuse a configuration that violates the accuracy contract, instead of warning about it.
    pub strict: bool,
    /// The values, in the schema's order.
    pub(super) values: Vec<(&'static str, Value)>,
}

impl Config {
    /// Returns the value of a key for integers, or of a choice among integers.
    ///
    /// # Panics
    /// Panics if the device has no such key, or if the key is of another type.
    pub fn integer(&self, key: &str) -> i64 {
        match self.value(key) {
            Value::Integer(value) => *value,
            Value::Text(text) => {
                text.parse().unwrap_or_else(|_| self.wrong_kind(key, "an integer"))
            }
            _ => self.wrong_kind(key, "an integer"),
        }
    }

    /// Returns the value of a key for numbers. Panics if the device has no such key, or a key of another type.
    pub fn number(&self, key: &str) -> f64 {
        match self.value(key) {
            Value::Number(value) => *value,
            _ => self.wrong_kind(key, "a number"),
        }
    }

    /// Returns a choice's word. Panics if the device has no such key, or a key of another type.
    pub fn choice(&self, key: &str) -> &str {
        match self.value(key) {
            Value::Text(value) => value,
            _ => self.wrong_kind(key, "a choice"),
        }
    }

    /// Returns the text of a key for texts, or a choice's word. Panics if the device has no such key, or a key of another type.
    pub fn text(&self, key: &str) -> &str {
        match self.value(key) {
            Value::Text(value) => value,
            _ => self.wrong_kind(key, "a text"),
        }
    }

    /// Returns a flag's value. Panics if the device has no such key, or a key of another type.
    pub fn flag(&self, key: &str) -> bool {
        match self.value(key) {
            Value::Flag(value) => *value,
            _ => self.wrong_kind(key, "a flag"),
        }
    }

    /// Returns the value of a key for lists. Panics if the device has no such key, or a key of another type.
    pub fn integers(&self, key: &str) -> &[i64] {
        match self.value(key) {
            Value::Integers(values) => values,
            _ => self.wrong_kind(key, "a list of integers"),
        }
    }

    /// Returns the entries of a key for a table. Panics if the device has no such key, or a key of another type.
    pub fn records(&self, key: &str) -> &TableEntries {
        match self.value(key) {
            Value::Table(records) => records,
            _ => self.wrong_kind(key, "a table of records"),
        }
    }

    /// Returns every key with its value: first the keys of the device in the order of its schema, and then the shared keys.
    pub fn values(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.values.iter().map(|(name, value)| (*name, value))
    }

    /// Returns the value of a key of any type. Panics if the device has no such key.
    pub fn value(&self, key: &str) -> &Value {
        match self.values.iter().find(|(name, _)| *name == key) {
            Some((_, value)) => value,
            None => panic!("device `{}` has no key `{key}`", self.device),
        }
    }

    /// Replaces a key's value. The caller must ensure that the key accepts the value. Does nothing if the device has no such key.
    pub fn set(&mut self, key: &str, value: Value) {
        if let Some(slot) = self.values.iter_mut().find(|(name, _)| *name == key) {
            slot.1 = value;
        }
    }

    fn wrong_kind(&self, key: &str, asked: &str) -> ! {
        panic!("key `{key}` of device `{}` is {:?}, not {asked}", self.device, self.value(key))
    }
}

/// Returns whether `word` is a 64-bit integer in its usual form. For example, `7` is one, and `007` and `+7` are not.
pub(super) fn is_integer(word: &str) -> bool {
    word.parse::<i64>().is_ok_and(|value| value.to_string() == word)
}

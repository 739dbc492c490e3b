//! Defines records: entries of a table that have names of the user's own, each with the same fields.
//!
//! For example, the table `operands` of the device `expression` has an entry for each operand, by the operand's name:
//!
//! ```toml
//! [operands]
//! x = { from = -1, to = 1, fraction = 15 }
//! y = { bits = 16, fraction = 15, signed = true }
//! ```

use serde::ser::{Serialize, SerializeMap, Serializer};

use super::schema::Key;
use super::values::Value;

/// One entry of a table: its name, and the fields that the user gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The name of the entry.
    pub name: String,
    /// The fields that are given, by their names.
    pub fields: Vec<(&'static str, Value)>,
}

/// The entries of a table, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Records(pub Vec<Record>);

impl Record {
    /// Makes an entry from the TOML of its fields. For example, `Record::new("x", &[("fraction", Value::Integer(15))])`.
    pub fn new(name: &str, fields: &[(&'static str, Value)]) -> Self {
        Self { name: name.to_owned(), fields: fields.to_vec() }
    }

    /// Returns the value of a field; `None` if it is not given.
    pub fn field(&self, name: &str) -> Option<&Value> {
        self.fields.iter().find(|(own, _)| *own == name).map(|(_, value)| value)
    }

    /// Returns the text of a field; `None` if it is not given.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.field(name)? {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Returns the number of bits that a field states; `None` if it is not given.
    pub fn bits(&self, name: &str) -> Option<u32> {
        match self.field(name)? {
            Value::Integer(value) => u32::try_from(*value).ok(),
            _ => None,
        }
    }

    /// Returns the number of a field; `None` if it is not given.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.field(name)? {
            Value::Number(value) => Some(*value),
            _ => None,
        }
    }

    /// Returns whether a field is given as `true`.
    pub fn flag(&self, name: &str) -> bool {
        self.field(name) == Some(&Value::Flag(true))
    }

    /// Returns the entry as TOML. `shorthand` names the field whose value alone states an entry without others.
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

impl Records {
    /// Returns the entries as a TOML table on one line. For example, `{ x = { fraction = 15 } }`.
    pub(super) fn toml(&self) -> String {
        let mut entries = Vec::new();
        for record in &self.0 {
            entries.push(format!("{} = {}", record.name, record.toml(None)));
        }
        if entries.is_empty() { "{}".to_owned() } else { format!("{{ {} }}", entries.join(", ")) }
    }
}

impl Serialize for Records {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for record in &self.0 {
            map.serialize_entry(&record.name, record)?;
        }
        map.end()
    }
}

impl Serialize for Record {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.fields.len()))?;
        for (name, value) in &self.fields {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}

/// Returns the name of a field of a record, as messages name it. For example, `operands.x.fraction`.
pub fn field_name(key: &Key, record: &str, field: &str) -> String {
    format!("{}.{record}.{field}", key.name)
}

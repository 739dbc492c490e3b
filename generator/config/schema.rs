//! Defines the schema of a device: the list of its configuration keys, with types, ranges, defaults, conditions and descriptions.

use std::ops::RangeInclusive;

use super::problems::Problems;
use super::text_pattern::TextPattern;
use super::values::{Config, TableEntries, TableEntry, Value, is_integer};
use glint_base::keywords::is_keyword;

/// The keys of one device, and the conditions between them.
#[derive(Clone, Debug)]
pub struct Schema {
    /// A configuration has this name under the key `device`.
    pub device: &'static str,
    /// The device's own keys, in the order in which a written file shows them, without the keys that every device shares
    /// ([`super::shared_keys`]).
    pub keys: Vec<Key>,
    /// Checks the conditions between keys. It gets configurations in which every value is inside its own range, in any
    /// combination, and must not panic. It must report each violated condition under the key that the user should change.
    pub check: fn(&Config, &mut Problems),
}

impl Schema {
    /// Returns the default name of the Verilog module: the device with `_` for `-`, and with `my_` in front of a Verilog keyword,
    /// as in `my_table`.
    pub fn module(&self) -> String {
        let name = self.device.replace('-', "_");
        if is_keyword(&name) { format!("my_{name}") } else { name }
    }
}

/// A configuration key of a device.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// The dotted name, for example `cosine.fraction`. Everything before the last dot is a TOML table.
    pub name: &'static str,
    pub kind: KeyKind,
    /// The value if a file does not set the key.
    pub default: Value,
    /// The meaning of the key, in one or two sentences.
    pub doc: &'static str,
    /// The condition under which the key applies. If it does not hold, a file may set the key only to its default.
    pub condition: Option<Condition>,
    /// Whether configurations of the device existed before the key. Such a key is not written while it has its default, so that
    /// digests of older configurations stay valid.
    pub joined_later: bool,
    /// The range from which random configurations draw an integer, if larger values would make a configuration too slow to test.
    /// The default of such a key is never adjusted to other keys.
    pub drawn: Option<(i64, i64)>,
}

/// When a key applies: another key has, or does not have, a certain value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Condition {
    pub key: &'static str,
    /// A value of the other key, without quotes.
    pub value: &'static str,
    /// Whether the other key must have this value, not a different one.
    pub is_equal: bool,
}

impl Condition {
    /// `architecture = "pipelined"` holds for the value `pipelined`.
    pub fn holds(&self, value: &Value) -> bool {
        (value.bare() == self.value) == self.is_equal
    }

    /// Returns the condition as text, for example `architecture = "pipelined"`. `value` must be some value of the other key. If
    /// it is a text, the value in the condition has quotes, unless it is an integer, as in `power = 4`.
    pub fn words(&self, value: &Value) -> String {
        let needed = match value {
            Value::Text(_) => Value::Text(self.value.to_owned()).toml(),
            _ => self.value.to_owned(),
        };
        let relation = if self.is_equal { "=" } else { "other than" };
        format!("{} {relation} {needed}", self.key)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum KeyKind {
    /// An integer between two limits, both included.
    Integer { min: i64, max: i64 },
    /// A finite number between two limits, both included, or 0 if `or_zero`. A file may write the number as an integer.
    Number { min: f64, max: f64, or_zero: bool },
    /// One of several texts. A file writes an option that is a decimal integer without quotes, as in `power = 16`.
    Choice(&'static [&'static str]),
    /// `true` or `false`.
    Flag,
    /// A text that matches a pattern.
    Text(TextPattern),
    /// A list of integers; its entries and its length have limits. For example, `visibility.levels = [50, 100, 200, 400, 800]`.
    Integers { min: i64, max: i64, len_min: usize, len_max: usize },
    /// A table whose entries have names that the user chooses, such as `operands` of the device `expression`.
    Table {
        /// The fields of an entry. The defaults of these keys are only examples: a field that is not given has no value.
        fields: Vec<Key>,
        /// The field whose value may replace a whole entry: `s = "x^2"` means `s = { formula = "x^2" }`.
        shorthand: Option<&'static str>,
        least: usize,
        most: usize,
    },
}

impl Key {
    fn new(name: &'static str, kind: KeyKind, default: Value, doc: &'static str) -> Self {
        Key { name, kind, default, doc, condition: None, joined_later: false, drawn: None }
    }

    /// Makes a key for an integer: `Key::integer("cosine.fraction", 20, 6..=24, "…")` accepts 6 to 24 and has the default 20.
    pub fn integer(
        name: &'static str,
        default: i64,
        range: RangeInclusive<i64>,
        doc: &'static str,
    ) -> Self {
        let (min, max) = range.into_inner();
        Self::new(name, KeyKind::Integer { min, max }, Value::Integer(default), doc)
    }

    /// Makes a key for a number in a range, both ends included.
    pub fn number(
        name: &'static str,
        default: f64,
        range: RangeInclusive<f64>,
        doc: &'static str,
    ) -> Self {
        let (min, max) = range.into_inner();
        Self::new(name, KeyKind::Number { min, max, or_zero: false }, Value::Number(default), doc)
    }

    /// Makes a key for a number that is 0 or in the given range. The default is 0, which means that the user states no number.
    pub fn number_or_zero(
        name: &'static str,
        range: RangeInclusive<f64>,
        doc: &'static str,
    ) -> Self {
        let (min, max) = range.into_inner();
        Self::new(name, KeyKind::Number { min, max, or_zero: true }, Value::Number(0.0), doc)
    }

    /// Makes a key whose value is one of several texts. If all texts are decimal integers, such as `["2", "4"]`, a file must
    /// write an integer, and [`Config::integer`] returns it.
    pub fn choice(
        name: &'static str,
        default: &'static str,
        options: &'static [&'static str],
        doc: &'static str,
    ) -> Self {
        let default = Value::Text(default.to_owned());
        Self::new(name, KeyKind::Choice(options), default, doc)
    }

    pub fn flag(name: &'static str, default: bool, doc: &'static str) -> Self {
        Self::new(name, KeyKind::Flag, Value::Flag(default), doc)
    }

    /// Makes a key for a text that matches a pattern, as the default must.
    pub fn text(
        name: &'static str,
        default: &'static str,
        pattern: TextPattern,
        doc: &'static str,
    ) -> Self {
        Self::new(name, KeyKind::Text(pattern), Value::Text(default.to_owned()), doc)
    }

    /// Makes a key for a list of integers. Each integer must be in `range`, and the length of the list must be in `len`.
    pub fn integers(
        name: &'static str,
        default: &[i64],
        range: RangeInclusive<i64>,
        len: RangeInclusive<usize>,
        doc: &'static str,
    ) -> Self {
        let (min, max) = range.into_inner();
        let (len_min, len_max) = len.into_inner();
        let kind = KeyKind::Integers { min, max, len_min, len_max };
        Self::new(name, kind, Value::Integers(default.to_vec()), doc)
    }

    /// Makes a key for a table whose entries the user names: the table `operands` may have an entry `x`, whose fields are the
    /// keys in `fields`. The number of entries must be in `entries`. `shorthand` names a field whose value may replace a whole
    /// entry.
    pub fn records(
        name: &'static str,
        default: &[TableEntry],
        fields: Vec<Key>,
        shorthand: Option<&'static str>,
        entries: RangeInclusive<usize>,
        doc: &'static str,
    ) -> Self {
        let (least, most) = entries.into_inner();
        let kind = KeyKind::Table { fields, shorthand, least, most };
        Self::new(name, kind, Value::Table(TableEntries(default.to_vec())), doc)
    }

    /// Restricts the key to configurations in which the key `other` has the value `value`: `pipeline.stages` has
    /// `only_when("architecture", "pipelined")`. `value` must be written without quotes, as [`Value::bare`] returns it.
    pub fn only_when(mut self, other: &'static str, value: &'static str) -> Self {
        self.condition = Some(Condition { key: other, value, is_equal: true });
        self
    }

    /// Restricts the key to configurations in which the key `other` has any other value, written as for [`Key::only_when`].
    pub fn unless(mut self, other: &'static str, value: &'static str) -> Self {
        self.condition = Some(Condition { key: other, value, is_equal: false });
        self
    }

    /// Marks a key that was added after configurations of the device existed, whose digests then do not change.
    pub fn joined_later(self) -> Self {
        Self { joined_later: true, ..self }
    }

    /// Sets the range, both ends included, from which random configurations draw the integer, because larger values take long to
    /// test. The default of the key is then never adjusted to other keys.
    pub fn drawn(self, min: i64, max: i64) -> Self {
        Self { drawn: Some((min, max)), ..self }
    }

    /// Returns the full name of a field, such as `operands.x.fraction`.
    pub fn field_name(&self, entry: &str, field: &str) -> String {
        format!("{}.{entry}.{field}", self.name)
    }

    /// Returns the table and the last part of the key's name, for example `("cosine", "fraction")`. The table is empty for a key
    /// outside tables, and the last part for a key that is itself a table.
    pub fn table_and_leaf(&self) -> (&'static str, &'static str) {
        if matches!(self.kind, KeyKind::Table { .. }) {
            return (self.name, "");
        }
        self.name.rsplit_once('.').unwrap_or(("", self.name))
    }
}

impl KeyKind {
    /// TOML writes the options of such a choice without quotes.
    pub fn is_integer_choice(&self) -> bool {
        matches!(self, KeyKind::Choice(options) if options.iter().all(|option| is_integer(option)))
    }

    /// Returns whether a file may write an integer for this key: for a choice with an integer among its options, or for a
    /// formula.
    pub(super) fn takes_integers(&self) -> bool {
        matches!(self, KeyKind::Choice(options) if options.iter().any(|option| is_integer(option)))
            || *self == KeyKind::Text(TextPattern::Formula)
    }
}

//! Defines a device's schema: the list of its configuration keys, with types, ranges, defaults, conditions and descriptions.

use std::ops::RangeInclusive;

use super::problems::Problems;
use super::text_pattern::TextPattern;
use super::values::{Config, TableEntries, TableEntry, Value, is_integer};
use glint_base::keywords::is_keyword;

/// The keys of one device, and the conditions between them.
#[derive(Clone, Debug)]
pub struct Schema {
    /// The device's name, which a configuration states under the key `device`.
    pub device: &'static str,
    /// The device's own keys, in the order in which a written file shows them, without the keys that every device shares
    /// ([`super::shared_keys`]).
    pub keys: Vec<Key>,
    /// Checks the conditions between keys. Each value of the configuration is inside its own range, in any combination. The
    /// function must not panic, and must report each violated condition under the key that the user should change.
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
    /// The key's meaning, in one or two sentences.
    pub doc: &'static str,
    /// The condition under which the key applies. If the condition does not hold, a file may set the key only to its default.
    pub condition: Option<Condition>,
    /// Whether configurations of the device existed before the key. The default of such a key is not written, so digests of older
    /// configurations stay valid.
    pub joined_later: bool,
    /// The range from which random configurations draw an integer, if larger values would be too slow to test. The default of
    /// such a key is never adjusted to other keys.
    pub drawn: Option<(i64, i64)>,
}

/// The condition that another key has, or does not have, a certain value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Condition {
    pub key: &'static str,
    /// A value of the key in `key`, without quotes.
    pub value: &'static str,
    /// Whether the key must have this value, not a different one.
    pub is_equal: bool,
}

impl Condition {
    /// Returns whether `value`, the value of the key in the condition, meets the condition. For example, `architecture =
    /// "pipelined"` holds for the value `pipelined`.
    pub fn holds(&self, value: &Value) -> bool {
        (value.bare() == self.value) == self.is_equal
    }

    /// Returns the condition as text, for example `architecture = "pipelined"`. `value` is any value of the key in the condition,
    /// and shows whether the text needs quotes. An integer has no quotes, as in `power = 4`.
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
    /// A list of integers with limits on the entries and on the length. For example, `visibility.levels = [50, 100, 200, 400,
    /// 800]`.
    Integers { min: i64, max: i64, len_min: usize, len_max: usize },
    /// A table whose entries have names that the user chooses, such as `operands` of the device `expression`.
    Table {
        /// An entry's fields. The defaults of these keys are only examples, and a field that is not given has no value.
        fields: Vec<Key>,
        /// The field whose value may replace a whole entry. For example, `s = "x^2"` means `s = { formula = "x^2" }`.
        shorthand: Option<&'static str>,
        least: usize,
        most: usize,
    },
}

impl Key {
    fn new(name: &'static str, kind: KeyKind, default: Value, doc: &'static str) -> Self {
        Key { name, kind, default, doc, condition: None, joined_later: false, drawn: None }
    }

    /// Makes a key for an integer. For example, `Key::integer("cosine.fraction", 20, 6..=24, "…")` accepts 6 to 24 and has the
    /// default 20.
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

    /// Makes a key for one of the texts in `options`. If all texts are decimal integers, such as `["2", "4"]`, a file must write
    /// an integer, and [`Config::integer`] returns it.
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

    /// Makes a key for a text that matches `pattern`. The default must match `pattern`.
    pub fn text(
        name: &'static str,
        default: &'static str,
        pattern: TextPattern,
        doc: &'static str,
    ) -> Self {
        Self::new(name, KeyKind::Text(pattern), Value::Text(default.to_owned()), doc)
    }

    /// Makes a key for a list of integers. Each integer must be in `range`, and the list's length must be in `len`.
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

    /// Makes a key for a table whose entries the user names. For example, the table `operands` may have an entry `x`, with the
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

    /// Restricts the key to configurations in which the key `other` has the value `value`. For example, `pipeline.stages` has
    /// `only_when("architecture", "pipelined")`. `value` has no quotes, like a result of [`Value::bare`].
    pub fn only_when(mut self, other: &'static str, value: &'static str) -> Self {
        self.condition = Some(Condition { key: other, value, is_equal: true });
        self
    }

    /// Restricts the key to configurations in which the key `other` lacks the value `value`. `value` has no quotes.
    pub fn unless(mut self, other: &'static str, value: &'static str) -> Self {
        self.condition = Some(Condition { key: other, value, is_equal: false });
        self
    }

    /// Marks a key that was added after configurations of the device existed. A default value then does not change the digests of
    /// these configurations.
    pub fn joined_later(self) -> Self {
        Self { joined_later: true, ..self }
    }

    /// Sets the range, both ends included, from which random configurations draw the integer, because larger values take long to
    /// test. The key's default is then never adjusted to other keys.
    pub fn drawn(self, min: i64, max: i64) -> Self {
        Self { drawn: Some((min, max)), ..self }
    }

    /// Returns the full name of a field in the entry `entry`, such as `operands.x.fraction`.
    pub fn field_name(&self, entry: &str, field: &str) -> String {
        format!("{}.{entry}.{field}", self.name)
    }

    /// Returns the table and the last part of the key's name, for example `("cosine", "fraction")`. The table is empty for a key
    /// outside tables. The last part is empty for a key that is a table.
    pub fn table_and_leaf(&self) -> (&'static str, &'static str) {
        if matches!(self.kind, KeyKind::Table { .. }) {
            return (self.name, "");
        }
        self.name.rsplit_once('.').unwrap_or(("", self.name))
    }
}

impl KeyKind {
    /// Returns whether the kind is a choice of integers, which TOML writes without quotes.
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

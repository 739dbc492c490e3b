//! What a device says about its configuration keys.

use std::ops::RangeInclusive;

use super::problems::Problems;
use super::shared::shared_keys;
use super::values::Config;

/// The keys of one device, and the conditions between them.
#[derive(Clone, Debug)]
pub struct Schema {
    /// The name of the device, which the key `device` gives.
    pub device: &'static str,
    /// The keys, in the order in which a written file shows them. Those that every device shares
    /// ([`shared_keys`]) are not among them.
    pub keys: Vec<Key>,
    /// Conditions between keys. It is called with every value inside its own range, in any
    /// combination, and must not panic on any. It pushes each violated condition under the key
    /// that is best changed, because that is where the reader of the message is sent.
    pub check: fn(&Config, &mut Problems),
}

/// One configuration key.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// The dotted name, as `cosine.fraction`: everything before the last dot is a TOML table.
    pub name: &'static str,
    /// Type and range.
    pub kind: Kind,
    /// The value when a file does not give one.
    pub default: Value,
    /// What it governs, in one or two sentences.
    pub doc: &'static str,
    /// The key applies only when another key (the first) has a value (the second, written without
    /// quotes). Elsewhere it may not be given, and it keeps its default.
    pub only_when: Option<(&'static str, &'static str)>,
}

/// The type of a key, and which of its values are accepted.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// An integer, both limits included.
    Integer { min: i64, max: i64 },
    /// A finite number, both limits included. A file may write it as an integer.
    Number { min: f64, max: f64 },
    /// One of some words. If all of them are decimal integers, a file writes an integer.
    Choice(&'static [&'static str]),
    /// `true` or `false`.
    Flag,
    /// A list of integers; its entries and its length have limits.
    Integers { min: i64, max: i64, len_min: usize, len_max: usize },
}

/// The value of a key.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Of [`Kind::Integer`].
    Integer(i64),
    /// Of [`Kind::Number`].
    Number(f64),
    /// Of [`Kind::Choice`].
    Text(String),
    /// Of [`Kind::Flag`].
    Flag(bool),
    /// Of [`Kind::Integers`].
    Integers(Vec<i64>),
}

impl Key {
    fn new(name: &'static str, kind: Kind, default: Value, doc: &'static str) -> Self {
        Key { name, kind, default, doc, only_when: None }
    }

    /// An integer in a range.
    pub fn integer(
        name: &'static str,
        default: i64,
        range: RangeInclusive<i64>,
        doc: &'static str,
    ) -> Self {
        let (min, max) = range.into_inner();
        Self::new(name, Kind::Integer { min, max }, Value::Integer(default), doc)
    }

    /// A number in a range.
    pub fn number(
        name: &'static str,
        default: f64,
        range: RangeInclusive<f64>,
        doc: &'static str,
    ) -> Self {
        let (min, max) = range.into_inner();
        Self::new(name, Kind::Number { min, max }, Value::Number(default), doc)
    }

    /// One of some words. With options that are all decimal integers, as `["2", "4"]`, a file
    /// writes an integer, and [`Config::integer`] reads it as one.
    pub fn choice(
        name: &'static str,
        default: &'static str,
        options: &'static [&'static str],
        doc: &'static str,
    ) -> Self {
        let default = Value::Text(default.to_owned());
        Self::new(name, Kind::Choice(options), default, doc)
    }

    /// `true` or `false`.
    pub fn flag(name: &'static str, default: bool, doc: &'static str) -> Self {
        Self::new(name, Kind::Flag, Value::Flag(default), doc)
    }

    /// A list of `len` integers, each in a range.
    pub fn integers(
        name: &'static str,
        default: &[i64],
        range: RangeInclusive<i64>,
        len: RangeInclusive<usize>,
        doc: &'static str,
    ) -> Self {
        let (min, max) = range.into_inner();
        let (len_min, len_max) = len.into_inner();
        let kind = Kind::Integers { min, max, len_min, len_max };
        Self::new(name, kind, Value::Integers(default.to_vec()), doc)
    }

    /// Restricts the key to configurations in which the key `other` has a value.
    ///
    /// `value` is written as [`Value`] displays it without quotes: `direct`, `true`, `16`.
    pub fn only_when(mut self, other: &'static str, value: &'static str) -> Self {
        self.only_when = Some((other, value));
        self
    }

    /// The table and the last part of the name: `("cosine", "fraction")`. The table of a key at
    /// the top is empty.
    pub fn table_and_leaf(&self) -> (&'static str, &'static str) {
        self.name.rsplit_once('.').unwrap_or(("", self.name))
    }
}

impl Kind {
    /// Whether this is a choice among integers, which TOML writes without quotes.
    pub fn is_integer_choice(&self) -> bool {
        matches!(self, Kind::Choice(options) if options.iter().all(|option| is_integer(option)))
    }

    /// Such a choice could not tell how a file writes it.
    fn mixes_integers_and_words(&self) -> bool {
        matches!(self, Kind::Choice(options)
            if !self.is_integer_choice() && options.iter().any(|option| is_integer(option)))
    }
}

impl Value {
    /// The text that [`Key::only_when`] compares with: the value without quotes.
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
        }
    }

    /// The value as TOML: [`Value::bare`], with quotes around a word.
    pub fn toml(&self) -> String {
        match self {
            Value::Text(text) if !is_integer(text) => format!("\"{text}\""),
            other => other.bare(),
        }
    }
}

impl Schema {
    /// The key of this name, the device's own or one of [`shared_keys`].
    pub fn key(&self, name: &str) -> Option<&Key> {
        self.all_keys().find(|key| key.name == name)
    }

    /// The keys of the device, then those that every device shares.
    pub fn all_keys(&self) -> impl Iterator<Item = &Key> {
        self.keys.iter().chain(shared_keys())
    }

    /// Mistakes in the schema itself, for a device's own tests: names that repeat, that are not
    /// plain TOML or that stand for a table and a value at once; defaults outside their range or
    /// refused by `check`; conditions on keys or values that do not exist.
    ///
    /// A schema without mistakes gives an empty list; the reader relies on that.
    pub fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        for (index, key) in self.keys.iter().enumerate() {
            let name = key.name;
            if !name.split('.').all(is_plain) {
                faults.push(format!("`{name}` is not made of plain lower-case words"));
            }
            let shared = shared_keys().iter().map(|key| key.name);
            let mut common = super::COMMON.iter().map(|(common, _)| *common).chain(shared);
            if common.any(|common| common == name) {
                faults.push(format!("`{name}` is a key of every device"));
            }
            if self.keys[..index].iter().any(|other| other.name == name) {
                faults.push(format!("`{name}` is declared twice"));
            }
            let table = format!("{name}.");
            if self.all_keys().any(|other| other.name.starts_with(&table)) {
                faults.push(format!("`{name}` is both a key and a table"));
            }
            for fault in key.faults_of(&key.default) {
                faults.push(format!("default of `{name}`: {}", fault.message));
            }
            if key.kind.mixes_integers_and_words() {
                faults.push(format!("`{name}` is a choice among integers and words"));
            }
            if let Some((other, value)) = key.only_when {
                // Only an earlier key, so that chains of conditions end.
                match self.keys[..index].iter().find(|key| key.name == other) {
                    None => faults.push(format!(
                        "`{name}` depends on `{other}`, which is not declared before it"
                    )),
                    Some(other) if !other.can_be(value) => faults.push(format!(
                        "`{name}` depends on `{}` = {value}, which that can never be",
                        other.name
                    )),
                    Some(_) => {}
                }
            }
        }
        if faults.is_empty() {
            let mut problems = Problems::default();
            (self.check)(&Config::defaults(self, self.device), &mut problems);
            faults.extend(problems.iter().map(|problem| format!("defaults: {}", problem.message)));
        }
        faults
    }
}

impl Key {
    /// Whether some accepted value displays as `bare`.
    fn can_be(&self, bare: &str) -> bool {
        match &self.kind {
            Kind::Choice(options) => options.contains(&bare),
            Kind::Flag => bare == "true" || bare == "false",
            Kind::Integer { min, max } => {
                bare.parse().is_ok_and(|value: i64| (*min..=*max).contains(&value))
            }
            // Conditions on fractions and lists would hang on how they are written.
            Kind::Number { .. } | Kind::Integers { .. } => false,
        }
    }
}

fn is_plain(part: &str) -> bool {
    part.starts_with(|c: char| c.is_ascii_lowercase())
        && part.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

/// Whether a word is an integer as it is displayed: `007` and `+7` are not.
fn is_integer(word: &str) -> bool {
    word.parse::<i64>().is_ok_and(|value| value.to_string() == word)
}

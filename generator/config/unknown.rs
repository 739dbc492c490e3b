//! Finds the key that a user means by a name that no key has, for the remedy in a message. The name can be misspelt, in the wrong
//! table, or a different word for a key.

use super::nearest::{listed, nearest};
use super::other_words::{self, MeantSetting};
use super::schema::{Key, Schema};
use super::shared::shared_keys;
use super::write::tables;

pub(super) struct UnknownName {
    pub(super) remedy: String,
    /// The keys that the user may mean. Their intended values are unknown.
    pub(super) meant: Vec<&'static str>,
}

impl UnknownName {
    /// Makes the remedy for the dotted name `name`, which no key and no table of `schema` has. `is_table` says whether the user
    /// gives a table as the value.
    pub(super) fn new(schema: &Schema, name: &str, is_table: bool) -> Self {
        let tables = || schema.all_keys().map(|key| key.table_and_leaf().0);
        let (heading, below) = name.split_once('.').unwrap_or(("", name));
        let mut known = common_names().chain(schema.all_keys().map(|key| key.name)).chain(tables());
        if !heading.is_empty() && known.any(|other| other == below) {
            let remedy = format!(
                "`{below}` does not belong to [{heading}]: move the line above the first [table] heading"
            );
            return Self { remedy, meant: Vec::new() };
        }
        let (table, leaf) = match name.rsplit_once('.') {
            Some((table, leaf)) if tables().any(|known| known == table) => (table, leaf),
            _ => ("", name),
        };
        if let Some(meant) = similar(schema, table, leaf, is_table) {
            return Self::suggested(schema, meant);
        }
        let elsewhere: Vec<&Key> =
            schema.all_keys().filter(|key| key.name.ends_with(&format!(".{leaf}"))).collect();
        if !is_table && !elsewhere.is_empty() {
            let names: Vec<String> =
                elsewhere.iter().map(|key| format!("`{}`", key.name)).collect();
            let meant = elsewhere.iter().map(|key| key.name).collect();
            return Self { remedy: format!("the device has {}", listed(&names)), meant };
        }
        let is_shared = |key: &Key| key.table_and_leaf().0 == table;
        let settings = other_words::settings(leaf);
        if !settings.is_empty() && (table.is_empty() || shared_keys().iter().any(is_shared)) {
            return Self {
                remedy: suggestion(settings),
                meant: settings.iter().map(|setting| setting.key).collect(),
            };
        }
        // A user may write `cosine_fraction` for `cosine.fraction`.
        let all = schema.all_keys().map(|key| key.name);
        match nearest(leaf, all).filter(|_| table.is_empty() && !is_table) {
            Some(meant) => Self::suggested(schema, meant),
            None => Self { remedy: keys_of(schema, table), meant: Vec::new() },
        }
    }

    /// Suggests a key, or a table with all its keys.
    fn suggested(schema: &Schema, name: &'static str) -> Self {
        let within = format!("{name}.");
        let is_meant = |key: &&Key| key.name == name || key.name.starts_with(&within);
        let meant = schema.all_keys().filter(is_meant).map(|key| key.name).collect();
        Self { remedy: format!("did you mean `{name}`?"), meant }
    }
}

pub(super) fn suggestion(settings: &[MeantSetting]) -> String {
    let settings: Vec<String> = settings.iter().map(|setting| setting.words()).collect();
    format!("did you mean {}?", settings.join(" or "))
}

/// Returns the key in `table` whose last part is most similar to `leaf`, or else has the same meaning. With an empty `table`,
/// returns a key outside tables, or a table if `is_table`.
fn similar(schema: &Schema, table: &str, leaf: &str, is_table: bool) -> Option<&'static str> {
    let in_table = || schema.all_keys().filter(|key| key.table_and_leaf().0 == table);
    if table.is_empty() && is_table {
        let tables = schema.all_keys().map(|key| key.table_and_leaf().0);
        return nearest(leaf, tables.filter(|table| !table.is_empty()));
    }
    let common = common_names().filter(|_| table.is_empty());
    // A key that is a table has no last part.
    let leaves = || in_table().map(|key| key.table_and_leaf().1).filter(|leaf| !leaf.is_empty());
    let meant =
        nearest(leaf, common.chain(leaves())).or_else(|| other_words::last_part(leaf, leaves()))?;
    let key = in_table().find(|key| key.table_and_leaf().1 == meant);
    Some(key.map_or(meant, |key| key.name))
}

/// Returns the names of the keys that a configuration stores in fields of its own, such as `device`.
pub(super) fn common_names() -> impl Iterator<Item = &'static str> {
    super::COMMON.iter().map(|(name, _)| *name)
}

/// Returns a remedy with the names of the keys in `table`. An empty `table` means the keys outside tables.
pub(super) fn keys_of(schema: &Schema, table: &str) -> String {
    let mut keys: Vec<&str> = schema
        .all_keys()
        .map(Key::table_and_leaf)
        .filter(|(of, _)| *of == table)
        .map(|(_, leaf)| leaf)
        .collect();
    if !table.is_empty() {
        return format!("keys of [{table}]: {}", keys.join(", "));
    }
    keys.splice(0..0, super::COMMON.map(|(name, _)| name));
    // The first entry has the keys outside tables, and no heading.
    let tables = tables(schema).into_iter().skip(1).map(|(name, _)| format!("[{name}]"));
    let tables = Vec::from_iter(tables).join(", ");
    let keys = keys.join(", ");
    if tables.is_empty() {
        format!("keys: {keys}")
    } else {
        format!("keys outside tables: {keys}; tables: {tables}")
    }
}

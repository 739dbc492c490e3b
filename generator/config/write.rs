//! Writes configurations as TOML text.

use super::schema::{Key, Schema};
use super::shared::shared_keys;
use super::values::Config;

/// The widest line of a comment.
const WIDTH: usize = 90;

/// Returns the file that `glint new` writes: every key with its default, what it governs and what it
/// accepts. It reads back as the defaults; keys that do not apply to them are commented out.
pub fn commented(schema: &Schema, name: &str) -> String {
    commented_values(schema, &Config::defaults(schema, name))
}

/// Writes what [`commented`] writes, with the values of a configuration in place of defaults.
pub fn commented_values(schema: &Schema, config: &Config) -> String {
    let shown = if *config == Config::defaults(schema, &config.name) {
        " with their defaults; those that you do not change"
    } else {
        "; those at their defaults"
    };
    let mut text = comment(&format!(
        "Glint configuration of the device \"{}\". All keys are shown{shown} may be deleted.",
        schema.device
    ));
    for ((key, value), doc) in common(config).into_iter().zip(super::COMMON.map(|c| c.1)) {
        text += &format!("\n{}{key} = {value}\n", comment(doc));
    }
    for (table, keys) in tables(schema) {
        if !table.is_empty() {
            text += &format!("\n[{table}]\n");
        }
        for (index, key) in keys.into_iter().enumerate() {
            if index > 0 || table.is_empty() {
                text.push('\n');
            }
            let value = config.value(key.name).toml();
            text += &comment(&sentence(key.doc));
            let mut rule = format!("{}, default {}", key.accepts(), key.default.toml());
            if let Some(condition) = key.condition {
                rule += &format!("; only with {}", condition.words(config.value(condition.key)));
            }
            text += &comment(&sentence(&rule));
            // No samples are no path.
            let on = config.applies(schema, key.name) && value != "\"\"";
            let off = if on { "" } else { "# " };
            text += &format!("{off}{} = {value}\n", key.table_and_leaf().1);
        }
    }
    text
}

impl Config {
    /// Returns the configuration as a TOML file that reads back as the same: every key of the device that
    /// applies, and of those that joined later or that every device shares the ones that differ from their defaults.
    pub fn to_toml(&self, schema: &Schema) -> String {
        plain(schema, self)
    }
}

/// Returns the keys of a configuration that apply, without comments; of those that joined later or that every device shares,
/// the ones that differ from their defaults.
fn plain(schema: &Schema, config: &Config) -> String {
    let mut text = String::new();
    for (key, value) in common(config) {
        text += &format!("{key} = {value}\n");
    }
    for (table, mut keys) in tables(schema) {
        keys.retain(|key| is_written(schema, config, key));
        if !table.is_empty() && !keys.is_empty() {
            text += &format!("\n[{table}]\n");
        }
        for key in keys {
            let value = config.value(key.name).toml();
            text += &format!("{} = {value}\n", key.table_and_leaf().1);
        }
    }
    text
}

fn is_written(schema: &Schema, config: &Config, key: &Key) -> bool {
    let is_quiet = key.joined_later || shared_keys().contains(key);
    config.applies(schema, key.name) && !(is_quiet && *config.value(key.name) == key.default)
}

/// Returns the keys that every device has, in the order of [`super::COMMON`], with their values as TOML.
fn common(config: &Config) -> [(&'static str, String); 3] {
    [
        ("device", toml::Value::from(config.device.as_str()).to_string()),
        ("name", toml::Value::from(config.name.as_str()).to_string()),
        ("strict", config.strict.to_string()),
    ]
}

/// Returns the keys by table, that of the keys at the top first; otherwise in the order of the schema.
pub(super) fn tables(schema: &Schema) -> Vec<(&'static str, Vec<&Key>)> {
    let mut tables: Vec<(&str, Vec<&Key>)> = vec![("", Vec::new())];
    for key in schema.all_keys() {
        let (table, _) = key.table_and_leaf();
        match tables.iter_mut().find(|(name, _)| *name == table) {
            Some((_, keys)) => keys.push(key),
            None => tables.push((table, vec![key])),
        }
    }
    tables
}

/// Returns a text as comment lines.
fn comment(text: &str) -> String {
    let mut lines = String::new();
    let mut line = String::from("#");
    for word in text.split_whitespace() {
        if line.len() + 1 + word.len() > WIDTH {
            lines += &line;
            lines.push('\n');
            line = String::from("#");
        }
        line.push(' ');
        line += word;
    }
    lines + &line + "\n"
}

/// Returns a text with a capital at its start and a full stop at its end.
fn sentence(text: &str) -> String {
    let text = text.trim_end_matches('.');
    let mut letters = text.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).chain(['.']).collect()
}

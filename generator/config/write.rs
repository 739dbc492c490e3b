//! Writes configurations as TOML, either as files from which a user can start, or as files that are read as the same
//! configuration.

use super::schema::{Key, KeyKind, Schema};
use super::shared::shared_keys;
use super::values::{Config, Value};

/// The largest length of a comment line in bytes. Only a single longer word makes a longer line.
const WIDTH: usize = 90;

/// The column in which the remarks of [`brief`] begin.
const REMARK_COLUMN: usize = 38;

/// The largest length of a remark in bytes. If a description's first clause and a choice's options are longer together, the
/// remark has only the options.
const REMARK_WIDTH: usize = 80;

/// Returns the short file that `glint new` prints: one line with a remark for each key of the device, or for each entry of a
/// table.
///
/// The keys in `given`, `device`, `name` and `architecture` are set, and `strict` if it is true. All other keys are comments that
/// show their values, so a default still adjusts to the keys that a user sets (see [`super::parse()`]). Keys that do not apply
/// and the shared keys are left out unless they are in `given`. `glint new DEVICE --all` prints the text of [`commented`].
pub fn brief(schema: &Schema, config: &Config, given: &[String]) -> String {
    let mut text = String::new();
    for (key, value) in common(config) {
        text += &match key {
            "strict" => {
                let sign = if config.strict { "" } else { "# " };
                let remark = "true refuses a configuration that misses the accuracy contract";
                remarked(&format!("{sign}strict = {value}"), remark)
            }
            _ => format!("{key} = {value}\n"),
        };
    }
    let architecture = "\"pipelined\" computes a point every clock or every few clocks";
    text += &remarked(&assignment(config, "architecture"), architecture);
    text.push('\n');
    for key in schema.all_keys().filter(|key| key.name != "architecture") {
        let is_given = given.iter().any(|name| name == key.name);
        let is_own = schema.keys.contains(key);
        if (is_own || is_given) && config.applies(schema, key.name) {
            let sign = if is_given { "" } else { "# " };
            for (number, line) in assignments(key, config, key.name).iter().enumerate() {
                let line = format!("{sign}{line}");
                text += &match number {
                    0 => remarked(&line, &remark(key)),
                    _ => format!("{line}\n"),
                };
            }
        }
    }
    text
}

/// Returns `key = value`, such as `cosine.fraction = 20`.
fn assignment(config: &Config, key: &str) -> String {
    format!("{key} = {}", config.value(key).toml())
}

/// Returns the lines that set `key` under the name `name`. A table has one line for each entry, such as `operands.x = { fraction
/// = 15 }`, and any other key has one line. An empty `name` is for lines below the table's heading.
fn assignments(key: &Key, config: &Config, name: &str) -> Vec<String> {
    let value = config.value(key.name);
    if let (KeyKind::Table { shorthand, .. }, Value::Table(records)) = (&key.kind, value)
        && (!records.0.is_empty() || name.is_empty())
    {
        let mut lines = Vec::new();
        for entry in &records.0 {
            let entry_name = match name {
                "" => entry.name.clone(),
                table => format!("{table}.{}", entry.name),
            };
            lines.push(format!("{entry_name} = {}", entry.toml(*shorthand)));
        }
        return lines;
    }
    vec![format!("{name} = {}", value.toml())]
}

/// Returns the first clause of a key's description, and a choice's options. If clause and options are too long together, returns
/// only the options.
fn remark(key: &Key) -> String {
    let ends = [". ", ": ", "; "].map(|mark| key.doc.find(mark).unwrap_or(key.doc.len()));
    let end = ends.into_iter().min().unwrap_or(key.doc.len());
    let clause = key.doc[..end].trim_end_matches('.');
    let KeyKind::Choice(options) = key.kind else {
        return clause.to_owned();
    };
    let values = key.accepts();
    let is_said = !options.contains(&clause) && clause.len() + values.len() < REMARK_WIDTH;
    if is_said { format!("{clause}: {values}") } else { values }
}

fn remarked(line: &str, remark: &str) -> String {
    format!("{line:REMARK_COLUMN$} # {remark}\n")
}

/// Returns the file that `glint new --all` prints: every key with its value, its meaning, and the values that it accepts.
///
/// The keys in `given`, `device`, `name` and `strict` are set. All other keys are comments, even keys that do not apply. The
/// user can remove `# ` from these lines, and the file is still read as the same configuration.
pub fn commented(schema: &Schema, config: &Config, given: &[String]) -> String {
    let mut text = comment(&format!(
        "Glint configuration of the device \"{}\". It shows all keys. A key in a comment has its default, \
         which adjusts to the keys that you set.",
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
            text += &comment(&sentence(key.doc));
            let mut rule = match key.kind {
                // The lines below this comment show the entries, which are too long for a sentence.
                KeyKind::Table { .. } => key.accepts(),
                _ => format!("{}, default {}", key.accepts(), key.default.toml()),
            };
            if let Some(condition) = key.condition {
                rule += &format!("; only with {}", condition.words(config.value(condition.key)));
            }
            text += &comment(&sentence(&rule));
            let is_given = given.iter().any(|name| name == key.name);
            let sign = if is_given { "" } else { "# " };
            for line in assignments(key, config, key.table_and_leaf().1) {
                text += &format!("{sign}{line}\n");
            }
        }
    }
    text
}

impl Config {
    /// Returns a TOML file that is read as the same configuration, with every key of the device that applies. A shared key, or a
    /// key with [`Key::joined_later`](super::Key::joined_later), is written only if it differs from its default.
    pub fn to_toml(&self, schema: &Schema) -> String {
        plain(schema, self)
    }
}

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
            for line in assignments(key, config, key.table_and_leaf().1) {
                text += &format!("{line}\n");
            }
        }
    }
    text
}

fn is_written(schema: &Schema, config: &Config, key: &Key) -> bool {
    let is_quiet = key.joined_later || shared_keys().contains(key);
    config.applies(schema, key.name) && !(is_quiet && *config.value(key.name) == key.default)
}

/// Returns the keys of [`super::COMMON`] with their values in TOML syntax.
fn common(config: &Config) -> [(&'static str, String); 3] {
    [
        ("device", toml::Value::from(config.device.as_str()).to_string()),
        ("name", toml::Value::from(config.name.as_str()).to_string()),
        ("strict", config.strict.to_string()),
    ]
}

/// Returns the keys by table, in the schema's order. The keys outside tables come first.
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

/// Returns `text` as comment lines of at most [`WIDTH`] bytes. Only a longer word makes a longer line.
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

/// Adds a capital letter at the start of `text`, and a full stop at the end.
fn sentence(text: &str) -> String {
    let text = text.trim_end_matches('.');
    let mut letters = text.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).chain(['.']).collect()
}

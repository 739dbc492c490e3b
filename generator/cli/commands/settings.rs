//! Parses the option `--set KEY=VALUE`, which sets a key of a configuration on the command line.

use anyhow::Result;

use crate::wrong_usage;

pub struct KeyAssignment {
    /// The dotted name, for example `cosine.fraction`.
    pub key: String,
    /// The value in TOML syntax.
    pub value: String,
}

impl KeyAssignment {
    /// Parses `KEY=VALUE`. A text needs no quotes: `architecture=pipelined` sets `architecture = "pipelined"`.
    ///
    /// # Errors
    /// Fails if there is no `=`, if the key is empty, or if it has other characters than ASCII letters, digits, `_`, `-` and
    /// `.`.
    pub fn parse(given: &str) -> Result<KeyAssignment> {
        let Some((key, value)) = given.split_once('=') else {
            wrong_usage!("--set {given}: expected KEY=VALUE, for example cosine.fraction=16");
        };
        let (key, value) = (key.trim(), value.trim());
        let is_of_key = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
        if key.is_empty() || !key.chars().all(is_of_key) {
            wrong_usage!(
                "--set {given}: `{key}` cannot be the name of a key; a key is for example cosine.fraction"
            );
        }
        let is_toml = value.parse::<f64>().is_ok()
            || value.starts_with(['[', '"'])
            || matches!(value, "true" | "false");
        let value = if is_toml { value.to_owned() } else { quoted(value) };
        Ok(KeyAssignment { key: key.to_owned(), value })
    }

    /// Makes a setting of `key` to the text `word`, given without quotes.
    pub fn word(key: &str, word: &str) -> KeyAssignment {
        KeyAssignment { key: key.to_owned(), value: quoted(word) }
    }

    /// Returns the setting as a line of TOML, for example `cosine.fraction = 16`.
    pub fn line(&self) -> String {
        format!("{} = {}\n", self.key, self.value)
    }
}

fn quoted(word: &str) -> String {
    toml::Value::from(word).to_string()
}

//! Holds a configuration file's text, with the locations of its keys.

use std::collections::BTreeMap;
use std::ops::Range;

use glint_base::config_error::ConfigError;

/// The text of a configuration file, which gives errors found after reading their lines and columns.
#[derive(Clone, Debug, Default)]
pub struct ConfigSource {
    /// The path as the caller gave it. The path is empty for a configuration without a file.
    pub file: String,
    pub text: String,
    /// The ranges of bytes in which the text sets the keys.
    locations: BTreeMap<String, Range<usize>>,
}

impl ConfigSource {
    /// Returns the source without locations of keys.
    pub(super) fn new(file: &str, text: &str) -> Self {
        Self { file: file.to_owned(), text: text.to_owned(), locations: BTreeMap::new() }
    }

    pub(super) fn locate(&mut self, key: &str, span: Range<usize>) {
        self.locations.insert(key.to_owned(), span);
    }

    pub fn gives(&self, key: &str) -> bool {
        self.locations.contains_key(key)
    }

    /// Returns the line and the column at which the file sets `key`, or `None` for a key that the file does not set. Lines and
    /// columns are counted from 1, and columns count characters.
    pub fn position(&self, key: &str) -> Option<(usize, usize)> {
        self.line_and_column(self.locations.get(key)?.start)
    }

    /// Returns the range of bytes in the file that `error` concerns, or `None` if the file does not set the key. The range is a
    /// part of the key's text if the file has the text in quotes and without escapes, and otherwise the whole value.
    pub(super) fn span_of(&self, error: &ConfigError) -> Option<Range<usize>> {
        let whole = self.locations.get(&error.key)?.clone();
        let within = error.place.clone().and_then(|bytes| {
            // If something is missing at the end of the text, the span is the closing quote.
            let text = self.text.get(whole.clone())?;
            let is_literal = text.starts_with(['"', '\''])
                && !text.starts_with("\"\"\"")
                && !text.contains('\\');
            let from = whole.start + 1 + bytes.start;
            is_literal.then_some(from..(whole.start + 1 + bytes.end).max(from + 1))
        });
        Some(within.unwrap_or(whole))
    }

    pub(super) fn line_and_column(&self, at: usize) -> Option<(usize, usize)> {
        let before = self.text.get(..at)?;
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = before.matches('\n').count() + 1;
        Some((line, before[line_start..].chars().count() + 1))
    }
}

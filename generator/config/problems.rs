//! Collects a configuration file's mistakes, each with a remedy and, except for missing keys, with its location.

use std::fmt;
use std::ops::Range;

use annotate_snippets::{AnnotationKind, Level, Origin, Renderer, Snippet};
use serde_json::{Value as Json, json};

use glint_base::config_error::ConfigError;

use super::source::ConfigSource;

/// The mistakes of one configuration file, in the order of their locations. The list has at most 200; further mistakes are only
/// counted. `Display` shows each mistake with its lines of the file in plain text.
#[derive(Clone, Debug, Default)]
pub struct Problems {
    source: ConfigSource,
    list: Vec<Problem>,
    /// The number of mistakes beyond the list's limit.
    further: usize,
    /// Whether the file has mistakes that are not in this list.
    refused: bool,
}

pub(super) const STANDARD_INPUT: &str = "standard input";

/// The largest length of the list. A file that is no configuration at all could have very many problems.
const LIMIT: usize = 200;

/// A mistake of a key, with its location in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    pub error: ConfigError,
    /// The range of bytes in the file, or `None` for a mistake without a location, such as a missing key.
    span: Option<Range<usize>>,
}

impl Problems {
    pub(super) fn of_file(file: &str, text: &str) -> Self {
        Self::of_source(ConfigSource::new(file, text))
    }

    pub(super) fn of_source(source: ConfigSource) -> Self {
        Problems { source, ..Problems::default() }
    }

    /// Returns the file, with the keys that are located so far.
    pub(super) fn source(&self) -> &ConfigSource {
        &self.source
    }

    /// Adds a mistake of a key. The report shows the key's location, or only the file's name if the file does not set the key.
    pub fn push(&mut self, key: &str, message: impl Into<String>, remedy: impl Into<String>) {
        self.push_error(ConfigError::new(key, message, remedy));
    }

    /// Adds the mistake `error` of a key. If `error` concerns some bytes of the key's text, the report marks these bytes. The
    /// file must contain the text literally, in quotes and without escapes. Otherwise the report marks the whole value.
    pub fn push_error(&mut self, error: ConfigError) {
        let span = self.source.span_of(&error);
        self.insert(Problem { error, span });
    }

    /// Adds an error with the location `span`, a range of bytes in the file.
    pub(super) fn push_error_at(&mut self, span: Range<usize>, error: ConfigError) {
        // If something is missing at the end of the text, the report marks the last line, and no line below it.
        let end = self.source.text.trim_end_matches(['\r', '\n']).len();
        let span = span.start.min(end)..span.end.min(end);
        self.insert(Problem { error, span: Some(span) });
    }

    pub(super) fn locate(&mut self, key: &str, span: Range<usize>) {
        self.source.locate(key, span);
    }

    pub fn gives(&self, key: &str) -> bool {
        self.source.gives(key)
    }

    /// Returns an empty list for a trial check of the same file, with the same locations. [`Problems::is_refused`] gives the same
    /// result for the new list.
    pub(super) fn cleared(&self) -> Self {
        Problems { list: Vec::new(), further: 0, refused: self.is_refused(), ..self.clone() }
    }

    /// Returns whether Glint must already refuse the file. A check may then skip work that takes a long time.
    pub fn is_refused(&self) -> bool {
        self.refused || !self.is_empty()
    }

    /// Adds problems with the locations that they already have.
    pub(super) fn extend(&mut self, problems: impl IntoIterator<Item = Problem>) {
        for problem in problems {
            self.insert(problem);
        }
    }

    /// Inserts a problem, unless the list already has it. Problems without a location come last.
    fn insert(&mut self, problem: Problem) {
        if self.list.len() == LIMIT {
            self.further += 1;
        } else if !self.list.contains(&problem) {
            let rank = |problem: &Problem| problem.start().unwrap_or(usize::MAX);
            let position = self.list.partition_point(|other| rank(other) <= rank(&problem));
            self.list.insert(position, problem);
        }
    }

    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Returns the number of mistakes, including the mistakes that are only counted.
    pub fn len(&self) -> usize {
        self.list.len() + self.further
    }

    /// Returns the mistakes in the list, in the order of their locations. Mistakes without a location come last.
    pub fn iter(&self) -> impl Iterator<Item = &Problem> {
        self.list.iter()
    }

    /// Returns the file's name as the caller gave it. The name is empty for problems without a file.
    pub fn file(&self) -> &str {
        &self.source.file
    }

    /// Returns the line and the column of a mistake in this list. Lines and columns are counted from 1, and columns count
    /// characters. Returns `None` for a mistake without a location.
    pub fn position(&self, problem: &Problem) -> Option<(usize, usize)> {
        self.source.line_and_column(problem.start()?)
    }

    /// Returns a JSON array with one object per problem in the list: `file`, `line` and `column` (null without a location), `key`
    /// (null for a problem of the whole file), `message` and `remedy`.
    pub fn to_json(&self) -> Json {
        let each = |problem: &Problem| {
            let (line, column) = self.position(problem).unzip();
            let error = &problem.error;
            json!({
                "file": self.source.file,
                "line": line,
                "column": column,
                "key": (!error.key.is_empty()).then_some(&error.key),
                "message": error.message,
                "remedy": error.remedy,
            })
        };
        Json::Array(self.list.iter().map(each).collect())
    }

    /// Returns the report for people, in the style and the colours of `renderer`. The report ends with the number of mistakes
    /// that are only counted.
    pub fn render(&self, renderer: &Renderer) -> String {
        let each = |problem: &Problem| {
            let title = Level::ERROR.primary_title(&problem.error.message);
            let help = Level::HELP.message(&problem.error.remedy);
            let group = match problem.span.clone() {
                Some(span) => {
                    let annotation = AnnotationKind::Primary.span(span);
                    let snippet = Snippet::source(&self.source.text).path(&self.source.file);
                    title.element(snippet.annotation(annotation)).element(help)
                }
                None if self.source.file.is_empty() => title.element(help),
                None => title.element(Origin::path(&self.source.file)).element(help),
            };
            renderer.render(&[group])
        };
        let mut reports: Vec<String> = self.list.iter().map(each).collect();
        if self.further > 0 {
            reports.push(format!("and {} further problems", self.further));
        }
        reports.join("\n\n")
    }
}

impl Problem {
    /// Replaces the message by the result of `words`.
    pub(super) fn told(self, words: impl FnOnce(&str) -> String) -> Self {
        let message = words(&self.error.message);
        let error = ConfigError { message, ..self.error };
        Self { error, ..self }
    }

    fn start(&self) -> Option<usize> {
        self.span.as_ref().map(|span| span.start)
    }
}

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(&Renderer::plain()))
    }
}

impl std::error::Error for Problems {}

/// An error of a key's value, before the value's location is known.
pub(super) struct Violation {
    /// The list entry that is wrong, or `None` if the error concerns the whole value.
    pub entry: Option<usize>,
    pub error: ConfigError,
}

pub(super) fn out_of_range(name: &str, given: impl std::fmt::Display) -> String {
    format!("`{name}` = {} is out of range", shown(&given.to_string()))
}

/// Cuts a text after 40 characters, and adds `…`.
pub(super) fn shown(text: &str) -> String {
    const LIMIT: usize = 40;
    match text.char_indices().nth(LIMIT) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}…", &text[..end]),
    }
}

/// Quotes a text from a file for a message. Quotes, backslashes and control characters are escaped, and [`shown`] cuts the text.
pub(super) fn quoted(text: &str) -> String {
    format!("\"{}\"", shown(&text.escape_debug().to_string()))
}

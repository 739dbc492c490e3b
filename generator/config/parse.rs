//! Parses the text of a TOML file to a [`Config`] with valid values.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue, Error};

use super::module_name;
use super::nearest::nearest;
use super::other_words;
use super::points;
use super::problems::{Problems, STANDARD_INPUT, Violation, out_of_range, quoted, shown};
use super::schema::{Key, KeyKind, Schema};
use super::source::ConfigSource;
use super::text_pattern::{TextPattern, is_path_of_points};
use super::unknown::{UnknownName, common_names, keys_of, suggestion};
use super::validate::Draft;
use super::values::{Config, TableEntries, TableEntry, Value};
use glint_base::config_error::ConfigError;
use glint_base::program::Program;

/// Parses a configuration from `text`, the text of a TOML file. `schemas` must contain the schemas of all devices.
///
/// Messages show `file_name`. Its stem (with `_` for `-`) is the module name unless the text states a `name`, which a text from
/// standard input must do. Defaults of keys that the text does not set are adjusted to the values in the text.
///
/// # Errors
///
/// Fails with all problems of the text at once, at most 200. Conditions between keys are checked only if the text is valid TOML
/// and names a device, because otherwise some keys of the file are unknown.
pub fn parse(file_name: &str, text: &str, schemas: &[Schema]) -> Result<Config, Problems> {
    parse_located(file_name, text, schemas).map(|(config, _)| config)
}

/// Parses a text like [`parse`]. Also returns the location of each key in the text, for errors that are found later.
pub fn parse_located(
    file_name: &str,
    text: &str,
    schemas: &[Schema],
) -> Result<(Config, ConfigSource), Problems> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut problems = Problems::of_file(file_name, text);
    if text.trim().is_empty() {
        problems.push("", "the file is empty", start_from(schemas));
        return Err(problems);
    }
    let (document, errors) = DeTable::parse_recoverable(text);
    let mut reader = TomlReader {
        text,
        directory: Path::new(file_name).parent().unwrap_or(Path::new("")),
        newlines: text.match_indices('\n').map(|(offset, _)| offset).collect(),
        problems,
        broken: BTreeSet::new(),
        valid_toml: errors.is_empty(),
    };
    for error in &errors {
        reader.syntax_error(error);
    }
    reader.spoil_below_broken_headings();
    reader.read(document.get_ref(), file_name, schemas)
}

struct TomlReader<'t> {
    text: &'t str,
    /// The directory to which paths of further files in the text are relative.
    directory: &'t Path,
    newlines: Vec<usize>,
    problems: Problems,
    /// The lines, counted from 0, with a syntax error. The parser's result for such a line may be wrong, so no further problem is
    /// reported there.
    broken: BTreeSet<usize>,
    valid_toml: bool,
}

impl TomlReader<'_> {
    fn syntax_error(&mut self, error: &Error) {
        let span = error.span().unwrap_or(0..0);
        let lines = self.line(span.start)..=self.line(span.end);
        // The first syntax error of a line is the mistake. Further errors in the line follow from it.
        if self.broken.contains(lines.start()) {
            return;
        }
        self.broken.extend(lines);
        let found = self.text.get(span.clone()).unwrap_or("");
        let message = error.message();
        let (message, remedy) = if message == "duplicate key" {
            let message = format!("`{}` is given twice", shown(found));
            (message, "remove one of the two; a table can have only one heading")
        } else if message.contains("recursion") || message.contains("recurse") {
            let message = "tables or lists are nested too deeply".to_owned();
            (message, "give plain values in tables")
        } else if message.starts_with("string values must be quoted") {
            let message = format!("not valid TOML: `{}` is not a value", shown(found));
            (message, "put a word in double quotes")
        } else {
            let message = format!("not valid TOML: {message}");
            (message, "write one `key = value` or one `[table]` in each line")
        };
        self.problems.push_error_at(span, ConfigError::new("", message, remedy));
    }

    /// Returns the line of the byte `offset`, counted from 0.
    fn line(&self, offset: usize) -> usize {
        self.newlines.partition_point(|newline| *newline < offset)
    }

    /// Marks the lines below a heading with a syntax error as broken, because the table of their keys is unknown.
    fn spoil_below_broken_headings(&mut self) {
        let mut spoilt = false;
        for (number, line) in self.text.lines().enumerate() {
            if line.trim_start().starts_with('[') {
                spoilt = self.broken.contains(&number);
            }
            if spoilt {
                self.broken.insert(number);
            }
        }
    }

    fn read(
        mut self,
        document: &DeTable,
        file_name: &str,
        schemas: &[Schema],
    ) -> Result<(Config, ConfigSource), Problems> {
        let schema = self.device(document, schemas);
        let name = self.name(document, file_name);
        let strict = self.strict(document);
        let Some(schema) = schema else {
            return Err(self.problems);
        };
        let mut draft = Draft::new(schema, &name);
        draft.config.strict = strict;
        self.table(document, "", schema, &mut draft);
        if self.valid_toml {
            let source = self.problems.source().clone();
            Ok((draft.finish(schema, self.problems)?, source))
        } else {
            Err(self.problems)
        }
    }

    /// Returns the schema of the device that the file names, or else of the most similar one. Reports a missing or wrong name.
    /// After a syntax error, a missing name is not reported.
    fn device<'s>(&mut self, document: &DeTable, schemas: &'s [Schema]) -> Option<&'s Schema> {
        let devices: Vec<&str> = schemas.iter().map(|schema| schema.device).collect();
        let remedy = format!("devices: {}", devices.join(", "));
        let Some(value) = document.get("device") else {
            // After a syntax error, the key may be in the file without having been read.
            if self.valid_toml {
                let message = "the file does not name the device that it configures";
                let remedy = format!("add `device = \"…\"`; {remedy}");
                self.problems.push("device", message, remedy);
            }
            return None;
        };
        let DeValue::String(given) = value.get_ref() else {
            let message = format!("`device` must be a string, not {}", described(value));
            self.report("device", value.span(), message, remedy);
            return None;
        };
        let meant = nearest(given, devices.iter().copied());
        if !devices.contains(&&**given) {
            let message = format!("there is no device {}", quoted(given));
            let remedy = match meant {
                Some(meant) => format!("did you mean \"{meant}\"? {remedy}"),
                None => remedy,
            };
            self.report("device", value.span(), message, remedy);
        }
        let exact = schemas.iter().find(|schema| schema.device == &**given);
        exact.or_else(|| schemas.iter().find(|schema| Some(schema.device) == meant))
    }

    fn name(&mut self, document: &DeTable, file_name: &str) -> String {
        match document.get("name") {
            None if file_name == STANDARD_INPUT => {
                let message = "the module has no name, because a configuration from standard input has no \
                               file name";
                let remedy = "add `name = \"…\"`, the name of the Verilog module".to_owned();
                self.problems.push("name", message, remedy);
                String::new()
            }
            None => {
                let stem = Path::new(file_name).file_stem().unwrap_or_default();
                let name = stem.to_string_lossy().replace('-', "_");
                if let Some(error) = module_name::error(&name) {
                    let message = format!("{}; the module has the name of the file", error.message);
                    let remedy = format!("set `name`: {}", error.remedy);
                    self.problems.push("name", message, remedy);
                }
                name
            }
            Some(value) => match value.get_ref() {
                DeValue::String(name) => {
                    if let Some(error) = module_name::error(name) {
                        self.report_error(value.span(), error);
                    }
                    name.clone().into_owned()
                }
                _ => {
                    let message = format!("`name` must be a string, not {}", described(value));
                    let remedy = "give the name of the Verilog module in double quotes";
                    self.report("name", value.span(), message, remedy.to_owned());
                    String::new()
                }
            },
        }
    }

    fn strict(&mut self, document: &DeTable) -> bool {
        match document.get("strict").map(|value| (value, value.get_ref())) {
            None => false,
            Some((_, DeValue::Boolean(strict))) => *strict,
            Some((value, _)) => {
                let message = format!("`strict` must be true or false, not {}", described(value));
                let remedy = "give true or false (default false)".to_owned();
                self.report("strict", value.span(), message, remedy);
                false
            }
        }
    }

    /// Reads all keys of `table` into `draft`. `prefix` is the name of the table followed by a dot, or empty.
    fn table<'s>(
        &mut self,
        table: &DeTable,
        prefix: &str,
        schema: &'s Schema,
        draft: &mut Draft<'s>,
    ) {
        for (key, value) in table {
            // A quoted key with a dot in it is no path. With its quotes, it equals no name of a key.
            let name = if is_bare(key.get_ref()) {
                format!("{prefix}{}", key.get_ref())
            } else {
                format!("{prefix}{}", quoted(key.get_ref()))
            };
            let as_table = format!("{name}.");
            // On a line with a syntax error, the parser's value may be wrong.
            if self.broken.contains(&self.line(key.span().start)) {
                continue;
            }
            // The parser's span of a table is the table's heading, or one of its keys.
            let span = match value.get_ref() {
                DeValue::Table(_) => key.span(),
                _ => value.span(),
            };
            if is_common(&name) {
                self.problems.locate(&name, span);
            } else if let Some(key) = schema.key(&name) {
                self.value(key, value, span, schema, draft);
            } else if !schema.all_keys().any(|key| key.name.starts_with(&as_table)) {
                self.unknown(&name, key.span(), value, schema, draft);
            } else if let DeValue::Table(inner) = value.get_ref() {
                self.table(inner, &as_table, schema, draft);
            } else {
                let message = format!("`{name}` is a table, not {}", described(value));
                let mut remedy = keys_of(schema, &name);
                let meant = other_words::settings(&name);
                if !meant.is_empty() {
                    draft.doubtful.extend(meant.iter().map(|setting| setting.key));
                    remedy = format!("{} {remedy}", suggestion(meant));
                }
                self.report(&name, span, message, remedy);
            }
        }
    }

    fn value<'s>(
        &mut self,
        key: &'s Key,
        value: &Spanned<DeValue>,
        span: Range<usize>,
        schema: &'s Schema,
        draft: &mut Draft<'s>,
    ) {
        self.problems.locate(key.name, span.clone());
        if let (KeyKind::Table { .. }, DeValue::Table(entries)) = (&key.kind, value.get_ref()) {
            return self.records(key, entries, span, schema, draft);
        }
        let found = match (&key.kind, value.get_ref()) {
            (KeyKind::Text(TextPattern::Samples), DeValue::String(path))
                if is_path_of_points(path) =>
            {
                let points = points::read(&self.directory.join(&**path));
                points.map(Value::Text).map_err(|(message, remedy)| {
                    let error = ConfigError::new(key.name, message, remedy);
                    vec![Violation { entry: None, error }]
                })
            }
            _ => converted(key, value),
        };
        match found {
            Ok(value) => draft.give(key, Some(value)),
            Err(violations) => {
                draft.give(key, None);
                for violation in violations {
                    let entry = violation.entry.zip(value.get_ref().as_array());
                    let entry = entry.and_then(|(index, entries)| entries.get(index));
                    let span = entry.map_or_else(|| span.clone(), Spanned::span);
                    self.report_error(span, violation.error);
                }
            }
        }
    }

    /// Reads a table whose entries the user names, in the file's order.
    fn records<'s>(
        &mut self,
        key: &'s Key,
        entries: &DeTable,
        span: Range<usize>,
        schema: &'s Schema,
        draft: &mut Draft<'s>,
    ) {
        let mut in_order: Vec<_> = entries.iter().collect();
        in_order.sort_by_key(|(name, _)| name.span().start);
        let is_optional = matches!(key.kind, KeyKind::Table { least: 0, .. });
        if in_order.is_empty() && !is_optional {
            // A heading without keys gives no value.
            return;
        }
        let mut records = Vec::new();
        let mut is_good = true;
        for (name, entry) in in_order {
            if self.broken.contains(&self.line(name.span().start)) {
                is_good = false;
                continue;
            }
            let name_text = shown(name.get_ref());
            if let Some(other) = schema.key(&format!("{}.{name_text}", key.name)) {
                // A key that every device has may be in the same table.
                if matches!(entry.get_ref(), DeValue::Table(_)) {
                    let message = format!(
                        "`{}` is a key of every core, so an entry of [{}] cannot be named `{name_text}`",
                        other.name, key.name
                    );
                    let remedy =
                        format!("give the entry another name, for example `{name_text}_value`");
                    self.report(other.name, name.span(), message, remedy);
                    is_good = false;
                    continue;
                }
                self.value(other, entry, entry.span(), schema, draft);
                continue;
            }
            self.problems.locate(&format!("{}.{name_text}", key.name), name.span());
            let table = EntriesOf::key(key, key.name).expect("a key for a table");
            match self.record(&table, &name_text, entry) {
                Some(fields) => records.push(TableEntry { name: name_text, fields }),
                None => is_good = false,
            }
        }
        if records.is_empty() && is_good && !is_optional {
            return;
        }
        let value = Value::Table(TableEntries(records));
        let violations = if is_good { key.violations_of(&value) } else { Vec::new() };
        is_good &= violations.is_empty();
        for Violation { error, .. } in violations {
            self.report(key.name, span.clone(), error.message, error.remedy);
        }
        draft.give(key, is_good.then_some(value));
    }

    /// Returns an entry's fields, or reports a wrong or unknown field.
    fn record(
        &mut self,
        table: &EntriesOf<'_>,
        name: &str,
        entry: &Spanned<DeValue>,
    ) -> Option<Vec<(&'static str, Value)>> {
        let EntriesOf { fields, shorthand, .. } = *table;
        let mut given = Vec::new();
        let mut is_good = true;
        if let DeValue::Table(entry) = entry.get_ref() {
            if let Some(path) = entry.get(FILE)
                && table.has_only_tables()
            {
                return self.record_of_file(table, name, entry.len(), path);
            }
            let mut in_order: Vec<_> = entry.iter().collect();
            in_order.sort_by_key(|(field, _)| field.span().start);
            for (field, value) in in_order {
                let known = fields.iter().find(|known| known.name == field.get_ref());
                let Some(known) = known else {
                    self.unknown_field(table, name, field);
                    is_good = false;
                    continue;
                };
                let value = self.field(table, name, known, value);
                is_good &= value.is_some();
                given.extend(value.map(|value| (known.name, value)));
            }
        } else if let Some(known) = fields.iter().find(|field| Some(field.name) == shorthand) {
            let value = self.field(table, name, known, entry);
            is_good &= value.is_some();
            given.extend(value.map(|value| (known.name, value)));
        } else {
            let within = format!("{}.{name}", table.name);
            let message = format!("`{within}` must be a table, not {}", described(entry));
            let names: Vec<&str> = fields.iter().map(|field| field.name).collect();
            let remedy = format!("give {{ {} = …, … }}; fields: {}", names[0], names.join(", "));
            self.report(&within, entry.span(), message, remedy);
            is_good = false;
        }
        is_good.then_some(given)
    }

    /// Returns the fields of an entry that refers to another configuration, such as `file = "fog.toml"`. The fields are the
    /// tables of that file with the same names. Reports a mistake if the file cannot be read, configures another device than
    /// [`DEVICE_OF_FILES`], or has a wrong field. The entry must not have further fields.
    fn record_of_file(
        &mut self,
        table: &EntriesOf<'_>,
        name: &str,
        fields: usize,
        path: &Spanned<DeValue>,
    ) -> Option<Vec<(&'static str, Value)>> {
        let within = format!("{}.{name}.{FILE}", table.name);
        self.problems.locate(&within, path.span());
        let given = match fields {
            1 => self.fields_of_file(table, path),
            _ => Err((
                format!("`{}.{name}` has `{FILE}` and other fields", table.name),
                format!("remove `{FILE}`, or the other fields"),
            )),
        };
        match given {
            Ok(given) => Some(given),
            Err((message, remedy)) => {
                self.report(&within, path.span(), message, remedy);
                None
            }
        }
    }

    /// Returns the fields for [`Self::record_of_file`], or a message and a remedy.
    fn fields_of_file(
        &self,
        table: &EntriesOf<'_>,
        path: &Spanned<DeValue>,
    ) -> Result<Vec<(&'static str, Value)>, (String, String)> {
        let remedy =
            || "give the path of a configuration, relative to this configuration".to_owned();
        let DeValue::String(path) = path.get_ref() else {
            return Err((format!("`{FILE}` must be a string, not {}", described(path)), remedy()));
        };
        let shown_path = shown(path);
        let unread = |error: &dyn std::fmt::Display| {
            (format!("`{shown_path}` cannot be read: {error}"), remedy())
        };
        let text = points::text(&self.directory.join(&**path)).map_err(|error| unread(&error))?;
        let document = DeTable::parse(&text).map_err(|error| unread(&error.message()))?;
        let document = document.get_ref();
        let device = document.get("device").and_then(|device| device.get_ref().as_str());
        if device != Some(DEVICE_OF_FILES) {
            let message = format!("`{shown_path}` does not configure the device {DEVICE_OF_FILES}");
            return Err((message, remedy()));
        }
        let mut reader = TomlReader {
            text: &text,
            directory: self.directory,
            newlines: text.match_indices('\n').map(|(offset, _)| offset).collect(),
            problems: Problems::of_file(&shown_path, &text),
            broken: BTreeSet::new(),
            valid_toml: true,
        };
        let mut given = Vec::new();
        for field in table.fields {
            if let Some(DeValue::Table(entries)) = document.get(field.name).map(Spanned::get_ref)
                && let Some(inner) = EntriesOf::key(field, field.name)
            {
                let value = reader.entries_within(&inner, entries);
                given.extend(value.map(|value| (field.name, value)));
            }
        }
        match reader.problems.iter().next() {
            None => Ok(given),
            Some(problem) => {
                let message = format!("in `{shown_path}`: {}", problem.error.message);
                Err((message, problem.error.remedy.clone()))
            }
        }
    }

    /// Returns a field's value, or reports that it is wrong.
    fn field(
        &mut self,
        table: &EntriesOf<'_>,
        record: &str,
        field: &Key,
        value: &Spanned<DeValue>,
    ) -> Option<Value> {
        let within = format!("{}.{record}.{}", table.name, field.name);
        self.problems.locate(&within, value.span());
        let violations = match (EntriesOf::key(field, &within), value.get_ref()) {
            (Some(table), DeValue::Table(entries)) => {
                let value = self.entries_within(&table, entries)?;
                let violations = field.violations_of(&value);
                if violations.is_empty() {
                    return Some(value);
                }
                violations
            }
            _ => match converted(field, value) {
                Ok(value) => return Some(value),
                Err(violations) => violations,
            },
        };
        for violation in violations {
            let Violation { error, .. } = field.named_within(violation, &within);
            // Fields have no default, so the remedy states the key's default as an example.
            let remedy = error.remedy.replace("(default ", "(for example ");
            self.report(&within, value.span(), error.message, remedy);
        }
        None
    }

    /// Returns the entries of a table that is a field of an entry, or reports a wrong field.
    fn entries_within(&mut self, table: &EntriesOf<'_>, entries: &DeTable) -> Option<Value> {
        let mut in_order: Vec<_> = entries.iter().collect();
        in_order.sort_by_key(|(name, _)| name.span().start);
        let mut records = Vec::new();
        let mut is_good = true;
        for (name, entry) in in_order {
            let name_text = shown(name.get_ref());
            self.problems.locate(&format!("{}.{name_text}", table.name), name.span());
            match self.record(table, &name_text, entry) {
                Some(fields) => records.push(TableEntry { name: name_text, fields }),
                None => is_good = false,
            }
        }
        is_good.then_some(Value::Table(TableEntries(records)))
    }

    fn unknown_field(
        &mut self,
        table: &EntriesOf<'_>,
        record: &str,
        field: &Spanned<std::borrow::Cow<'_, str>>,
    ) {
        let names: Vec<&str> = table.fields.iter().map(|known| known.name).collect();
        let given = shown(field.get_ref());
        let within = format!("{}.{record}.{given}", table.name);
        let message = format!("an entry of `{}` has no field `{given}`", table.name);
        let similar = nearest(&given, names.iter().copied())
            .or_else(|| other_words::last_part(&given, names.iter().copied()));
        let remedy = match similar {
            Some(meant) => format!("did you mean `{meant}`? fields: {}", names.join(", ")),
            None => format!("fields: {}", names.join(", ")),
        };
        self.report(&within, field.span(), message, remedy);
    }

    fn unknown<'s>(
        &mut self,
        name: &str,
        span: Range<usize>,
        value: &Spanned<DeValue>,
        schema: &'s Schema,
        draft: &mut Draft<'s>,
    ) {
        let is_table = value.get_ref().is_table();
        let what = if is_table { "table" } else { "key" };
        let unknown = UnknownName::new(schema, name, is_table);
        draft.doubtful.extend(unknown.meant);
        let name = shown(name);
        let message = format!("device `{}` has no {what} `{name}`", schema.device);
        self.report(&name, span, message, unknown.remedy);
    }

    fn report(&mut self, key: &str, span: Range<usize>, message: String, remedy: String) {
        self.report_error(span, ConfigError::new(key, message, remedy));
    }

    /// Adds an error, unless the first line of `span` has a syntax error.
    fn report_error(&mut self, span: Range<usize>, error: ConfigError) {
        if !self.broken.contains(&self.line(span.start)) {
            self.problems.push_error_at(span, error);
        }
    }
}

/// A table whose entries the user names. `name` is its full name, such as `functions.rcp.operands`, and `fields` are an entry's
/// fields.
struct EntriesOf<'k> {
    name: &'k str,
    fields: &'k [Key],
    /// The field whose value may replace a whole entry.
    shorthand: Option<&'static str>,
}

/// The field of an entry that is another configuration.
const FILE: &str = "file";

/// The device that a configuration named by `FILE` must have.
const DEVICE_OF_FILES: &str = "expression";

impl<'k> EntriesOf<'k> {
    /// Returns whether each field is itself a table, so an entry can be another configuration.
    fn has_only_tables(&self) -> bool {
        self.fields.iter().all(|field| matches!(field.kind, KeyKind::Table { .. }))
    }

    /// Returns the table with the full name `name`, or `None` if `key` is not for a table.
    fn key(key: &'k Key, name: &'k str) -> Option<Self> {
        match &key.kind {
            KeyKind::Table { fields, shorthand, .. } => {
                Some(Self { name, fields, shorthand: *shorthand })
            }
            _ => None,
        }
    }
}

/// Converts a value to the type of `key`. Fails with all mistakes if the type or the range is wrong.
fn converted(key: &Key, value: &Spanned<DeValue>) -> Result<Value, Vec<Violation>> {
    let wrong_type = || vec![key.wrong_type(&described(value))];
    let too_large = || vec![key.violation(out_of_range(key.name, written(value)))];
    let converted = match (&key.kind, value.get_ref()) {
        (KeyKind::Integer { .. }, DeValue::Integer(_)) => {
            Value::Integer(integer(value).ok_or_else(too_large)?)
        }
        (KeyKind::Number { .. }, DeValue::Integer(_)) => {
            Value::Number(integer(value).ok_or_else(too_large)? as f64)
        }
        (KeyKind::Number { .. }, DeValue::Float(number)) => {
            Value::Number(number.as_str().parse().map_err(|_| too_large())?)
        }
        (KeyKind::Choice(_), DeValue::String(text)) if !key.kind.is_integer_choice() => {
            Value::Text(text.clone().into_owned())
        }
        (KeyKind::Text(_), DeValue::String(text)) => Value::Text(text.clone().into_owned()),
        (_, DeValue::Integer(_)) if key.kind.takes_integers() => {
            Value::Text(integer(value).ok_or_else(too_large)?.to_string())
        }
        (KeyKind::Text(TextPattern::Formula), DeValue::Float(number)) => {
            Value::Text(number.as_str().to_owned())
        }
        (KeyKind::Flag, DeValue::Boolean(flag)) => Value::Flag(*flag),
        (KeyKind::Integers { .. }, DeValue::Array(entries)) => {
            let mut values = Vec::new();
            let mut violations = Vec::new();
            for (index, entry) in entries.iter().enumerate() {
                let named = format!("{}[{index}]", key.name);
                let message = match (integer(entry), entry.get_ref()) {
                    (Some(value), _) => {
                        values.push(value);
                        continue;
                    }
                    (None, DeValue::Integer(_)) => out_of_range(&named, written(entry)),
                    (None, _) => format!("`{named}` must be an integer, not {}", described(entry)),
                };
                violations.push(Violation { entry: Some(index), ..key.violation(message) });
            }
            if !violations.is_empty() {
                return Err(violations);
            }
            Value::Integers(values)
        }
        _ => return Err(wrong_type()),
    };
    let violations = key.violations_of(&converted);
    if violations.is_empty() { Ok(converted) } else { Err(violations) }
}

/// Returns the value as a signed integer, or `None` if it has more than 64 bits or is no integer.
fn integer(value: &Spanned<DeValue>) -> Option<i64> {
    let integer = value.get_ref().as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

/// Returns a number as the file writes it, without underscores. The text is empty for a value that is no number.
fn written(value: &Spanned<DeValue>) -> String {
    match value.get_ref() {
        DeValue::Integer(integer) => integer.to_string(),
        other => other.as_float().map(ToString::to_string).unwrap_or_default(),
    }
}

/// Returns the type and the value for a message, such as `the integer 7`.
fn described(value: &Spanned<DeValue>) -> String {
    match value.get_ref() {
        DeValue::String(text) => format!("the string {}", quoted(text)),
        DeValue::Integer(integer) => format!("the integer {}", shown(&integer.to_string())),
        DeValue::Float(float) => format!("the float {}", shown(&float.to_string())),
        DeValue::Boolean(flag) => format!("the boolean {flag}"),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

fn is_common(name: &str) -> bool {
    common_names().any(|common| common == name)
}

fn is_bare(key: &str) -> bool {
    !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

fn start_from(schemas: &[Schema]) -> String {
    let devices: Vec<&str> = schemas.iter().map(|schema| schema.device).collect();
    let devices = devices.join(", ");
    format!("write a configuration with `{Program} new DEVICE > FILE.toml`; devices: {devices}")
}

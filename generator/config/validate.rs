//! Checks ranges and conditions of keys, and builds a [`Config`] from valid values.

use std::collections::BTreeSet;

use super::follow::follow;
use super::module_name;
use super::nearest::nearest;
use super::other_words;
use super::problems::{Problem, Problems, Violation, out_of_range, quoted, shown};
use super::schema::{Condition, Key, KeyKind, Schema};
use super::shared::{DEFAULT_QUEUE, Shared};
use super::text_pattern::TextPattern;
use super::unknown::UnknownName;
use super::values::{Config, Value, is_integer};
use glint_base::config_error::ConfigError;

impl Key {
    /// Returns all mistakes of `value`, such as an integer out of range. The result is empty if the key accepts `value`.
    pub(super) fn violations_of(&self, value: &Value) -> Vec<Violation> {
        let name = self.name;
        match (&self.kind, value) {
            (KeyKind::Integer { min, max }, Value::Integer(given)) => {
                self.required((min..=max).contains(&given), || out_of_range(name, given))
            }
            (KeyKind::Number { min, max, or_zero }, Value::Number(given)) => {
                let good = (min..=max).contains(&given) || *or_zero && *given == 0.0;
                self.required(good, || out_of_range(name, value.bare()))
            }
            (KeyKind::Choice(options), Value::Text(given)) => self
                .required(options.contains(&given.as_str()), || {
                    if is_integer(given) {
                        format!("`{name}` cannot be {}", shown(given))
                    } else {
                        format!("`{name}` cannot be {}", quoted(given))
                    }
                })
                .into_iter()
                .map(|violation| self.with_suggestion(violation, given))
                .collect(),
            (KeyKind::Flag, Value::Flag(_)) => Vec::new(),
            (KeyKind::Text(TextPattern::Formula), Value::Text(given)) if given.contains('\n') => {
                let message = format!("`{name}` has a line break, and a formula is a single line");
                let remedy =
                    "write the formula in one line, or end each line of a text in \"\"\" with \\";
                vec![Violation { entry: None, error: ConfigError::new(name, message, remedy) }]
            }
            (KeyKind::Text(pattern), Value::Text(given)) => self
                .required(pattern.fits(given), || format!("`{name}` cannot be {}", quoted(given))),
            (KeyKind::Integers { min, max, len_min, len_max }, Value::Integers(given)) => {
                let mut all = self.required((len_min..=len_max).contains(&&given.len()), || {
                    let plural = if given.len() == 1 { "y" } else { "ies" };
                    format!("`{name}` has {} entr{plural}", given.len())
                });
                for (index, entry) in given.iter().enumerate() {
                    let inside = (min..=max).contains(&entry);
                    let named = format!("{name}[{index}]");
                    let found = self.required(inside, || out_of_range(&named, entry));
                    all.extend(found.into_iter().map(|it| Violation { entry: Some(index), ..it }));
                }
                all
            }
            (KeyKind::Table { fields, least, most, .. }, Value::Table(given)) => {
                let count = given.0.len();
                let mut all = self.required((*least..=*most).contains(&count), || {
                    let plural = if count == 1 { "y" } else { "ies" };
                    format!("`{name}` has {count} entr{plural}")
                });
                for record in &given.0 {
                    for (field, value) in &record.fields {
                        let Some(key) = fields.iter().find(|key| key.name == *field) else {
                            all.push(self.violation(format!("`{name}` has no field `{field}`")));
                            continue;
                        };
                        let within = self.field_name(&record.name, field);
                        all.extend(key.violations_within(value, &within));
                    }
                }
                all
            }
            (_, other) => vec![self.wrong_type(&other.described())],
        }
    }

    /// Returns the mistakes of a value in a field of an entry. `within` is the full name of the field, for example
    /// `operands.x.fraction`.
    pub(super) fn violations_within(&self, value: &Value, within: &str) -> Vec<Violation> {
        let violations = self.violations_of(value).into_iter();
        violations.map(|violation| self.named_within(violation, within)).collect()
    }

    /// Replaces the short name of a field in the message by the full name `within`.
    pub(super) fn named_within(&self, mut violation: Violation, within: &str) -> Violation {
        let own = format!("`{}`", self.name);
        let message = violation.error.message.replacen(&own, &format!("`{within}`"), 1);
        violation.error.message = message;
        violation.error.key = within.to_owned();
        violation
    }

    /// Returns the mistake of a value with a wrong type. `found` describes the value, for example `the integer 7`.
    pub(super) fn wrong_type(&self, found: &str) -> Violation {
        let wanted = match self.kind {
            KeyKind::Integer { .. } => "an integer",
            KeyKind::Number { .. } => "a number",
            KeyKind::Choice(_) if self.kind.is_integer_choice() => "an integer",
            KeyKind::Choice(words) if words.iter().any(|word| is_integer(word)) => {
                "an integer or a word"
            }
            KeyKind::Choice(_) | KeyKind::Text(_) => "a string",
            KeyKind::Flag => "true or false",
            KeyKind::Integers { .. } => "a list of integers",
            KeyKind::Table { .. } => "a table",
        };
        self.violation(format!("`{}` must be {wanted}, not {found}", self.name))
    }

    /// Returns a mistake with this message. The remedy names the values that the key accepts.
    pub(super) fn violation(&self, message: String) -> Violation {
        let remedy = format!("give {} (default {})", self.accepts(), self.default.toml());
        Violation { entry: None, error: ConfigError::new(self.name, message, remedy) }
    }

    fn required(&self, good: bool, message: impl FnOnce() -> String) -> Vec<Violation> {
        if good { Vec::new() } else { vec![self.violation(message())] }
    }

    fn with_suggestion(&self, violation: Violation, given: &str) -> Violation {
        let KeyKind::Choice(options) = self.kind else {
            return violation;
        };
        // Among numbers, a similar spelling means nothing.
        let near = nearest(given, options.iter().copied()).filter(|_| !is_integer(given));
        let near =
            near.map(|near| format!("\"{near}\"")).or_else(|| other_words::choice(self, given));
        match near {
            None => violation,
            Some(near) => {
                let remedy = format!("did you mean {near}? {}", violation.error.remedy);
                let error = ConfigError { remedy, ..violation.error };
                Violation { error, ..violation }
            }
        }
    }

    /// Returns a description of the accepted values, such as `an integer from 4 to 30`.
    pub fn accepts(&self) -> String {
        match &self.kind {
            KeyKind::Integer { min, max } => format!("an integer from {min} to {max}"),
            KeyKind::Number { min, max, or_zero } => {
                let zero = if *or_zero { "0, or " } else { "" };
                format!("{zero}a number from {min:?} to {max:?}")
            }
            KeyKind::Choice(options) => {
                let (numbers, words): (Vec<&str>, Vec<&str>) =
                    options.iter().copied().partition(|option| is_integer(option));
                let text = |option: &&str| Value::Text((*option).to_owned()).toml();
                // Many integers are described by the first and the last.
                let options: Vec<String> = match numbers[..] {
                    [first, .., last] if numbers.len() > 8 && !words.is_empty() => {
                        let integers = format!("an integer from {first} to {last}");
                        [integers].into_iter().chain(words.iter().map(text)).collect()
                    }
                    _ => options.iter().map(text).collect(),
                };
                match options.as_slice() {
                    [one] => one.clone(),
                    [start @ .., last] => format!("{} or {last}", start.join(", ")),
                    [] => "nothing".to_owned(),
                }
            }
            KeyKind::Flag => "true or false".to_owned(),
            KeyKind::Text(pattern) => pattern.text().to_owned(),
            KeyKind::Integers { min, max, len_min, len_max } => {
                if len_min == len_max {
                    format!("{len_min} integers from {min} to {max}")
                } else {
                    format!("{len_min} to {len_max} integers from {min} to {max}")
                }
            }
            KeyKind::Table { fields, least, most, .. } => {
                let mut names = Vec::new();
                for field in fields {
                    names.push(field.name);
                }
                format!("{least} to {most} entries, each with {}", names.join(", "))
            }
        }
    }

    /// Returns values that replace an unknown value in trials of the device's check: the default, and the ends of the range or
    /// all options. For a list of integers, these are the shortest list of the smallest integer and the longest list of the
    /// largest integer. A text or a table has only its default.
    fn stand_ins(&self) -> Vec<Value> {
        let ends: Vec<Value> = match &self.kind {
            KeyKind::Integer { min, max } => vec![Value::Integer(*min), Value::Integer(*max)],
            KeyKind::Number { min, max, .. } => vec![Value::Number(*min), Value::Number(*max)],
            KeyKind::Choice(options) => {
                options.iter().map(|option| Value::Text((*option).to_owned())).collect()
            }
            KeyKind::Flag => vec![Value::Flag(false), Value::Flag(true)],
            KeyKind::Text(_) | KeyKind::Table { .. } => Vec::new(),
            KeyKind::Integers { min, max, len_min, len_max } => {
                vec![Value::Integers(vec![*min; *len_min]), Value::Integers(vec![*max; *len_max])]
            }
        };
        let mut values = vec![self.default.clone()];
        values.extend(ends);
        values
    }
}

impl Value {
    /// Returns type and value for a message, such as `the integer 7`.
    fn described(&self) -> String {
        let kind = match self {
            Value::Integer(_) => "integer",
            Value::Number(_) => "number",
            Value::Text(text) => return format!("the string {}", quoted(text)),
            Value::Flag(_) => "flag",
            Value::Integers(_) => "list",
            Value::Table(_) => "table",
        };
        format!("the {kind} {}", shown(&self.bare()))
    }
}

/// A configuration during the reading of its values.
pub(super) struct Draft<'a> {
    /// A key has its default if the user gave no value, or a value that is not accepted.
    pub config: Config,
    /// The keys that the user gave.
    pub given: BTreeSet<&'a str>,
    /// The given keys whose intended value is unknown, because the given value is wrong.
    pub doubtful: BTreeSet<&'a str>,
}

/// Checks the conditions of `only_when` and `unless`, the conditions between shared keys, and the device's own check. An unmet
/// `only_when` or `unless` is reported only if the user gave the key, with a value other than the default.
///
/// A value that is not accepted is unknown. A problem of the device's check is reported only if the check finds it for all trial
/// values of the unknown keys. One mistake therefore raises no messages about other keys.
fn check(schema: &Schema, draft: &Draft, problems: &mut Problems) {
    for key in schema.all_keys() {
        let governors = chain(schema, key);
        let doubtful = governors.iter().any(|it| draft.doubtful.contains(it.key));
        // A key at its default has no effect that could be missing.
        let is_default = *draft.config.value(key.name) == key.default;
        if !draft.given.contains(key.name) || doubtful || is_default {
            continue;
        }
        let is_unmet = |condition: &&Condition| !condition.holds(draft.config.value(condition.key));
        if let Some(condition) = governors.iter().rev().find(is_unmet) {
            let other = condition.key;
            let actual = draft.config.value(other).toml();
            let needed = condition.words(draft.config.value(other));
            problems.push(
                key.name,
                format!("`{}` has no effect with {other} = {actual}", key.name),
                format!("remove the key, or set {needed}"),
            );
        }
    }

    let keys = Shared::of(&draft.config);
    if keys.stages != 0 && draft.given.contains("pipeline.clock_mhz") {
        problems.push(
            "pipeline.clock_mhz",
            "`pipeline.clock_mhz` and `pipeline.stages` both set the speed of the pipeline",
            "remove one of the two keys",
        );
    }

    if keys.stream && keys.stall == "none" {
        problems.push(
            "interface.stream",
            "`interface.stream` needs a pipeline that the receiver of the stream can stall",
            "set pipeline.stall = \"ready\", or remove interface.stream",
        );
    }

    let is_queue_set = keys.queue != DEFAULT_QUEUE && keys.architecture == "pipelined";
    if is_queue_set && keys.registers == "none" && !draft.doubtful.contains("interface.registers") {
        problems.push(
            "interface.queue",
            "`interface.queue` has no effect with interface.registers = \"none\"",
            "remove the key, or set interface.registers = \"axi-lite\" or \"wishbone\"",
        );
    }

    let aims = [keys.rate != 0.0, keys.max_multipliers != 0];
    let doubtful = ["pipeline.rate", "pipeline.max_multipliers"]
        .iter()
        .any(|key| draft.doubtful.contains(key));
    if keys.interval == "auto" && aims == [false; 2] && !doubtful {
        problems.push(
            "pipeline.interval",
            "`pipeline.interval` = \"auto\" needs a goal from which the interval follows",
            "set pipeline.rate or pipeline.max_multipliers",
        );
    }
    if aims == [true; 2] {
        problems.push(
            "pipeline.max_multipliers",
            "`pipeline.max_multipliers` and `pipeline.rate` both set the interval of the pipeline",
            "remove one of the two keys",
        );
    }

    // The formulas of a device name the entries of its tables. With an unknown entry, the check would report false mistakes.
    let is_table = |key: &Key| matches!(key.kind, KeyKind::Table { .. });
    if schema.all_keys().any(|key| is_table(key) && draft.doubtful.contains(key.name)) {
        return;
    }
    let mut certain: Option<Vec<Problem>> = None;
    for trial in trials(schema, draft) {
        let mut found = problems.cleared();
        (schema.check)(&trial, &mut found);
        let found: Vec<Problem> = found.iter().cloned().collect();
        certain = Some(match certain {
            None => found,
            Some(before) => before.into_iter().filter(|p| found.contains(p)).collect(),
        });
    }
    let found = certain.unwrap_or_default().into_iter().map(|problem| {
        let governs = schema.key(&problem.error.key).filter(|key| !draft.given.contains(key.name));
        match governs {
            None => problem,
            Some(key) => problem.told(|message| of_default(key, &draft.config, message)),
        }
    });
    problems.extend(found);
}

/// Begins a message about a key that the user did not give with the value, and says that the value is the default.
pub(super) fn of_default(key: &Key, config: &Config, message: &str) -> String {
    let value = config.value(key.name).toml();
    format!("`{}` is not set and has the default {value}: {message}", key.name)
}

/// Returns the conditions that must hold so that `key` applies, the key's own condition first.
fn chain(schema: &Schema, key: &Key) -> Vec<Condition> {
    let mut conditions = Vec::new();
    let mut condition = key.condition;
    while let Some(next) = condition {
        // A schema with a cycle of conditions has a mistake, but must not cause an endless loop.
        if conditions.contains(&next) {
            break;
        }
        conditions.push(next);
        condition = schema.key(next.key).and_then(|key| key.condition);
    }
    conditions
}

/// Returns configurations in which trial values replace the unknown values. Each configuration uses the next trial value of every
/// unknown key.
fn trials(schema: &Schema, draft: &Draft) -> Vec<Config> {
    let stand_ins: Vec<(&str, Vec<Value>)> = schema
        .all_keys()
        .filter(|key| draft.doubtful.contains(key.name))
        .map(|key| (key.name, key.stand_ins()))
        .collect();
    let count = stand_ins.iter().map(|(_, values)| values.len()).max();
    (0..count.unwrap_or(1))
        .map(|round| {
            let mut trial = draft.config.clone();
            for (name, values) in &stand_ins {
                trial.set(name, values[round % values.len()].clone());
            }
            trial
        })
        .collect()
}

impl Config {
    /// Returns a configuration with the module name `name` in which every key has its default.
    pub fn defaults(schema: &Schema, name: &str) -> Self {
        Config {
            name: name.to_owned(),
            device: schema.device.to_owned(),
            strict: false,
            values: schema.all_keys().map(|key| (key.name, key.default.clone())).collect(),
        }
    }

    /// Returns the configuration with the given values, and adjusted defaults for all other keys. Fails with the problems that a
    /// file with these values would have, without locations.
    pub fn from_values(
        schema: &Schema,
        name: &str,
        values: Vec<(String, Value)>,
    ) -> Result<Self, Problems> {
        let mut problems = Problems::default();
        let mut draft = Draft::new(schema, name);
        if let Some(error) = module_name::error(name) {
            problems.push_error(error);
        }
        for (name, value) in values {
            let Some(key) = schema.key(&name) else {
                let message = format!("device `{}` has no key {}", schema.device, quoted(&name));
                let unknown = UnknownName::new(schema, &name, matches!(value, Value::Table(_)));
                draft.doubtful.extend(unknown.meant);
                problems.push(&name, message, unknown.remedy);
                continue;
            };
            let violations = key.violations_of(&value);
            draft.give(key, violations.is_empty().then_some(value));
            for violation in violations {
                problems.push_error(violation.error);
            }
        }
        draft.finish(schema, problems)
    }

    /// Sets the keys that do not apply to their defaults. For example, `output.registered` applies only to sequential cores.
    pub fn reset_keys_without_effect(&mut self, schema: &Schema) {
        for key in schema.all_keys() {
            if !self.applies(schema, key.name) {
                self.set(key.name, key.default.clone());
            }
        }
    }

    /// Returns whether the key has an effect, given the values of the other keys. Returns true for keys without a condition, and
    /// for keys that the schema does not have.
    pub fn applies(&self, schema: &Schema, key: &str) -> bool {
        match schema.key(key).and_then(|key| key.condition) {
            None => true,
            Some(condition) => {
                condition.holds(self.value(condition.key)) && self.applies(schema, condition.key)
            }
        }
    }
}

impl<'a> Draft<'a> {
    /// Returns a draft in which all keys have their defaults, and no key counts as given.
    pub(super) fn new(schema: &Schema, name: &str) -> Self {
        Draft {
            config: Config::defaults(schema, name),
            given: BTreeSet::new(),
            doubtful: BTreeSet::new(),
        }
    }

    /// Records that the user gave `key`. `value` is `None` if the given value is not accepted.
    pub(super) fn give(&mut self, key: &'a Key, value: Option<Value>) {
        self.given.insert(key.name);
        match value {
            Some(value) => self.config.set(key.name, value),
            None => {
                self.doubtful.insert(key.name);
            }
        }
    }

    /// Adjusts the defaults of keys that the user left out, and checks the conditions between keys. With an unknown value, no
    /// default is adjusted. Fails with all problems, the problems in `problems` first.
    pub(super) fn finish(
        mut self,
        schema: &Schema,
        mut problems: Problems,
    ) -> Result<Config, Problems> {
        if self.doubtful.is_empty() {
            self.config = follow(schema, &self.config, &self.given);
        }
        check(schema, &self, &mut problems);
        if problems.is_empty() { Ok(self.config) } else { Err(problems) }
    }
}

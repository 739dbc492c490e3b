//! Declares the configuration keys of the device `expression`, and finds the plan of its formulas.
//!
//! The table `operands` of a configuration states the operands, and the table `let` named parts of formulas. The table `results`
//! states the results with their formulas, such as `sqrt(x^2 + y^2)`. A plan is a list of fixed-point operations that computes
//! the formulas ([`glint_plan`]).

use std::ops::Range;
use std::sync::Arc;

use glint_approximate::Outside;
use glint_base::config_error::ConfigError;
use glint_base::fixed::{Format, MAX_WIDTH, exp2};
use glint_config::{Config, Key, Problems, Schema, TableEntries, TableEntry, TextPattern, Value};
use glint_formula::{
    Comparison, EULER, Expression, Fault, Kind, NumberList, NumberOrList, Operator, TextSpan,
    parse, parse_condition_with_lists, parse_with_lists,
};
use glint_plan::{
    ExpressionStatement, Operation, PartToLimit, PlanRefusal, ProvedPlan, StatedOperand,
    StatedOverflow, StatedResult, StatedWidth, TableMemory, find_ordered, least_size,
};

use lists::{MOST_NUMBERS, OperandPorts, operand_entry, result_names};

use super::port_names::{self, NameFault, NamedTable};
use super::power_bases;
use super::stated_function::End;

pub use lists::{result_doc, result_entry};

mod lists;

/// The errors that a configuration may allow, in units of a result's last bit.
const LEAST_ERROR: f64 = 0.5;
const LARGEST_ERROR: f64 = 1024.0;

/// The remedy for a relative error that is not a number between 0 and 1.
const RELATIVE_ERROR: &str =
    "give a number between 0 and 1, or a formula of numbers, for example \"2^-12\"";

/// The key that says where the tables of polynomials are stored.
pub(super) const TABLES: &str = "tables";

glint_config::choices! {
    /// The memory for the tables of polynomials.
    pub enum TableChoice {
        Logic = "logic",
        BlockMemory = "block-memory",
    }
}

glint_config::keys! {
    pub struct Keys {
        operands: TableEntries = Key::records("operands", &example_operands(), operand_fields(), None, 1..=16,
            "The operands, in the order of the ports. The field bits gives an operand a whole format; the \
             fields from and to give it a domain. The field size or axes makes it a list of numbers."),
        parts: TableEntries = Key::records("let", &[], part_fields(), Some("formula"), 0..=32,
            "Named parts of the formulas. The formula of a part may use operands and earlier parts."),
        results: TableEntries = Key::records("results", &example_results(), result_fields(), None, 1..=16,
            "The results, in the order of the ports. The formula of a result may use operands and named parts."),
        tables: TableChoice = Key::choice(TABLES, "logic", TableChoice::WORDS,
            "Where the tables of polynomials are stored. \"block-memory\" puts a table into a block memory wherever that \
             saves look-up tables or multipliers; on ECP5, a pipeline then reaches 144 MHz. \"logic\" takes a block memory \
             only if it saves at least 300 look-up tables."),
    }
}

fn operand_fields() -> Vec<Key> {
    vec![
        Key::integer("size", 3, 2..=16, "The number of numbers of a list. Each has a port."),
        Key::text(
            "axes",
            "xyz",
            TextPattern::Formula,
            "A letter for each number of a list, for the names of the ports.",
        ),
        Key::integer("fraction", 12, -40..=40, "Fraction bits."),
        Key::integer("bits", 12, 1..=32, "The width. The domain is then the whole format."),
        Key::flag("signed", true, "Together with bits: whether the operand is signed."),
        Key::text("from", "-1", TextPattern::Formula, "The smallest value of the operand."),
        Key::text("to", "1", TextPattern::Formula, "The upper end of the domain."),
        Key::flag("to_included", false, "Whether the upper end belongs to the domain."),
        Key::choice(
            "outside",
            "anything",
            &["anything", "clamp"],
            "The result for operands outside the domain. anything: any result. clamp: the result of the nearer \
             end of the domain.",
        ),
        Key::text(
            "doc",
            "the input",
            TextPattern::Remark,
            "A remark, which the emitted files contain.",
        ),
    ]
}

fn part_fields() -> Vec<Key> {
    vec![Key::text("formula", "x^2 + y^2", TextPattern::Formula, "The formula.")]
}

fn result_fields() -> Vec<Key> {
    vec![
        Key::text(
            "formula",
            "sqrt(s)",
            TextPattern::Formula,
            "The formula. A list gives a result for each of its numbers.",
        ),
        Key::integer(
            "size",
            3,
            2..=16,
            "The number of numbers of a list, which the formula must give.",
        ),
        Key::text(
            "axes",
            "xyz",
            TextPattern::Formula,
            "A letter for each number of a list, for the names of the ports.",
        ),
        Key::integer("fraction", 12, 0..=40, "Fraction bits."),
        Key::number(
            "error",
            1.0,
            LEAST_ERROR..=LARGEST_ERROR,
            "The bound of the error against the formula, in units of the last place of the result.",
        ),
        Key::text(
            "error_relative",
            "2^-12",
            TextPattern::Formula,
            "The bound of the relative error against the formula, in place of error.",
        ),
        Key::integer(
            "bits",
            12,
            1..=64,
            "The width. By default, the number of integer bits follows from the values.",
        ),
        Key::flag("signed", true, "Together with bits: whether the result is signed."),
        Key::choice(
            "overflow",
            "refuse",
            &["refuse", "saturate", "wrap"],
            "Together with bits: how values outside the format are handled. refuse allows no such value.",
        ),
        Key::flag(
            "ordered",
            false,
            "For a list: whether the results must have the order of their values. The largest result of a softmax is \
             then a result of the largest number.",
        ),
        Key::text(
            "where",
            "s > 0",
            TextPattern::Formula,
            "A condition, such as `x < y and y != 0`. The error bound holds for the operands for which the condition \
             is true.",
        ),
        Key::text(
            "doc",
            "the result",
            TextPattern::Remark,
            "A remark, which the emitted files contain.",
        ),
    ]
}

/// Returns the default operands, the coordinates `x` and `y` of a point.
fn example_operands() -> Vec<TableEntry> {
    let fields = [
        ("bits", Value::Integer(12)),
        ("fraction", Value::Integer(11)),
        ("signed", Value::Flag(true)),
    ];
    vec![TableEntry::new("x", &fields), TableEntry::new("y", &fields)]
}

/// Returns the default result, the distance `r` of the point from the origin.
fn example_results() -> Vec<TableEntry> {
    let fields = [
        ("formula", Value::Text("sqrt(x^2 + y^2)".to_owned())),
        ("fraction", Value::Integer(11)),
        ("error", Value::Number(1.0)),
    ];
    vec![TableEntry::new("r", &fields)]
}

pub fn schema() -> Schema {
    Schema { device: "expression", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    if let Err(error) = statement(&Keys::of(config)) {
        problems.push_error(error);
    }
}

/// Turns a mistake in a formula into an error. `has_lists` says whether the formula can name lists.
fn misread(key: String, fault: Fault, has_lists: bool) -> ConfigError {
    let remedy = match has_lists {
        true => {
            "write a formula of numbers and lists of the same size, for example `2 * n + [n.x, n.y, 1]`, `v[0]` or \
             `dot(n, n)`"
        }
        false => {
            "write a formula of numbers, pi, e, operands, + - * / ^, parentheses and functions, for \
             example `sqrt(x^2 + y^2)`"
        }
    };
    ConfigError::new(key, fault.message, remedy).at(fault.span.bytes)
}

/// Plans the formulas of a configuration, and proves an error bound for each result. This can take some seconds.
///
/// # Errors
/// Fails if a name, an operand, a formula or an allowed error is wrong, no result depends on some operand, or no plan can be
/// found.
pub fn plan(config: &Config) -> Result<ProvedPlan, ConfigError> {
    let keys = Keys::of(config);
    let statement = statement(&keys)?;
    let lists = ordered_lists(&keys, &statement)?;
    let memory = match keys.tables {
        TableChoice::Logic => TableMemory::Logic,
        TableChoice::BlockMemory => TableMemory::Block,
    };
    let plan = find_ordered(&statement, &lists, memory)
        .map_err(|refusal| refused(&keys, &statement, refusal))?;
    check_operands_have_readers(&keys, &plan)?;
    Ok(plan)
}

/// Returns the lists of results that must have the order of their values, as ranges of indices.
///
/// # Errors
/// Fails if an `ordered` result is a single number.
fn ordered_lists(
    keys: &Keys,
    statement: &ExpressionStatement,
) -> Result<Vec<Range<usize>>, ConfigError> {
    let mut lists = Vec::new();
    for record in keys.results.0.iter().filter(|record| record.flag("ordered")) {
        let is_own = |result: &StatedResult| result_entry(keys, &result.name).name == record.name;
        let first = statement.results.iter().position(is_own).unwrap_or_default();
        let count = statement.results.iter().filter(|result| is_own(result)).count();
        if count < 2 {
            let message = format!("`{}` is a single number, which has no order", record.name);
            let key = format!("results.{}.ordered", record.name);
            let remedy = "remove `ordered`, or give a formula of lists, such as softmax(v)";
            return Err(ConfigError::new(key, message, remedy));
        }
        lists.push(first..first + count);
    }
    Ok(lists)
}

/// Checks that the plan reads every operand. Fails for an operand if every choice or remainder that reads it was decided:
/// `if(x < 100, y, x)` with x below 2 is y.
fn check_operands_have_readers(keys: &Keys, found: &ProvedPlan) -> Result<(), ConfigError> {
    let plan = &found.plan;
    let is_read = |node: usize| {
        let mut results = 0..found.statement.results.len();
        results.any(|result| plan.needed_for(result)[node])
    };
    for (at, node) in plan.nodes().iter().enumerate() {
        if let Operation::Operand(number) = node.operation
            && !is_read(at)
        {
            let port = &found.statement.operands[number].name;
            let entry = &operand_entry(keys, port).name;
            let name = lists::as_written(keys, port);
            let message = format!(
                "no result changes with `{name}`, because each choice or remainder that reads it is the same for all values \
                 in the domains"
            );
            let remedy = "remove the operand, or give the operands larger domains";
            return Err(ConfigError::new(format!("operands.{entry}"), message, remedy));
        }
    }
    Ok(())
}

/// Turns the refusal of a plan into an error in the formula that it concerns, also of a named part, or in the table `results`.
pub(super) fn refused(
    keys: &Keys,
    statement: &ExpressionStatement,
    refusal: PlanRefusal,
) -> ConfigError {
    let of_part = |place: &TextSpan| Some(&keys.parts.0.get(place.text.checked_sub(1)?)?.name);
    let key = match (refusal.place.as_ref().and_then(of_part), refusal.result) {
        (Some(name), _) => part_key(name),
        (None, Some(number)) => {
            let entry = result_entry(keys, &statement.results[number].name);
            format!("results.{}.formula", entry.name)
        }
        (None, None) => "results".to_owned(),
    };
    let message = lists::as_written(keys, &refusal.message);
    let remedy = match refusal
        .limited
        .and_then(|limited| condition(keys, statement, refusal.result, *limited))
    {
        Some(condition) => format!(
            "limit the operands with `where`, for example where = \"{condition}\", or with `from` and `to`"
        ),
        None => lists::as_written(keys, &refusal.remedy),
    };
    let place = refusal.place.map(|place| place.bytes);
    ConfigError::new(key, message, remedy).at(place)
}

/// The longest part of a formula that a remedy repeats, in bytes.
const LONGEST_LIMITED_PART: usize = 60;

/// Returns a condition for `where` that limits a part of a formula, such as `x - y > 0`. If a text of the configuration has the
/// part, the condition repeats this text. Returns `None` if the part is long.
fn condition(
    keys: &Keys,
    statement: &ExpressionStatement,
    result: Option<usize>,
    PartToLimit { place, formula, sign }: PartToLimit,
) -> Option<String> {
    let part = match place {
        None => lists::as_written(keys, &formula),
        Some(place) => {
            let entry = match place.text.checked_sub(1) {
                Some(part) => keys.parts.0.get(part)?,
                None => result_entry(keys, &statement.results[result?].name),
            };
            entry.text("formula")?.get(place.bytes)?.to_owned()
        }
    };
    (part.len() <= LONGEST_LIMITED_PART).then(|| format!("{part} {sign} 0"))
}

/// The named parts of the formulas, in the order of the table `let`. The formula of part number i lies in text number i + 1
/// ([`TextSpan::text`]).
type Parts = Vec<(String, Arc<Expression>)>;

/// The names that a formula may have: operands, and earlier parts.
#[derive(Default)]
struct KnownNames {
    /// The names of the ports of all operands.
    operands: Vec<String>,
    /// The parts that are numbers.
    parts: Parts,
    /// The operands and parts that are lists.
    lists: Vec<(String, NumberList)>,
}

impl KnownNames {
    /// Returns the list with the name `name`, or the operand or the part that is named `e`: the parser would otherwise read the
    /// base of the natural logarithm. Returns `None` for other names.
    fn list_or_constant(&self, name: &str) -> Option<NumberOrList> {
        if let Some((_, list)) = self.lists.iter().find(|(own, _)| own == name) {
            return Some(NumberOrList::List(list.clone()));
        }
        let is_named = self.is_operand(name) || self.parts.iter().any(|(own, _)| own == name);
        (is_named && name == EULER).then(|| Expression::operand(name).into())
    }

    fn is_operand(&self, name: &str) -> bool {
        self.operands.iter().any(|operand| operand == name)
    }

    /// Returns the names in the order of the configuration, for messages.
    fn all(&self, keys: &Keys) -> String {
        let mut names: Vec<&str> = Vec::new();
        names.extend(keys.operands.0.iter().map(|operand| operand.name.as_str()));
        let is_known = |name: &str| {
            let is_list = self.lists.iter().any(|(own, _)| own == name);
            is_list || self.parts.iter().any(|(own, _)| own == name)
        };
        let parts = keys.parts.0.iter().map(|part| part.name.as_str());
        names.extend(parts.filter(|name| is_known(name)));
        names.join(", ")
    }
}

fn part_key(name: &str) -> String {
    format!("let.{name}.formula")
}

/// Returns the operands and results that a configuration states, with the formulas of named parts in place of their names, and with
/// numbers in place of lists.
///
/// # Errors
/// Fails if an entry or a relative error is wrong, if two entries have the same name, if no result depends on an operand, or if
/// there are more than [`MOST_NUMBERS`] operands or results.
pub(super) fn statement(keys: &Keys) -> Result<ExpressionStatement, ConfigError> {
    let mut known = KnownNames::default();
    let mut operands = Vec::new();
    for record in &keys.operands.0 {
        let ports = OperandPorts::of(record)?;
        let operand = operand(record)?;
        let docs = ports.docs(&record.name, &operand.doc);
        for (name, doc) in ports.names.iter().zip(docs) {
            operands.push(StatedOperand { name: name.clone(), doc, ..operand.clone() });
            known.operands.push(name.clone());
        }
        if let Some(list) = ports.list() {
            known.lists.push((record.name.clone(), list));
        }
    }
    check_count("operands", operands.len())?;
    let stated: Vec<&str> = keys.results.0.iter().map(|record| record.name.as_str()).collect();
    check_names(keys, &known.operands, &stated)?;
    for (number, record) in keys.parts.0.iter().enumerate() {
        let key = part_key(&record.name);
        match formula(record.text("formula"), &key, keys, &known)? {
            NumberOrList::Number(formula) => {
                let formula = Arc::new(formula.in_text(number + 1));
                known.parts.push((record.name.clone(), formula));
            }
            NumberOrList::List(mut list) => {
                for element in &mut list.elements {
                    *element = Arc::new(element.in_text(number + 1));
                }
                known.lists.push((record.name.clone(), list));
            }
        }
    }
    let mut results = Vec::new();
    for record in &keys.results.0 {
        results.extend(results_of(record, keys, &known)?);
    }
    check_count("results", results.len())?;
    let names: Vec<&str> = results.iter().map(|result| result.name.as_str()).collect();
    check_names(keys, &known.operands, &names)?;
    for operand in &operands {
        let names_it =
            |result: &StatedResult| result.formula.operands().contains(&operand.name.as_str());
        if !results.iter().any(names_it) {
            let entry = &operand_entry(keys, &operand.name).name;
            let name = lists::as_written(keys, &operand.name);
            let message = format!("no result depends on `{name}`");
            let remedy = match *entry == operand.name {
                true => "remove the operand, or use it in a formula",
                false => "give the list fewer numbers, or use this number in a formula",
            };
            return Err(ConfigError::new(format!("operands.{entry}"), message, remedy));
        }
    }
    let mut statement = ExpressionStatement { operands, results };
    for number in 0..statement.results.len() {
        let record = result_entry(keys, &statement.results[number].name);
        if let Some(text) = record.text("error_relative") {
            statement.results[number].error = error_of_relative(keys, &statement, number, text)?;
        }
    }
    Ok(statement)
}

/// Checks that a table states at most [`MOST_NUMBERS`] numbers.
fn check_count(table: &str, count: usize) -> Result<(), ConfigError> {
    if count <= MOST_NUMBERS {
        return Ok(());
    }
    let message = format!(
        "the {table} have {count} numbers together, and at most {MOST_NUMBERS} are possible"
    );
    Err(ConfigError::new(table, message, "give fewer numbers, or make two cores"))
}

/// Returns the allowed error of the result with the index `number`, in units of its last bit, at most [`LARGEST_ERROR`]. `text`
/// states it as a part of the result's value, and the smallest absolute value decides. For example, 2^-12 of values from 0.5 to 1
/// is 2^-13, just below 4 units with 15 fraction bits.
///
/// # Errors
/// Fails if `text` is not a number between 0 and 1, or if the result may be 0 or near 0. Fails if the smallest absolute value of
/// the result cannot be computed, or if the error would be below half a unit.
fn error_of_relative(
    keys: &Keys,
    statement: &ExpressionStatement,
    number: usize,
    text: &str,
) -> Result<f64, ConfigError> {
    let StatedResult { name, fraction, .. } = &statement.results[number];
    let key = format!("results.{}.error_relative", result_entry(keys, name).name);
    let part = parse(text).and_then(|part| part.enclose(&[])).map_err(|fault| {
        ConfigError::new(&key, fault.message, RELATIVE_ERROR).at(fault.span.bytes)
    })?;
    if !(part.low > 0.0 && part.high < 1.0) {
        let message = format!("`{text}` is not a number between 0 and 1");
        return Err(ConfigError::new(key, message, RELATIVE_ERROR));
    }
    let least =
        least_size(statement, number).map_err(|refusal| refused(keys, statement, refusal))?;
    if least == 0.0 {
        let message = format!(
            "`{name}` can be 0 or near 0, and no error is a small enough part of such a value"
        );
        let remedy = "limit the operands with `where` or with their domains, or give `error` in place of \
                      `error_relative`";
        return Err(ConfigError::new(key, message, remedy));
    }
    let allowed = part.low * least;
    let units = (allowed * exp2(*fraction as i32)).next_down();
    if units < LEAST_ERROR {
        let needed = (LEAST_ERROR / allowed).log2().ceil();
        let message = format!(
            "the smallest value of `{name}` is {least:.6}: with {fraction} fraction bits, half a unit is \
             more than {text} of this value"
        );
        let remedy = format!("set at least {needed} fraction bits, or a larger error_relative");
        return Err(ConfigError::new(key, message, remedy));
    }
    Ok(units.min(LARGEST_ERROR))
}

/// Checks the names of operands, parts and results, and fails at the first one that cannot be used. `operands` and `results` have the
/// names of the ports.
fn check_names(keys: &Keys, operands: &[String], results: &[&str]) -> Result<(), ConfigError> {
    let mut names: Vec<(NamedTable, &str, &str)> = Vec::new();
    let mut operands = operands.iter();
    for record in &keys.operands.0 {
        let count = OperandPorts::of(record)?.names.len();
        names.extend(
            operands
                .by_ref()
                .take(count)
                .map(|port| (NamedTable::Operands, port.as_str(), record.name.as_str())),
        );
    }
    for TableEntry { name, .. } in &keys.parts.0 {
        names.push((NamedTable::Parts, name, name));
    }
    for name in results {
        names.push((NamedTable::Results, name, &result_entry(keys, name).name));
    }
    let entries: Vec<(NamedTable, &str)> =
        names.iter().map(|(table, name, _)| (*table, *name)).collect();
    port_names::check(&entries).map_err(|NameFault { entry, message, remedy }| {
        let (table, name, record) = names[entry];
        if name != record {
            let message = format!("{message}, and the list `{record}` has a port of this name");
            let remedy = format!("give the list `{record}` another name or other axes");
            return ConfigError::new(format!("{}.{record}", table.key()), message, remedy);
        }
        // The name of a port of a list before it looks free in the configuration.
        let is_port = |(_, port, list): &&(NamedTable, &str, &str)| *port == name && port != list;
        let message = match names[..entry].iter().find(is_port) {
            Some((_, _, list)) => format!("the list `{list}` has a port `{name}` already"),
            None => message,
        };
        ConfigError::new(format!("{}.{record}", table.key()), message, remedy)
    })
}

fn operand(record: &TableEntry) -> Result<StatedOperand, ConfigError> {
    let key = |field: &str| format!("operands.{}.{field}", record.name);
    let name = record.name.clone();
    let doc = record.text("doc").unwrap_or_default().to_owned();
    let whole = format!("operands.{name}");
    let Some(Value::Integer(fraction)) = record.field("fraction") else {
        let remedy =
            "add fraction, the number of fraction bits: for example, { bits = 12, fraction = 11 }";
        return Err(ConfigError::new(whole, format!("`{name}` has no `fraction`"), remedy));
    };
    let frac = *fraction as i32;
    let (from, to) = (record.text("from"), record.text("to"));
    if let Some(bits) = record.bits("bits") {
        if from.is_some() || to.is_some() {
            let message = format!("`{name}` has both `bits` and a domain");
            let remedy = "keep bits and signed, or from and to";
            return Err(ConfigError::new(key("bits"), message, remedy));
        }
        if record.field("outside").is_some() {
            let message =
                format!("`outside` has no effect on `{name}`: its domain is the whole format");
            return Err(ConfigError::new(
                key("outside"),
                message,
                "remove `outside`, or give from and to",
            ));
        }
        let signed = record.flag("signed");
        let format = Format { signed, int: bits as i32 - i32::from(signed) - frac, frac };
        let (low, high) = format.range();
        return Ok(StatedOperand {
            name,
            format,
            domain: (low as i64, high as i64),
            outside: Outside::Anything,
            doc,
        });
    }
    let (Some(from), Some(to)) = (from, to) else {
        let message = format!("`{name}` has neither `bits` nor `from` and `to`");
        let remedy = "add bits for a whole format, or from and to for a domain";
        return Err(ConfigError::new(whole, message, remedy));
    };
    if record.field("signed").is_some() {
        let message =
            "`from` and `to` determine whether the operand has a sign, so `signed` has no effect";
        return Err(ConfigError::new(key("signed"), message, "remove `signed`"));
    }
    let Ok(fraction) = u32::try_from(frac) else {
        let message = "an operand with `from` and `to` cannot have fewer than 0 fraction bits";
        return Err(ConfigError::new(
            key("fraction"),
            message,
            "give 0 or more, or bits in place of from and to",
        ));
    };
    let first = end(from, fraction, key("from"))?;
    let last = end(to, fraction, key("to"))?;
    let is_included = last.is_operand && record.flag("to_included");
    let (low, high) = (first.ceiling, last.ceiling - i128::from(!is_included));
    if Format::holding(low, high, frac).width() > MAX_WIDTH / 2 {
        let message = format!(
            "the domain from {from} to {to} has operands of more than {} bits",
            MAX_WIDTH / 2
        );
        return Err(ConfigError::new(
            key("fraction"),
            message,
            "set fewer fraction bits, or a smaller domain",
        ));
    }
    if high <= low {
        let message = format!(
            "the domain from {from} to {to} has no two operands with {fraction} fraction bits"
        );
        return Err(ConfigError::new(
            key("to"),
            message,
            "set a larger `to`, or more fraction bits",
        ));
    }
    let outside = match record.text("outside") {
        Some("clamp") => Outside::Clamp,
        _ => Outside::Anything,
    };
    let format = Format::holding(low, high, frac);
    Ok(StatedOperand { name, format, domain: (low as i64, high as i64), outside, doc })
}

fn end(text: &str, fraction: u32, key: String) -> Result<End, ConfigError> {
    End::read("", text, fraction)
        .map_err(|refusal| ConfigError::new(key, refusal.message, refusal.remedy).at(refusal.place))
}

/// Returns the result of an entry, or a result for each number of a list.
fn results_of(
    record: &TableEntry,
    keys: &Keys,
    known: &KnownNames,
) -> Result<Vec<StatedResult>, ConfigError> {
    let name = record.name.clone();
    let whole = format!("results.{name}");
    let Some(fraction) = record.bits("fraction") else {
        let remedy = "add fraction, the number of fraction bits: for example, { formula = \"x * y\", \
                      fraction = 11 }";
        return Err(ConfigError::new(whole, format!("`{name}` has no `fraction`"), remedy));
    };
    let key = format!("{whole}.formula");
    if record.text("formula").is_none() {
        let message = format!("`{name}` has no `formula`");
        return Err(ConfigError::new(
            whole,
            message,
            "add a formula: for example, formula = \"x * y\"",
        ));
    }
    let formula = formula(record.text("formula"), &key, keys, known)?;
    let names = result_names(record, &formula)?;
    let promise = match record.text("where") {
        Some(text) => Some(promise(text, &format!("{whole}.where"), keys, known)?),
        None => None,
    };
    if record.field("error").is_some() && record.field("error_relative").is_some() {
        let message = format!("`{name}` has both `error` and `error_relative`");
        return Err(ConfigError::new(
            format!("{whole}.error_relative"),
            message,
            "keep one of the two",
        ));
    }
    let error = record.number("error").unwrap_or(1.0);
    let width_of = |formula: &Expression| {
        let format = stated_format(record, record.bits("bits")?, fraction);
        let overflow = match record.text("overflow") {
            Some("saturate") => StatedOverflow::Saturate(limited(formula, format)),
            Some("wrap") => StatedOverflow::Wrap,
            _ => StatedOverflow::Refuse,
        };
        Some(StatedWidth { format, overflow })
    };
    if record.field("bits").is_none() {
        for field in ["signed", "overflow"] {
            if record.field(field).is_some() {
                let message = format!("`{field}` has no effect without `bits`");
                let key = format!("{whole}.{field}");
                return Err(ConfigError::new(key, message, "add bits, or remove the field"));
            }
        }
    }
    let mut results = Vec::new();
    for (name, formula) in names.into_iter().zip(formula.elements()) {
        let (formula, promise) = ((**formula).clone(), promise.clone());
        let width = width_of(&formula);
        results.push(StatedResult { name, formula, fraction, error, promise, width });
    }
    Ok(results)
}

/// Returns the format of a result, with a sign if the field `signed` of the entry says so.
fn stated_format(record: &TableEntry, bits: u32, fraction: u32) -> Format {
    let signed = record.flag("signed");
    let frac = fraction as i32;
    Format { signed, int: bits as i32 - i32::from(signed) - frac, frac }
}

/// Limits the formula to the range of a format: `x + y` in s0.7 becomes `min(max(x + y, -1), 127/128)`.
fn limited(formula: &Expression, format: Format) -> Expression {
    let span = formula.span.clone();
    let (least, most) = format.range();
    let limit = |raw: i128| {
        let number = parse(&format!("{raw} / 2^{}", format.frac)).expect("a formula of a number");
        Arc::new(Expression::new(number.kind, span.clone()))
    };
    let not_below = Kind::Binary(Operator::Max, Arc::new(formula.clone()), limit(least));
    let not_below = Arc::new(Expression::new(not_below, span.clone()));
    Expression::new(Kind::Binary(Operator::Min, not_below, limit(most)), span.clone())
}

/// Parses a formula, and replaces named parts by their formulas. `key` is the configuration key for errors. A missing text counts
/// as an empty one. Fails if the text is not a formula, or if the formula has an unknown name.
fn formula(
    text: Option<&str>,
    key: &str,
    keys: &Keys,
    known: &KnownNames,
) -> Result<NumberOrList, ConfigError> {
    let text = text.unwrap_or_default();
    let formula = parse_with_lists(text, &|name| known.list_or_constant(name))
        .map_err(|fault| misread(key.to_owned(), fault, !known.lists.is_empty()))?;
    Ok(match formula {
        NumberOrList::Number(number) => {
            NumberOrList::Number(Arc::new(resolved(&number, key, keys, known)?))
        }
        NumberOrList::List(list) => NumberOrList::List(resolved_list(list, key, keys, known)?),
    })
}

/// Replaces the names in each number of a list. Parts that several numbers share stay shared. Fails if a name is unknown.
fn resolved_list(
    list: NumberList,
    key: &str,
    keys: &Keys,
    known: &KnownNames,
) -> Result<NumberList, ConfigError> {
    let mut elements = Vec::new();
    for element in &list.elements {
        elements.push(Arc::new(resolved(element, key, keys, known)?));
    }
    Ok(NumberList { elements, ..list })
}

/// The name of 2 π in formulas, unless an operand or a part has this name, such as a time constant.
const TAU: &str = "tau";

/// Replaces the names of parts by their formulas, and [`TAU`] by its value. Fails if the formula has a name that is neither an
/// operand nor an earlier part.
fn resolved(
    formula: &Expression,
    key: &str,
    keys: &Keys,
    known: &KnownNames,
) -> Result<Expression, ConfigError> {
    power_bases::check(formula, key)?;
    let mut unknown = None;
    formula.walk(&mut |part| {
        let (Kind::Operand(name) | Kind::Word(name, _)) = &part.kind else { return };
        let is_part = known.parts.iter().any(|(own, _)| own == name) || name == TAU;
        let is_known = known.is_operand(name) || is_part;
        if !is_known || matches!(part.kind, Kind::Word(..)) {
            unknown.get_or_insert((part.span.bytes.clone(), name.clone(), is_known));
        }
    });
    if let Some((span, name, is_known)) = unknown {
        let (message, remedy) = match is_known {
            true => {
                (format!("`{name}` is a number and has no index"), "write only its name".to_owned())
            }
            false => (
                format!("there is no operand and no earlier part `{name}`"),
                format!("use one of these names: {}", known.all(keys)),
            ),
        };
        return Err(ConfigError::new(key, message, remedy).at(span));
    }
    let of_part = |name: &str| {
        let part = known.parts.iter().find(|(own, _)| own == name);
        let part = part.map(|(_, formula)| formula.clone());
        let is_whole_turn = name == TAU && part.is_none() && !known.is_operand(name);
        if is_whole_turn { parse("2 * pi").ok().map(Arc::new) } else { part }
    };
    Ok(formula.with_operands(&of_part))
}

/// Parses a condition, for example `x < y` or `0 < x < y`, into an equivalent comparison, and replaces named parts. Fails if the
/// text is not a condition, or if a name is unknown.
fn promise(
    text: &str,
    key: &str,
    keys: &Keys,
    known: &KnownNames,
) -> Result<Comparison, ConfigError> {
    let comparison = parse_condition_with_lists(text, &|name| known.list_or_constant(name))
        .map_err(|fault| {
            let remedy = match known.lists.is_empty() {
                true => "give a condition, for example `x < y` or `s > 0 and x != 0`",
                false => "compare numbers, for example `n.x > 0`, `min(v) > 0` or `dot(n, n) > 0`",
            };
            ConfigError::new(key, fault.message, remedy).at(fault.span.bytes)
        })?;
    let Comparison { left, right, or_equal } = comparison;
    let left = Arc::new(resolved(&left, key, keys, known)?);
    let right = Arc::new(resolved(&right, key, keys, known)?);
    Ok(Comparison { left, right, or_equal })
}

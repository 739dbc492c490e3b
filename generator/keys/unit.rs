//! Declares the configuration keys of the device `unit`, and plans its functions.
//!
//! The table `functions` has an entry for each function, whose fields are the tables of the device `expression`: operands, named
//! parts and results. The order of the entries is the order of the opcodes. For example, `functions.rcp.results.r.formula = "1 / x"`
//! states a function `rcp`.

use std::sync::Arc;

use glint_approximate::{Refusal, TargetFunction, Wish, find_images};
use glint_base::config_error::ConfigError;
use glint_base::identifier;
use glint_config::{
    Config, Key, Problems, Schema, Shared, TableEntries, TableEntry, TextPattern, Value,
};
use glint_plan::{
    ExpressionStatement, MOST_FUNCTIONS, PlanRefusal, ProvedPlan, StatedFunction, StatedOverflow,
    UnitPlan, find_unit, target_function,
};

use super::images::StatedImage;
use super::{expression, images};

/// The longest name of a function, as for modules.
const LONGEST_NAME: usize = 60;

/// The tables of a function. They have the names of the keys of the device `expression`.
const OPERANDS: &str = "operands";
const PARTS: &str = "let";
const RESULTS: &str = "results";

/// The table of further formulas. A function that has it has a table that can be written.
const IMAGES: &str = "images";

glint_config::keys! {
    pub struct Keys {
        functions: TableEntries = Key::records("functions", &example_functions(), function_fields(), None, 1..=MOST_FUNCTIONS,
            "The functions, in the order of their opcodes. Each has the tables operands, let and results of the device expression. \
             One function of one operand may have a table images with further formulas of the operand: its table of \
             coefficients can then be written, and is planned for all of them."),
    }
}

fn function_fields() -> Vec<Key> {
    let mut fields = expression::Keys::keys();
    // The functions of a unit share one table.
    fields.retain(|field| field.name != expression::TABLES);
    let formula =
        Key::text("formula", "x^2", TextPattern::Formula, "A formula of the function's operand.");
    fields.push(Key::records(
        IMAGES,
        &[],
        vec![formula],
        Some("formula"),
        0..=16,
        "Further formulas for the table of the function, which can then be written.",
    ));
    fields
}

/// Returns the functions of a unit whose configuration states none: the reciprocal `rcp` and the reciprocal square root
/// `rsqrt`. Their operand x is above 0 and below 16.
fn example_functions() -> Vec<TableEntry> {
    let integer = Value::Integer;
    let text = |text: &str| Value::Text(text.to_owned());
    let function = |name: &str, formula: &str| {
        let operand = TableEntry::new("x", &[("bits", integer(12)), ("fraction", integer(8))]);
        let fields = [
            ("formula", text(formula)),
            ("fraction", integer(8)),
            ("error", Value::Number(1.0)),
            ("where", text("x > 0")),
        ];
        let tables = [
            (OPERANDS, Value::Table(TableEntries(vec![operand]))),
            (RESULTS, Value::Table(TableEntries(vec![TableEntry::new("r", &fields)]))),
        ];
        TableEntry::new(name, &tables)
    };
    vec![function("rcp", "1 / x"), function("rsqrt", "1 / sqrt(x)")]
}

pub fn schema() -> Schema {
    Schema { device: "unit", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let functions = Keys::of(config).functions.0;
    let checked = statements(&functions).and_then(|_| image_functions(&functions));
    if let Err(error) = checked {
        problems.push_error(error);
    }
}

/// Returns the keys of a function as keys of the device `expression`.
///
/// # Errors
/// Fails if the function has no operands or no results.
fn keys_of(function: &TableEntry) -> Result<expression::Keys, ConfigError> {
    let entries = |table: &str| match function.field(table) {
        Some(Value::Table(entries)) => entries.clone(),
        _ => TableEntries::default(),
    };
    for (table, example) in [
        (OPERANDS, "operands.x = { bits = 16, fraction = 15 }"),
        (RESULTS, "results.r = { formula = \"1 / x\", fraction = 15 }"),
    ] {
        if entries(table).0.is_empty() {
            let message = format!("the function `{}` has no {table}", function.name);
            let remedy = format!("add a table, for example {example}");
            return Err(ConfigError::new(String::new(), message, remedy));
        }
    }
    Ok(expression::Keys {
        operands: entries(OPERANDS),
        parts: entries(PARTS),
        results: entries(RESULTS),
        tables: expression::TableChoice::Logic,
    })
}

/// Returns the error of a function's keys as an error of the unit's keys.
fn within(function: &TableEntry, error: ConfigError) -> ConfigError {
    let whole = format!("functions.{}", function.name);
    let key = match error.key.as_str() {
        "" => whole,
        key => format!("{whole}.{key}"),
    };
    ConfigError { key, ..error }
}

/// Checks that the names of functions are legal identifiers, and differ in more than upper and lower case, because the emitted files
/// define constants such as `FUNCTION_RCP`.
fn check_names(functions: &[TableEntry]) -> Result<(), ConfigError> {
    for (number, function) in functions.iter().enumerate() {
        let name = &function.name;
        let key = format!("functions.{name}");
        let remedy = "give the function another name";
        if name.chars().count() > LONGEST_NAME {
            let message = format!("the name of a function has at most {LONGEST_NAME} letters");
            return Err(ConfigError::new(key, message, remedy));
        }
        if let Err(reason) = identifier::check(name) {
            let message = format!("`{name}` cannot be the name of a function: {reason}");
            return Err(ConfigError::new(key, message, remedy));
        }
        let is_same = |other: &TableEntry| other.name.eq_ignore_ascii_case(name);
        if functions[..number].iter().any(is_same) {
            let message =
                format!("another function has the name `{name}`, apart from upper and lower case");
            return Err(ConfigError::new(key, message, remedy));
        }
    }
    Ok(())
}

/// Returns the statement of each function.
///
/// # Errors
/// Fails if a name, an operand, a formula or an allowed error is wrong, if a result wraps, or if a list is to be ordered.
fn statements(functions: &[TableEntry]) -> Result<Vec<ExpressionStatement>, ConfigError> {
    check_names(functions)?;
    let mut statements = Vec::new();
    for function in functions {
        statements.push(statement(function).map_err(|error| within(function, error))?);
    }
    Ok(statements)
}

fn statement(function: &TableEntry) -> Result<ExpressionStatement, ConfigError> {
    let keys = keys_of(function)?;
    let statement = expression::statement(&keys)?;
    if let Some(result) = keys.results.0.iter().find(|result| result.flag("ordered")) {
        let message = "the order of results is not proved for a unit".to_owned();
        let key = format!("results.{}.ordered", result.name);
        let remedy = "remove `ordered`, or make a core of its own of this function";
        return Err(ConfigError::new(key, message, remedy));
    }
    for result in &statement.results {
        let width = result.width.as_ref();
        if width.is_some_and(|width| matches!(width.overflow, StatedOverflow::Wrap)) {
            let message = "a result of a unit cannot wrap".to_owned();
            let key = format!("results.{}.overflow", result.name);
            return Err(ConfigError::new(key, message, "set \"saturate\" or \"refuse\""));
        }
    }
    Ok(statement)
}

/// Returns the opcode of the function whose table can be written, if there is one.
///
/// # Errors
/// Fails if several functions have such a table.
fn written_opcode(functions: &[TableEntry]) -> Result<Option<usize>, ConfigError> {
    let mut opcodes = (0..functions.len()).filter(|at| functions[*at].field(IMAGES).is_some());
    let (first, second) = (opcodes.next(), opcodes.next());
    match second {
        None => Ok(first),
        Some(second) => Err(ConfigError::new(
            format!("functions.{}.{IMAGES}", functions[second].name),
            "one function of a unit has a table that can be written",
            "remove the images of all functions but one, or make a unit for each",
        )),
    }
}

/// Returns the function with `field` in place of the fields `dropped` of its first result.
fn with_result_field(
    function: &TableEntry,
    dropped: &[&str],
    field: (&'static str, Value),
) -> TableEntry {
    let mut changed = function.clone();
    let mut tables = changed.fields.iter_mut();
    let results = tables.find_map(|(table, value)| match value {
        Value::Table(entries) if *table == RESULTS => entries.0.first_mut(),
        _ => None,
    });
    if let Some(result) = results {
        result.fields.retain(|(own, _)| !dropped.contains(own));
        result.fields.push(field);
    }
    changed
}

/// Returns the function with the formula `text` of its first result.
fn with_formula(function: &TableEntry, text: &str) -> TableEntry {
    with_result_field(function, &["formula"], ("formula", Value::Text(text.to_owned())))
}

/// Returns the entries of the images of a function: their names and formulas.
fn images_of(function: &TableEntry) -> Vec<(String, String)> {
    let Some(Value::Table(entries)) = function.field(IMAGES) else { return Vec::new() };
    let entry = |entry: &TableEntry| {
        (entry.name.clone(), entry.text("formula").unwrap_or_default().to_owned())
    };
    entries.0.iter().map(entry).collect()
}

/// Returns the opcode of the function whose table can be written, with this function and its images, as functions of x. Returns `None` if
/// the unit has no such function.
///
/// # Errors
/// Fails if several functions have such a table, if the function has another form than a polynomial of one operand, or if an image has a
/// bad name or a wrong formula.
fn image_functions(
    functions: &[TableEntry],
) -> Result<Option<(usize, Vec<TargetFunction>)>, ConfigError> {
    let Some(opcode) = written_opcode(functions)? else { return Ok(None) };
    let function = &functions[opcode];
    let target = |entry: &TableEntry| {
        let statement = statement(entry)?;
        target_function(&statement)
            .map_err(|refusal| ConfigError::new(String::new(), refusal.message, refusal.remedy))
    };
    let mut targets = vec![target(function).map_err(|error| within(function, error))?];
    let images = images_of(function);
    let names: Vec<&str> = images.iter().map(|(name, _)| name.as_str()).collect();
    let key = |name: &str| format!("functions.{}.{IMAGES}.{name}", function.name);
    images::check_names(&names, &key)?;
    for (name, formula) in &images {
        let stated = target(&with_formula(function, formula));
        targets.push(stated.map_err(|error| ConfigError { key: key(name), ..error })?);
    }
    Ok(Some((opcode, targets)))
}

/// Plans the functions with tables of the same widths, proves an error bound for each result, and merges the plans. This can take
/// some seconds.
///
/// # Errors
/// Fails if a statement is wrong, or if a function or the unit has no plan. The error names the function.
pub fn plan(config: &Config) -> Result<UnitPlan, ConfigError> {
    let functions = Keys::of(config).functions.0;
    let mut stated = Vec::new();
    for (function, statement) in functions.iter().zip(statements(&functions)?) {
        stated.push(StatedFunction { name: function.name.clone(), statement, table: None });
    }
    if let Some((opcode, targets)) = image_functions(&functions)? {
        let found = find_images(&targets, Wish::default());
        let found = found.map_err(|refusal| unplanned(&functions[opcode], refusal))?;
        let own = found.into_iter().next().expect("the image of the function itself");
        let target = targets.into_iter().next().expect("the function itself");
        stated[opcode].table = Some((target, Arc::new(own)));
    }
    find_unit(&stated, is_sequential(config)).map_err(|(number, refusal)| {
        let function = &functions[number];
        let error = keys_of(function).map_or_else(
            |error| error,
            |keys| expression::refused(&keys, &stated[number].statement, refusal),
        );
        within(function, error)
    })
}

fn is_sequential(config: &Config) -> bool {
    Shared::of(config).architecture == "sequential"
}

/// Turns the refusal of polynomials for a function and its images into an error of the function.
fn unplanned(function: &TableEntry, refusal: Refusal) -> ConfigError {
    let remedy = "allow a larger error, or remove an image";
    within(function, ConfigError::new(IMAGES, refusal.message, remedy))
}

/// Returns the name and the opcode of the function whose table can be written.
pub fn written_function(config: &Config) -> Option<(String, usize)> {
    let functions = Keys::of(config).functions.0;
    let opcode = written_opcode(&functions).ok().flatten()?;
    Some((functions[opcode].name.clone(), opcode))
}

/// Returns the images of the function whose table can be written.
pub fn stated_images(config: &Config) -> Vec<StatedImage> {
    let Some((_, opcode)) = written_function(config) else { return Vec::new() };
    let function = &Keys::of(config).functions.0[opcode];
    let mut images = Vec::new();
    for (name, formula) in images_of(function) {
        let config = image_config(config, &formula, None);
        images.push(StatedImage { name, formula, config });
    }
    images
}

/// Returns the configuration with another formula of the function whose table can be written, and with another allowed error if it is
/// given.
pub fn image_config(config: &Config, formula: &str, error: Option<f64>) -> Config {
    let mut changed = config.clone();
    let Some((_, opcode)) = written_function(config) else { return changed };
    let mut functions = Keys::of(config).functions;
    functions.0[opcode] = with_formula(&functions.0[opcode], formula);
    if let Some(error) = error {
        functions.0[opcode] = with_error(&functions.0[opcode], error);
    }
    changed.set("functions", Value::Table(functions));
    changed
}

/// Returns the function with another allowed error of its first result.
fn with_error(function: &TableEntry, error: f64) -> TableEntry {
    with_result_field(function, &["error", "error_relative"], ("error", Value::Number(error)))
}

/// Plans the unit of `config` with the datapath of `unit`. Both configurations may differ only in the formula of the function
/// whose table can be written, and in its allowed error.
///
/// # Errors
/// Fails if the unit has no such function, or if its table cannot hold the formula with the allowed error.
pub fn refit(config: &Config, unit: &UnitPlan) -> Result<UnitPlan, ConfigError> {
    let functions = Keys::of(config).functions.0;
    let Some((opcode, targets)) = image_functions(&functions)? else {
        return Err(ConfigError::new(
            "functions",
            "no function of the unit has a table that can be written",
            "give a function the table images, for example images.half = \"x / 2\"",
        ));
    };
    let function = &functions[opcode];
    let own = &unit.functions[opcode].planned.plan;
    let mut tables = own.approximations().into_iter();
    let table = tables.find_map(|approximation| approximation.polynomials.clone());
    let table = table.expect("the table of the function");
    let polynomials = images::refit(&table, &targets[0])
        .map_err(|error| within(function, ConfigError { key: RESULTS.to_owned(), ..error }))?;
    let refused = |refusal: PlanRefusal| {
        within(function, ConfigError::new(RESULTS, refusal.message, refusal.remedy))
    };
    let statement = statement(function).map_err(|error| within(function, error))?;
    let planned =
        ProvedPlan::of_table(statement, &targets[0], &Arc::new(polynomials)).map_err(refused)?;
    unit.with_function(opcode, planned, is_sequential(config)).map_err(refused)
}

//! Declares the configuration keys of the device `unit`, and plans its functions.
//!
//! The table `functions` has an entry for each function, whose fields are the tables of the device `expression`: operands, named
//! parts and results. The order of the entries is the order of the opcodes. For example, `functions.rcp.results.r.formula = "1 / x"`
//! states a function `rcp`.

use glint_base::config_error::ConfigError;
use glint_base::identifier;
use glint_config::{Config, Key, Problems, Schema, Shared, TableEntries, TableEntry, Value};
use glint_plan::{ExpressionStatement, MOST_FUNCTIONS, StatedOverflow, UnitPlan, find_unit};

use super::expression;

/// The longest name of a function, as for modules.
const LONGEST_NAME: usize = 60;

/// The tables of a function. They have the names of the keys of the device `expression`.
const OPERANDS: &str = "operands";
const PARTS: &str = "let";
const RESULTS: &str = "results";

glint_config::keys! {
    pub struct Keys {
        functions: TableEntries = Key::records("functions", &example_functions(), expression::Keys::keys(), None, 1..=MOST_FUNCTIONS,
            "The functions, in the order of their opcodes. Each has the tables operands, let and results of the device expression."),
    }
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
    if let Err(error) = statements(config) {
        problems.push_error(error);
    }
}

/// Returns the keys of a function as those of the device `expression`.
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
/// Fails if a name, an operand, a formula or an allowed error is wrong, or if a result wraps.
fn statements(config: &Config) -> Result<Vec<ExpressionStatement>, ConfigError> {
    let functions = Keys::of(config).functions.0;
    check_names(&functions)?;
    let mut statements = Vec::new();
    for function in &functions {
        statements.push(statement(function).map_err(|error| within(function, error))?);
    }
    Ok(statements)
}

fn statement(function: &TableEntry) -> Result<ExpressionStatement, ConfigError> {
    let statement = expression::statement(&keys_of(function)?)?;
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

/// Plans the functions with tables of the same widths, proves an error bound for each result, and merges the plans. This can take
/// some seconds.
///
/// # Errors
/// Fails if a statement is wrong, or if a function or the unit has no plan. The error names the function.
pub fn plan(config: &Config) -> Result<UnitPlan, ConfigError> {
    let keys = Keys::of(config);
    let statements = statements(config)?;
    let names: Vec<String> =
        keys.functions.0.iter().map(|function| function.name.clone()).collect();
    let is_sequential = Shared::of(config).architecture == "sequential";
    find_unit(&names, &statements, is_sequential).map_err(|(number, refusal)| {
        let function = &keys.functions.0[number];
        let error = keys_of(function).map_or_else(
            |error| error,
            |keys| expression::refused(&keys, &statements[number], refusal),
        );
        within(function, error)
    })
}

//! Computes many points for `glint eval`: reads operands from a CSV file, and writes results as CSV or JSON.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Result, anyhow, bail};
use serde_json::{Map, Value, json};

use super::operands;
use crate::commands::setup::REAL;
use crate::commands::{Loaded, rows};
use crate::report::CommandReport;
use crate::{OutputOptions, failure, tables};
use glint_golden::{ANY_VALUE, Contract};

/// The result of a point. One value serves all points, to avoid new allocations.
#[derive(Default)]
struct PointResult {
    operands: Vec<i64>,
    /// The number of the point in its line, from 0; `None` if the device computes single points.
    point: Option<u64>,
    f: Option<i64>,
    outputs: Vec<i64>,
    exact_f: Option<f64>,
    /// The values of the formulas; NaN for a formula without a value.
    exact: Vec<f64>,
    /// Whether the contract promises an error, for each output.
    promised: Vec<bool>,
    /// The numbers of the outputs with an error that is promised only under a condition.
    conditional: Vec<usize>,
    inside: bool,
}

/// The subject of a computation of many points: a core, or a function of a unit.
pub struct BatchSubject<'a> {
    pub contract: &'a dyn Contract,
    /// The raw operands on the command line, which apply to all rows.
    pub given: &'a [Option<i64>],
    /// The names of the results, in the order of the contract.
    pub results: Vec<String>,
}

/// Computes every row of a CSV file with the golden model's arithmetic and with the formula in f64. If the device computes
/// lines, the report has all points of each line.
///
/// # Errors
/// Fails if the file cannot be read, if a column is unknown or given twice, or if a value is not valid.
pub fn batch(
    output: OutputOptions,
    one: &Loaded,
    subject: &BatchSubject,
    path: &Path,
) -> Result<bool> {
    let BatchSubject { contract, given, .. } = *subject;
    let (mut text, mut json) = (headings(subject), Vec::new());
    let for_people = output.is_for_people();
    let conditional = conditional_outputs(contract);
    let mut row = PointResult { conditional, ..PointResult::default() };
    let mut missing = Vec::new();
    let mut show = |row: &PointResult| {
        if for_people {
            append(contract, row, &mut text);
        } else {
            json.push(as_json(subject, row));
        }
    };
    rows::read(
        path,
        |headings| {
            let columns = columns(contract, given, headings.iter())?;
            missing = missing_columns(contract, given, &columns);
            Ok(columns)
        },
        |columns, record| points(contract, given, columns, record, &mut row, &mut show),
    )?;
    output.report(&EvaluatedPoints { one, path, missing, text, points: json })?;
    Ok(true)
}

struct EvaluatedPoints<'a> {
    one: &'a Loaded,
    path: &'a Path,
    /// The operands without a column, with the values that the command chose.
    missing: Vec<String>,
    /// The results for people; empty for a script.
    text: String,
    /// The results for a script; empty for people.
    points: Vec<Value>,
}

impl CommandReport for EvaluatedPoints<'_> {
    fn json(&self) -> Result<Value> {
        let Self { one, missing, points, .. } = self;
        Ok(json!({ "config": one.path, "not_given": missing, "points": points }))
    }

    fn print(&self) -> Result<()> {
        tables::print_line(self.text.trim_end());
        if !self.missing.is_empty() {
            let (path, missing) = (self.path.display(), self.missing.join(", "));
            failure::warn(&format!(
                "`{path}` has no column for some operands; they have the values {missing}"
            ));
        }
        Ok(())
    }
}

/// Returns the index of the operand for each column. It is `None` for a column of real values, such as `real_cos_gamma`, which
/// `glint setup` writes and this command ignores.
fn columns<'a>(
    contract: &dyn Contract,
    given: &[Option<i64>],
    headings: impl Iterator<Item = &'a str>,
) -> Result<Vec<Option<usize>>> {
    let known = contract.operands();
    let mut columns = Vec::new();
    for heading in headings {
        let at = match operands::position(known, heading) {
            Err(_) if heading.starts_with(REAL) => None,
            other => Some(other.map_err(|why| anyhow!("{why}"))?),
        };
        if at.is_some_and(|it| columns.contains(&at) || given[it].is_some()) {
            bail!("operand `{heading}` is given twice");
        }
        columns.push(at);
    }
    Ok(columns)
}

/// Returns the operands without a column and without a value on the command line, with the values that the command chooses.
fn missing_columns(
    contract: &dyn Contract,
    given: &[Option<i64>],
    columns: &[Option<usize>],
) -> Vec<String> {
    let mut with_columns = given.to_vec();
    for at in columns.iter().flatten() {
        with_columns[*at] = Some(0);
    }
    operands::missing(contract, &with_columns)
}

/// Computes a row's points, which are one point or all points of a line, and calls `show` with each. `row` is overwritten.
fn points(
    contract: &dyn Contract,
    given: &[Option<i64>],
    columns: &[Option<usize>],
    record: &csv::StringRecord,
    row: &mut PointResult,
    show: &mut impl FnMut(&PointResult),
) -> Result<(), String> {
    let known = contract.operands();
    let mut of_row = given.to_vec();
    for (at, text) in columns.iter().zip(record) {
        // An empty cell gives no value to the operand.
        if let (Some(at), false) = (*at, text.is_empty()) {
            of_row[at] = Some(operands::named_value(&known[at], text)?);
        }
    }
    row.operands.clear();
    row.operands.extend(of_row.iter().flatten());
    if row.operands.len() < known.len() {
        row.operands = operands::completed(contract, &of_row);
    }
    let length = known.iter().position(|operand| Some(operand.name.as_str()) == contract.length());
    let last = match length {
        Some(at) => row.operands[at].max(0) as u64,
        None => 0,
    };
    row.inside = true;
    for (operand, raw) in known.iter().zip(&row.operands) {
        let (low, high) = operand.domain;
        row.inside &= operand.clamped || (low..=high).contains(raw);
    }
    for index in 0..=last {
        let raw = &row.operands;
        (row.f, row.exact_f) = (None, None);
        if let Some(highlight) = contract.highlight() {
            let point = highlight.point(&raw[..highlight.control()], index);
            row.f = Some(highlight.f(&point));
            row.exact_f = Some(highlight.reference(&point));
        }
        row.outputs.clear();
        row.exact.clear();
        contract.results(raw, index, &mut row.outputs);
        contract.formula_values(raw, index, &mut row.exact);
        let mut sides = Vec::new();
        contract.exact(raw, index, &mut sides);
        row.promised = sides.into_iter().map(|sides| sides != ANY_VALUE).collect();
        row.point = length.map(|_| index);
        show(row);
    }
    Ok(())
}

/// Returns the headings with a newline. Operands, `f` and formulas are real values. An output is a raw integer; if it has
/// fraction bits, its heading begins with `raw_`.
fn headings(subject: &BatchSubject) -> String {
    let contract = subject.contract;
    let mut headings: Vec<String> =
        contract.operands().iter().map(|operand| operand.name.clone()).collect();
    let has_f = contract.highlight().is_some();
    if contract.length().is_some() {
        headings.push("point".to_owned());
    }
    if has_f {
        headings.push("f".to_owned());
    }
    for (output, name) in contract.outputs().iter().zip(&subject.results) {
        headings.push(match output.format.frac {
            0 => name.clone(),
            _ => format!("raw_{name}"),
        });
    }
    if has_f {
        headings.push("formula_f".to_owned());
    }
    for name in &subject.results {
        headings.push(format!("formula_{name}"));
    }
    headings.push("inside_the_domain".to_owned());
    for number in conditional_outputs(contract) {
        headings.push(format!("inside_where_{}", subject.results[number]));
    }
    headings.join(",") + "\n"
}

fn conditional_outputs(contract: &dyn Contract) -> Vec<usize> {
    let conditions = contract.conditions().unwrap_or_default();
    (0..conditions.len()).filter(|number| conditions[*number].is_some()).collect()
}

/// Appends a row. Numbers need no quotes.
fn append(contract: &dyn Contract, row: &PointResult, text: &mut String) {
    for (operand, &raw) in contract.operands().iter().zip(&row.operands) {
        decimal(operand.format.to_f64(raw.into()), text);
    }
    if let Some(index) = row.point {
        integer(index as i64, text);
    }
    if let (Some(highlight), Some(f)) = (contract.highlight(), row.f) {
        decimal(highlight.f_format().to_f64(f.into()), text);
    }
    for &raw in &row.outputs {
        integer(raw, text);
    }
    if let Some(f) = row.exact_f {
        decimal(f, text);
    }
    for &value in &row.exact {
        match value.is_nan() {
            true => text.push(','),
            false => decimal(value, text),
        }
    }
    text.push_str(if row.inside { "true" } else { "false" });
    for &number in &row.conditional {
        text.push_str(if row.promised[number] { ",true" } else { ",false" });
    }
    text.push('\n');
}

fn integer(value: i64, text: &mut String) {
    text.push_str(itoa::Buffer::new().format(value));
    text.push(',');
}

/// Appends a number and a comma, as the format `{}` prints the number. A faster function writes whole numbers.
fn decimal(value: f64, text: &mut String) {
    let whole = value as i64;
    let is_whole = whole as f64 == value && whole.unsigned_abs() < 1 << 53;
    if is_whole && (whole != 0 || value.is_sign_positive()) {
        return integer(whole, text);
    }
    write!(text, "{value},").expect("a text takes all that is written");
}

fn as_json(subject: &BatchSubject, row: &PointResult) -> Value {
    let contract = subject.contract;
    let mut operands = Map::new();
    for (operand, raw) in contract.operands().iter().zip(&row.operands) {
        operands.insert(operand.name.clone(), json!(raw));
    }
    let mut outputs = Map::new();
    for (name, raw) in subject.results.iter().zip(&row.outputs) {
        outputs.insert(name.clone(), json!(raw));
    }
    let exact: Vec<Option<f64>> =
        row.exact.iter().map(|value| (!value.is_nan()).then_some(*value)).collect();
    let mut point = json!({
        "operands": operands,
        "inside_the_domain": row.inside,
        "outputs": outputs,
        "formula": { "outputs": exact },
    });
    let mut inside_where = Map::new();
    for &number in &row.conditional {
        let name = subject.results[number].clone();
        inside_where.insert(name, json!(row.promised[number]));
    }
    if !inside_where.is_empty() {
        point["inside_where"] = Value::Object(inside_where);
    }
    if let Some(index) = row.point {
        point["point"] = json!(index);
    }
    if let (Some(f), Some(exact)) = (row.f, row.exact_f) {
        point["f"] = json!(f);
        point["formula"]["f"] = json!(exact);
    }
    point
}

//! Many points: operands from CSV, results as CSV.

use std::io;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail, ensure};
use csv::{ReaderBuilder, Trim};
use serde_json::{Map, Value, json};

use super::{formula, operands, outside};
use crate::base::input;
use crate::cli::commands::Loaded;
use crate::cli::{Output, tables};

/// The result of a row.
struct Row {
    operands: Vec<i64>,
    f: Option<i64>,
    outputs: Vec<i64>,
    exact_f: Option<f64>,
    exact: Vec<f64>,
    inside: bool,
}

/// Computes every row of a CSV file with the golden model's arithmetic and in f64. `given` holds for all rows.
pub fn batch(output: Output, one: &Loaded, given: &[Option<i64>], path: &Path) -> Result<bool> {
    let shown = path.display();
    let file = input::open(path).with_context(|| format!("cannot read `{shown}`"))?;
    let text = io::read_to_string(file).with_context(|| format!("cannot read `{shown}`"))?;
    let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(text.as_bytes());
    let headings = reader.headers().with_context(|| format!("cannot read `{shown}`"))?.clone();
    let columns =
        columns(one, given, headings.iter()).with_context(|| format!("`{shown}`, first row"))?;
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.with_context(|| format!("cannot read `{shown}`"))?;
        let row = row(one, given, &columns, &record).map_err(|why| {
            let start = record.position().map_or(0, |it| it.byte() as usize);
            anyhow!("`{shown}`, line {}: {why}", line(&text, start))
        });
        rows.push(row?);
    }
    ensure!(!rows.is_empty(), "`{shown}` has no row of operands below the row with their names");
    if output.json {
        print_json(one, &rows)
    } else {
        print_csv(one, &rows)?
    }
    Ok(true)
}

/// The line of a record that is said to begin here: empty lines before it count as a part of it.
fn line(text: &str, start: usize) -> usize {
    let record = text[start..].trim_start_matches(['\r', '\n']);
    1 + text[..text.len() - record.len()].matches('\n').count()
}

/// The operand of each column.
fn columns<'a>(
    one: &Loaded,
    given: &[Option<i64>],
    headings: impl Iterator<Item = &'a str>,
) -> Result<Vec<usize>> {
    let known = one.core.contract.operands();
    let mut columns: Vec<usize> = Vec::new();
    for heading in headings {
        let at = operands::position(known, heading).map_err(|why| anyhow!("{why}"))?;
        if columns.contains(&at) || given[at].is_some() {
            bail!("operand `{heading}` is given twice");
        }
        columns.push(at);
    }
    Ok(columns)
}

fn row(
    one: &Loaded,
    given: &[Option<i64>],
    columns: &[usize],
    record: &csv::StringRecord,
) -> Result<Row, String> {
    let contract = one.core.contract.as_ref();
    let known = contract.operands();
    let mut given = given.to_vec();
    for (&at, text) in columns.iter().zip(record) {
        // An empty cell leaves the operand to its default.
        if !text.is_empty() {
            given[at] = Some(operands::named_value(&known[at], text)?);
        }
    }
    let raw = operands::completed(contract, &given);
    let f = contract.highlight().map(|it| it.f(&it.point(&raw[..it.control()], 0)));
    let mut outputs = Vec::new();
    contract.results(&raw, 0, &mut outputs);
    let (exact_f, exact) = formula(contract, &raw);
    let inside = outside(known, &raw).is_empty();
    Ok(Row { operands: raw, f, outputs, exact_f, exact, inside })
}

fn print_csv(one: &Loaded, rows: &[Row]) -> Result<()> {
    let contract = one.core.contract.as_ref();
    let mut headings: Vec<String> =
        contract.operands().iter().map(|operand| operand.name.clone()).collect();
    let highlight = contract.highlight();
    let outputs = || contract.outputs().iter().map(|output| &output.name);
    headings.extend(highlight.map(|_| "f".to_owned()));
    headings.extend(outputs().cloned());
    headings.extend(highlight.map(|_| "formula_f".to_owned()));
    headings.extend(outputs().map(|name| format!("formula_{name}")));
    headings.push("inside_the_domain".to_owned());
    let cells = |row: &Row| {
        let operands = contract.operands().iter().zip(&row.operands);
        let mut cells: Vec<String> = operands
            .map(|(operand, &raw)| operand.format.to_f64(i128::from(raw)).to_string())
            .collect();
        let f = highlight.zip(row.f);
        cells.extend(f.map(|(it, f)| it.f_format().to_f64(i128::from(f)).to_string()));
        cells.extend(row.outputs.iter().map(i64::to_string));
        cells.extend(row.exact_f.map(|f| f.to_string()));
        cells.extend(row.exact.iter().map(f64::to_string));
        cells.push(row.inside.to_string());
        cells
    };
    tables::print_csv(std::iter::once(headings).chain(rows.iter().map(cells)))
}

fn print_json(one: &Loaded, rows: &[Row]) {
    let contract = one.core.contract.as_ref();
    let points = rows.iter().map(|row| {
        let operands = contract.operands().iter().zip(&row.operands);
        let operands: Map<String, Value> =
            operands.map(|(operand, raw)| (operand.name.clone(), json!(raw))).collect();
        let outputs = contract.outputs().iter().zip(&row.outputs);
        let outputs: Map<String, Value> =
            outputs.map(|(output, raw)| (output.name.clone(), json!(raw))).collect();
        let mut point = json!({
            "operands": operands,
            "inside_the_domain": row.inside,
            "outputs": outputs,
            "formula": { "outputs": row.exact },
        });
        if let (Some(f), Some(exact)) = (row.f, row.exact_f) {
            point["f"] = json!(f);
            point["formula"]["f"] = json!(exact);
        }
        point
    });
    let points: Vec<Value> = points.collect();
    tables::print_json(&json!({ "config": one.path, "points": points }));
}

//! Many points: operands from CSV, results as CSV.

use std::path::Path;

use anyhow::{Result, anyhow, bail};
use serde_json::{Map, Value, json};

use super::{formula, operands, outside};
use crate::commands::setup::REAL;
use crate::commands::{Loaded, rows};
use crate::{Output, tables};

/// The result of a point.
struct Row {
    operands: Vec<i64>,
    /// Its number in the line, of a device that walks lines.
    point: Option<u64>,
    f: Option<i64>,
    outputs: Vec<i64>,
    exact_f: Option<f64>,
    exact: Vec<f64>,
    inside: bool,
}

/// Computes every row of a CSV file with the golden model's arithmetic and in f64; of a line, every point. `given` holds
/// for all rows.
pub fn batch(output: Output, one: &Loaded, given: &[Option<i64>], path: &Path) -> Result<bool> {
    let rows = rows::read(
        path,
        |headings| columns(one, given, headings.iter()),
        |columns, record| points(one, given, columns, record),
    )?;
    let rows: Vec<Row> = rows.into_iter().flatten().collect();
    if output.json {
        print_json(one, &rows)
    } else {
        print_csv(one, &rows)?
    }
    Ok(true)
}

/// The operand of each column; none of one with the real values that `glint setup` writes beside the operands.
fn columns<'a>(
    one: &Loaded,
    given: &[Option<i64>],
    headings: impl Iterator<Item = &'a str>,
) -> Result<Vec<Option<usize>>> {
    let known = one.core.contract.operands();
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

/// The points of a row: those of a line, or one.
fn points(
    one: &Loaded,
    given: &[Option<i64>],
    columns: &[Option<usize>],
    record: &csv::StringRecord,
) -> Result<Vec<Row>, String> {
    let contract = one.core.contract.as_ref();
    let known = contract.operands();
    let mut given = given.to_vec();
    for (at, text) in columns.iter().zip(record) {
        // An empty cell leaves the operand to its default.
        if let (Some(at), false) = (*at, text.is_empty()) {
            given[at] = Some(operands::named_value(&known[at], text)?);
        }
    }
    let raw = operands::completed(contract, &given);
    let length = known.iter().position(|operand| Some(operand.name.as_str()) == contract.length());
    let last = length.map_or(0, |at| raw[at].max(0) as u64);
    let inside = outside(known, &raw).is_empty();
    let point = |index| {
        let f = contract.highlight().map(|it| it.f(&it.point(&raw[..it.control()], index)));
        let mut outputs = Vec::new();
        contract.results(&raw, index, &mut outputs);
        let (exact_f, exact) = formula(contract, &raw, index);
        let point = length.map(|_| index);
        Row { operands: raw.clone(), point, f, outputs, exact_f, exact, inside }
    };
    Ok((0..=last).map(point).collect())
}

fn print_csv(one: &Loaded, rows: &[Row]) -> Result<()> {
    let contract = one.core.contract.as_ref();
    let mut headings: Vec<String> =
        contract.operands().iter().map(|operand| operand.name.clone()).collect();
    let highlight = contract.highlight();
    let outputs = || contract.outputs().iter().map(|output| &output.name);
    headings.extend(contract.length().map(|_| "point".to_owned()));
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
        cells.extend(row.point.map(|index| index.to_string()));
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
        if let Some(index) = row.point {
            point["point"] = json!(index);
        }
        if let (Some(f), Some(exact)) = (row.f, row.exact_f) {
            point["f"] = json!(f);
            point["formula"]["f"] = json!(exact);
        }
        point
    });
    let points: Vec<Value> = points.collect();
    tables::print_json(&json!({ "config": one.path, "points": points }));
}

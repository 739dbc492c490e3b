//! Samples the errors of the outputs over the operands of a device that is no highlight. The page shows them as curves over the
//! only operand, or as maps over the first two operands.
//!
//! A sample may miss the largest error. Its points are few because the page waits for them: a point of an expression with
//! `atan2` takes a third of a millisecond.

use anyhow::Result;
use serde_json::{Value, json};

use glint_base::fixed::exp2;
use glint_golden::{ANY_VALUE, Contract, Operand, nearer};
use glint_show::evidence::chart::{Chart, ChartAxis, Mark, Series};

use crate::drawn;

/// The number of points of a map along each of its two operands.
const SIDE: i64 = 48;

/// The number of points over the domain of an only operand.
const LINE: i64 = 1024;

/// Each place of a curve shows the largest error of so many neighbouring points.
const NEIGHBOURS: usize = 8;

/// The errors of the outputs at points that are spread evenly over the first operand, or over the first two operands.
struct ErrorSample {
    /// The raw values of the first operand, in ascending order.
    columns: Vec<i64>,
    /// The raw values of the second operand, in ascending order; empty for a device with one operand.
    rows: Vec<i64>,
    /// For each output its errors in units, row by row. An error is `None` where the contract promises nothing.
    errors: Vec<Vec<Option<f64>>>,
}

/// Returns the errors of a contract for the page: for each output the largest error of the sample, and a map; or curves if the
/// device has one operand.
///
/// # Errors
/// Fails if a curve cannot be drawn.
pub fn answer(contract: &dyn Contract) -> Result<Value> {
    let sample = ErrorSample::new(contract);
    let operands = contract.operands();
    let largest: Vec<Option<f64>> = sample.errors.iter().map(|it| largest(it)).collect();
    let mut answer = json!({ "ok": true, "largest": largest, "points": sample.points(), "charts": [], "maps": [] });
    match operands {
        // The charts of a device with one operand and one output are those of `show`.
        [operand] if contract.outputs().len() > 1 => {
            answer["charts"] = json!([drawn(&curves(contract, operand, &sample))?]);
        }
        [_] => {}
        [first, second, others @ ..] => {
            answer["x"] = axis(first, &sample.columns);
            answer["y"] = axis(second, &sample.rows);
            answer["others"] = others.iter().map(middle_json).collect();
            answer["maps"] = maps(contract, &sample);
        }
        [] => {}
    }
    Ok(answer)
}

impl ErrorSample {
    /// Computes the errors at the points. Operands after the second are at the middle of their domains.
    fn new(contract: &dyn Contract) -> Self {
        let mut raw: Vec<i64> = contract.operands().iter().map(middle).collect();
        let (columns, rows) = match contract.operands() {
            [] => (Vec::new(), Vec::new()),
            [only] => (spread(only, LINE), Vec::new()),
            [first, second, ..] => (spread(first, SIDE), spread(second, SIDE)),
        };
        let mut sample = Self { columns, rows, errors: vec![Vec::new(); contract.outputs().len()] };
        for row in 0..sample.rows.len().max(1) {
            for column in 0..sample.columns.len() {
                raw[0] = sample.columns[column];
                if let Some(value) = sample.rows.get(row) {
                    raw[1] = *value;
                }
                sample.add(contract, &raw);
            }
        }
        sample
    }

    /// Appends the error of each output at raw operands.
    fn add(&mut self, contract: &dyn Contract, operands: &[i64]) {
        let (mut raw, mut exact) = (Vec::new(), Vec::new());
        contract.results(operands, 0, &mut raw);
        contract.exact(operands, 0, &mut exact);
        let values = raw.into_iter().zip(exact);
        for ((output, (raw, exact)), errors) in
            contract.outputs().iter().zip(values).zip(&mut self.errors)
        {
            let unit = exp2(-output.format.frac);
            // JSON has no infinity.
            let error = || nearer(raw as f64, exact.map(|it| it / unit)).min(f64::MAX);
            errors.push((exact != ANY_VALUE).then(error));
        }
    }

    /// Returns the number of points.
    fn points(&self) -> usize {
        self.columns.len() * self.rows.len().max(1)
    }
}

/// Returns at most `count` raw values of an operand, spread evenly from one end of its domain to the other. With both ends
/// among them, the values of a wide domain do not all end with zero bits, for which a device may be exact.
fn spread(operand: &Operand, count: i64) -> Vec<i64> {
    let (low, high) = operand.domain;
    let last = i128::from(high) - i128::from(low);
    let steps = last.min(i128::from(count) - 1).max(1);
    let mut values: Vec<i64> = (0..=steps).map(|step| low + (last * step / steps) as i64).collect();
    values.dedup();
    values
}

/// Returns the raw value at the middle of an operand's domain. For example, 0 for −8 to 7.
fn middle(operand: &Operand) -> i64 {
    let (low, high) = operand.domain;
    ((i128::from(low) + i128::from(high)) / 2) as i64
}

/// Returns an operand that is at the middle of its domain, with its value there.
fn middle_json(operand: &Operand) -> Value {
    json!({ "name": operand.name, "value": operand.format.to_f64(middle(operand).into()) })
}

/// Returns an axis of a map: the name of the operand, and its first and last value.
fn axis(operand: &Operand, values: &[i64]) -> Value {
    let value = |raw: Option<&i64>| raw.map(|raw| operand.format.to_f64((*raw).into()));
    let (from, to) = (value(values.first()), value(values.last()));
    json!({ "name": operand.name, "from": from, "to": to, "count": values.len() })
}

/// Returns the largest of some errors, or `None` if nothing is promised at any point.
fn largest(errors: &[Option<f64>]) -> Option<f64> {
    errors.iter().copied().flatten().reduce(f64::max)
}

/// Returns the map of each output: its errors, row by row, with four digits after the point. `null` means that nothing is
/// promised.
fn maps(contract: &dyn Contract, sample: &ErrorSample) -> Value {
    let rounded = |error: &Option<f64>| error.map(|it| (it * 1e4).round() / 1e4);
    let outputs = contract.outputs().iter().zip(&sample.errors);
    let maps = outputs.map(|(output, errors)| {
        let errors: Vec<Option<f64>> = errors.iter().map(rounded).collect();
        json!({ "output": output.name, "errors": errors })
    });
    maps.collect()
}

/// Returns the chart with the error of each output over the only operand, and with the bounds as lines across.
fn curves(contract: &dyn Contract, operand: &Operand, sample: &ErrorSample) -> Chart {
    let value = |raw: &i64| operand.format.to_f64((*raw).into());
    let places: Vec<f64> = sample.columns.chunks(NEIGHBOURS).map(|raw| value(&raw[0])).collect();
    let mut series = Vec::new();
    let mut top: f64 = 0.0;
    for (output, errors) in contract.outputs().iter().zip(&sample.errors) {
        let neighbours = errors.chunks(NEIGHBOURS);
        let values: Vec<f64> =
            neighbours.map(|errors| largest(errors).unwrap_or(f64::NAN)).collect();
        top = values.iter().copied().fold(top, f64::max);
        series.push(Series { name: output.name.clone(), values });
    }
    let mut marks = Vec::new();
    for bound in contract.bounds().outputs {
        if bound.is_stated() {
            top = top.max(bound.units);
            marks.push(Mark { label: format!("the bound of {}", bound.output), at: bound.units });
        }
    }
    let (first, last) = (sample.columns.first(), sample.columns.last());
    let ends = (first.map_or(0.0, value), last.map_or(1.0, value));
    let caption = format!(
        "The largest error of each output at {NEIGHBOURS} neighbouring operands, against the formula in f64. The {} operands \
         are a sample. The lines across are the bounds of the outputs.",
        sample.points()
    );
    Chart {
        id: "errors".to_owned(),
        title: "The error of each output against the operand".to_owned(),
        caption,
        x: ChartAxis::linear(&operand.name, ends.0, ends.1),
        y: ChartAxis::linear("error in units of the last place", 0.0, top.max(1e-9) * 1.1),
        places,
        series,
        marks,
    }
}

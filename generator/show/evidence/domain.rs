//! Makes the charts of a device that computes a function of one operand, such as a square root: the function and its error
//! over the domain.
//!
//! For a large domain, the charts show a sample of the operands, so they may miss the largest error.

use super::chart::{Chart, ChartAxis, Mark, Series};
use glint_golden::Contract;

/// The largest number of positions. A small domain has one position for each value.
const PLACES: i64 = 160;

/// The approximate number of operands that are tried for each position. The chart shows their largest error.
const OPERANDS: i64 = 256;

/// Returns the charts of a device with one operand and one output: the function and its error over the domain. Returns no
/// charts for a highlight, or if the operand sets the number of results of a computation.
pub fn charts(contract: &dyn Contract) -> Vec<Chart> {
    let ([operand], [output]) = (contract.operands(), contract.outputs()) else {
        return Vec::new();
    };
    if contract.highlight().is_some() || contract.length().is_some() {
        return Vec::new();
    }
    let (low, high) = operand.domain;
    let count = high - low + 1;
    let places = PLACES.min(count);
    let first =
        |place: i64| low + (i128::from(count) * i128::from(place) / i128::from(places)) as i64;
    let (mut at, mut values, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    let mut all = true;
    for place in 0..places {
        let (from, to) = (first(place), first(place + 1));
        let step = ((to - from) / OPERANDS).max(1);
        all &= step == 1;
        let mut raw = Vec::new();
        contract.results(&[from], 0, &mut raw);
        at.push(operand.format.to_f64(from.into()));
        values.extend(raw.first().map(|&raw| output.format.to_f64(raw.into())));
        let worst = (from..to).step_by(step as usize).map(|raw| contract.largest_error(&[raw]));
        errors.push(worst.fold(0.0, f64::max));
    }
    let bounds = contract.bounds();
    let bound = bounds.governing();
    let top = errors.iter().copied().filter(|it| it.is_finite()).fold(bound.units, f64::max) * 1.1;
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let margin = (most - least).max(1e-9) * 0.05;
    let x = || ChartAxis::linear(&operand.name, at[0], operand.format.to_f64(high.into()));
    let chart = |id: &str, title: &str, caption: String, y, values: &[f64]| Chart {
        id: id.to_owned(),
        title: title.to_owned(),
        caption,
        x: x(),
        y,
        places: at.clone(),
        series: vec![Series { name: output.name.clone(), values: values.to_vec() }],
        marks: Vec::new(),
    };
    let looked_at = if all { "every operand" } else { "operands taken evenly, a sample" };
    let function = chart(
        "function",
        "The result against the operand",
        format!("What `{}` is at {places} operands of the domain.", output.name),
        ChartAxis::linear(&output.name, least - margin, most + margin),
        &values,
    );
    let error = chart(
        "error",
        "The error against the operand",
        format!(
            "The largest error against the formula in f64 about each of {places} places, of {looked_at}. The line across is the \
             bound that is stated."
        ),
        ChartAxis::linear("error in units of the last place", 0.0, top),
        &errors,
    );
    let mark = Mark { label: "the bound".to_owned(), at: bound.units };
    let marks = bound.is_stated().then_some(mark).into_iter().collect();
    vec![function, Chart { marks, ..error }]
}

//! Makes a page's figures from charts: the plot, its legend, and a table of some of its values.

use anyhow::Result;
use rayon::prelude::*;

use super::plots;
use crate::evidence::chart::{AxisScale, Chart};

/// The number of rows of the table beside a plot.
const ROWS: usize = 11;

pub struct Figure<'a> {
    pub chart: &'a Chart,
    /// The source document's figure that this one reproduces; empty for a figure of Glint's own.
    pub source: &'a str,
    pub svg: String,
    /// The class and each curve's name.
    pub legend: Vec<(String, &'a str)>,
    /// Some values for the table: a position on the horizontal axis, and each curve's value.
    pub rows: Vec<(String, Vec<String>)>,
}

/// Makes the figures. `charts` has each chart with the text for [`Figure::source`], which may be empty.
///
/// # Errors
///
/// Fails if a chart cannot be plotted.
pub fn figures<'a>(charts: &[(&'a Chart, &'a str)]) -> Result<Vec<Figure<'a>>> {
    charts.par_iter().map(|(chart, source)| figure(chart, source)).collect()
}

fn figure<'a>(chart: &'a Chart, source: &'a str) -> Result<Figure<'a>> {
    let marks = chart.marks.iter().map(|mark| ("mark".to_owned(), mark.label.as_str()));
    let legend = chart
        .series
        .iter()
        .enumerate()
        .map(|(at, series)| (plots::class(at), series.name.as_str()))
        .chain(marks)
        .collect();
    let rows = chart
        .rows(ROWS)
        .into_iter()
        .map(|at| {
            let values = chart.series.iter();
            let values = values.map(|series| cell(series.values[at], chart.y.scale));
            (number(chart.places[at]), values.collect())
        })
        .collect();
    Ok(Figure { chart, source, svg: plots::svg(chart)?, legend, rows })
}

/// Writes a value for the table. A logarithmic axis has scientific notation, a linear axis four digits after the point. NaN
/// becomes a dash.
fn cell(value: f64, scale: AxisScale) -> String {
    match scale {
        _ if value.is_nan() => "\u{2013}".to_owned(),
        AxisScale::Logarithmic => scientific(value),
        AxisScale::Linear => format!("{value:.4}").replace('-', "\u{2212}"),
    }
}

/// Writes a value with one digit after the point and an exponent. For example, 0.00123 is `1.2e−3`, and 0 is `0`.
pub fn scientific(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        _ => format!("{value:.1e}").replace('-', "\u{2212}"),
    }
}

/// Writes a value with at most three digits after the point. For example, 2.5 is `2.5`, and 0.12345 is `0.123`.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

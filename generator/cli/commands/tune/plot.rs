//! Plots the area of the configurations that `glint tune` found over their errors, as SVG.

use anyhow::{Result, bail};

use super::Arguments;
use crate::commands::plot_file::svg_file;
use glint_prove::tune::{Answer, Candidate, ErrorUnit};
use glint_show::evidence::chart::{Chart, ChartAxis, Series};

/// Returns the plot as SVG that needs no other file.
///
/// # Errors
///
/// Fails if the Pareto front has fewer than two configurations or an error of 0, because these give no line.
pub fn plot(answer: &Answer, arguments: &Arguments) -> Result<String> {
    let is_best = |candidate: &&Candidate| candidate.config == answer.best.config;
    let (Some(first), Some(last)) = (answer.front.first(), answer.front.last()) else {
        bail!("there is no front to plot");
    };
    let (low, high) = (arguments.unit.of(&first.bounds), arguments.unit.of(&last.bounds));
    if answer.front.len() < 2 || low <= 0.0 || low >= high {
        bail!("one configuration is best in both error and area, so there is no line to plot");
    }
    let unit = match arguments.unit {
        ErrorUnit::F => "error of f",
        ErrorUnit::Output => "error in output units",
    };
    // If a configuration on the front does not fit the chip, the answer may not lie on the front.
    let mut front: Vec<&Candidate> = answer.front.iter().collect();
    if !front.iter().any(is_best) {
        front.push(&answer.best);
    }
    front.sort_by(|one, other| {
        arguments.unit.of(&one.bounds).total_cmp(&arguments.unit.of(&other.bounds))
    });
    let on_front = |it: &Candidate| answer.front.iter().any(|other| other.config == it.config);
    let area = |shown: &dyn Fn(&Candidate) -> bool| -> Vec<f64> {
        let area =
            |it: &&Candidate| if shown(it) { it.cost.area(arguments.target) } else { f64::NAN };
        front.iter().map(area).collect()
    };
    let (values, chosen) = (area(&on_front), area(&|it| is_best(&it)));
    let chart = Chart {
        id: "front".to_owned(),
        title: format!("{}: area over the bound of the error", arguments.device),
        caption: "Each corner is a configuration; no other configuration that was tried is better in both \
                  error and area."
            .to_owned(),
        x: ChartAxis::logarithmic(unit, low * 0.95, high * 1.05),
        y: ChartAxis::linear(
            &format!(
                "{}: look-up tables of {}, including blocks",
                arguments.device,
                arguments.target.title()
            ),
            0.0,
            values.iter().chain(&chosen).copied().fold(0.0, f64::max) * 1.1,
        ),
        places: front.iter().map(|candidate| arguments.unit.of(&candidate.bounds)).collect(),
        series: vec![
            Series { name: "front".to_owned(), values },
            Series { name: "the answer".to_owned(), values: chosen },
        ],
        marks: Vec::new(),
    };
    svg_file(&chart)
}

//! Plots the area of the configurations that `glint tune` found over their errors, as SVG.

use anyhow::{Result, bail};

use super::Arguments;
use glint_prove::tune::{Answer, Candidate, ErrorUnit};
use glint_show::evidence::chart::{Chart, ChartAxis, Series};
use glint_show::pages::plots;

/// The rules that a page's style sheet has elsewhere.
const STYLE: &str = "<style>svg{background:#fcfcfb}text{fill:#1c1d1f;font-family:sans-serif}.ink{stroke:#5b5f66}text.ink{stroke:#fcfcfb;stroke-width:16;paint-order:stroke}\
                     .grid{stroke:#e6e8ea;stroke-width:4}.s1{stroke:#1b4fa8;stroke-width:8;stroke-linejoin:round}circle.s2{fill:#b3410b}\
                     @media(prefers-color-scheme:dark){svg{background:#16181b}text{fill:#e6e8ea}.ink{stroke:#9aa0a8}text.ink{stroke:#16181b}\
                     .grid{stroke:#2c3036}.s1{stroke:#6aaeff}circle.s2{fill:#ff9d66}}</style>";

/// Room for the heading above the plot.
const HEADING: u32 = 110;

/// Returns the plot as an SVG file that needs no other file.
///
/// # Errors
/// Fails if the search found fewer than two configurations on the Pareto front, since they give no line.
pub fn plot(answer: &Answer, arguments: &Arguments) -> Result<String> {
    let is_best = |candidate: &&Candidate| candidate.config == answer.best.config;
    let (Some(first), Some(last)) = (answer.front.first(), answer.front.last()) else {
        bail!("there is no front to plot");
    };
    let (low, high) = (arguments.unit.of(&first.bound), arguments.unit.of(&last.bound));
    if answer.front.len() < 2 || low <= 0.0 || low >= high {
        bail!("the front is a single configuration, and no line to plot");
    }
    let unit = match arguments.unit {
        ErrorUnit::F => "error of f",
        ErrorUnit::Output => "error in output units",
    };
    // Where something on the front does not fit the chip, the answer may lie behind it.
    let mut front: Vec<&Candidate> = answer.front.iter().collect();
    if !front.iter().any(is_best) {
        front.push(&answer.best);
    }
    front.sort_by(|one, other| {
        arguments.unit.of(&one.bound).total_cmp(&arguments.unit.of(&other.bound))
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
        caption: "Each corner is a configuration that none of those looked at betters in both."
            .to_owned(),
        x: ChartAxis::logarithmic(unit, low * 0.95, high * 1.05),
        y: ChartAxis::linear(
            &format!(
                "{}: look-up tables of {}, blocks counted in",
                arguments.device,
                arguments.target.title()
            ),
            0.0,
            values.iter().chain(&chosen).copied().fold(0.0, f64::max) * 1.1,
        ),
        places: front.iter().map(|candidate| arguments.unit.of(&candidate.bound)).collect(),
        series: vec![
            Series { name: "front".to_owned(), values },
            Series { name: "the answer".to_owned(), values: chosen },
        ],
        marks: Vec::new(),
    };
    let svg = plots::svg(&chart)?;
    let (start, rest) = svg.split_once('>').unwrap_or((&svg, ""));
    let start = start.replace("<svg ", "<svg xmlns=\"http://www.w3.org/2000/svg\" ");
    // The page of a report has title and axis beside the plot; this file has them in the plot.
    let (width, height) = (plots::WIDTH, plots::HEIGHT);
    let start = start.replace(
        &format!("viewBox=\"0 0 {width} {height}\""),
        &format!("viewBox=\"0 -{HEADING} {width} {}\"", height + HEADING),
    );
    let shown = format!("<text x=\"40\" y=\"-36\" font-size=\"52\">{}</text>", chart.y.label);
    let about = format!(
        "<title id=\"front-title\">{}</title><desc id=\"front-caption\">{}</desc>",
        chart.title, chart.caption
    );
    Ok(format!("{start}>{about}{STYLE}{shown}{rest}\n"))
}

//! The front as a picture: area over error.

use anyhow::{Result, bail};

use super::Arguments;
use crate::evidence::chart::{Chart, ChartAxis, Series};
use crate::pages::plots;
use crate::tune::{Answer, ErrorUnit};

/// What the page's style sheet says elsewhere.
const STYLE: &str = "<style>svg{background:#fcfcfb}text{fill:#1c1d1f;font-family:sans-serif}.ink{stroke:#5b5f66}text.ink{stroke:none}\
                     .grid{stroke:#e6e8ea;stroke-width:4}\
                     .s1{stroke:#1b4fa8;stroke-width:8;stroke-linejoin:round}</style>";

/// An SVG that stands by itself.
///
/// # Errors
/// A front of one configuration, which is no line.
pub fn plot(answer: &Answer, arguments: &Arguments) -> Result<String> {
    let area = |at: usize| answer.front[at].cost.area(arguments.target);
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
    let values: Vec<f64> = (0..answer.front.len()).map(area).collect();
    let chart = Chart {
        id: "front".to_owned(),
        title: format!("{}: area over proved error", arguments.device),
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
            values.iter().copied().fold(0.0, f64::max) * 1.1,
        ),
        places: answer.front.iter().map(|candidate| arguments.unit.of(&candidate.bound)).collect(),
        series: vec![Series { name: "front".to_owned(), values }],
        marks: Vec::new(),
    };
    let svg = plots::svg(&chart)?;
    let (start, rest) = svg.split_once('>').unwrap_or((&svg, ""));
    let start = start.replace("<svg ", "<svg xmlns=\"http://www.w3.org/2000/svg\" ");
    // On the page of a report, title and axis stand beside the plot.
    let shown = format!(
        "<text x=\"1840\" y=\"90\" font-size=\"52\" text-anchor=\"end\">{}</text>",
        chart.y.label
    );
    let about = format!(
        "<title id=\"front-title\">{}</title><desc id=\"front-caption\">{}</desc>",
        chart.title, chart.caption
    );
    Ok(format!("{start}>{about}{STYLE}{shown}{rest}\n"))
}

//! Makes a plot as an SVG file that needs no other file. The style sheet, the title and the label of the axis are inside.

use anyhow::Result;

use glint_show::evidence::chart::Chart;
use glint_show::pages::plots;

/// The style sheet of the file. In a page, the style sheet of the page has these rules.
const STYLE: &str = "<style>svg{background:#fcfcfb}text{fill:#1c1d1f;font-family:sans-serif}.ink{stroke:#5b5f66}text.ink{stroke:#fcfcfb;stroke-width:16;paint-order:stroke}\
                     .grid{stroke:#e6e8ea;stroke-width:4}.s1{stroke:#1b4fa8;stroke-width:8;stroke-linejoin:round}circle.s2{fill:#b3410b}\
                     @media(prefers-color-scheme:dark){svg{background:#16181b}text{fill:#e6e8ea}.ink{stroke:#9aa0a8}text.ink{stroke:#16181b}\
                     .grid{stroke:#2c3036}.s1{stroke:#6aaeff}circle.s2{fill:#ff9d66}}</style>";

/// The height of the heading above the plot, in units of the drawing.
const HEADING: u32 = 110;

/// Plots `chart` as a file of its own, with title and axis label inside. In a page, both are next to the plot.
///
/// # Errors
///
/// Fails if the plotting library fails.
pub fn svg_file(chart: &Chart) -> Result<String> {
    let svg = plots::svg(chart)?;
    let (start, rest) = svg.split_once('>').unwrap_or((&svg, ""));
    let start = start.replace("<svg ", "<svg xmlns=\"http://www.w3.org/2000/svg\" ");
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

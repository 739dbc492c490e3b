//! Plots charts as SVG inside a page. The style sheet of the page decides the colours.

use anyhow::{Result, anyhow};
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::evidence::chart::{AxisScale, Chart, ChartAxis};

/// The number of curves that the style sheet can distinguish, by colour and by dashes.
pub const STYLES: usize = 10;

/// The number of the plotting library's units in a unit of the page at full size. The library rounds positions to whole units,
/// so finer units make smoother curves.
const FINE: u32 = 4;

/// A plot's width, in units of the plotting library.
pub const WIDTH: u32 = 480 * FINE;
/// A plot's height, in units of the plotting library.
pub const HEIGHT: u32 = 300 * FINE;

/// Placeholder colours for lines and text; [`themed`] replaces them by classes.
const INK: RGBColor = RGBColor(1, 0, 0);
const GRID: RGBColor = RGBColor(2, 0, 0);
const MARK: RGBColor = RGBColor(3, 0, 0);

/// Returns a placeholder colour, which [`themed`] replaces by the class from [`class`].
fn style(at: usize) -> RGBColor {
    RGBColor(4, 0, (at % STYLES) as u8)
}

/// Returns the class of curve number `at`. Curves 0 and 10 have the class `s1`.
pub fn class(at: usize) -> String {
    format!("s{}", at % STYLES + 1)
}

/// Plots a chart as an `svg` element that scales to the available width. Its colours come from the classes `ink`, `grid` and
/// `mark`, and from [`class`].
///
/// # Errors
///
/// Fails if the plotting library fails, for example because a range is empty.
pub fn svg(chart: &Chart) -> Result<String> {
    let mut text = String::new();
    draw(chart, &mut text).map_err(|error| anyhow!("cannot plot `{}`: {error}", chart.id))?;
    Ok(themed(&text, chart))
}

/// An axis in the form that the plotting library takes.
struct AxisPlaces {
    range: std::ops::Range<f64>,
    ticks: Vec<f64>,
}

impl AxisPlaces {
    fn new(axis: &ChartAxis) -> Result<Self> {
        let (Some(from), Some(to)) = (axis.place(axis.range.0), axis.place(axis.range.1)) else {
            return Err(anyhow!("an end of the axis `{}` has no position on the axis", axis.label));
        };
        let mut places = Vec::new();
        for tick in ticks(axis) {
            places.extend(axis.place(tick));
        }
        Ok(Self { range: from..to, ticks: places })
    }
}

impl Ranged for AxisPlaces {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (value - self.range.start) / (self.range.end - self.range.start);
        limit.0 + (f64::from(limit.1 - limit.0) * share).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.clone() }
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.range.clone()
    }
}

fn draw(chart: &Chart, text: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(text, (WIDTH, HEIGHT)).into_drawing_area();
    let mut plane = ChartBuilder::on(&area)
        .margin_top(8 * FINE)
        .margin_right(16 * FINE)
        .margin_bottom(4 * FINE)
        .x_label_area_size(44 * FINE)
        .y_label_area_size(58 * FINE)
        .build_cartesian_2d(AxisPlaces::new(&chart.x)?, AxisPlaces::new(&chart.y)?)?;
    // The library's font sizes are a quarter larger than the sizes in SVG.
    let font = ("sans-serif", 16 * FINE).into_font().color(&INK);
    plane
        .configure_mesh()
        .axis_style(INK)
        .bold_line_style(GRID)
        .light_line_style(GRID.mix(0.0))
        .set_all_tick_mark_size(5 * FINE)
        .x_desc(chart.x.label.as_str())
        .label_style(font.clone())
        .axis_desc_style(font.clone())
        .x_label_formatter(&|place| tick_label(&chart.x, *place))
        .y_label_formatter(&|place| tick_label(&chart.y, *place))
        .draw()?;
    let (low, high) = chart.x.range;
    for mark in &chart.marks {
        let line = [low, high].map(|x| Some((chart.x.place(x)?, chart.y.place(mark.at)?)));
        plane.draw_series(LineSeries::new(line.into_iter().flatten(), MARK))?;
    }
    for (at, series) in chart.series.iter().enumerate() {
        let style = style(at).stroke_width(2);
        for run in runs(chart, &series.values) {
            plane.draw_series(LineSeries::new(run, style))?;
        }
    }
    // A series with only one value is drawn as a point with its name beside it.
    for (at, (x, y), left) in points(chart) {
        plane.draw_series([Circle::new((x, y), 4 * FINE, style(at).filled())])?;
        let (side, end) = if left { (-8, HPos::Right) } else { (8, HPos::Left) };
        let away = side * FINE as i32;
        let text_style = font.clone().pos(Pos::new(end, VPos::Center));
        let name = Text::new(chart.series[at].name.clone(), (away, 0), text_style);
        plane.draw_series([EmptyElement::at((x, y)) + name])?;
    }
    area.present()?;
    Ok(())
}

/// Returns a position's label. For example, the position 2 of a logarithmic axis has the label `100`.
fn tick_label(axis: &ChartAxis, place: f64) -> String {
    match axis.scale {
        AxisScale::Linear => number(place),
        AxisScale::Logarithmic => number(libm::pow(10.0, place)),
    }
}

/// Returns the position of a series with only one value, and `None` for any other series.
fn only_place(chart: &Chart, values: &[f64]) -> Option<(f64, f64)> {
    let mut known = chart.places.iter().zip(values).filter(|(_, value)| value.is_finite());
    let (x, y) = known.next()?;
    let place = (chart.x.place(*x)?, chart.y.place(*y)?);
    match known.next() {
        None => Some(place),
        Some(_) => None,
    }
}

fn ends(axis: &ChartAxis) -> Option<(f64, f64)> {
    Some((axis.place(axis.range.0)?, axis.place(axis.range.1)?))
}

/// Returns the index of each series with only one value, its position, and whether its name is left of the point.
fn points(chart: &Chart) -> Vec<(usize, (f64, f64), bool)> {
    let mut places: Vec<(usize, (f64, f64))> = Vec::new();
    for (at, series) in chart.series.iter().enumerate() {
        if let Some(place) = only_place(chart, &series.values) {
            places.push((at, place));
        }
    }
    places.sort_by(|(_, (_, one)), (_, (_, other))| other.total_cmp(one));
    let (Some((left, right)), Some((low, high))) = (ends(&chart.x), ends(&chart.y)) else {
        return Vec::new();
    };
    let mut points: Vec<(usize, (f64, f64), bool)> = Vec::new();
    for (at, (x, y)) in places {
        let roomier = x > (left + right) / 2.0;
        let in_the_way = match points.last() {
            Some((_, (_, above), taken)) => above - y < (high - low) / 20.0 && *taken == roomier,
            None => false,
        };
        points.push((at, (x, y), roomier != in_the_way));
    }
    points
}

/// Returns the connected parts of a curve inside the range of the vertical axis, as positions. A line that leaves the range is
/// cut at the range's end. The parts leave out a line between two points outside the range, and a point without neighbours in the
/// range.
fn runs(chart: &Chart, values: &[f64]) -> Vec<Vec<(f64, f64)>> {
    let low = chart.y.place(chart.y.range.0).unwrap_or(f64::NEG_INFINITY);
    let high = chart.y.place(chart.y.range.1).unwrap_or(f64::INFINITY);
    let inside = |y: f64| (low..=high).contains(&y);
    let points: Vec<Option<(f64, f64)>> = chart
        .places
        .iter()
        .zip(values)
        .map(|(x, y)| Some((chart.x.place(*x)?, chart.y.place(*y)?)))
        .collect();
    let mut runs = vec![Vec::new()];
    let mut previous: Option<(f64, f64)> = None;
    for point in points {
        let Some((x, y)) = point else {
            runs.push(Vec::new());
            previous = None;
            continue;
        };
        if let Some((before, from)) = previous
            && inside(from) != inside(y)
        {
            let border = if from.max(y) > high { high } else { low };
            let crossing = before + (x - before) * (border - from) / (y - from);
            if let Some(run) = runs.last_mut() {
                run.push((crossing, border));
            }
            if inside(from) {
                runs.push(Vec::new());
            }
        }
        if inside(y)
            && let Some(run) = runs.last_mut()
        {
            run.push((x, y));
        }
        previous = Some((x, y));
    }
    runs.retain(|run| run.len() > 1);
    runs
}

/// Returns the round values within the range of an axis, in order. For example, a linear axis from 0 to 6 has 0, 2, 4 and 6.
/// A logarithmic axis from 2 to 60 has 2, 5, 10, 20 and 50.
fn ticks(axis: &ChartAxis) -> Vec<f64> {
    let (low, high) = axis.range;
    match axis.scale {
        AxisScale::Linear => {
            let coarse = (high - low) / 5.0;
            let decade = libm::pow(10.0, libm::floor(libm::log10(coarse)));
            let step = [1.0, 2.0, 2.5, 5.0, 10.0]
                .into_iter()
                .map(|factor| factor * decade)
                .find(|step| *step >= coarse * 0.999)
                .unwrap_or(coarse);
            let (first, last) = (libm::ceil(low / step), libm::floor(high / step + 1e-9));
            (0..=(last - first) as u32).map(|at| (first + f64::from(at)) * step).collect()
        }
        AxisScale::Logarithmic => {
            let (first, last) = (libm::log10(low), libm::log10(high));
            // An axis of less than three decades has room for steps between the powers of ten.
            let steps: &[f64] = if last - first < 3.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
            let (first, last) = (libm::floor(first) as i32, libm::ceil(last) as i32);
            (first..=last)
                .flat_map(|decade| {
                    let decade = libm::pow(10.0, f64::from(decade));
                    steps.iter().map(move |step| step * decade)
                })
                .filter(|tick| (low * 0.999..=high * 1.001).contains(tick))
                .collect()
        }
    }
}

/// Writes a value with at most six digits after the point, without trailing zeros. A number nearer to 0 than 0.001 has at most
/// two digits and an exponent. For example, `0.5`, or `1.5e−4`.
fn number(value: f64) -> String {
    if value != 0.0 && value.abs() < 0.001 {
        return format!("{value:.1e}").replace(".0e", "e").replace("e-", "e\u{2212}");
    }
    let text = format!("{value:.6}");
    let shortest = text.trim_end_matches('0').trim_end_matches('.');
    if shortest == "-0" { "0" } else { shortest }.replace('-', "\u{2212}")
}

/// Returns a colour in the notation of the library's SVG. For example, [`INK`] is `#010000`.
fn hex(RGBColor(r, g, b): RGBColor) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}

/// Replaces placeholder colours by classes, and adds the attributes that make the element an image to a screen reader.
fn themed(text: &str, chart: &Chart) -> String {
    let mut roles = vec![
        (hex(INK), "ink".to_owned()),
        (hex(GRID), "grid".to_owned()),
        (hex(MARK), "mark".to_owned()),
    ];
    roles.extend((0..STYLES).map(|at| (hex(style(at)), class(at))));
    let mut themed = text.to_owned();
    for (colour, class) in roles {
        for property in ["fill", "stroke"] {
            themed =
                themed.replace(&format!("{property}=\"{colour}\""), &format!("class=\"{class}\""));
        }
    }
    let body = match themed.split_once('>') {
        Some((_, body)) => body,
        None => "",
    };
    format!(
        "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-labelledby=\"{id}-title\" aria-describedby=\"{id}-caption\">{body}",
        id = chart.id,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::chart::{Mark, Series};

    fn chart() -> Chart {
        Chart {
            id: "parabola".to_owned(),
            title: "A parabola".to_owned(),
            caption: "It rises.".to_owned(),
            x: ChartAxis::linear("x", 0.0, 4.0),
            y: ChartAxis::linear("y", 0.0, 4.0),
            places: vec![0.0, 1.0, 2.0, 3.0, 4.0],
            series: vec![Series {
                name: "x squared".to_owned(),
                values: vec![0.0, 1.0, f64::NAN, 3.0, 5.0],
            }],
            marks: vec![Mark { label: "two".to_owned(), at: 2.0 }],
        }
    }

    #[test]
    fn colours_are_classes() {
        let svg = svg(&chart()).expect("it plots");
        for class in ["ink", "grid", "mark", "s1"] {
            assert!(svg.contains(&format!("class=\"{class}\"")), "{class}: {svg}");
        }
        assert!(!svg.contains("=\"#"), "{svg}");
        assert!(!svg.contains("http"), "{svg}");
        assert_eq!(svg.matches("<svg").count(), 1);
    }

    #[test]
    fn lines_end_where_the_range_does() {
        let chart = chart();
        let found = runs(&chart, &chart.series[0].values);
        // 5 is outside the range. The line from (3, 3) to (4, 5) leaves the range half way, at (3.5, 4).
        assert_eq!(found, [vec![(0.0, 0.0), (1.0, 1.0)], vec![(3.0, 3.0), (3.5, 4.0)]]);
        let found = runs(&chart, &[6.0, 2.0, 2.0, 6.0, 6.0]);
        assert_eq!(found, [vec![(0.5, 4.0), (1.0, 2.0), (2.0, 2.0), (2.5, 4.0)]]);
    }

    #[test]
    fn names_of_neighbours_stand_on_different_sides() {
        let places = vec![1.0, 3.0, 3.5];
        let alone = |name: &str, at: usize, value| {
            let mut values = vec![f64::NAN; 3];
            values[at] = value;
            Series { name: name.to_owned(), values }
        };
        let series = vec![alone("a", 0, 2.0), alone("b", 1, 1.1), alone("c", 2, 1.0)];
        let sides = points(&Chart { places, series, ..chart() });
        assert_eq!(sides, [(0, (1.0, 2.0), false), (1, (3.0, 1.1), true), (2, (3.5, 1.0), false)]);
    }

    #[test]
    fn round_ticks() {
        let linear = |low, high| ticks(&ChartAxis::linear("", low, high));
        assert_eq!(linear(0.0, 1.0).len(), 6);
        assert_eq!(linear(0.0, 10.0), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(linear(-4.0, 4.0), [-4.0, -2.0, 0.0, 2.0, 4.0]);
        let logarithmic = ticks(&ChartAxis::logarithmic("", 0.05, 1000.0));
        let labels: Vec<String> = logarithmic.into_iter().map(number).collect();
        assert_eq!(labels, ["0.1", "1", "10", "100", "1000"]);
        assert_eq!(ticks(&ChartAxis::logarithmic("", 2.0, 60.0)), [2.0, 5.0, 10.0, 20.0, 50.0]);
        let labels = [-0.5, 1e-5, 0.00015].map(number);
        assert_eq!(labels, ["\u{2212}0.5", "1e\u{2212}5", "1.5e\u{2212}4"]);
    }
}

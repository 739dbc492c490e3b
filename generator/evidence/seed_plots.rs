//! The plots and tables that the captions of the seeds' figures describe, made anew.

use serde::Serialize;

use super::chart::{Chart, ChartAxis, Mark, Series, even, exponents};
use super::claims::{percent, quad, schlick, stretched, w};
use super::measure::{self, Function, Region};
use crate::golden::formulas;

/// The largest exponent of the patent.
pub const LARGEST: u32 = 1000;

/// The largest power that the k table tries.
const LARGEST_POWER: u32 = 64;

/// A plot or a table of a seed, and what its caption is there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SeedPlot {
    /// `seed 000, Fig. 5`.
    pub figure: &'static str,
    /// Ours.
    pub chart: Chart,
}

/// One line of the patent's table 1 (Fig. 8): which powers a required accuracy needs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RequiredPowers {
    /// The required relative error to the inflection point.
    pub error: f64,
    /// The smallest power for each run of exponents.
    pub powers: Vec<PowerRun>,
}

/// Exponents that one power serves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PowerRun {
    /// The first exponent.
    pub first: u32,
    /// The last.
    pub last: u32,
    /// k.
    pub power: u32,
}

/// One word of ROM 9 (Fig. 14).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rom9Word {
    /// The address.
    pub n: u32,
    /// The power that decoder 10 chooses.
    pub k: u32,
    /// `√(n/k)`.
    pub root: f64,
}

const GAMMA: &str = "\u{3b3}, degrees";
const EXPONENT: &str = "n";
const VALUE: &str = "value";
const ERROR: &str = "largest relative error, %";

fn blinn(gamma: f64, n: f64) -> f64 {
    formulas::blinn(libm::cos(gamma), n)
}

/// Functions of the angle at one exponent.
fn over_angle(
    figure: &'static str,
    id: &str,
    title: &str,
    caption: &str,
    n: f64,
    degrees: f64,
    functions: &[(&str, Function)],
) -> SeedPlot {
    let places = even(0.0, degrees, 120);
    let series = functions
        .iter()
        .map(|(name, function)| Series {
            name: (*name).to_owned(),
            values: places.iter().map(|degrees| function(degrees.to_radians(), n)).collect(),
        })
        .collect();
    let chart = Chart {
        id: id.to_owned(),
        title: title.to_owned(),
        caption: caption.to_owned(),
        x: ChartAxis::linear(GAMMA, 0.0, degrees),
        y: ChartAxis::linear(VALUE, 0.0, 1.0),
        places,
        series,
        marks: Vec::new(),
    };
    SeedPlot { figure, chart }
}

/// The height of `cosⁿγ` at its inflection point.
fn inflection_mark(n: f64) -> Mark {
    let edge = Region::Inflection.edge(n).unwrap_or(0.0);
    Mark {
        label: format!("height of the inflection point of cos\u{207f}\u{3b3}, n = {n}"),
        at: blinn(edge, n),
    }
}

/// Largest relative errors against n.
fn over_exponents(
    figure: &'static str,
    id: &str,
    title: &str,
    caption: &str,
    axes: (ChartAxis, ChartAxis),
    series: &[(&str, Function, Region)],
) -> SeedPlot {
    let low = libm::round(axes.0.range.0) as u32;
    let high = libm::round(axes.0.range.1) as u32;
    let places = exponents(low, high, 24);
    let series: Vec<Series> = series
        .iter()
        .map(|(name, function, region)| Series {
            name: (*name).to_owned(),
            values: places
                .iter()
                .map(|&n| {
                    measure::at(*function, n, *region).map_or(f64::NAN, |worst| 100.0 * worst.error)
                })
                .collect(),
        })
        .collect();
    let chart = Chart {
        id: id.to_owned(),
        title: title.to_owned(),
        caption: format!("{caption} {}", largest(&series, &places)),
        x: axes.0,
        y: axes.1,
        places: places.into_iter().map(f64::from).collect(),
        series,
        marks: Vec::new(),
    };
    SeedPlot { figure, chart }
}

/// "The largest are ...": of each series its largest value, per cent, and where that is.
fn largest(series: &[Series], places: &[u32]) -> String {
    let of = |series: &Series| {
        let pairs = series.values.iter().zip(places);
        let (value, n) = pairs.max_by(|a, b| a.0.total_cmp(b.0))?;
        Some(format!("{}: {} at n = {n}", series.name, percent(value / 100.0)))
    };
    let all: Vec<String> = series.iter().filter_map(of).collect();
    format!("The largest: {}.", all.join("; "))
}

/// All plots, in the order of the seeds.
pub fn plots() -> Vec<SeedPlot> {
    let mut plots = patent();
    plots.extend(paper());
    plots
}

fn patent() -> Vec<SeedPlot> {
    let exponents = || ChartAxis::logarithmic(EXPONENT, 2.0, f64::from(LARGEST));
    let mut zones = over_angle(
        "seed 000, Fig. 7",
        "zones",
        "The zones of a highlight",
        "cos\u{207f}\u{3b3} for n = 35. Above the inflection point is the epicentre, where errors are seen; below it the \
         highlight fades.",
        35.0,
        30.0,
        &[("cos\u{207f}\u{3b3}", &blinn)],
    );
    zones.chart.marks.push(inflection_mark(35.0));
    let (squared, sixteen) = (stretched(2), stretched(16));
    vec![
        zones,
        over_exponents(
            "seed 000, Fig. 5",
            "cosine-squared-error",
            "cos\u{b2}(a\u{b7}\u{3b4}) for cos\u{207f}\u{3b4}",
            "Largest relative error of the prototype's function against n.",
            (exponents(), ChartAxis::linear(ERROR, 0.0, 15.0)),
            &[
                ("to the inflection point", &squared, Region::Inflection),
                ("where cos\u{207f}\u{3b4} \u{2265} 0.46", &squared, Region::Level(0.46)),
            ],
        ),
        over_exponents(
            "seed 000, Fig. 9",
            "stretched-error",
            "cos\u{1d4f}(\u{221a}(n/k)\u{b7}\u{3b4}) for cos\u{207f}\u{3b4}",
            "Largest relative error to the inflection point against n. With the patent's k the error has a peak \
                 wherever k changes; k = 16 alone would not do for small n.",
            (exponents(), ChartAxis::linear(ERROR, 0.0, 5.0)),
            &[
                ("k = 2, 4, 16 by n", &quad, Region::Inflection),
                ("k = 16 throughout", &sixteen, Region::Inflection),
                ("k = 2 throughout (the prototype)", &squared, Region::Inflection),
            ],
        ),
    ]
}

fn paper() -> Vec<SeedPlot> {
    let (w2, w4, w8, w16) = (w(2), w(4), w(8), w(16));
    let exponents = || ChartAxis::logarithmic(EXPONENT, 2.0, 250.0);
    let mut plots = vec![
        over_angle(
            "seed 002, Fig. 3",
            "w2-and-schlick",
            "W with m = 2 and Schlick's function, n = 100",
            &format!(
                "Both follow cos\u{207f}\u{3b3} near the peak. W falls to 0 at {:.1} degrees; Schlick's function \
                     fades so slowly that the highlight has a halo.",
                libm::acos((100.0 - 2.0) / 100.0).to_degrees()
            ),
            100.0,
            30.0,
            &[("cos\u{207f}\u{3b3}", &blinn), ("W, m = 2", &w2), ("Schlick", &schlick)],
        ),
        over_exponents(
            "seed 002, Fig. 4",
            "w2-epicentre",
            "The epicentre: W with m = 2, and Schlick's function",
            "Largest relative error to the inflection point against n.",
            (exponents(), ChartAxis::linear(ERROR, 0.0, 12.0)),
            &[("W, m = 2", &w2, Region::Inflection), ("Schlick", &schlick, Region::Inflection)],
        ),
    ];
    let of_power: [(_, _, Function); 3] = [
        ("seed 002, Fig. 5", 4, &w4),
        ("seed 002, Fig. 6", 8, &w8),
        ("seed 002, Fig. 7", 16, &w16),
    ];
    for (figure, m, function) in of_power {
        plots.push(over_angle(
            figure,
            &format!("w{m}-lobe"),
            &format!("W with m = {m}, n = 35"),
            "W stays below cos\u{207f}\u{3b3} and meets it at the peak; the greater m, the farther out they part.",
            35.0,
            45.0,
            &[("cos\u{207f}\u{3b3}", &blinn), (&format!("W, m = {m}"), function)],
        ));
    }
    let less = |function: Function<'_>, gamma: f64, n: f64| function(gamma, n) - blinn(gamma, n);
    let mut differences = over_angle(
        "seed 002, Figs. 5 to 7",
        "w-differences",
        "W less cos\u{207f}\u{3b3}, n = 35",
        "What the three figures before can hardly show. With each doubling of m the difference falls to less than a half.",
        35.0,
        45.0,
        &[
            ("m = 4", &|gamma, n| less(&w4, gamma, n)),
            ("m = 8", &|gamma, n| less(&w8, gamma, n)),
            ("m = 16", &|gamma, n| less(&w16, gamma, n)),
        ],
    );
    differences.chart.y = ChartAxis::linear("difference", -0.08, 0.02);
    plots.push(differences);
    let families = |region| {
        [
            ("W, m = 4", &w4 as Function, region),
            ("W, m = 8", &w8, region),
            ("W, m = 16", &w16, region),
            ("Schlick", &schlick, region),
        ]
    };
    plots.push(over_exponents(
        "seed 002, Fig. 8",
        "w-epicentre",
        "The epicentre: W with m = 4, 8, 16",
        "Largest relative error to the inflection point against n. Where n is less than m, W is on the other side of \
         cos\u{207f}\u{3b3}, and worse than for large n.",
        (exponents(), ChartAxis::linear(ERROR, 0.0, 12.0)),
        &families(Region::Inflection),
    ));
    plots.push(over_exponents(
        "seed 002, Fig. 8",
        "w-epicentre-0.46",
        "The same where cos\u{207f}\u{3b3} \u{2265} 0.46",
        "Largest relative error down to this level against n. Three of the paper's four figures come out here: those of \
         m = 4 and 8 and of Schlick's function.",
        (exponents(), ChartAxis::linear(ERROR, 0.0, 25.0)),
        &families(Region::Level(0.46)),
    ));
    plots.push(over_exponents(
        "seed 002, Fig. 9",
        "w-blooming",
        "The blooming zone: W with m = 4, 8, 16",
        "Largest relative error where cos\u{207f}\u{3b3} \u{2265} 0.20, against n.",
        (exponents(), ChartAxis::linear(ERROR, 0.0, 100.0)),
        &families(Region::Level(0.20)),
    ));
    plots
}

/// The patent's table 1: for each required accuracy the smallest k by n, where the error counts to the
/// inflection point. n = 1 has none, and k = 1 is exact there.
pub fn power_table() -> Vec<RequiredPowers> {
    [0.005, 0.006, 0.01, 0.02, 0.03, 0.05]
        .into_iter()
        .map(|error| RequiredPowers { error, powers: power_runs(error) })
        .collect()
}

fn power_runs(limit: f64) -> Vec<PowerRun> {
    let suffices = |n: u32, k: u32| {
        measure::at(&stretched(k), n, Region::Inflection).is_some_and(|worst| worst.error <= limit)
    };
    let mut runs: Vec<PowerRun> = vec![PowerRun { first: 1, last: 1, power: 1 }];
    for n in 2..=LARGEST {
        // k = n is exact, and the powers that suffice do not fall as n grows.
        let least = runs.last().map_or(1, |run| run.power);
        let Some(power) = (least..=LARGEST_POWER).find(|&k| suffices(n, k)) else {
            continue;
        };
        match runs.last_mut() {
            Some(run) if run.power == power => run.last = n,
            _ => runs.push(PowerRun { first: n, last: n, power }),
        }
    }
    runs
}

/// ROM 9's map: every word.
pub fn rom_9() -> Vec<Rom9Word> {
    (1..=LARGEST)
        .map(|n| {
            let k = formulas::quad_power(i64::from(n));
            Rom9Word { n, k, root: (f64::from(n) / f64::from(k)).sqrt() }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_per_cent_takes_nine() {
        // From a table of errors: k = 3 gives 1.50 % at n = 5, k = 4 0.88 % at n = 6.
        let runs = power_runs(0.01);
        let power = |n| {
            let run = runs.iter().find(|run| (run.first..=run.last).contains(&n));
            run.map(|run| run.power)
        };
        assert_eq!([1, 2, 3, 4, 5, 6, 1000].map(power), [1, 2, 3, 3, 4, 4, 9].map(Some));
        let covered: u32 = runs.iter().map(|run| run.last - run.first + 1).sum();
        assert_eq!(covered, LARGEST);
    }

    #[test]
    fn words_of_rom_9() {
        let map = rom_9();
        let root = |n: usize| map[n - 1].root;
        assert_eq!([1, 2, 4, 16, 64, 400].map(root), [1.0, 1.0, 1.0, 1.0, 2.0, 5.0]);
        assert_eq!(map.len(), 1000);
        assert_eq!((map[2].k, map[6].k), (4, 16));
    }

    #[test]
    fn plots_have_what_they_need() {
        for SeedPlot { chart, .. } in plots() {
            assert!(chart.series.len() <= crate::pages::plots::STYLES, "{}", chart.id);
            for series in &chart.series {
                assert_eq!(series.values.len(), chart.places.len());
                assert!(series.values.iter().all(|value| value.is_finite()), "{}", chart.id);
            }
        }
    }
}

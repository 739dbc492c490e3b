//! Makes the plots and tables that the captions of the seeds' figures describe.

use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};

use super::claims::{percent, quad, schlick, stretched, w};
use super::measure::{self, Region};
use glint::evidence::chart::{Chart, ChartAxis, Mark, Series, even, exponents};
use glint::golden::formulas;

/// The largest exponent of the patent.
pub const LARGEST: u32 = 1000;

/// The largest power that the k table tries.
const LARGEST_POWER: u32 = 64;

/// A plot or a table of a seed, and what its caption is there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SeedPlot {
    /// `seed 000, Fig. 5`.
    pub figure: String,
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

/// A plot as `seed_plots.toml` states it.
#[derive(Deserialize)]
struct Stated {
    figure: String,
    id: String,
    title: String,
    caption: String,
    over_angle: Option<(f64, f64)>,
    over_exponent: Option<(f64, f64)>,
    /// The range of values, where they are differences.
    difference: Option<(f64, f64)>,
    /// Whether the height of the inflection point is marked.
    #[serde(default)]
    marked: bool,
    functions: Vec<String>,
}

#[derive(Deserialize)]
struct List {
    plot: Vec<Stated>,
}

/// A function of the angle in radians and the exponent.
type Function = Box<dyn Fn(f64, f64) -> f64 + Sync>;

/// Returns the function of this name, which a power may follow.
fn function(text: &str) -> Result<Function> {
    let (name, power) = match text.split_once(' ') {
        None => (text, None),
        Some((name, power)) => (name, Some(power.parse().context("the power of a function")?)),
    };
    Ok(match (name, power) {
        ("blinn", None) => Box::new(blinn),
        ("quad", None) => Box::new(quad),
        ("schlick", None) => Box::new(schlick),
        ("w", Some(power)) => Box::new(w(power)),
        ("stretched", Some(power)) => Box::new(stretched(power)),
        ("less", Some(power)) => {
            let w = w(power);
            Box::new(move |gamma, n| w(gamma, n) - blinn(gamma, n))
        }
        _ => bail!("there is no function `{text}`"),
    })
}

/// Returns the region of this name, or above this level.
fn region(text: &str) -> Result<Region> {
    Ok(match text {
        "inflection" => Region::Inflection,
        level => Region::Level(level.parse().context("the region of a function")?),
    })
}

impl Stated {
    /// Returns the series: of each function its name and what `values` makes of the function and its region.
    fn series(&self, values: impl Fn(Function, &str) -> Result<Vec<f64>>) -> Result<Vec<Series>> {
        let series = |text: &String| {
            let mut parts = text.splitn(3, " | ");
            let mut part = || parts.next().unwrap_or("");
            let (name, of, region) = (part().to_owned(), function(part())?, part());
            Ok(Series { name, values: values(of, region)? })
        };
        self.functions.iter().map(series).collect()
    }

    fn plot(self) -> Result<SeedPlot> {
        let mut chart = match (self.over_exponent, self.over_angle) {
            (Some(ends), None) => self.over_exponents(ends)?,
            (None, Some(ends)) => self.over_angles(ends)?,
            _ => bail!("the plot `{}` has one of over_angle and over_exponent", self.id),
        };
        if let Some((low, high)) = self.difference {
            chart.y = ChartAxis::linear("difference", low, high);
        }
        Ok(SeedPlot { figure: self.figure, chart })
    }

    /// Functions of the angle at one exponent.
    fn over_angles(&self, (n, degrees): (f64, f64)) -> Result<Chart> {
        let places = even(0.0, degrees, 120);
        let series = self.series(|function, _| {
            Ok(places.iter().map(|degrees| function(degrees.to_radians(), n)).collect())
        })?;
        Ok(Chart {
            series,
            id: self.id.clone(),
            title: self.title.clone(),
            caption: self.caption.clone(),
            x: ChartAxis::linear(GAMMA, 0.0, degrees),
            y: ChartAxis::linear(VALUE, 0.0, 1.0),
            places,
            marks: self.marked.then(|| inflection_mark(n)).into_iter().collect(),
        })
    }

    /// Largest relative errors against n.
    fn over_exponents(&self, (most, top): (f64, f64)) -> Result<Chart> {
        let places = exponents(2, most as u32, 24);
        let series = self.series(|function, text| {
            let region = region(text)?;
            let error = |&n: &u32| measure::at(&*function, n, region).map(|it| 100.0 * it.error);
            Ok(places.iter().map(|n| error(n).unwrap_or(f64::NAN)).collect())
        })?;
        Ok(Chart {
            id: self.id.clone(),
            title: self.title.clone(),
            caption: format!("{} {}", self.caption, largest(&series, &places)),
            x: ChartAxis::logarithmic(EXPONENT, 2.0, most),
            y: ChartAxis::linear(ERROR, 0.0, top),
            places: places.into_iter().map(f64::from).collect(),
            series,
            marks: Vec::new(),
        })
    }
}

/// Returns the height of `cosⁿγ` at its inflection point.
fn inflection_mark(n: f64) -> Mark {
    let edge = Region::Inflection.edge(n).unwrap_or(0.0);
    Mark {
        label: format!("height of the inflection point of cos\u{207f}\u{3b3}, n = {n}"),
        at: blinn(edge, n),
    }
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

/// Returns all plots, in the order of the seeds.
///
/// # Errors
/// A mistake in `seed_plots.toml`.
pub fn plots() -> Result<Vec<SeedPlot>> {
    let list: List = toml::from_str(include_str!("seed_plots.toml"))?;
    list.plot.into_iter().map(Stated::plot).collect()
}

/// Returns the patent's table 1: for each required accuracy the smallest k by n, where the error counts to the
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
    fn plots_have_what_they_need() -> Result<()> {
        let plots = plots()?;
        assert_eq!(plots.len(), 12);
        for SeedPlot { chart, .. } in plots {
            assert!(chart.series.len() <= glint::pages::plots::STYLES, "{}", chart.id);
            for series in &chart.series {
                assert_eq!(series.values.len(), chart.places.len());
                assert!(series.values.iter().all(|value| value.is_finite()), "{}", chart.id);
            }
        }
        Ok(())
    }
}

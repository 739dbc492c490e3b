//! Makes the report as one HTML page that needs no other file and no network.

use anyhow::Result;
use glint_base::template::Template;

use super::Evidence;
use super::benchmark::Benchmark;
use super::claims::{Claim, Verdict, percent};
use super::seed_plots::{RequiredPowers, Rom9Word};
use glint::evidence::chart::Chart;
use glint::evidence::curves::DeviceCurves;
use glint::pages::figure::{Figure, figures, scientific};
use glint::pages::formula;

/// The words of ROM 9 in a row of its table.
const WORDS: usize = 10;

#[glint_base::template::template("report.html")]
struct Page<'a> {
    schlick: String,
    w: String,
    evidence: &'a Evidence,
    counts: Vec<(&'static str, &'static str, usize)>,
    claims: Vec<ClaimView<'a>>,
    plots: Vec<Figure<'a>>,
    powers: Vec<PowerRow>,
    rom_9: Vec<RomRow>,
    overview: Vec<Figure<'a>>,
    devices: Vec<DeviceView<'a>>,
    benchmark: Option<BenchmarkView<'a>>,
}

struct ClaimView<'a> {
    claim: &'a Claim,
    class: &'static str,
    verdict: &'static str,
}

struct PowerRow {
    error: String,
    runs: Vec<String>,
}

struct RomRow {
    first: u32,
    words: Vec<String>,
}

struct DeviceView<'a> {
    device: &'a DeviceCurves,
    figures: Vec<Figure<'a>>,
    bound: String,
    rows: Vec<[String; 5]>,
}

struct BenchmarkView<'a> {
    benchmark: &'a Benchmark,
    rows: Vec<[String; 6]>,
}

/// Returns the page. The benchmark's section is there only if it was run.
///
/// # Errors
/// A chart cannot be plotted.
pub fn page(evidence: &Evidence, benchmark: Option<&Benchmark>) -> Result<String> {
    let plots: Vec<(&Chart, &str)> =
        evidence.plots.iter().map(|plot| (&plot.chart, plot.figure.as_str())).collect();
    let overview: Vec<(&Chart, &str)> = evidence.overview.iter().map(|chart| (chart, "")).collect();
    let page = Page {
        schlick: formula::typeset("S(n, gamma) = cos(gamma) / (n - n * cos(gamma) + cos(gamma))"),
        w: formula::typeset("W(n, gamma) = (n/m * (cos(gamma) - 1) + 1)^m"),
        evidence,
        counts: counts(&evidence.claims),
        claims: evidence.claims.iter().map(claim).collect(),
        plots: figures(&plots)?,
        powers: evidence.power_table.iter().map(powers).collect(),
        rom_9: evidence.rom_9.chunks(WORDS).map(rom_row).collect(),
        overview: figures(&overview)?,
        devices: evidence.devices.iter().map(device).collect::<Result<_>>()?,
        benchmark: benchmark.map(timings),
    };
    // Neither a range nor a number and its unit is broken across lines.
    let mut text = page.render()?;
    text = text.replace('\u{2026}', "&NoBreak;\u{2026}&NoBreak;");
    text = text.replace(" %", "&nbsp;%");
    text.push('\n');
    Ok(text)
}

/// Returns the class of a verdict in the style sheet.
fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Depends => "depends",
        Verdict::Nearly => "nearly",
        Verdict::Fails | Verdict::Contradictory => "fails",
        Verdict::Elsewhere => "elsewhere",
    }
}

/// Returns how many claims have each verdict that occurs.
fn counts(claims: &[Claim]) -> Vec<(&'static str, &'static str, usize)> {
    let counts = Verdict::ALL.into_iter().map(|verdict| {
        let count = claims.iter().filter(|claim| claim.verdict == verdict).count();
        (class(verdict), verdict.words(), count)
    });
    counts.filter(|(_, _, count)| *count > 0).collect()
}

fn claim(claim: &Claim) -> ClaimView<'_> {
    ClaimView { claim, class: class(claim.verdict), verdict: claim.verdict.words() }
}

fn powers(accuracy: &RequiredPowers) -> PowerRow {
    PowerRow {
        error: percent(accuracy.error),
        runs: accuracy
            .powers
            .iter()
            .map(|run| {
                if run.first == run.last {
                    format!("k = {}: n = {}", run.power, run.first)
                } else {
                    format!("k = {}: n = {}\u{2026}{}", run.power, run.first, run.last)
                }
            })
            .collect(),
    }
}

fn rom_row(words: &[Rom9Word]) -> RomRow {
    RomRow {
        first: words.first().map_or(0, |word| word.n),
        words: words.iter().map(|word| format!("{:.4}", word.root)).collect(),
    }
}

fn device(device: &DeviceCurves) -> Result<DeviceView<'_>> {
    let charts: Vec<(&Chart, &str)> = device.charts.iter().map(|chart| (chart, "")).collect();
    let rows = device
        .exponents
        .iter()
        .map(|at| {
            [
                at.n.to_string(),
                scientific(at.formula),
                scientific(at.fixed_point),
                scientific(at.whole),
                format!("{:.3}", at.fixed_point * device.largest_colour),
            ]
        })
        .collect();
    Ok(DeviceView {
        device,
        figures: figures(&charts)?,
        bound: format!("{:.3}", device.bound_units),
        rows,
    })
}

fn timings(benchmark: &Benchmark) -> BenchmarkView<'_> {
    let rows = benchmark
        .pairs
        .iter()
        .map(|pair| {
            [
                pair.m.to_string(),
                pair.precision.to_owned(),
                if pair.dependent {
                    "each waits for the one before".to_owned()
                } else {
                    "many at once".to_owned()
                },
                format!("{:.2}", pair.w_ns),
                format!("{:.2}", pair.schlick_ns),
                format!("{:.2} ({:.2} to {:.2})", pair.ratio[1], pair.ratio[0], pair.ratio[2]),
            ]
        })
        .collect();
    BenchmarkView { benchmark, rows }
}

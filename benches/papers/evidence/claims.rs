//! Lists the claims of the seeds about their functions, each with Glint's measurement, the definition under which it was
//! measured, and a verdict.

mod paper;
mod patent;
mod rough;

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::measure::{self, Function, Region, Worst};
use glint::golden::formulas;

/// The level down to which the paper's errors "before the inflection point" come out.
const EPICENTRE: Region = Region::Level(0.46);

/// A figure this near to the seed's, relatively, is taken for the same.
const SAME: f64 = 0.03;

/// The verdict on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Under every definition that was tried.
    Holds,
    /// Under some definition, not under another.
    Depends,
    /// The seed's figure is nearly reproduced, and exceeded by little.
    Nearly,
    /// Under none.
    Fails,
    /// The seed says two things that exclude each other.
    Contradictory,
    /// It is no matter of this part of the report.
    Elsewhere,
}

impl Verdict {
    /// Every verdict, the best first.
    pub const ALL: [Self; 6] = [
        Self::Holds,
        Self::Depends,
        Self::Nearly,
        Self::Fails,
        Self::Contradictory,
        Self::Elsewhere,
    ];

    /// For the ledger.
    pub fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Depends => "depends on the definition",
            Self::Nearly => "nearly",
            Self::Fails => "does not hold",
            Self::Contradictory => "contradicts itself",
            Self::Elsewhere => "see there",
        }
    }
}

/// A figure of ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// For scripts and tests: `inflection`, `level-0.46`, `n-7`.
    pub key: String,
    /// Under which definition.
    pub definition: String,
    /// The figure.
    pub value: f64,
    /// The figure as the ledger prints it, with its unit.
    pub text: String,
    /// The exponent at which it is found, where the definition leaves it open.
    pub n: Option<u32>,
}

/// One line of the ledger.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    /// Unique, for scripts and links.
    pub id: String,
    /// Where it stands.
    pub source: String,
    /// The claim, in English.
    pub claim: String,
    /// The seed's figure.
    pub seed: String,
    /// Ours.
    pub ours: Vec<Measured>,
    /// The verdict.
    pub verdict: Verdict,
    /// The verdict in a sentence or two.
    pub words: String,
}

/// The texts of a claim, in `claims.toml`.
#[derive(Clone, Default, Deserialize)]
struct Texts {
    source: String,
    claim: String,
    seed: String,
    words: String,
}

static TEXTS: LazyLock<BTreeMap<String, Texts>> =
    LazyLock::new(|| toml::from_str(include_str!("claims/claims.toml")).unwrap_or_default());

/// Returns the claim of this name, with our figures and the verdict.
pub fn claim(id: &str, ours: Vec<Measured>, verdict: Verdict, values: &[(&str, String)]) -> Claim {
    instance(id, id, ours, verdict, values)
}

/// Returns a claim with the texts of a name that several share. In the texts `{name}` stands for the value of that name.
fn instance(
    texts: &str,
    id: &str,
    ours: Vec<Measured>,
    verdict: Verdict,
    values: &[(&str, String)],
) -> Claim {
    let Texts { source, claim, seed, words } = TEXTS.get(texts).cloned().unwrap_or_default();
    let filled = |text: String| {
        let value = |text: String, (name, value): &(&str, String)| {
            text.replace(&format!("{{{name}}}"), value)
        };
        values.iter().fold(text, value)
    };
    let [claim, seed, words] = [claim, seed, words].map(filled);
    Claim { id: id.to_owned(), source, claim, seed, ours, verdict, words }
}

/// Returns an error in per cent: two digits after the point below 10 %, one from there on.
pub fn percent(value: f64) -> String {
    let value = 100.0 * value;
    match value {
        _ if value >= 10.0 => format!("{value:.1} %"),
        _ => format!("{value:.2} %"),
    }
}

/// Returns the verdict on a claim that either holds or fails.
fn holds_if(holds: bool) -> Verdict {
    if holds { Verdict::Holds } else { Verdict::Fails }
}

/// Returns a figure that is not an error.
fn plain(key: &str, definition: &str, value: f64, text: String) -> Measured {
    Measured { key: key.to_owned(), definition: definition.to_owned(), value, text, n: None }
}

/// Returns the key of a definition.
fn key(region: Region) -> String {
    match region {
        Region::Inflection => "inflection".to_owned(),
        Region::Level(level) => format!("level-{level:.2}"),
    }
}

fn error(worst: Worst, key: String, definition: String) -> Measured {
    Measured { key, definition, value: worst.error, text: percent(worst.error), n: Some(worst.n) }
}

/// Judges "not more than `limit`": figures are compared to the limit's last digit, a tenth of a per cent.
fn upper(ours: &[Measured], limit: f64) -> Verdict {
    let within = |measured: &&Measured| libm::round(measured.value * 1000.0) <= limit * 1000.0;
    match ours.iter().filter(within).count() {
        count if count == ours.len() => Verdict::Holds,
        0 if ours.iter().any(|one| one.value < limit * (1.0 + SAME)) => Verdict::Nearly,
        0 => Verdict::Fails,
        _ => Verdict::Depends,
    }
}

/// W with power m, and Schlick's function, as functions of the angle.
pub fn w(m: u32) -> impl Fn(f64, f64) -> f64 + Sync {
    move |gamma, n| formulas::cosine_power(libm::cos(gamma), n, m)
}

/// Schlick's function of the angle.
pub fn schlick(gamma: f64, n: f64) -> f64 {
    formulas::schlick(libm::cos(gamma), n)
}

/// `cosᵏ(√(n/k)·δ)`.
pub fn stretched(k: u32) -> impl Fn(f64, f64) -> f64 + Sync {
    move |delta, n| formulas::stretched_cosine(delta, n, k)
}

/// `cosᵏ(√(n/k)·δ)` with the k that the device chooses by n.
pub fn quad(delta: f64, n: f64) -> f64 {
    formulas::quad_cosine(delta, n as i64)
}

/// Returns the ledger: what the paper says, then what the patents say.
pub fn ledger() -> Vec<Claim> {
    [paper::claims(), patent::claims(), rough::claims()].concat()
}

/// `n` as a list of runs: `2…7`.
fn runs(exponents: &[u32]) -> String {
    let mut runs: Vec<(u32, u32)> = Vec::new();
    for &n in exponents {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == n => *last = n,
            _ => runs.push((n, n)),
        }
    }
    let texts: Vec<String> = runs
        .into_iter()
        .map(|(first, last)| match first == last {
            true => first.to_string(),
            false => format!("{first}…{last}"),
        })
        .collect();
    texts.join(", ")
}

/// Returns the exponents at which the error to the inflection point exceeds a limit.
fn exceeding(function: Function, exponents: impl IntoIterator<Item = u32>, limit: f64) -> Vec<u32> {
    exponents
        .into_iter()
        .filter(|&n| {
            measure::at(function, n, Region::Inflection).is_some_and(|worst| worst.error > limit)
        })
        .collect()
}

/// Returns the largest error in a region over exponents.
fn largest(
    function: Function,
    exponents: std::ops::RangeInclusive<u32>,
    region: Region,
    key: &str,
    what: &str,
) -> Option<Measured> {
    let range = runs(&exponents.clone().collect::<Vec<u32>>());
    let alone = exponents.start() == exponents.end();
    let worst = measure::over(function, exponents, region)?;
    let found = error(worst, key.to_owned(), format!("{what}, {}, n = {range}", region.name()));
    Some(Measured { n: found.n.filter(|_| !alone), ..found })
}

/// Returns the largest error to the inflection point over exponents.
fn to_inflection(
    function: Function,
    exponents: std::ops::RangeInclusive<u32>,
    key: &str,
    what: &str,
) -> Option<Measured> {
    largest(function, exponents, Region::Inflection, key, what)
}

/// Returns the figures that were found.
fn found(figures: impl IntoIterator<Item = Option<Measured>>) -> Vec<Measured> {
    figures.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests;

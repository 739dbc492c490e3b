//! Measures the relative error of a function against `cosⁿγ`, from γ = 0 to the end of a region.
//!
//! A region ends at the inflection point of `cosⁿγ`, or where `cosⁿγ` falls to a given level, for example 0.2.

use serde::Serialize;

use glint::golden::formulas;

/// Angles at which an error is looked for, from the peak to the end of the region, which is one of them.
const ANGLES: u32 = 64;

/// A function of the angle γ in radians and the exponent n that stands in for `cosⁿγ`.
pub type Function<'a> = &'a (dyn Fn(f64, f64) -> f64 + Sync);

/// Where the region in which an error counts ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// The inflection point of `cosⁿγ` as a function of γ: tan γ = 1/√(n − 1).
    Inflection,
    /// Where `cosⁿγ` falls to this level.
    Level(f64),
}

impl Region {
    /// Returns the angle at which it ends; `None` for n = 1, where a cosine has no inflection before 90°.
    pub fn edge(self, n: f64) -> Option<f64> {
        match self {
            Self::Inflection if n > 1.0 => Some(libm::atan(1.0 / (n - 1.0).sqrt())),
            Self::Inflection => None,
            Self::Level(level) => Some(libm::acos(libm::pow(level, 1.0 / n))),
        }
    }

    /// For a sentence: "to the inflection point".
    pub fn name(self) -> String {
        match self {
            Self::Inflection => "to the inflection point".to_owned(),
            Self::Level(level) => format!("where cos\u{207f}\u{3b3} \u{2265} {level:.2}"),
        }
    }
}

/// The largest relative error, and where it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// The error, relative to `cosⁿγ`: 0.01 is one per cent.
    pub error: f64,
    /// The exponent.
    pub n: u32,
    /// The angle, in radians.
    pub gamma: f64,
}

/// Returns the relative error at one point. `cosⁿγ` must not be 0 there.
pub fn relative(function: Function, gamma: f64, n: f64) -> f64 {
    let exact = formulas::blinn(libm::cos(gamma), n);
    ((function(gamma, n) - exact) / exact).abs()
}

/// Returns the largest relative error from γ = 0 to `edge`.
fn to_edge(function: Function, n: u32, edge: f64) -> Worst {
    let mut worst = Worst { error: 0.0, n, gamma: 0.0 };
    for step in 1..=ANGLES {
        let gamma = edge * f64::from(step) / f64::from(ANGLES);
        let error = relative(function, gamma, f64::from(n));
        if error > worst.error {
            worst = Worst { error, n, gamma };
        }
    }
    worst
}

/// Returns the largest relative error at one exponent; `None` where the region has no end.
pub fn at(function: Function, n: u32, region: Region) -> Option<Worst> {
    Some(to_edge(function, n, region.edge(f64::from(n))?))
}

/// Returns the largest relative error over exponents; those at which the region has no end do not count.
pub fn over(
    function: Function,
    exponents: impl IntoIterator<Item = u32>,
    region: Region,
) -> Option<Worst> {
    exponents
        .into_iter()
        .filter_map(|n| at(function, n, region))
        .reduce(|worst, other| if other.error > worst.error { other } else { worst })
}

/// Returns the level of `cosⁿγ` down to which the largest relative error over exponents is `error`, to four digits;
/// `None` when it stays below it down to 0.01. The error must grow with the angle.
pub fn level_of(
    function: Function,
    exponents: impl IntoIterator<Item = u32> + Clone,
    error: f64,
) -> Option<f64> {
    let exceeds = |level: f64| {
        over(function, exponents.clone(), Region::Level(level))
            .is_some_and(|worst| worst.error > error)
    };
    let (mut low, mut high) = (0.01, 1.0);
    if !exceeds(low) {
        return None;
    }
    while high - low > 1e-4 {
        let middle = 0.5 * (low + high);
        if exceeds(middle) { low = middle } else { high = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_4;

    #[test]
    fn regions_end_where_they_say() {
        // cos²γ = (1 + cos 2γ)/2 bends at 45°.
        let edge = Region::Inflection.edge(2.0).expect("n > 1");
        assert!((edge - FRAC_PI_4).abs() < 1e-15);
        assert_eq!(Region::Inflection.edge(1.0), None);
        let edge = Region::Level(0.5).edge(2.0).expect("a level has an edge");
        assert!((edge - FRAC_PI_4).abs() < 1e-15);
    }

    #[test]
    fn errors_of_a_known_size() {
        // cosⁿγ less a tenth of it at 45° and beyond.
        let step = |gamma: f64, n: f64| {
            let exact = libm::pow(libm::cos(gamma), n);
            if gamma >= FRAC_PI_4 - 1e-12 { 0.9 * exact } else { exact }
        };
        let worst = at(&step, 2, Region::Inflection).expect("n > 1");
        assert!((worst.error - 0.1).abs() < 1e-12, "{worst:?}");
        assert!((worst.gamma - FRAC_PI_4).abs() < 1e-12, "{worst:?}");
        let before = at(&step, 2, Region::Level(0.51)).expect("a level has an edge");
        assert!(before.error < 1e-12, "{before:?}");
        assert_eq!(over(&step, [1], Region::Inflection), None);
    }

    #[test]
    fn a_level_is_found_from_its_error() {
        // The relative error is 1 − cosⁿγ.
        let square = |gamma: f64, n: f64| libm::pow(libm::cos(gamma), 2.0 * n);
        let level = level_of(&square, [7], 0.25).expect("it is reached");
        assert!((level - 0.75).abs() < 2e-4, "{level}");
        assert_eq!(level_of(&square, [7], 0.995), None);
    }
}

//! Measures the error curves of a configuration, over the exponent n and over the angle γ.
//!
//! One kind of curve is the error of the device's formula against `cosⁿγ`, Blinn's specular highlight. The second kind is the
//! error of the fixed-point results against the formula.

use std::f64::consts::FRAC_PI_2;

use serde::Serialize;

use super::chart::{Chart, ChartAxis, Mark, Series, even};
use super::comparison;
use glint_core::registry::Device;
use glint_golden::{Contract, Highlight, formulas};

pub const EXPONENTS: [u32; 20] =
    [1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64, 91, 128, 181, 256, 362, 512, 724, 1000];

/// The exponents with a curve over the angle.
const SHOWN: [u32; 5] = [2, 8, 35, 128, 1000];

/// The largest value of `√n·γ` on the curves over the angle.
const REACH: f64 = 4.0;

/// `PLACES` is the number of steps between the first and the last position of a curve over the angle. A position has the largest
/// error of [`ANGLES`] steps around it.
const PLACES: u32 = 100;
const ANGLES: u32 = 12;

/// The lowest error on a logarithmic axis. Smaller errors are drawn there.
const FLOOR: f64 = 1e-6;

/// The error curves of a device, with the facts that a page shows next to them.
#[derive(Clone, Debug, Serialize)]
pub struct DeviceCurves {
    pub device: String,
    pub summary: String,
    /// The proved bound of an output's error, in output units.
    pub bound_units: f64,
    /// The largest value of a colour operand; 0 for a device without colours. An error of `f` times this value is an error in
    /// output units.
    pub largest_colour: f64,
    /// The largest errors for each exponent; empty if the operands of the device do not denote γ and n.
    pub exponents: Vec<AtExponent>,
    /// The charts; empty if `exponents` is empty.
    pub charts: Vec<Chart>,
}

/// The largest errors of `f` at one exponent, over all angles from 0 to 90°.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AtExponent {
    pub n: u32,
    /// The formula against `cosⁿγ`.
    pub formula: f64,
    /// The computed reflectance f against the formula at the quantised operands.
    pub fixed_point: f64,
    /// The computed reflectance f against `cosⁿγ`, before the angle is quantised.
    pub whole: f64,
}

/// The number of times that [`device`] calls `done`.
pub const STEPS: usize = EXPONENTS.len() + SHOWN.len();

/// The signed error of the formula against `cosⁿγ`, and the absolute error of the fixed-point arithmetic against the formula,
/// at one angle.
#[derive(Clone, Copy, Default)]
struct AtAngle {
    formula: f64,
    fixed_point: f64,
}

/// Measures the curves of the default configuration. Calls `done` after each of [`STEPS`] steps.
pub fn device(device: &Device, done: &(dyn Fn() + Sync)) -> DeviceCurves {
    let opened = device.open(device.defaults()).expect("the defaults of a device can be opened");
    let contract = opened.contract();
    configuration(device, contract.as_ref(), done)
}

/// Measures the curves of a configuration with the contract `contract`, see [`device`].
pub fn configuration(
    device: &Device,
    contract: &dyn Contract,
    done: &(dyn Fn() + Sync),
) -> DeviceCurves {
    use rayon::prelude::*;

    let exponents: Vec<AtExponent> = EXPONENTS
        .par_iter()
        .filter_map(|&n| {
            let accuracy = comparison::accuracy(contract, f64::from(n));
            done();
            let accuracy = accuracy?;
            Some(AtExponent {
                n,
                formula: accuracy.formula.largest,
                fixed_point: accuracy.fixed_point.largest,
                whole: accuracy.whole.largest,
            })
        })
        .collect();
    let lines: Vec<(u32, Option<Vec<AtAngle>>)> = SHOWN
        .par_iter()
        .map(|&n| {
            let line = over_angle(contract, f64::from(n));
            done();
            (n, line)
        })
        .collect();
    let mut largest_colour: f64 = 0.0;
    for operand in contract.operands() {
        if operand.colour {
            let (_, high) = operand.domain;
            largest_colour = largest_colour.max(operand.format.to_f64(i128::from(high)));
        }
    }
    let charts = if exponents.is_empty() {
        Vec::new()
    } else {
        charts(device.name, &exponents, &lines, largest_colour)
    };
    DeviceCurves {
        device: device.name.to_owned(),
        summary: device.summary.to_owned(),
        bound_units: contract.bounds().governing().units,
        largest_colour,
        exponents,
        charts,
    }
}

/// Returns 101 values of `√n·γ` from 0 to 4.
fn places() -> Vec<f64> {
    even(0.0, REACH, PLACES)
}

/// Returns the signed error of the formula at each position of [`places`], and the largest fixed-point error near the position.
/// Both are NaN for angles beyond 90°, at which the surface faces away. For example, the curve of n = 2 ends at √n·γ = 2.2.
fn over_angle(contract: &dyn Contract, n: f64) -> Option<Vec<AtAngle>> {
    let highlight = contract.highlight()?;
    let half = REACH / f64::from(PLACES) / 2.0;
    let mut curve = Vec::new();
    for x in places() {
        if x > FRAC_PI_2 * n.sqrt() {
            curve.push(AtAngle { formula: f64::NAN, fixed_point: f64::NAN });
            continue;
        }
        let mut errors = at_angle(highlight, x, n)?;
        for near in even(x - half, x + half, ANGLES) {
            let errors_near = at_angle(highlight, near, n)?;
            errors.fixed_point = errors.fixed_point.max(errors_near.fixed_point);
        }
        curve.push(errors);
    }
    Some(curve)
}

/// Returns the errors at the angle γ = x/√n, or `None` if the operands cannot represent it.
fn at_angle(highlight: &Highlight, x: f64, n: f64) -> Option<AtAngle> {
    let gamma = (x / n.sqrt()).clamp(0.0, FRAC_PI_2);
    let control = highlight.at(gamma, n)?;
    let cosine = match highlight.cosine(&control) {
        Some(cosine) => cosine,
        None => libm::cos(gamma),
    };
    let f = highlight.f_format().to_f64(i128::from(highlight.f(&control)));
    let formula = comparison::formula(highlight, &control, f);
    Some(AtAngle {
        formula: formula - formulas::blinn(cosine, n),
        fixed_point: (f - formula).abs(),
    })
}

fn charts(
    name: &str,
    exponents: &[AtExponent],
    lines: &[(u32, Option<Vec<AtAngle>>)],
    largest_colour: f64,
) -> Vec<Chart> {
    let unit = 1.0 / largest_colour;
    let over_n = Chart {
        id: format!("{name}-over-n"),
        title: "Largest error of f against n".to_owned(),
        caption: format!(
            "The formula against cos\u{207f}\u{3b3}, and the fixed-point word f against the formula, over all angles. \
             f is 1 at the peak; the line across is one output unit, 1/{largest_colour}."
        ),
        x: ChartAxis::logarithmic("n", 1.0, 1000.0),
        y: ChartAxis::logarithmic("absolute error of f", FLOOR, 1.0),
        places: exponents.iter().map(|at| f64::from(at.n)).collect(),
        series: vec![
            Series {
                name: "formula".to_owned(),
                values: exponents.iter().map(|at| at.formula.max(FLOOR)).collect(),
            },
            Series {
                name: "fixed point".to_owned(),
                values: exponents.iter().map(|at| at.fixed_point.max(FLOOR)).collect(),
            },
        ],
        marks: vec![Mark { label: "one output unit".to_owned(), at: unit }],
    };
    let scaled = || ChartAxis::linear("\u{221a}n\u{b7}\u{3b3}, \u{3b3} in radians", 0.0, REACH);
    let (mut formula, mut fixed) = (Vec::new(), Vec::new());
    for (n, line) in lines {
        let Some(line) = line else { continue };
        let name = format!("n = {n}");
        formula.push(Series {
            name: name.clone(),
            values: line.iter().map(|at| at.formula).collect(),
        });
        fixed
            .push(Series { name, values: line.iter().map(|at| floored(at.fixed_point)).collect() });
    }
    let reach = reach(&formula);
    let over_gamma = Chart {
        id: format!("{name}-formula"),
        title: "The formula's error against the angle".to_owned(),
        caption: "Formula less cos\u{207f}\u{3b3}. In \u{221a}n\u{b7}\u{3b3} the highlights of all exponents have the same \
                  width: the inflection point is near 1."
            .to_owned(),
        x: scaled(),
        y: ChartAxis::linear("f, formula \u{2212} cos\u{207f}\u{3b3}", -reach, reach),
        places: places(),
        series: formula,
        marks: vec![Mark {
            label: "no error".to_owned(),
            at: 0.0,
        }],
    };
    let fixed_point = Chart {
        id: format!("{name}-fixed-point"),
        title: "The fixed point's error against the angle".to_owned(),
        caption: "The largest difference between the word f and the formula at the same operands, about each angle. \
                  The line across is one output unit."
            .to_owned(),
        x: scaled(),
        y: ChartAxis::logarithmic("absolute error of f", FLOOR, 0.1),
        places: places(),
        series: fixed,
        marks: vec![Mark {
            label: "one output unit".to_owned(),
            at: unit,
        }],
    };
    vec![over_n, over_gamma, fixed_point]
}

/// Returns the end of an axis: the smallest round number from 0.001 to 0.5 that no finite absolute value of the curves exceeds.
/// For example, values up to 0.013 give 0.02.
fn reach(series: &[Series]) -> f64 {
    let mut largest: f64 = 0.0;
    for value in series.iter().flat_map(|series| &series.values) {
        if value.is_finite() {
            largest = largest.max(value.abs());
        }
    }
    for reach in [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5] {
        if reach >= largest {
            return reach;
        }
    }
    1.0
}

/// Raises errors below `FLOOR` to it, so a logarithmic axis can show them. NaN stays NaN.
fn floored(error: f64) -> f64 {
    if error.is_nan() { f64::NAN } else { error.max(FLOOR) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glint_core::registry::Registry;

    fn curves() -> DeviceCurves {
        let registry = Registry::catalogue();
        device(registry.device("cosine-power").expect("it is in the catalogue"), &|| ())
    }

    #[test]
    fn formula_and_fixed_point_apart() {
        let found = curves();
        assert_eq!(found.largest_colour, 255.0);
        assert_eq!(found.exponents.len(), EXPONENTS.len());
        // For n = 16 = m, the formula is c to the 16th power, which is cosⁿγ itself. Only the fixed-point error remains.
        let at = |n| found.exponents.iter().find(|at| at.n == n).expect("measured");
        assert!(at(16).formula < 1e-12, "{:?}", at(16));
        // The square of the formula is nearly 0 beyond the peak, where e^(-2) would be right; W(1000) is wrong by about 0.01.
        assert!((0.005..0.02).contains(&at(1000).formula), "{:?}", at(1000));
        for at in &found.exponents {
            let units = 255.0 * at.fixed_point + 0.5;
            assert!(units <= found.bound_units, "{at:?}: {}", found.bound_units);
            assert!(at.fixed_point > 0.0 && at.fixed_point < at.formula.max(1e-3), "{at:?}");
        }
    }

    #[test]
    fn curves_end_at_a_right_angle() {
        let found = curves();
        let formula = &found.charts[1];
        let n2 = &formula.series[0];
        assert_eq!(n2.name, "n = 2");
        // √2·π/2 = 2.22.
        let last = n2.values.iter().rposition(|value| value.is_finite());
        assert_eq!(last.map(|at| formula.places[at]), Some(2.2));
    }
}

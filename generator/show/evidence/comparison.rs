//! Compares devices at one exponent n: how near each device comes to `cosⁿγ`, and how much hardware it takes.
//!
//! `cosⁿγ` is Blinn's specular highlight. A device that is no highlight, or whose operands cannot represent n, has no error
//! here. The error is measured at 9001 angles from 0 to 90° and split by cause: the device's formula, the rounding of its
//! operands, and its fixed-point arithmetic.

use std::fmt;

use anyhow::Result;
use serde::Serialize;

use glint_core::cosim::trial;
use glint_golden::formulas;
use glint_golden::{Contract, Highlight};
use glint_rtl::netlist::{Design, Driver, Op};

/// The number of angles in each degree at which [`accuracy`] compares the reflectance f of a device with `cosⁿγ`.
pub const ANGLES_PER_DEGREE: u32 = 100;

/// The number of angles from 0 to 90°, both included.
pub const ANGLES: u32 = 90 * ANGLES_PER_DEGREE + 1;

/// The exponent n at which the clocks per point are counted, because they may depend on n.
pub const EXPONENT: f64 = 35.0;

/// The angle γ, in degrees, at which the clocks per point are counted.
const TYPICAL: f64 = 10.0;

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    pub largest: f64,
    pub mean: f64,
}

impl Spread {
    /// Adds the error at one angle. The mean is right after one call for each angle.
    fn take(&mut self, error: f64) {
        let error = error.abs();
        self.largest = self.largest.max(error);
        self.mean += error / f64::from(ANGLES);
    }
}

/// The error of a device's reflectance `f` against `cosⁿγ`, in total and by cause. At every angle the total error is the sum of
/// the signed errors by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Accuracy {
    /// The reflectance f that the hardware computes, against `cosⁿγ`.
    #[serde(rename = "error")]
    pub whole: Spread,
    /// The device's formula in f64, at the quantised operands, against `cosⁿ` of the angle that these operands denote.
    pub formula: Spread,
    /// `cosⁿ` of the angle that the quantised operands denote, against `cosⁿγ`. The error is 0 if the operands determine no angle
    /// ([`Highlight::cosine`]); the formula's error then includes it.
    pub operands: Spread,
    /// The reflectance f that the hardware computes, against the formula at the quantised operands.
    pub fixed_point: Spread,
}

/// Returns the formula's value at the quantised operands. At a jump, returns the value that is nearer to `f`.
pub fn formula(highlight: &Highlight, control: &[i64], f: f64) -> f64 {
    let [one, other] = highlight.references(control);
    if (f - other).abs() < (f - one).abs() { other } else { one }
}

/// Measures the errors of a device's reflectance f for the exponent `n`. Returns `None` if the device is no highlight, or if
/// its operands cannot represent `n`.
pub fn accuracy(contract: &dyn Contract, n: f64) -> Option<Accuracy> {
    let highlight = contract.highlight()?;
    let format = highlight.f_format();
    let mut accuracy = Accuracy::default();
    for step in 0..ANGLES {
        let gamma = (f64::from(step) / f64::from(ANGLES_PER_DEGREE)).to_radians();
        // In f64, cos 90° is not 0. For n near 0 the difference would be visible.
        let cosine = if step == ANGLES - 1 { 0.0 } else { libm::cos(gamma) };
        let control = highlight.at(gamma, n)?;
        let exact = formulas::blinn(cosine, n);
        let denoted = highlight.cosine(&control);
        let denoted = denoted.map_or(exact, |cosine| formulas::blinn(cosine, n));
        let f = format.to_f64(i128::from(highlight.f(&control)));
        let formula = formula(highlight, &control, f);
        accuracy.whole.take(f - exact);
        accuracy.formula.take(formula - denoted);
        accuracy.operands.take(denoted - exact);
        accuracy.fixed_point.take(f - formula);
    }
    Some(accuracy)
}

/// Returns the number of clocks per point: the clocks from one `start` to the earliest next `start`, divided by the number of
/// results between them. The computation has an angle of 10° and the exponent `n`; other operands, such as colours, have their
/// largest values. For example, a line of 16 points in 20 clocks takes 1.25 clocks per point.
///
/// # Errors
/// Fails if the computation is not over after 65 536 clocks, or if the device never raises `valid`.
pub fn clocks_per_point(design: &Design, contract: &dyn Contract, n: f64) -> Result<f64> {
    let point = contract.highlight().and_then(|it| it.at(TYPICAL.to_radians(), n));
    let point = point.unwrap_or_default();
    let operands = contract.operands().iter().enumerate();
    let operands: Vec<i64> = operands
        .map(|(place, operand)| match point.get(place) {
            Some(&raw) if contract.length() != Some(&operand.name) => raw,
            _ => operand.domain.1,
        })
        .collect();
    let (clocks, points) = trial::throughput(design, contract, &operands)?;
    Ok(f64::from(clocks) / f64::from(points))
}

/// The operand widths of a multiplier in bits, the wider one first. As text, for example, `21x10`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MultiplierSize {
    pub first: u32,
    pub second: u32,
}

impl fmt::Display for MultiplierSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.first, self.second)
    }
}

/// Returns one size for each product in the netlist, the largest first.
pub fn multipliers(design: &Design) -> Vec<MultiplierSize> {
    let mut found: Vec<MultiplierSize> = design
        .nets
        .iter()
        .filter_map(|net| match net.driver {
            Driver::Op(Op::Mul(a, b)) => {
                let (a, b) = (design.width(a), design.width(b));
                Some(MultiplierSize { first: a.max(b), second: a.min(b) })
            }
            _ => None,
        })
        .collect();
    found.sort_unstable_by_key(|it| std::cmp::Reverse((it.first * it.second, it.first)));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use glint_base::fixed::Format;
    use glint_golden::contract::{ErrorShare, control};
    use glint_golden::highlight::{Products, Reflectance};
    use glint_rtl::dsl::{Designer, end, fixture, loop_while, step, valid};

    /// A device that computes half of cosⁿγ plus an eighth. The cosine has one fraction bit, and f has eight.
    struct Line;

    impl Line {
        fn contract() -> Highlight {
            let operands = vec![
                control("cos_gamma", Format::unsigned(1, 1), (0, 2), ""),
                control("intervals", Format::unsigned(4, 0), (0, 15), ""),
                control("exponent", Format::unsigned(4, 0), (1, 15), ""),
            ];
            Highlight::new(Self, operands, Products::none(Format::unsigned(1, 8)))
        }
    }

    impl Reflectance for Line {
        fn f(&self, control: &[i64]) -> i64 {
            (self.reference(control) * 256.0) as i64 + 32
        }

        fn reference(&self, control: &[i64]) -> f64 {
            0.5 * formulas::blinn(control[0] as f64 / 2.0, control[2] as f64)
        }

        fn length(&self) -> Option<&str> {
            Some("intervals")
        }

        fn shares(&self) -> Vec<ErrorShare> {
            Vec::new()
        }
    }

    /// Makes a device that shows `intervals + 1` results, one a clock.
    fn design() -> Design {
        let d = Designer::new("line");
        let cosine = d.operand("cos_gamma", Format::unsigned(1, 1));
        let intervals = d.operand("intervals", Format::unsigned(4, 0));
        let exponent = d.operand("exponent", Format::unsigned(4, 0));
        let left = d.down_counter("left", intervals.q());
        let more = d.any("more", left.q());
        d.output("left_out", left.q());
        d.output("cosine_out", cosine.q());
        d.output("exponent_out", exponent.q());
        d.microprogram([
            step("operands", []),
            step("load", [left.load()]),
            step("point", [valid(), left.count(), loop_while(more, "point")]),
            step("end", [end()]),
        ]);
        d.finish().unwrap_or_else(|mistakes| panic!("{mistakes}"))
    }

    #[test]
    fn errors_are_told_apart() {
        // For n = 1, the cosine c is rounded to halves, the formula is c/2, and f is c/2 + 1/8.
        let found = accuracy(&Line::contract(), 1.0).expect("within the domain");
        assert_eq!(found.fixed_point, Spread { largest: 0.125, mean: found.fixed_point.mean });
        assert!((found.fixed_point.mean - 0.125).abs() < 1e-12);
        assert_eq!(found.formula.largest, 0.5);
        // Cosines near 1/4 and 3/4 have the largest rounding error.
        assert!((found.operands.largest - 0.25).abs() < 1e-3, "{found:?}");
        // At γ = 0, f is 1/2 + 1/8 instead of 1.
        assert_eq!(found.whole.largest, 0.375);
        assert_eq!(accuracy(&Line::contract(), 16.0), None);
    }

    #[test]
    fn a_line_counts_by_its_points() {
        // The clocks are: the clock of `start`, words 0 and 1, 16 points, and the last word.
        let clocks = clocks_per_point(&design(), &Line::contract(), 3.0).expect("it ends");
        assert_eq!(clocks, 20.0 / 16.0);
    }

    #[test]
    fn multipliers_are_listed_by_size() {
        let design = fixture::design(|d| {
            let a = d.operand("a", Format::unsigned(0, 4)).q();
            let b = d.operand("b", Format::signed(0, 8)).q();
            d.output("square_out", d.mul("square", a, a));
            d.output("scaled_out", d.mul("scaled", a, b));
            Vec::new()
        });
        // Each operand of the second product has a sign bit.
        let sizes: Vec<String> =
            multipliers(&design).iter().map(MultiplierSize::to_string).collect();
        assert_eq!(sizes, ["9x5", "4x4"]);
    }
}

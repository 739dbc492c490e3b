//! Finds a bound on the error of f of the device `rough` by branch and bound over pairs of angles γ and dγ.
//!
//! **Bounds.** A bin is a small interval of angles. The analysis in [`super::bound`] gives a bound for each pair of bins, one for
//! γ and one for dγ. For a pair of operands in these bins, the same formula gives a smaller bound. The reason is that the errors
//! of the table of sines are known at these operands. If the output of the hardware's adder 15 is computed too, its distance D
//! from cos(γ ± dγ) − 1 is known. The error of f is then at most n·b·D plus the roundings of register 13. Here b is the square's
//! base. n·b is largest at n = 1/(1 − cos(γ − dγ)) or at an end of the domain of n. For a pair of operands and one n, the error
//! itself is computed, with the hardware's roundings.
//!
//! **The search.** The search remembers the largest error that it has computed. It skips every pair whose bound is no larger,
//! because such a pair has no larger error, and examines all other pairs. If that takes more than 2²¹ steps, the result is the
//! largest bound of the remaining pairs. The result is never below half of the bound of the worst pair of bins, so the search
//! spends no time on smaller errors.

use std::collections::BTreeMap;

use super::analysis::{Analysis, BIN, SLACK};
use super::{Derived as _, RoughArithmetic};
use crate::highlight::Reflectance;
use glint_base::fixed::exp2;

/// A step examines a pair of operands, or one exponent of a pair.
const STEPS: u64 = 1 << 21;

/// The search ignores errors below this fraction of the largest bound of a pair of bins.
const LEAST: f64 = 0.5;

/// An upper limit of the f64 rounding error in a sine's error.
const F64: f64 = 1e-15;

struct RawCosine {
    raw: i64,
    /// The exact sine of the angle with this cosine, and the error of the table's sine.
    sine: f64,
    error: f64,
}

/// Two cosines with the sign of dγ, and a bound on the error of f for all exponents.
struct OperandPair {
    bound: f64,
    control: [i64; 4],
    /// The distance of the sum in adder 15 from its exact value, and the amount by which the exact value is below 0.
    distance: f64,
    below: f64,
}

struct PairSearch<'a> {
    it: &'a RoughArithmetic,
    analysis: &'a Analysis,
    /// The cosine operands in each bin of angles, from the largest error of their sine to the smallest.
    cosines: BTreeMap<usize, Vec<RawCosine>>,
    /// The largest error found so far, or half of the largest bound of a pair of bins if that is larger.
    largest: f64,
    steps: u64,
}

/// Returns a proven bound on the error of f, as a value, for all operands of the domain.
pub fn largest_error(it: &RoughArithmetic, analysis: &Analysis) -> f64 {
    let mut bins: Vec<(f64, usize, usize, i64)> = Vec::new();
    let mut first = 0.0_f64;
    for (i, j) in analysis.pairs() {
        for negative in [0, 1] {
            let bound = analysis.bound(i, j, negative == 1);
            first = first.max(bound);
            if bound > LEAST * first {
                bins.push((bound, i, j, negative));
            }
        }
    }
    bins.sort_by(|one, other| other.0.total_cmp(&one.0));
    let mut search =
        PairSearch { it, analysis, cosines: BTreeMap::new(), largest: LEAST * first, steps: STEPS };
    let mut open: Vec<OperandPair> = Vec::new();
    for (bound, i, j, negative) in bins {
        if bound <= search.largest {
            break;
        }
        if !search.look_into(i, j, negative, &mut open) {
            // The remaining bins have no larger bound, but pairs from earlier bins may have.
            let largest = open.iter().map(|pair| pair.bound).fold(bound, f64::max);
            return (largest + SLACK).min(first);
        }
    }
    open.sort_by(|one, other| other.bound.total_cmp(&one.bound));
    for pair in open {
        if pair.bound <= search.largest {
            break;
        }
        if !search.go_through_exponents(&pair) {
            return (pair.bound + SLACK).min(first);
        }
    }
    (search.largest + SLACK).min(first)
}

impl PairSearch<'_> {
    /// Examines the pairs of operands with γ in bin `i` and dγ in bin `j`, for γ − dγ if `negative` is 1, and for γ + dγ if it
    /// is 0. Computes the error of a pair only at the exponent n that weighs its roundings most. Appends to `open` the pairs
    /// for which another n may give an error above the largest found before. Returns false if the steps run out.
    fn look_into(
        &mut self,
        i: usize,
        j: usize,
        negative: i64,
        open: &mut Vec<OperandPair>,
    ) -> bool {
        for bin in [i, j] {
            let cosines = self.cosines_of(bin);
            self.cosines.entry(bin).or_insert(cosines);
        }
        let cosines = std::mem::take(&mut self.cosines);
        let lowest = self.it.keys.cos_dgamma_domain().0;
        let (analysis, mut within) = (self.analysis, true);
        'pairs: for x in &cosines[&i] {
            for y in cosines[&j].iter().filter(|y| y.raw >= lowest) {
                let error = x.sine * y.error + (analysis.sine(j) + y.error) * x.error;
                if analysis.bound_of(i, j, negative == 1, error) <= self.largest {
                    // The cosines that follow have errors that are no larger.
                    break;
                }
                if self.steps == 0 {
                    within = false;
                    break 'pairs;
                }
                self.steps -= 1;
                open.extend(self.pair(x, y, negative));
            }
        }
        self.cosines = cosines;
        within
    }

    /// Returns the pair if its bound is larger than the largest error found so far. For such a pair, computes the error at the
    /// exponent with the largest weight, and updates the largest error.
    fn pair(&mut self, x: &RawCosine, y: &RawCosine, negative: i64) -> Option<OperandPair> {
        let (it, keys) = (self.it, &self.it.keys);
        let ulp = exp2(-(keys.operands.cosine.fraction as i32));
        let turned = if negative == 1 { x.sine * y.sine } else { -(x.sine * y.sine) };
        let exact = (x.raw as f64 * ulp) * (y.raw as f64 * ulp) + turned - 1.0;
        let sin_sin = it.sin_sin(it.sine.at(x.raw), it.sine.at(y.raw));
        let adder_15 = it.adder_15(it.cos_cos(x.raw, y.raw), sin_sin, negative) as f64;
        let distance = (adder_15 * exp2(-(keys.product_fraction as i32)) - exact).abs();
        let below = (-exact).max(0.0);
        let (least, most) = keys.domain.exponents();
        let n = (1.0 / below).clamp(least as f64, most as f64);
        let bound = self.analysis.rounded(weight(n, below) * distance);
        if bound <= self.largest {
            return None;
        }
        let control = [x.raw, y.raw, n as i64, negative];
        self.largest = self.largest.max(self.error(&control));
        Some(OperandPair { bound, control, distance, below })
    }

    /// Computes the error of `pair` for every n of the domain whose bound is above the largest error so far, and updates the
    /// largest error. Returns false if the steps run out.
    fn go_through_exponents(&mut self, pair: &OperandPair) -> bool {
        let (least, most) = self.it.keys.domain.exponents();
        let [x, y, _, negative] = pair.control;
        for n in (least..=most).rev() {
            let bound = self.analysis.rounded(weight(n as f64, pair.below) * pair.distance);
            if bound > self.largest {
                if self.steps == 0 {
                    return false;
                }
                self.steps -= 1;
                self.largest = self.largest.max(self.error(&[x, y, n, negative]));
            }
        }
        true
    }

    fn error(&self, control: &[i64]) -> f64 {
        let f = self.it.f(control) as f64 * exp2(-(self.it.keys.f.fraction as i32));
        (f - self.it.reference(control)).abs()
    }

    /// Returns the cosines of the angles in a bin, and one or two more at each end, from the largest error of their sine to the
    /// smallest.
    fn cosines_of(&self, bin: usize) -> Vec<RawCosine> {
        let keys = &self.it.keys;
        let one = 1_i64 << keys.operands.cosine.fraction;
        let [first, last] = [bin + 1, bin].map(|edge| libm::cos(edge as f64 * BIN) * one as f64);
        let (low, high) = (first.floor() as i64 - 1, last.ceil() as i64 + 1);
        let unit = exp2(-(keys.sine_fraction as i32));
        let mut cosines: Vec<RawCosine> = Vec::new();
        for raw in low.max(0)..=high.min(keys.largest_cosine()) {
            let sine = ((one * one - raw * raw) as f64).sqrt() / one as f64;
            let error = (self.it.sine.at(raw) as f64 * unit - sine).abs() + F64;
            cosines.push(RawCosine { raw, sine, error });
        }
        cosines.sort_by(|one, other| other.error.total_cmp(&one.error));
        cosines
    }
}

/// Returns the weight n·b for the exponent `n`, if cos(γ ± dγ) is less than 1 by `below`.
fn weight(n: f64, below: f64) -> f64 {
    n * (1.0 - n * below / 2.0).max(0.0)
}

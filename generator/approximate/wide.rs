//! Proves a bound on the error of a piecewise polynomial by intervals, for domains with more than 2^26 operands.
//!
//! The proof treats the offset of an operand in its segment as a real number t, so that a word of the table is a polynomial P(t).
//! The hardware drops bits, and the proof bounds the difference of its result from P(t) for a whole segment. Within an interval,
//! the distance between the function and P is at most the distance in the middle, plus half of the length times the largest slope
//! of their difference. If this bound is too large, or if the function may have no derivative, the proof halves the interval,
//! down to four operands.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::{Curve, Piecewise, Refusal, RefusalKind, TargetFunction};
use glint_base::fixed::exp2;
use glint_base::interval::{self, Interval};
use glint_formula::Enclosure;

/// A proof examines at most this number of intervals.
const MOST: u64 = 1 << 20;

/// An interval with at most this number of operands is computed operand by operand.
const FEW: i64 = 4;

/// Limits over all operands of a segment.
pub(super) struct Walk {
    /// For each coefficient k, the partial sum that includes it and all higher ones, in units of the sum's last bit.
    pub sums: Vec<Interval>,
    /// P(t) minus the hardware's result, in units of the result's last bit. The difference arises from dropped bits.
    lag: Enclosure,
}

impl Piecewise {
    /// Returns the first and the last raw operand of the domain that read the word `word`.
    fn operands_of(&self, word: usize) -> Option<(i64, i64)> {
        let (from, count) = self.segments.numbers(word);
        let low = (self.origin + from as i64).max(self.domain.0);
        let high = (self.origin + (from + count - 1) as i64).min(self.domain.1);
        (low <= high).then_some((low, high))
    }

    /// Returns by how many fraction bits coefficient `k` exceeds the result.
    fn beyond(&self, k: usize) -> i32 {
        self.coefficients[k].frac - self.sums[0].frac
    }

    /// Returns the limits over all operands that read the word `word`, if there are any.
    pub(super) fn walk(&self, word: usize) -> Option<Walk> {
        let (low, high) = self.operands_of(word)?;
        let [a, b] = [low, high].map(|raw| self.place(raw).offset);
        let (low, high) = (a.min(b), a.max(b));
        let (rest, top) = (self.segments.rest(), self.degree());
        let exact = |k: usize| i128::from(self.words[word][k]);
        let way = self.way(low).hull(self.way(high));
        let mut sums = vec![(0, 0); top + 1];
        sums[top] = (exact(top), exact(top));
        let mut lag = Enclosure::exactly(0.0);
        for (k, step) in self.steps.iter().enumerate().rev() {
            let cut = rest - step.offset;
            let offsets = (i128::from(low >> cut), i128::from(high >> cut));
            let (least, most) = interval::product(sums[k + 1], offsets);
            sums[k] = (exact(k) + (least >> step.dropped), exact(k) + (most >> step.dropped));
            let (least, most) = sums[k + 1];
            let above = Enclosure::between((least as f64).next_down(), (most as f64).next_up())
                * Enclosure::exactly(exp2(-self.beyond(k + 1)));
            let cut_off = (exp2(cut as i32) - 1.0) * exp2(-(rest as i32));
            let dropped = exp2(-self.beyond(k)) * (1.0 - exp2(-(step.dropped as i32)));
            lag = lag * way
                + above * Enclosure::between(0.0, cut_off)
                + Enclosure::between(0.0, dropped);
        }
        let last = Enclosure::between(0.0, 1.0 - exp2(-self.beyond(0)));
        Some(Walk { sums, lag: lag + last })
    }

    /// Returns t for an offset: the distance from the middle of the segment, as a fraction of the segment's length.
    fn way(&self, offset: i64) -> Enclosure {
        Enclosure::exactly(offset as f64 * exp2(-(self.segments.rest() as i32)))
    }

    /// Returns the values of a word's polynomial over the interval `way` of t, and of its derivative, in units of the result's
    /// last bit.
    fn polynomial(&self, word: usize, way: Enclosure) -> (Enclosure, Enclosure) {
        let mut value = Enclosure::exactly(0.0);
        let mut slope = Enclosure::exactly(0.0);
        for (k, &raw) in self.words[word].iter().enumerate().rev() {
            let coefficient = Enclosure::exactly(raw as f64 * exp2(-self.beyond(k)));
            slope = slope * way + value;
            value = value * way + coefficient;
        }
        (value, slope)
    }

    /// Proves the bound of [`Piecewise::prove`] by intervals of operands. Fails if a sum does not fit its format, if an error is
    /// not below the allowed error, if the function has no value, or if the proof needs more than [`MOST`] intervals.
    pub(super) fn prove_by_segments(&self, function: &TargetFunction) -> Result<f64, Refusal> {
        let left = AtomicU64::new(MOST);
        let words = (0..self.words.len()).into_par_iter();
        let bounds = words.map(|word| self.prove_segment(function, word, &left));
        bounds.try_reduce(|| 0.0, |a, b| Ok(a.max(b)))
    }

    /// Returns a proved bound on the error over all operands that read the table word `word`, in units of the result's last bit;
    /// 0 if no operand reads it. `left` is the number of intervals that the proof of all words may still examine. Fails if a sum
    /// does not fit its format, if an error is not below `function.error`, if the function has no value, or if `left` reaches 0.
    fn prove_segment(
        &self,
        function: &TargetFunction,
        word: usize,
        left: &AtomicU64,
    ) -> Result<f64, Refusal> {
        let Some(walk) = self.walk(word) else { return Ok(0.0) };
        for (sum, format) in walk.sums.iter().zip(&self.sums).skip(1) {
            if !format.holds(sum.0) || !format.holds(sum.1) {
                let message = format!("a sum with the table word {word} does not fit {format}");
                return Err(Refusal::new(RefusalKind::ResultBits, message));
            }
        }
        let mut bound: f64 = 0.0;
        let mut open: Vec<(i64, i64)> = self.operands_of(word).into_iter().collect();
        while let Some((low, high)) = open.pop() {
            if left.fetch_sub(1, Ordering::Relaxed) <= 1 {
                left.store(0, Ordering::Relaxed);
                return Err(unproved());
            }
            if high - low < FEW {
                for raw in low..=high {
                    bound = bound.max(self.error_at(function, raw)?);
                }
                continue;
            }
            match self.error_between(function, word, (low, high), walk.lag) {
                Some(whole) if whole < function.error => bound = bound.max(whole),
                _ => {
                    let middle = low + (high - low) / 2;
                    open.extend([(low, middle), (middle + 1, high)]);
                }
            }
        }
        Ok(bound)
    }

    /// Returns a bound on the error over the raw operands from `low` to `high`, which must all read the word `word`. `lag` has
    /// the limits of the dropped bits. Returns `None` if the formula may jump between these operands, or may have no value or no
    /// derivative there. It is also `None` if a result may not fit its format, and for a curve through samples.
    fn error_between(
        &self,
        function: &TargetFunction,
        word: usize,
        (low, high): (i64, i64),
        lag: Enclosure,
    ) -> Option<f64> {
        let Curve::Formula(formula) = &function.curve else { return None };
        let middle = low + (high - low) / 2;
        let [from, to] = [low, high].map(|raw| self.operand.to_f64(raw.into()));
        let (_, slope) = formula.slope("x", Enclosure::between(from, to)).ok()?;
        let [first, here, last] = [low, middle, high].map(|raw| self.place(raw).offset);
        let (value, _) = self.polynomial(word, self.way(here));
        let (_, lean) =
            self.polynomial(word, self.way(first.min(last)).hull(self.way(first.max(last))));
        // The change of the offset from an operand to the next one.
        let step = (last - first) / (high - low).max(1);
        let lean = lean * self.way(step);
        let unit = exp2(function.fraction as i32 - self.operand.frac);
        let reach = Enclosure::between((low - middle) as f64, (high - middle) as f64);
        let apart = function.limits(middle).ok()? - value
            + (slope * Enclosure::exactly(unit) - lean) * reach;
        let error = apart + lag;
        let results = value + lean * reach - lag;
        let format = self.sums[0];
        let inside = results.low > format.min_raw() as f64 - 1.0
            && results.high < format.max_raw() as f64 + 1.0;
        inside.then_some(error.low.abs().max(error.high.abs()))
    }
}

fn unproved() -> Refusal {
    let message = format!("the bound cannot be proved with 2^{} intervals", MOST.ilog2());
    Refusal::new(RefusalKind::Unproved, message)
}

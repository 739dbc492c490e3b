//! Computes the lowest and the highest result within the allowed error, for each operand that a search evaluates: 10 and 11 for
//! the value 10.3 with an allowed error of 1.0.

use rayon::prelude::*;

use super::{Numbering, Reduction, Refusal, RefusalKind, TargetFunction};
use glint_base::fixed::{Format, exp2, nearest};

/// The search evaluates at most this number of operands; it takes evenly spaced ones of a larger domain.
const HELD: u64 = 1 << 25;

/// This limit replaces [`HELD`] if the domain is too large for a proof operand by operand.
const HELD_OF_MANY: u64 = 1 << 18;

/// The number of operands in one parallel step.
const BLOCK: usize = 1 << 16;

/// The allowed results at the operands that the search evaluates.
pub(super) struct AllowedResults<'f> {
    pub(super) function: &'f TargetFunction,
    pub(super) origin: i64,
    pub(super) bits: u32,
    /// The number of operands whose numbers are 2^`bits` or larger.
    pub(super) overhang: u64,
    /// The distance between two operands that the search evaluates.
    pub(super) stride: i64,
    /// The lowest and the highest allowed raw value of the polynomial for each of these operands.
    pub(super) right: Vec<(i64, i64)>,
    /// The format of the polynomial's value.
    pub(super) result: Format,
    /// The function on the large domain, its range reduction, and the format of its results.
    pub(super) whole: Option<(&'f TargetFunction, &'f Reduction, Format)>,
}

struct Nearest {
    right: Vec<(i64, i64)>,
    nearest: (i64, i64),
}

impl Default for Nearest {
    fn default() -> Self {
        Self { right: Vec::new(), nearest: (i64::MAX, i64::MIN) }
    }
}

impl Nearest {
    fn with(mut self, it: Result<(i64, i64, i64), Refusal>) -> Result<Self, Refusal> {
        let (nearest, low, high) = it?;
        self.right.push((low, high));
        self.nearest = (self.nearest.0.min(nearest), self.nearest.1.max(nearest));
        Ok(self)
    }

    fn and(mut self, mut other: Self) -> Self {
        self.right.append(&mut other.right);
        let (low, high) = other.nearest;
        Self { nearest: (self.nearest.0.min(low), self.nearest.1.max(high)), ..self }
    }
}

impl TargetFunction {
    /// Returns the result nearest to the exact value, the lowest and the highest allowed result. The allowed error is reduced by
    /// the margin `stricter`. The lowest result exceeds the highest if no result is allowed. Fails if the function has no value
    /// at the operand, or if the result needs more than 48 bits.
    fn right(&self, raw: i64, stricter: f64) -> Result<(i64, i64, i64), Refusal> {
        let limits = self.limits(raw).map_err(|fault| self.refusal(raw, &fault))?;
        if limits.low.abs().max(limits.high.abs()) > exp2(48) {
            let message = format!("at the raw operand {raw}, the result has more than 48 bits");
            return Err(Refusal::new(RefusalKind::ResultBits, message));
        }
        let error = self.error - stricter;
        let nearest = nearest(limits.middle()) as i64;
        // Subtracts two roundings: these results are nearer than the error for every exact value within the limits, whatever the
        // proof's rounding of the difference adds.
        let low = (limits.high - error).next_up().next_up().floor() as i64 + 1;
        let high = (limits.low + error).next_down().next_down().ceil() as i64 - 1;
        Ok((nearest, low, high))
    }
}

impl<'f> AllowedResults<'f> {
    /// Evaluates the function. Returns `None` if an operand has no allowed result. If the search does not evaluate every operand,
    /// the allowed error is reduced by the margin `stricter`. Fails if the function has no value at an operand, or if a result
    /// needs more than 48 bits.
    pub(super) fn new(
        function: &'f TargetFunction,
        stricter: f64,
        numbering: Numbering,
    ) -> Result<Option<Self>, Refusal> {
        let (first, last) = function.domain;
        let Numbering { origin, bits, overhang } = numbering;
        let count = (last - first) as u64 + 1;
        let held = if function.is_wide() { HELD_OF_MANY } else { HELD };
        // An odd stride lets the low bits of the operands take every value.
        let stride = if count > held { count.div_ceil(held) as i64 | 1 } else { 1 };
        let stricter = if stride > 1 { stricter } else { 0.0 };
        let seen = count.div_ceil(stride as u64) + u64::from(stride > 1);
        let results = (0..seen).into_par_iter().map(|at| {
            let raw = (first + at as i64 * stride).min(last);
            function.right(raw, stricter)
        });
        let parts = results.try_fold(Nearest::default, Nearest::with);
        let all = parts.try_reduce(Nearest::default, |a, b| Ok(a.and(b)))?;
        let (low, high) = all.nearest;
        let result = Format::holding(low.into(), high.into(), function.fraction as i32);
        let (least, most) = (result.min_raw() as i64, result.max_raw() as i64);
        let mut right = all.right;
        for (low, high) in &mut right {
            *low = (*low).max(least);
            *high = (*high).min(most);
            if low > high {
                return Ok(None);
            }
        }
        Ok(Some(Self { function, origin, bits, overhang, stride, right, result, whole: None }))
    }

    /// Computes the allowed values of the polynomial behind a range reduction, which approximates `inner`. Several operands of
    /// `whole` may be reduced to the same number; a value must then be allowed for all of them. Returns `None` if a number has no
    /// allowed value. Fails if a function has no value at an operand, or if a result needs more than 48 bits.
    pub(super) fn reduced(
        whole: &'f TargetFunction,
        reduction: &'f Reduction,
        inner: &'f TargetFunction,
        numbering: Numbering,
    ) -> Result<Option<Self>, Refusal> {
        let Some(mut seen) = Self::new(inner, 0.0, numbering)? else { return Ok(None) };
        let all = (seen.result.min_raw() as i64, seen.result.max_raw() as i64);
        seen.right.fill(all);
        let (first, last) = whole.domain;
        let nearest = (first..=last).into_par_iter().map(|raw| whole.right(raw, 0.0));
        let ends = nearest.map(|it| it.map(|(nearest, ..)| (nearest, nearest)));
        let (low, high) =
            ends.try_reduce(|| (i64::MAX, i64::MIN), |a, b| Ok((a.0.min(b.0), a.1.max(b.1))))?;
        let result = Format::holding(low.into(), high.into(), whole.fraction as i32);
        let (least, most) = (result.min_raw() as i64, result.max_raw() as i64);
        for from in (first..=last).step_by(BLOCK) {
            let block = from..=last.min(from + BLOCK as i64 - 1);
            let polynomials = block.into_par_iter().map(|raw| {
                let (_, low, high) = whole.right(raw, 0.0)?;
                let (number, restore) = reduction.reduce(raw);
                Ok((number as usize, restore.polynomials((low.max(least), high.min(most)))))
            });
            let polynomials: Vec<_> = polynomials.collect::<Result<_, Refusal>>()?;
            for (number, (low, high)) in polynomials {
                let right = &mut seen.right[number];
                *right = (right.0.max(low), right.1.min(high));
                if right.0 > right.1 {
                    return Ok(None);
                }
            }
        }
        seen.whole = Some((whole, reduction, result));
        Ok(Some(seen))
    }

    /// Returns about `most` evenly spaced operands of this list, always fewer than twice as many.
    pub(super) fn thinned(&self, most: usize) -> Self {
        // An odd stride lets the low bits of the operands take every value.
        let by = if self.right.len() > most { (self.right.len() / most) | 1 } else { 1 };
        let last = self.right.last().filter(|_| by > 1);
        let right = self.right.iter().step_by(by).chain(last).copied().collect();
        Self { stride: self.stride * by as i64, right, ..*self }
    }

    pub(super) fn raw(&self, seen: usize) -> i64 {
        let (first, last) = self.function.domain;
        (first + seen as i64 * self.stride).min(last)
    }

    pub(super) fn number(&self, raw: i64) -> u64 {
        (raw - self.origin) as u64
    }

    /// Returns how many operands that the search evaluates are below `raw`.
    pub(super) fn seen_below(&self, raw: i64) -> usize {
        let (first, _) = self.function.domain;
        ((raw - first) as u64).div_ceil(self.stride as u64) as usize
    }
}

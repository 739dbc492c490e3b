//! Rewrites a quotient a / b as a product with a reciprocal from a table, so that no divider is needed.
//!
//! If the divisor has few bits, and its largest absolute value is less than four times its smallest, a table has the values of
//! 1/b. Any other divisor is normalised: b = m · 2^−k with m from 1/2 to below 1. A table has the values of 1/m, and the
//! dividend is shifted by the same k bits, so that a / b = (a · 2^k) · (1/m).
//!
//! If several dividends have the same divisor, and the reciprocal 1/b needs few bits, it is computed once, and each dividend has only a
//! product: a softmax of eight numbers shifts one reciprocal in place of eight dividends. For a divisor that is a root, one dividend is
//! enough: a / sqrt(x) is a · (1 / sqrt(x)), which reads one table in place of two.

use std::sync::Arc;

use glint_base::fixed::{Format, Rounding, exp2};
use glint_formula::{Enclosure, Expression, Function, Kind, Operator};

use super::root::{FEW_OCTAVES, Octave, holding};
use super::shape::number;
use super::{Lowering, WIDEST_FACTOR, WIDEST_OPERAND};
use crate::facts::promises_less;
use crate::node::NodeId;
use crate::refusal::PlanRefusal;
use crate::statement::ExpressionStatement;

/// The widest reciprocal that is computed once for several dividends, in bits, with the guard bits that a product needs at least.
const WIDEST_RECIPROCAL: f64 = 20.0;

/// Returns the different quotients in the formulas of a statement.
fn quotients_of(statement: &ExpressionStatement) -> Vec<Expression> {
    let mut quotients: Vec<Expression> = Vec::new();
    for result in &statement.results {
        result.formula.walk(&mut |part| {
            if matches!(part.kind, Kind::Binary(Operator::Div, ..)) && !quotients.contains(part) {
                quotients.push(part.clone());
            }
        });
    }
    quotients
}

/// Returns a number of quotients by the same divisor from which on one reciprocal for all may take fewer look-up tables: 1 if a divisor
/// is a root or an exponential, whose reciprocal is as easy to compute, and 2 if two quotients have the same divisor. Returns `None`
/// without such quotients.
pub(crate) fn fewest_dividends(statement: &ExpressionStatement) -> Option<usize> {
    let mut divisors: Vec<(Expression, usize)> = Vec::new();
    for quotient in quotients_of(statement) {
        let Kind::Binary(_, dividend, divisor) = &quotient.kind else { continue };
        if !dividend.varies() || !divisor.varies() {
            continue;
        }
        match divisors.iter_mut().find(|(known, _)| *known == **divisor) {
            Some((_, count)) => *count += 1,
            None => divisors.push(((**divisor).clone(), 1)),
        }
    }
    let has_easy_reciprocal = |divisor: &Expression| {
        let is_function =
            matches!(divisor.kind, Kind::Unary(Function::Sqrt | Function::Exp | Function::Exp2, _));
        is_function || matches!(divisor.kind, Kind::Binary(Operator::Power, ..))
    };
    if divisors.iter().any(|(divisor, _)| has_easy_reciprocal(divisor)) {
        return Some(1);
    }
    divisors.iter().any(|(_, count)| *count == 2).then_some(2)
}

impl Lowering<'_> {
    /// Returns the node of the quotient a / b. `part` must be this quotient as a formula. Fails if a part has too many bits, no
    /// finite values, or no rule. For example, a divisor that may be 0 gives no finite values.
    pub(super) fn quotient(
        &mut self,
        a: &Expression,
        b: &Expression,
        part: &Expression,
    ) -> Result<NodeId, PlanRefusal> {
        if let Some(quotients) = self.quotients_by(a, b)? {
            let one = Arc::new(number("1"));
            let kind = Kind::Binary(Operator::Div, one, Arc::new(b.clone()));
            let reciprocal = Expression::new(kind, part.span.clone());
            // All results with such a quotient share the reciprocal.
            let outer = self.uses.clone();
            self.add_readers_of(&quotients.iter().collect::<Vec<_>>());
            let reciprocal = self.part(&reciprocal);
            self.uses = outer;
            let dividend = self.factor(a)?;
            return self.plan.multiply("ratio", dividend, reciprocal?);
        }
        let values = self.range(part)?;
        self.quotient_within(a, b, values)
    }

    /// Returns all quotients with the divisor `b`, if the reciprocal of `b` is to be computed once: there are several, and the reciprocal
    /// needs few bits for the dividend `a`. Otherwise returns `None`. Fails if a or b has no finite values.
    fn quotients_by(
        &self,
        a: &Expression,
        b: &Expression,
    ) -> Result<Option<Vec<Expression>>, PlanRefusal> {
        if !a.varies() || self.fixed_guard.is_some() {
            return Ok(None);
        }
        let mut quotients = quotients_of(self.statement);
        quotients.retain(
            |quotient| matches!(&quotient.kind, Kind::Binary(_, _, divisor) if **divisor == *b),
        );
        if quotients.len() < self.guards.style.fewest_dividends {
            return Ok(None);
        }
        let largest_dividend = sizes_of(self.range(a)?).high;
        let smallest_divisor = sizes_of(self.range(b)?).low;
        let bits = f64::from(self.finest) + 2.0 + (largest_dividend / smallest_divisor).log2();
        Ok((bits <= WIDEST_RECIPROCAL).then_some(quotients))
    }

    /// Returns the node of the quotient a / b, whose values lie within `values`. Fails as [`Self::quotient`] does.
    pub(super) fn quotient_within(
        &mut self,
        a: &Expression,
        b: &Expression,
        values: Enclosure,
    ) -> Result<NodeId, PlanRefusal> {
        let dividend = self.part(a)?;
        let divisor = self.part(b)?;
        let divisors = self.range(b)?;
        let largest = match self.is_proper(a, b) {
            true => 1.0,
            false => values.low.abs().max(values.high.abs()),
        };
        let size = self.plan.absolute("divisor_size", divisor)?;
        let sizes = sizes_of(divisors);
        let is_short = self.plan.node(size).format.width() <= WIDEST_OPERAND;
        let quotient = if is_short && sizes.high < sizes.low * FEW_OCTAVES {
            let inverse = self.function("inverse", size, &number("1 / x"), sizes)?;
            let dividend = self.factor(a)?;
            self.plan.multiply("ratio", dividend, inverse)?
        } else {
            let octave = self.octave(size, sizes, false)?;
            self.ratio_in_octave(dividend, &octave, largest, false)?
        };
        if divisors.low >= 0.0 {
            return Ok(quotient);
        }
        let frac = self.plan.node(divisor).format.frac;
        let zero = self.plan.constant("zero", 0, frac)?;
        let is_negative = self.plan.less("divisor_is_negative", divisor, zero)?;
        let negated = self.plan.negate("quotient_negated", quotient)?;
        self.plan.choose("quotient", is_negative, [quotient, negated])
    }

    /// Returns whether every result of the statement is promised only for a < b, and a is never below 0. The quotient a / b is
    /// then at most 1.
    fn is_proper(&self, a: &Expression, b: &Expression) -> bool {
        let is_not_negative = self.range(a).is_ok_and(|values| values.low >= 0.0);
        let mut results = self.statement.results.iter();
        is_not_negative && results.all(|result| promises_less(self.statement, result, a, b))
    }

    /// Returns the node of a dividend divided by a divisor, which is given as a normalised word in `octave`. `largest` must be
    /// the largest absolute value of the quotient. `is_never_larger` must say whether the hardware's dividend is never larger
    /// than its divisor. Fails if a node has too many bits, or if the reciprocal is not finite on the domain of the word.
    pub(super) fn ratio_in_octave(
        &mut self,
        dividend: NodeId,
        octave: &Octave,
        largest: f64,
        is_never_larger: bool,
    ) -> Result<NodeId, PlanRefusal> {
        let reciprocal = number("1 / x");
        let finest = self.finest;
        let inverse = self.rounding(finest + 2, |own, frac| {
            own.approximation("inverse", octave.mantissa, &reciprocal, octave.domain, frac)
        })?;
        let frac = self.plan.node(dividend).format.frac;
        let is_signed = self.plan.node(dividend).range.0 < 0;
        let is_exact = self.is_exact(dividend) && self.is_exact(octave.word);
        let fits_below = is_never_larger || is_exact && largest <= 1.0;
        let format = if fits_below {
            // The shifted divisor is below 2^exponent, and the shifted dividend is not larger than it.
            let above = exp2(octave.exponent + frac) as i128;
            Format::holding(if is_signed { 1 - above } else { 0 }, above - 1, frac)
        } else {
            // The dividend is at most the largest quotient times the divisor. If a value was rounded, the divisor may have been
            // larger; the proof then shows that one more bit is enough.
            let most = largest * exp2(octave.exponent) * if is_exact { 1.0 } else { 2.0 };
            holding(Enclosure::between(if is_signed { -most } else { 0.0 }, most), frac)
        };
        let limits = Enclosure::between(
            format.to_f64(if is_signed { format.min_raw() } else { 0 }),
            format.to_f64(format.max_raw()),
        );
        // The limits of a format of many bits are rounded up to numbers that need one bit more.
        let is_rounded = format.width() > f64::MANTISSA_DIGITS;
        let format = Format { int: format.int + i32::from(is_rounded), ..format };
        let shifted = self.plan.shift_left("dividend_shifted", dividend, octave.places, format)?;
        if is_exact {
            self.plan.nodes[shifted.0].limits = limits;
        }
        if is_never_larger {
            self.plan.nodes[shifted.0].actual_limits = limits;
        }
        // The dividend is as large as the quotient, up to the weight of the divisor's octave.
        let value_bits = self.fixed_guard.map_or(0, |fixed| fixed.value_bits);
        let shifted = self.rounding(finest - octave.exponent - value_bits, |own, frac| {
            if own.plan.node(shifted).format.width() <= WIDEST_FACTOR {
                return Ok(shifted);
            }
            own.plan.shorten("dividend_shortened", shifted, frac, Rounding::Nearest)
        })?;
        let product = self.plan.multiply("ratio", shifted, inverse)?;
        let ratio = self.plan.scale("ratio_scaled", product, -octave.exponent)?;
        self.plan.nodes[ratio.0].limits =
            Enclosure::between(if is_signed { -largest } else { 0.0 }, largest);
        Ok(ratio)
    }
}

/// Returns limits of the absolute values of values within limits. For example, values from −3 to −1 have absolute values from 1
/// to 3.
fn sizes_of(values: Enclosure) -> Enclosure {
    let (low, high) = (values.low.abs(), values.high.abs());
    let has_both_signs = values.low < 0.0 && values.high > 0.0;
    let least = if has_both_signs { 0.0 } else { low.min(high) };
    Enclosure::between(least, low.max(high))
}

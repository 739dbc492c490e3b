//! Rewrites a quotient or a square root of exact numbers so that the result is the nearest value, with an error of at most half a
//! unit.
//!
//! An estimate with an error of at most a quarter of a unit, plus a quarter, rounded down, is the nearest value or the value below
//! it. The exact difference of the operand and the square of this estimate decides which. A quotient is rounded by an integer
//! division ([`super::division`]): the nearest integer to a / b is floor((a + b / 2) / b).

use std::sync::Arc;

use glint_base::fixed::{Format, Rounding, exp2};
use glint_formula::{Comparison, Enclosure, Expression, Function, Kind, Operator, TextSpan};

use super::rational::{QuotientParts, rational_quotient};
use super::shape::number;
use super::{FixedGuard, Lowering};
use crate::facts::is_polynomial;
use crate::node::{NodeId, Operation, PlanNode, ValueAccuracy};
use crate::refusal::PlanRefusal;

/// The largest error of the estimate of a root, in units of the result.
const LARGEST_ERROR: f64 = 0.25;

/// The fraction bits beyond the result's that the estimate of a root has at least, and the most that are tried.
const GUARD_BITS: std::ops::RangeInclusive<i32> = 2..=8;

/// The integer bits of a root that its guard bits include.
const FEW_BITS: i32 = 2;

/// The largest power of two by which a formula is multiplied at once.
const LARGEST_SHIFT: i32 = 30;

/// Returns whether a formula has sums, products, remainders, absolute values and choices alone, so that its value can be exact.
pub(super) fn has_no_function(formula: &Expression) -> bool {
    let is_function = |kind: &Kind| match kind {
        Kind::Unary(function, _) => !matches!(function, Function::Negate | Function::Abs),
        Kind::Binary(operator, _, exponent) => match operator {
            Operator::Power => exponent.varies(),
            Operator::Div => exponent.varies(),
            Operator::Atan2 => true,
            _ => false,
        },
        _ => false,
    };
    !formula.has(&is_function)
}

impl Lowering<'_> {
    /// Returns the node of `formula`, rounded to the nearest value with `frac` fraction bits. Returns `None` unless `formula` is a
    /// quotient with a divisor that is not 0, or a square root, of exact numbers, or a choice with such a case.
    ///
    /// # Errors
    /// Fails if a part has too many bits or no finite values, or if no estimate is near enough.
    pub(super) fn nearest(
        &mut self,
        formula: &Expression,
        frac: i32,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        if let Kind::If(comparison, yes, no) = &formula.kind {
            return self.nearest_choice(comparison, yes, no, frac);
        }
        let integer = if let Kind::Unary(Function::Sqrt, square) = &formula.kind
            && is_polynomial(self.statement, square)
        {
            self.nearest_root(formula, square, frac)?
        } else if let Some(QuotientParts { dividend, divisor }) = rational_quotient(formula)
            && has_no_function(&dividend)
            && has_no_function(&divisor)
            && self.are_exact([&dividend, &divisor])?
            && let Some(quotient) = self.with_positive_divisor(QuotientParts { dividend, divisor })
        {
            self.nearest_quotient(&quotient.dividend, &quotient.divisor, frac, &formula.span)?
        } else {
            return Ok(None);
        };
        let whole = self.plan.node(integer).clone();
        let format = Format { int: whole.format.int - frac, frac, ..whole.format };
        let stated = Some(self.stated(formula, &self.uses, ValueAccuracy::Nearest));
        let node = PlanNode { name: "nearest".to_owned(), format, stated, ..whole };
        Ok(Some(self.plan.push_copy(&node, Operation::Scale(integer))))
    }

    /// Returns the node of a choice with cases that are rounded to the nearest value with `frac` fraction bits. Returns `None` if the
    /// compared numbers are rounded, or if a case is neither such a value nor exact. Fails as [`Self::nearest`] does.
    fn nearest_choice(
        &mut self,
        comparison: &Comparison,
        yes: &Expression,
        no: &Expression,
        frac: i32,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        if let Some(outcome) = self.decided(comparison) {
            return self.nearest_case(if outcome { yes } else { no }, frac);
        }
        if let Some(comparison) = self.without_quotients(comparison) {
            return self.nearest_choice(&comparison, yes, no, frac);
        }
        if !has_no_function(&comparison.left) || !has_no_function(&comparison.right) {
            return Ok(None);
        }
        let compared = self.compared(comparison)?;
        if !compared.is_exact {
            return Ok(None);
        }
        let yes = self.under(comparison, true, |own| own.nearest_case(yes, frac))?;
        let no = self.under(comparison, false, |own| own.nearest_case(no, frac))?;
        match (yes, no) {
            (Some(yes), Some(no)) => Ok(Some(self.chosen(&compared, [yes, no])?)),
            _ => Ok(None),
        }
    }

    /// Returns the node of a case of a choice: a value that is rounded to the nearest one, or an exact value with at most `frac`
    /// fraction bits. Returns `None` for another case. Fails as [`Self::nearest`] does.
    fn nearest_case(
        &mut self,
        case: &Expression,
        frac: i32,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        if let Some(node) = self.nearest(case, frac)? {
            return Ok(Some(node));
        }
        if !has_no_function(case) {
            return Ok(None);
        }
        let node = self.part(case)?;
        let is_kept = self.is_exact(node) && self.plan.node(node).format.frac <= frac;
        Ok(is_kept.then_some(node))
    }

    /// Returns whether no part is rounded. Fails if a part has too many bits.
    fn are_exact(&mut self, parts: [&Expression; 2]) -> Result<bool, PlanRefusal> {
        for part in parts {
            let node = self.part(part)?;
            if !self.is_exact(node) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Returns the node of the nearest integer to a / b · 2^`frac`. Fails if a node has too many bits.
    fn nearest_quotient(
        &mut self,
        a: &Expression,
        b: &Expression,
        frac: i32,
        span: &TextSpan,
    ) -> Result<NodeId, PlanRefusal> {
        let binary = |operator, a: &Expression, b: &Expression| {
            let kind = Kind::Binary(operator, Arc::new(a.clone()), Arc::new(b.clone()));
            Expression::new(kind, span.clone())
        };
        let mut shifted = a.clone();
        let mut left = frac;
        while left > 0 {
            let places = left.min(LARGEST_SHIFT);
            shifted = binary(Operator::Mul, &shifted, &number(&exp2(places).to_string()));
            left -= places;
        }
        let half = binary(Operator::Mul, b, &number("0.5"));
        let dividend = binary(Operator::Add, &shifted, &half);
        let [whole, _] = self.whole_quotient(&dividend, b, span)?;
        Ok(whole)
    }

    /// Returns the node of the nearest integer n to √s · 2^`frac`. `root` must be the formula √s. Let m be the estimate, which is n
    /// or n − 1. The nearest integer is m + 1 if s · 4^`frac` is at least (m + 1/2)² = m² + m + 1/4. Fails if a node has too many
    /// bits.
    fn nearest_root(
        &mut self,
        root: &Expression,
        square: &Expression,
        frac: i32,
    ) -> Result<NodeId, PlanRefusal> {
        let most = (self.range(root)?.high * exp2(frac)).floor() as i128 + 1;
        let estimate = self.estimated_root(root, frac)?;
        let scaled = self.plan.scale("root_estimate", estimate, frac)?;
        let quarter = self.plan.constant("quarter", 1, 2)?;
        let above = self.plan.add("root_above", scaled, quarter)?;
        let floor = self.plan.shorten("root_floor", above, 0, Rounding::Truncate)?;
        let integers = Format::holding(0, most, 0);
        let first = self.plan.narrow("root_first", floor, integers, Rounding::Truncate)?;
        let one = self.plan.constant("one", 1, 0)?;
        let next = self.plan.add("root_next", first, one)?;
        let product = self.plan.multiply("root_times_next", first, next)?;
        let operand = self.part(square)?;
        let operand = self.plan.scale("square_scaled", operand, 2 * frac)?;
        let rest = self.plan.subtract("root_rest", operand, product)?;
        // The estimate is at most one below the nearest integer, and at most half a unit above the root.
        let limit = 2.0 * (most as f64 + 2.0);
        let rest =
            self.plan.limited("root_rest_limited", rest, Enclosure::between(-limit, limit))?;
        let is_nearest = self.plan.less("root_is_nearest", rest, quarter)?;
        let nearest = self.plan.choose("nearest_root", is_nearest, [next, first])?;
        self.plan.narrow("nearest_root_within", nearest, integers, Rounding::Truncate)
    }

    /// Returns the node of an estimate of `root` with an error of at most a quarter of 2^−`frac`, for all results that read the part
    /// that is being rewritten. Fails if no number of guard bits shows this, or if a node has too many bits.
    fn estimated_root(&mut self, root: &Expression, frac: i32) -> Result<NodeId, PlanRefusal> {
        // A factor of a large root needs as many bits more as the root has integer bits.
        let bits = (self.range(root)?.high + 1.0).log2().ceil() as i32;
        let value_bits = if bits <= FEW_BITS { 0 } else { bits };
        for guard in GUARD_BITS {
            let fixed = FixedGuard { guard: frac + guard - self.finest, value_bits };
            let before = self.fixed_guard.replace(fixed);
            let estimate = self.new_part(root);
            self.fixed_guard = before;
            let estimate = estimate?;
            let unit = exp2(frac - self.plan.node(estimate).format.frac);
            let errors = self.errors_by_result(estimate);
            let mut readers = self.uses.readers.iter().zip(&errors).filter(|(reads, _)| **reads);
            if readers.all(|(_, units)| *units * unit <= LARGEST_ERROR) {
                return Ok(estimate);
            }
        }
        Err(PlanRefusal::new(
            "Glint finds no estimate of this root with an error below a quarter of a unit",
            "give the operands fewer bits, or allow a larger error",
        ))
    }
}

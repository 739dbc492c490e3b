//! Rewrites a quotient or a square root of exact numbers so that the result is the nearest value, with an error of at most half a
//! unit.
//!
//! A root is rounded by [`super::whole_root`]. A quotient is rounded by an integer division ([`super::division`]): the nearest integer
//! to a / b is floor((a + b / 2) / b).

use std::sync::Arc;

use glint_base::fixed::{Format, exp2};
use glint_formula::{Comparison, Expression, Function, Kind, Operator, TextSpan};

use super::Lowering;
use super::rational::{QuotientParts, rational_quotient};
use super::shape::{has_no_function, number};
use super::whole_root::RootRounding;
use crate::node::{NodeId, Operation, PlanNode, ValueAccuracy};
use crate::refusal::PlanRefusal;

/// The largest power of two by which a formula is multiplied at once.
const LARGEST_SHIFT: i32 = 30;

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
            && let Some(exact) = self.exact_root(square)?
        {
            self.rounded_root(formula, &exact, frac, RootRounding::Nearest)?
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

    /// Returns the node of a choice with cases that are rounded to the nearest value with `frac` fraction bits. Returns `None` if
    /// the compared numbers are rounded, or if a case is neither such a value nor exact. Fails if a part has too many bits or no
    /// finite values, or if no estimate is near enough.
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
    /// fraction bits. Returns `None` for another case. Fails if a part has too many bits or no finite values, or if no estimate
    /// is near enough.
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
}

//! Rewrites a square root of an exact number so that its value, rounded down, up or to the nearest value, is exact. For example,
//! floor(√7) is 2.
//!
//! An estimate with an error of at most a quarter of a unit, plus a quarter, rounded down, is the integer part of the root or the
//! integer above it. The exact difference of the operand and the square of this integer decides which.

use glint_base::fixed::{Format, Rounding, exp2};
use glint_formula::{Enclosure, Expression, Function, Kind, Operator, RBig};

use super::rational::{OverNumber, over_number, times};
use super::shape::{has_no_function, modulus_exponent, number};
use super::{FixedGuard, Lowering};
use crate::node::{NodeId, Operation, PlanNode, ValueAccuracy};
use crate::refusal::PlanRefusal;

/// The largest error of the estimate of a root, in units of the result.
const LARGEST_ERROR: f64 = 0.25;

/// The least and the most guard bits with which the estimate of a root is tried: its fraction bits beyond the result's.
const GUARD_BITS: std::ops::RangeInclusive<i32> = 2..=8;

/// The integer bits of a root for which the factors of the estimate need no further bits.
const FEW_BITS: i32 = 2;

/// The direction in which a root is rounded to an integer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum RootRounding {
    /// The greatest integer that is not above the root.
    Down,
    /// The nearest integer; a half is rounded up.
    Nearest,
    /// The smallest integer that is not below the root.
    Up,
}

/// A square root that is rounded to a multiple of a power of two.
pub(super) struct WholeRoot {
    /// The number whose root it is.
    square: Expression,
    rounding: RootRounding,
    /// Whether the result is minus the rounded root.
    is_negated: bool,
    /// The result is a multiple of 2^−`frac`.
    frac: i32,
}

impl WholeRoot {
    /// Returns the root in a difference `a - b`, if `b` is the remainder of `a` by a power of two, and `a` a constant times a root:
    /// `floor(u)` is `u - u % 1`. For `a` below 0, the difference is minus a root that is rounded up. `round(u)` is the floor of
    /// u + 1/2. Returns `None` for another difference.
    pub(super) fn of_difference(a: &Expression, b: &Expression) -> Option<Self> {
        let Kind::Binary(Operator::Mod, of, modulus) = &b.kind else { return None };
        let exponent = modulus_exponent(modulus).filter(|_| **of == *a)?;
        if let Kind::Binary(Operator::Add, root, half) = &a.kind
            && exponent == 0
            && *half.as_ref() == number("1/2")
        {
            let (square, is_negated) = scaled_square(root)?;
            let rounding = RootRounding::Nearest;
            return (!is_negated).then_some(Self { square, rounding, is_negated, frac: 0 });
        }
        let (square, is_negated) = scaled_square(a)?;
        let rounding = if is_negated { RootRounding::Up } else { RootRounding::Down };
        Some(Self { square, rounding, is_negated, frac: -exponent })
    }
}

/// Returns whether a formula is a root that is rounded to a multiple of a power of two, of a number that can be exact.
pub(super) fn is_whole_root(formula: &Expression) -> bool {
    let Kind::Binary(Operator::Sub, a, b) = &formula.kind else { return false };
    let root = WholeRoot::of_difference(a, b);
    root.is_some_and(|root| has_no_function(&root.square) && over_number(&root.square).is_some())
}

/// Writes a constant times a square root as a root with a sign: `-2 * sqrt(x)` gives `4 * x`, and true because the root is
/// negated. Returns `None` for another formula, and for the constant 0.
fn scaled_square(formula: &Expression) -> Option<(Expression, bool)> {
    let scaled = |root: &Expression, factor: RBig| {
        let (square, is_negated) = scaled_square(root)?;
        let is_zero = factor == RBig::ZERO;
        let is_negated = is_negated != (factor < RBig::ZERO);
        (!is_zero).then(|| (times(&square, &(factor.clone() * factor)), is_negated))
    };
    match &formula.kind {
        Kind::Unary(Function::Sqrt, square) => Some(((**square).clone(), false)),
        Kind::Unary(Function::Negate, root) => scaled(root, -RBig::ONE),
        Kind::Binary(Operator::Mul, root, factor) | Kind::Binary(Operator::Mul, factor, root)
            if !factor.varies() =>
        {
            scaled(root, factor.rational()?)
        }
        Kind::Binary(Operator::Div, root, divisor) if !divisor.varies() => {
            let divisor = divisor.rational().filter(|divisor| *divisor != RBig::ZERO)?;
            scaled(root, RBig::ONE / divisor)
        }
        _ => None,
    }
}

/// The root of an exact number, divided by an odd number: √(dividend / divisor).
pub(super) struct ExactRoot {
    dividend: Expression,
    divisor: RBig,
}

impl Lowering<'_> {
    /// Writes `square`, the operand of a root, as dividend / divisor with constants that are exact in binary, and adds the nodes
    /// of the dividend: `x / 3` has the dividend x and the divisor 3. Returns `None` for a formula that has no such form, or if
    /// the plan rounds the dividend, because the root could then not be rounded exactly. Fails if a part has too many bits.
    pub(super) fn exact_root(
        &mut self,
        square: &Expression,
    ) -> Result<Option<ExactRoot>, PlanRefusal> {
        if !has_no_function(square) {
            return Ok(None);
        }
        let Some(OverNumber { dividend, divisor }) = over_number(square) else { return Ok(None) };
        let node = self.part(&dividend)?;
        Ok(self.is_exact(node).then_some(ExactRoot { dividend, divisor }))
    }

    /// Returns the node of `part`, a root that is rounded to a multiple of a power of two. Returns `None` if the operand of the root is
    /// rounded. Fails if a node has too many bits.
    pub(super) fn whole_root(
        &mut self,
        root: &WholeRoot,
        part: &Expression,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let Some(exact) = self.exact_root(&root.square)? else { return Ok(None) };
        let kind = Kind::Unary(Function::Sqrt, root.square.clone().into());
        let formula = Expression::new(kind, root.square.span.clone());
        let integer = self.rounded_root(&formula, &exact, root.frac, root.rounding)?;
        let scaled = self.plan.scale("root_scaled", integer, -root.frac)?;
        let whole = match root.is_negated {
            true => self.plan.negate("root_negated", scaled)?,
            false => scaled,
        };
        let stated = Some(self.stated(part, &self.uses, ValueAccuracy::Exact));
        let node = self.plan.node(whole).clone();
        let node = PlanNode { name: "whole_root".to_owned(), stated, ..node };
        Ok(Some(self.plan.push_copy(&node, Operation::Scale(whole))))
    }

    /// Returns the node of √s · 2^`frac`, rounded to an integer. `root` must be the formula √s, and `exact` the same root. Let f be the
    /// integer part of the root, and m the estimate, which is f or f + 1. Then
    /// - rounded down, the root is m, or m − 1 if s is below m²;
    /// - rounded up, it is m, or m + 1 if s is above m²;
    /// - the nearest integer is m or m + 1, and it is m + 1 if s is at least (m + 1/2)² = m² + m + 1/4.
    ///
    /// Fails if a node has too many bits.
    pub(super) fn rounded_root(
        &mut self,
        root: &Expression,
        exact: &ExactRoot,
        frac: i32,
        rounding: RootRounding,
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
        let next = match rounding {
            RootRounding::Down => self.plan.subtract("root_before", first, one)?,
            RootRounding::Nearest | RootRounding::Up => self.plan.add("root_next", first, one)?,
        };
        let nearest_factor = if rounding == RootRounding::Nearest { next } else { first };
        let product = self.plan.multiply("root_squared", first, nearest_factor)?;
        let product = self.times_divisor("root_squared_scaled", product, exact)?;
        let operand = self.part(&exact.dividend)?;
        let operand = self.plan.scale("square_scaled", operand, 2 * frac)?;
        let rest = self.plan.subtract("root_rest", operand, product)?;
        // The integer differs from the root by at most 1.
        let limit = exact.divisor.to_f64().value() * 2.0 * (most as f64 + 2.0);
        let rest =
            self.plan.limited("root_rest_limited", rest, Enclosure::between(-limit, limit))?;
        let zero = self.plan.constant("zero", 0, 0)?;
        let chosen = match rounding {
            RootRounding::Down => {
                let is_below = self.plan.less("root_is_below", rest, zero)?;
                self.plan.choose("root_down", is_below, [first, next])?
            }
            RootRounding::Nearest => {
                let quarter = self.times_divisor("quarter_scaled", quarter, exact)?;
                let is_nearest = self.plan.less("root_is_nearest", rest, quarter)?;
                self.plan.choose("nearest_root", is_nearest, [next, first])?
            }
            RootRounding::Up => {
                let is_above = self.plan.less("root_is_above", zero, rest)?;
                self.plan.choose("root_up", is_above, [first, next])?
            }
        };
        self.plan.narrow("root_within", chosen, integers, Rounding::Truncate)
    }

    /// Returns the node of a value times the divisor of the root's operand, or the value itself if the divisor is 1. Fails if the product
    /// has too many bits.
    fn times_divisor(
        &mut self,
        name: &str,
        value: NodeId,
        exact: &ExactRoot,
    ) -> Result<NodeId, PlanRefusal> {
        if exact.divisor == RBig::ONE {
            return Ok(value);
        }
        let divisor = self.part(&number(&exact.divisor.to_string()))?;
        self.plan.multiply(name, value, divisor)
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

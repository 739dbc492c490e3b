//! Derives limits of parts of formulas from conditions on operands. For example, where `hi > lo`, `hi - lo` is at least the
//! smallest difference of the operands, so that `1 / (hi - lo)` has a limit.
//!
//! A fact states that a polynomial of operands is not below a number. It limits a part that is a multiple of this polynomial plus
//! a rest. For example, `c >= a` limits `c^2 - a^2`, which is `(c - a) * (c + a)`, to 0 and above if c and a are not negative.

use std::sync::Arc;

use glint_formula::{Comparison, Enclosure, Expression, Function, Kind, Operator, RBig};

use super::polynomial::{ANYTHING, EnclosedPolynomial, OperandPolynomial, enclosed};
use super::statement::{ExpressionStatement, StatedResult};
use super::uses::PartUses;

/// A polynomial of operands that is not below a number.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fact {
    polynomial: OperandPolynomial,
    least: RBig,
}

impl Fact {
    /// Returns the fact that a comparison with the outcome `outcome` states. Returns `None` if the difference of both sides is no
    /// polynomial. For example, `x > y` for integers gives x − y ≥ 1, and if it does not hold, y − x ≥ 0.
    fn of(comparison: &Comparison, outcome: bool, statement: &ExpressionStatement) -> Option<Self> {
        let left = OperandPolynomial::of(&comparison.left, statement)?;
        let right = OperandPolynomial::of(&comparison.right, statement)?;
        let polynomial = if outcome { left.minus(&right) } else { right.minus(&left) };
        if polynomial.is_number() {
            return None;
        }
        let is_strict = comparison.or_equal != outcome;
        let least = if is_strict { polynomial.step(statement) } else { RBig::ZERO };
        Some(Self { polynomial, least })
    }

    /// Returns the facts that a comparison with the outcome `outcome` states, one for each comparison that it combines.
    pub(super) fn all_of(
        comparison: &Comparison,
        outcome: bool,
        statement: &ExpressionStatement,
    ) -> Vec<Self> {
        let mut facts = Vec::new();
        for (comparison, outcome) in single_comparisons(comparison, outcome) {
            facts.extend(Self::of(&comparison, outcome, statement));
        }
        facts
    }
}

/// Divides a comparison into comparisons with outcomes, which all hold where `comparison` has the outcome `outcome`. For example,
/// `min(x, y) > 0`, the form of a condition of several comparisons, gives `x > 0` and `y > 0`.
fn single_comparisons(comparison: &Comparison, outcome: bool) -> Vec<(Comparison, bool)> {
    let Comparison { left, right, or_equal } = comparison;
    let beside = |left: &Arc<Expression>, right: &Arc<Expression>| {
        let (left, right) = (left.clone(), right.clone());
        single_comparisons(&Comparison { left, right, or_equal: *or_equal }, outcome)
    };
    match (&left.kind, &right.kind, outcome) {
        (Kind::Binary(Operator::Min, a, b), _, true)
        | (Kind::Binary(Operator::Max, a, b), _, false) => {
            [beside(a, right), beside(b, right)].concat()
        }
        (_, Kind::Binary(Operator::Max, a, b), true)
        | (_, Kind::Binary(Operator::Min, a, b), false) => {
            [beside(left, a), beside(left, b)].concat()
        }
        // Conditions that are joined compare differences with 0.
        (Kind::Binary(Operator::Sub, a, b), _, _) if has_sign_or_root(a, b) && is_zero(right) => {
            beside(a, b)
        }
        // Both sides are not below 0, so that their squares compare alike.
        (Kind::Unary(Function::Sqrt, a), _, _) if is_not_negative_number(right) => {
            beside(a, &squared(right))
        }
        (_, Kind::Unary(Function::Sqrt, a), _) if is_not_negative_number(left) => {
            beside(&squared(left), a)
        }
        // A size of at most c means that the number is from −c to c.
        (_, Kind::Unary(Function::Abs, a), true) => {
            [beside(left, a), beside(left, &negated(a))].concat()
        }
        (Kind::Unary(Function::Abs, a), _, false) => {
            [beside(a, right), beside(&negated(a), right)].concat()
        }
        (Kind::If(condition, yes, no), _, true) => {
            let without =
                Comparison { left: no.clone(), right: right.clone(), or_equal: *or_equal };
            // The other case never satisfies the comparison.
            match without.holds(&[]) {
                Ok(Some(false)) => {
                    [single_comparisons(condition, true), beside(yes, right)].concat()
                }
                _ => vec![(comparison.clone(), outcome)],
            }
        }
        _ => vec![(comparison.clone(), outcome)],
    }
}

/// Returns whether one of two formulas is a root or an absolute value, and the other one is a number.
fn has_sign_or_root(a: &Expression, b: &Expression) -> bool {
    let is = |part: &Expression, other: &Expression| {
        matches!(part.kind, Kind::Unary(Function::Sqrt | Function::Abs, _)) && !other.varies()
    };
    is(a, b) || is(b, a)
}

fn is_zero(part: &Expression) -> bool {
    part.rational().is_some_and(|value| value.is_zero())
}

fn is_not_negative_number(part: &Expression) -> bool {
    part.rational().is_some_and(|value| value >= RBig::ZERO)
}

fn squared(part: &Arc<Expression>) -> Arc<Expression> {
    let kind = Kind::Binary(Operator::Mul, part.clone(), part.clone());
    Arc::new(Expression::new(kind, part.span.clone()))
}

fn negated(part: &Arc<Expression>) -> Arc<Expression> {
    let kind = Kind::Unary(Function::Negate, part.clone());
    Arc::new(Expression::new(kind, part.span.clone()))
}

/// Returns whether a result is promised only where `a` is below `b`.
pub(super) fn promises_less(
    statement: &ExpressionStatement,
    result: &StatedResult,
    a: &Expression,
    b: &Expression,
) -> bool {
    let Some(promise) = &result.promise else { return false };
    let difference = OperandPolynomial::of(b, statement)
        .and_then(|b| Some(b.minus(&OperandPolynomial::of(a, statement)?)));
    single_comparisons(promise, true).iter().any(|(comparison, outcome)| {
        let is_same = *comparison.left == *b && *comparison.right == *a && *outcome;
        let fact = Fact::of(comparison, *outcome, statement);
        is_same || fact.is_some_and(|it| it.least > RBig::ZERO && Some(it.polynomial) == difference)
    })
}

/// Returns the facts that hold for all operands for which a part with these uses matters.
pub(super) fn facts_of(statement: &ExpressionStatement, uses: &PartUses) -> Vec<Fact> {
    let mut facts = Vec::new();
    for (comparison, outcome) in &uses.conditions {
        facts.extend(Fact::all_of(comparison, *outcome, statement));
    }
    let mut promises = statement.results.iter().zip(&uses.readers).filter(|(_, reads)| **reads);
    if let Some((first, _)) = promises.next()
        && let Some(promise) = &first.promise
        && promises.all(|(result, _)| result.promise.as_ref() == Some(promise))
    {
        facts.extend(Fact::all_of(promise, true, statement));
    }
    with_products(with_signs(facts, statement))
}

/// Adds the facts that follow from two facts about different operands: `x^2 + y^2 >= 1` and `u^2 + v^2 >= 2` give
/// `(x^2 + y^2) * (u^2 + v^2) >= 2`. This is the square of the length of a product of two complex numbers. Linear polynomials are
/// left out, because boxes of operands limit them.
fn with_products(facts: Vec<Fact>) -> Vec<Fact> {
    let mut curved = Vec::new();
    for fact in &facts {
        let (polynomial, number) = fact.polynomial.without_number();
        let least = fact.least.clone() - number;
        if polynomial.is_curved() && least > RBig::ZERO {
            curved.push(Fact { polynomial, least });
        }
    }
    let mut all = facts;
    for (at, one) in curved.iter().enumerate() {
        for other in &curved[at + 1..] {
            if one.polynomial.shares_variable(&other.polynomial) {
                continue;
            }
            if let Some(polynomial) = one.polynomial.times(&other.polynomial) {
                let least = one.least.clone() * other.least.clone();
                all.push(Fact { polynomial, least });
            }
        }
    }
    all
}

/// Adds the facts that follow from the size and the sign of a number: from `abs(x - y) >= 1` and `x - y >= 0` follows
/// `x - y >= 1`.
pub(super) fn with_signs(facts: Vec<Fact>, statement: &ExpressionStatement) -> Vec<Fact> {
    let mut all = facts.clone();
    for Fact { polynomial, least } in &facts {
        let Some(number) = polynomial.size_of_number() else { continue };
        let Some(number) = OperandPolynomial::of(number, statement) else { continue };
        for signed in [number.times_number(&RBig::from(-1)), number] {
            if is_not_negative(&signed, &facts) {
                all.push(Fact { polynomial: signed, least: least.clone() });
            }
        }
    }
    all
}

/// Returns whether a fact, or the sum of two facts, states that a polynomial is not below 0.
fn is_not_negative(polynomial: &OperandPolynomial, facts: &[Fact]) -> bool {
    let states = |polynomial: &OperandPolynomial| {
        facts.iter().any(|it| it.polynomial == *polynomial && it.least >= RBig::ZERO)
    };
    let mut parts = facts.iter().filter(|it| it.least >= RBig::ZERO);
    states(polynomial) || parts.any(|part| states(&polynomial.minus(&part.polynomial)))
}

/// A part of a formula, as `factor` · p + `rest`, where p is a polynomial that is at least `least` by a fact.
#[derive(Clone, Debug)]
pub(super) struct LimitedPart {
    factor: EnclosedPolynomial,
    rest: EnclosedPolynomial,
    least: Enclosure,
}

impl LimitedPart {
    /// Returns the limits of the part that follow from the fact, for operands within limits.
    pub(super) fn limits(&self, operands: &[(&str, Enclosure)]) -> Enclosure {
        let (factor, rest) = (self.factor.values(operands), self.rest.values(operands));
        let mut limits = ANYTHING;
        if factor.low >= 0.0 {
            limits.low = (Enclosure::exactly(factor.low) * self.least + rest).low;
        }
        if factor.high <= 0.0 {
            limits.high = (Enclosure::exactly(factor.high) * self.least + rest).high;
        }
        limits
    }
}

/// Returns whether the conditions of the uses of a part limit the part itself, and not only its operands.
pub(super) fn has_fact(
    statement: &ExpressionStatement,
    uses: &PartUses,
    part: &Expression,
) -> bool {
    !limited(statement, &facts_of(statement, uses), part).is_empty()
}

/// Returns whether a box of operands limits a part without facts, because the part is an operand, or a minimum, a maximum or an
/// absolute value of one operand.
fn is_shown_by_boxes(part: &Expression) -> bool {
    let is_variable = matches!(
        part.kind,
        Kind::Operand(_)
            | Kind::Binary(Operator::Min | Operator::Max, ..)
            | Kind::Unary(Function::Abs, _)
    );
    is_variable && part.operands().len() <= 1
}

/// Returns the limits of a part that follow from facts, an entry for each fact about the part.
pub(super) fn limited(
    statement: &ExpressionStatement,
    facts: &[Fact],
    part: &Expression,
) -> Vec<LimitedPart> {
    let mut limits = Vec::new();
    if facts.is_empty() || !part.varies() || is_shown_by_boxes(part) {
        return limits;
    }
    let Some(polynomial) = OperandPolynomial::of(part, statement) else { return limits };
    for fact in facts {
        if let Some((factor, rest)) = polynomial.divided_by(&fact.polynomial) {
            limits.push(LimitedPart {
                factor: EnclosedPolynomial::new(&factor),
                rest: EnclosedPolynomial::new(&rest),
                least: enclosed(&fact.least),
            });
        }
    }
    limits
}

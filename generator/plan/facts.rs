//! What conditions on operands say about parts of formulas. For example, `hi > lo` says that `hi - lo` is at least the smallest
//! difference that the operands can have, so that `1 / (hi - lo)` has a limit.
//!
//! A fact is a polynomial of operands that is not below a number. A part that is a multiple of this polynomial plus a rest gets
//! limits from it: `c^2 - a^2` is `(c - a) * (c + a)`, so that it is not below 0 where `c >= a` and both are not negative.

use std::collections::{BTreeMap, HashMap};
use std::ptr;
use std::sync::Arc;

use glint_formula::{Comparison, Enclosure, Expression, Function, Kind, Operator, RBig};

use super::order;
use super::statement::{ExpressionStatement, StatedResult};
use super::uses::PartUses;

/// The most parts of a formula that is written as a polynomial.
const MOST_PARTS: u32 = 200;

/// The most terms of a polynomial.
const MOST_TERMS: usize = 32;

/// The largest exponent in a formula that is written as a polynomial.
const LARGEST_EXPONENT: u32 = 8;

/// The most cases of choices in a formula whose conditions are read as facts.
const MOST_CASES: usize = 64;

/// The exponents above 0 of the variables in a product of powers. A variable is an operand, or a minimum, a maximum or an absolute value
/// of polynomials; its key is its text. The product without variables is 1.
type Exponents = BTreeMap<String, u32>;

/// A polynomial of operands, minima, maxima and absolute values, with exact coefficients other than 0.
#[derive(Clone, Debug)]
struct OperandPolynomial {
    terms: BTreeMap<Exponents, RBig>,
    /// The formulas of the variables, by their texts.
    variables: BTreeMap<String, Expression>,
}

impl PartialEq for OperandPolynomial {
    fn eq(&self, other: &Self) -> bool {
        self.terms == other.terms
    }
}

impl OperandPolynomial {
    fn zero() -> Self {
        Self { terms: BTreeMap::new(), variables: BTreeMap::new() }
    }

    fn number(value: RBig) -> Self {
        Self::term(Exponents::new(), value)
    }

    fn variable(formula: &Expression) -> Self {
        let name = formula.python();
        let mut variable = Self::term(Exponents::from([(name.clone(), 1)]), RBig::ONE);
        variable.variables.insert(name, formula.clone());
        variable
    }

    fn term(exponents: Exponents, coefficient: RBig) -> Self {
        let mut sum = Self::zero();
        sum.add_term(exponents, coefficient);
        sum
    }

    fn add_term(&mut self, exponents: Exponents, coefficient: RBig) {
        let before = self.terms.remove(&exponents).unwrap_or(RBig::ZERO);
        let sum = before + coefficient;
        if sum != RBig::ZERO {
            self.terms.insert(exponents, sum);
        }
    }

    /// Writes a formula as a polynomial. Returns `None` for a formula that is none, or that has too many terms.
    fn of(formula: &Expression, statement: &ExpressionStatement) -> Option<Self> {
        if formula.size() > MOST_PARTS {
            return None;
        }
        if !formula.varies() {
            return Some(Self::number(formula.rational()?));
        }
        let of = |part: &Expression| Self::of(part, statement);
        let polynomial = match &formula.kind {
            Kind::Operand(name) if statement.operands.iter().any(|it| it.name == *name) => {
                Self::variable(formula)
            }
            Kind::Unary(Function::Negate, a) => of(a)?.times_number(&RBig::from(-1)),
            Kind::Unary(Function::Abs, a) => {
                let operands = statement.enclosed_operands(&statement.domain());
                let values = a.enclose(&operands).ok()?;
                let limits = order::limits(a, &operands);
                match () {
                    () if values.low >= 0.0 || limits.low >= 0.0 => of(a)?,
                    () if values.high <= 0.0 || limits.high <= 0.0 => {
                        of(a)?.times_number(&RBig::from(-1))
                    }
                    () => of(a).map(|_| Self::variable(formula))?,
                }
            }
            Kind::Binary(Operator::Min | Operator::Max, a, b) => {
                let _ = (of(a)?, of(b)?);
                Self::variable(formula)
            }
            Kind::Binary(Operator::Add, a, b) => of(a)?.plus(&of(b)?),
            Kind::Binary(Operator::Sub, a, b) => of(a)?.minus(&of(b)?),
            Kind::Binary(Operator::Mul, a, b) => of(a)?.times(&of(b)?)?,
            Kind::Binary(Operator::Div, a, b) if !b.varies() => {
                let divisor = b.rational().filter(|divisor| *divisor != RBig::ZERO)?;
                of(a)?.times_number(&(RBig::ONE / divisor))
            }
            Kind::Binary(Operator::Power, a, b) if !b.varies() => {
                let exponent = b.rational().filter(RBig::is_int)?;
                let exponent = u32::try_from(exponent.numerator().clone()).ok()?;
                if exponent > LARGEST_EXPONENT {
                    return None;
                }
                let base = of(a)?;
                let mut power = Self::number(RBig::ONE);
                for _ in 0..exponent {
                    power = power.times(&base)?;
                }
                power
            }
            _ => return None,
        };
        (polynomial.terms.len() <= MOST_TERMS).then_some(polynomial)
    }

    fn plus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        sum.variables.extend(other.variables.clone());
        for (exponents, coefficient) in &other.terms {
            sum.add_term(exponents.clone(), coefficient.clone());
        }
        sum
    }

    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.times_number(&RBig::from(-1)))
    }

    fn times_number(&self, factor: &RBig) -> Self {
        let mut product = Self { terms: BTreeMap::new(), variables: self.variables.clone() };
        for (exponents, coefficient) in &self.terms {
            product.add_term(exponents.clone(), coefficient.clone() * factor);
        }
        product
    }

    /// Returns the product, or `None` if it has too many terms.
    fn times(&self, other: &Self) -> Option<Self> {
        let mut product = Self { terms: BTreeMap::new(), variables: self.variables.clone() };
        product.variables.extend(other.variables.clone());
        for (left, a) in &self.terms {
            for (right, b) in &other.terms {
                let mut exponents = left.clone();
                for (variable, exponent) in right {
                    *exponents.entry(variable.clone()).or_insert(0) += exponent;
                }
                product.add_term(exponents, a.clone() * b);
            }
        }
        (product.terms.len() <= MOST_TERMS).then_some(product)
    }

    /// Returns whether the polynomial depends on no operand.
    fn is_number(&self) -> bool {
        self.terms.keys().all(Exponents::is_empty)
    }

    /// Returns the number whose absolute value the polynomial is; `None` for another polynomial.
    fn size_of_number(&self) -> Option<&Expression> {
        let mut terms = self.terms.iter();
        let (exponents, coefficient) = terms.next()?;
        let (variable, exponent) = exponents.iter().next()?;
        let is_variable = exponents.len() == 1 && *exponent == 1 && *coefficient == RBig::ONE;
        if terms.next().is_some() || !is_variable {
            return None;
        }
        match &self.variables[variable].kind {
            Kind::Unary(Function::Abs, number) => Some(number),
            _ => None,
        }
    }

    /// Returns a polynomial m and a rest r with `self` = m · `divisor` + r. First tries a number m with which the rest is a number
    /// too, and then a division by a variable that `divisor` has only to the first power and without another variable. Returns
    /// `None` if neither is possible, or if m is 0.
    fn divided_by(&self, divisor: &Self) -> Option<(Self, Self)> {
        let (exponents, leading) =
            divisor.terms.iter().find(|(exponents, _)| !exponents.is_empty())?;
        if let Some(own) = self.terms.get(exponents) {
            let factor = own.clone() / leading;
            let rest = self.minus(&divisor.times_number(&factor));
            if rest.is_number() {
                return Some((Self::number(factor), rest));
            }
        }
        let variable = divisor.variables.keys().find(|variable| divisor.is_linear_in(variable))?;
        let unit = Exponents::from([(variable.clone(), 1)]);
        let slope = divisor.terms.get(&unit)?;
        let (mut factor, mut rest) = (Self::zero(), self.clone());
        factor.variables = self.variables.clone();
        factor.variables.extend(divisor.variables.clone());
        while let Some((mut lower, coefficient)) = rest.highest_in(variable) {
            let exponent = lower.remove(variable)?;
            if exponent > 1 {
                lower.insert(variable.clone(), exponent - 1);
            }
            let step = Self::term(lower, coefficient / slope);
            rest = rest.minus(&step.times(divisor)?);
            factor = factor.plus(&step);
        }
        (factor != Self::zero()).then_some((factor, rest))
    }

    /// Returns whether exactly one term has the variable, to the first power and without another variable.
    fn is_linear_in(&self, variable: &str) -> bool {
        let mut terms = self.terms.keys().filter(|exponents| exponents.contains_key(variable));
        let only = terms.next().is_some_and(|exponents| exponents.values().sum::<u32>() == 1);
        only && terms.next().is_none()
    }

    /// Returns the exponents and the coefficient of a term with the largest exponent of the variable; `None` if no term has it.
    fn highest_in(&self, variable: &str) -> Option<(Exponents, RBig)> {
        let terms = self.terms.iter().filter(|(exponents, _)| exponents.contains_key(variable));
        let highest = terms.max_by_key(|(exponents, _)| exponents[variable])?;
        Some((highest.0.clone(), highest.1.clone()))
    }

    /// Returns a number that divides every value of the polynomial, for operands of the statement.
    fn step(&self, statement: &ExpressionStatement) -> RBig {
        let mut step = RBig::ZERO;
        for (exponents, coefficient) in &self.terms {
            let mut of_term = coefficient.clone();
            for (variable, exponent) in exponents {
                let of_variable = step_of(&self.variables[variable], statement);
                of_term *= of_variable.pow(*exponent as isize);
            }
            step = common_divisor(step, of_term);
        }
        step
    }
}

/// Returns a number that divides every value of a variable of polynomials.
fn step_of(variable: &Expression, statement: &ExpressionStatement) -> RBig {
    if let Kind::Operand(name) = &variable.kind {
        let operand = statement.operands.iter().find(|operand| operand.name == *name);
        let frac = operand.map_or(0, |operand| operand.format.frac as isize);
        return RBig::from(2).pow(-frac);
    }
    let mut step = RBig::ZERO;
    for part in variable.parts() {
        let Some(polynomial) = OperandPolynomial::of(part, statement) else { return RBig::ZERO };
        step = common_divisor(step, polynomial.step(statement));
    }
    step
}

/// Returns the largest number that divides both numbers. For example, 3/4 and 1/2 give 1/4.
fn common_divisor(a: RBig, b: RBig) -> RBig {
    let (mut a, mut b) = (size_of(a), size_of(b));
    while b != RBig::ZERO {
        let rest = a.clone() - (a.clone() / &b).floor() * &b;
        (a, b) = (b, rest);
    }
    a
}

fn size_of(value: RBig) -> RBig {
    if value < RBig::ZERO { -value } else { value }
}

/// A polynomial of operands that is not below a number.
#[derive(Clone, Debug, PartialEq)]
struct Fact {
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

    /// Returns the facts that a comparison with the outcome `outcome` states, if it combines several comparisons.
    fn all_of(
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

/// Returns comparisons with their outcomes; all of them hold where `comparison` has the outcome `outcome`. For example, `min(x, y)
/// > 0` gives `x > 0` and `y > 0`. A condition of several comparisons is written so.
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

/// Returns what holds for all operands for which a part with these uses matters.
fn facts_of(statement: &ExpressionStatement, uses: &PartUses) -> Vec<Fact> {
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
    with_signs(facts, statement)
}

/// Adds the facts that follow from the size and the sign of a number: from `abs(x - y) >= 1` and `x - y >= 0` follows
/// `x - y >= 1`.
fn with_signs(facts: Vec<Fact>, statement: &ExpressionStatement) -> Vec<Fact> {
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

/// A polynomial whose coefficients are intervals in `f64`.
#[derive(Clone, Debug)]
struct EnclosedPolynomial {
    terms: Vec<(Exponents, Enclosure)>,
    variables: BTreeMap<String, Expression>,
}

impl EnclosedPolynomial {
    fn new(polynomial: &OperandPolynomial) -> Self {
        let terms = polynomial.terms.iter();
        let terms = terms.map(|(exponents, it)| (exponents.clone(), enclosed(it))).collect();
        Self { terms, variables: polynomial.variables.clone() }
    }

    /// Returns an interval that contains all values for operands within limits.
    fn values(&self, operands: &[(&str, Enclosure)]) -> Enclosure {
        let mut sum = Enclosure::exactly(0.0);
        for (exponents, coefficient) in &self.terms {
            let mut product = *coefficient;
            for (variable, exponent) in exponents {
                let value = self.variables[variable].enclose(operands).unwrap_or(ANYTHING);
                product = product * power(value, *exponent);
            }
            sum = sum + product;
        }
        sum
    }
}

/// Returns an interval that contains a rational number.
fn enclosed(value: &RBig) -> Enclosure {
    let near = value.to_f64().value();
    match RBig::try_from(near) {
        Ok(exact) if exact == *value => Enclosure::exactly(near),
        _ => Enclosure::between(near.next_down(), near.next_up()),
    }
}

/// Returns an interval that contains the powers of all values within limits.
fn power(base: Enclosure, exponent: u32) -> Enclosure {
    let mut power = Enclosure::exactly(1.0);
    for _ in 0..exponent {
        power = power * base;
    }
    if exponent.is_multiple_of(2) {
        Enclosure::between(power.low.max(0.0), power.high)
    } else {
        power
    }
}

/// A part that is a multiple of a fact's polynomial plus a rest.
#[derive(Clone, Debug)]
struct LimitedPart {
    factor: EnclosedPolynomial,
    rest: EnclosedPolynomial,
    least: Enclosure,
}

impl LimitedPart {
    /// Returns the limits of the part that follow from the fact, for operands within limits.
    fn limits(&self, operands: &[(&str, Enclosure)]) -> Enclosure {
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

/// A part of a formula with facts about it, and the name of the operand that replaces it.
#[derive(Clone, Debug)]
struct GuardedPart {
    name: String,
    part: Expression,
    facts: Vec<LimitedPart>,
    /// Whether the facts hold wherever the formula matters, and not only in a case of a choice.
    is_always: bool,
}

impl GuardedPart {
    /// Returns an interval that contains the values of the part, wherever its facts hold. Returns `None` if the formula matters for
    /// none of the operands within the limits.
    fn values(&self, operands: &[(&str, Enclosure)]) -> Option<Enclosure> {
        let values = self.part.enclose(operands).unwrap_or(ANYTHING);
        let mut stated = ANYTHING;
        for fact in &self.facts {
            let limits = fact.limits(operands);
            stated.low = stated.low.max(limits.low);
            stated.high = stated.high.min(limits.high);
        }
        let (low, high) = (values.low.max(stated.low), values.high.min(stated.high));
        match (low <= high, self.is_always) {
            (true, _) => Some(Enclosure::between(low, high)),
            (false, true) => None,
            // The case with the part is taken for none of these operands, so that any value will do. A stated limit is a value with
            // which the case has a value of its own: no divisor is 0.
            (false, false) => {
                let limit = if stated.low.is_finite() { stated.low } else { stated.high };
                Some(Enclosure::exactly(limit))
            }
        }
    }
}

const ANYTHING: Enclosure = Enclosure::between(f64::NEG_INFINITY, f64::INFINITY);

/// A formula whose value matters only under some conditions, in which an operand replaces each part with a fact about it.
#[derive(Clone, Debug)]
pub struct GuardedFormula {
    formula: Arc<Expression>,
    parts: Vec<GuardedPart>,
}

impl GuardedFormula {
    /// Finds the parts of a formula about which the conditions of its uses, or choices within the formula, state a fact.
    pub(super) fn new(
        statement: &ExpressionStatement,
        uses: &PartUses,
        formula: &Expression,
    ) -> Self {
        let facts = facts_of(statement, uses);
        let is_guarded = |kind: &Kind| {
            let is_extreme =
                matches!(kind, Kind::Binary(Operator::Max | Operator::Min, a, _) if a.varies());
            is_extreme || matches!(kind, Kind::If(..))
        };
        let is_plain = facts.is_empty() && !formula.has(&is_guarded);
        if is_plain {
            return Self { formula: Arc::new(formula.clone()), parts: Vec::new() };
        }
        let domain = statement.domain();
        let operands = statement.enclosed_operands(&domain);
        let mut rewriting = GuardRewriting { statement, operands, parts: Vec::new(), cases: 0 };
        let formula = rewriting.rewritten(formula, &facts, false, &mut HashMap::new());
        Self { formula, parts: rewriting.parts }
    }

    /// Returns an interval that contains the values of the formula for operands within limits, under the conditions. Returns `None`
    /// if the conditions hold for none of these operands.
    pub(super) fn values(&self, operands: &[(&str, Enclosure)]) -> Option<Enclosure> {
        let mut all = operands.to_vec();
        for part in &self.parts {
            let values = part.values(&all)?;
            all.push((&part.name, values));
        }
        Some(self.formula.enclose(&all).unwrap_or(ANYTHING))
    }
}

/// The parts of a formula that were rewritten under the same facts, by their addresses.
type RewrittenParts = HashMap<*const Expression, Arc<Expression>>;

/// The rewriting of a formula, in which operands replace the parts with facts.
struct GuardRewriting<'s> {
    statement: &'s ExpressionStatement,
    /// The operands with the limits of their domains.
    operands: Vec<(&'s str, Enclosure)>,
    parts: Vec<GuardedPart>,
    /// The number of cases of choices so far.
    cases: usize,
}

impl GuardRewriting<'_> {
    /// Returns a part in which operands replace the parts with facts. `is_case` says whether the facts hold only in a case of a
    /// choice. `known` has the parts that were rewritten under the same facts.
    fn rewritten(
        &mut self,
        part: &Expression,
        facts: &[Fact],
        is_case: bool,
        known: &mut RewrittenParts,
    ) -> Arc<Expression> {
        if let Some(known) = known.get(&ptr::from_ref(part)) {
            return known.clone();
        }
        let rewritten = self.newly_rewritten(part, facts, is_case, known);
        known.insert(ptr::from_ref(part), rewritten.clone());
        rewritten
    }

    fn newly_rewritten(
        &mut self,
        part: &Expression,
        facts: &[Fact],
        is_case: bool,
        known: &mut RewrittenParts,
    ) -> Arc<Expression> {
        let limits = limited(self.statement, facts, part);
        if !limits.is_empty() {
            // Facts about the numbers of a minimum or a maximum limit it, too.
            let part = match &part.kind {
                Kind::Binary(operator @ (Operator::Min | Operator::Max), a, b) => {
                    let a = self.rewritten(a, facts, is_case, known);
                    let b = self.rewritten(b, facts, is_case, known);
                    Expression::new(Kind::Binary(*operator, a, b), part.span.clone())
                }
                _ => part.clone(),
            };
            // No operand of a user has such a name.
            let name = format!("part {}", self.parts.len());
            let operand = Arc::new(Expression::operand(&name));
            let is_always = !is_case;
            self.parts.push(GuardedPart { name, part, facts: limits, is_always });
            return operand;
        }
        let kind = match &part.kind {
            Kind::Number(_) | Kind::Constant(..) | Kind::Operand(_) | Kind::Word(..) => {
                return Arc::new(part.clone());
            }
            Kind::Unary(function, a) => {
                Kind::Unary(*function, self.rewritten(a, facts, is_case, known))
            }
            Kind::Binary(operator, a, b) => {
                let a = self.rewritten(a, facts, is_case, known);
                Kind::Binary(*operator, a, self.rewritten(b, facts, is_case, known))
            }
            Kind::If(comparison, yes, no) => {
                if let Ok(Some(outcome)) = comparison.holds(&self.operands) {
                    // No operand takes the other case.
                    let case = if outcome { yes } else { no };
                    return self.rewritten(case, facts, is_case, known);
                }
                let left = self.rewritten(&comparison.left, facts, is_case, known);
                let right = self.rewritten(&comparison.right, facts, is_case, known);
                let yes = self.case(yes, facts, (comparison, true), is_case, known);
                let no = self.case(no, facts, (comparison, false), is_case, known);
                let or_equal = comparison.or_equal;
                Kind::If(Comparison { left, right, or_equal }, yes, no)
            }
        };
        let rewritten = Arc::new(Expression::new(kind, part.span.clone()));
        order::clamped(part, &rewritten, &self.operands).unwrap_or(rewritten)
    }

    /// Returns a case of a choice, in which the facts of the comparison's outcome hold too. The facts of further cases are left out
    /// after [`MOST_CASES`] cases.
    fn case(
        &mut self,
        case: &Expression,
        facts: &[Fact],
        (comparison, outcome): (&Comparison, bool),
        is_case: bool,
        known: &mut RewrittenParts,
    ) -> Arc<Expression> {
        let own = Fact::all_of(comparison, outcome, self.statement);
        if own.is_empty() || self.cases == MOST_CASES {
            return self.rewritten(case, facts, is_case, known);
        }
        self.cases += 1;
        let all = with_signs([facts, &own].concat(), self.statement);
        self.rewritten(case, &all, true, &mut HashMap::new())
    }
}

/// Returns whether a formula is a polynomial of operands, whose value the plan computes without rounding.
pub(super) fn is_polynomial(statement: &ExpressionStatement, formula: &Expression) -> bool {
    OperandPolynomial::of(formula, statement).is_some()
}

/// Returns whether the conditions of the uses of a part state a fact about the part itself.
pub(super) fn has_fact(
    statement: &ExpressionStatement,
    uses: &PartUses,
    part: &Expression,
) -> bool {
    !limited(statement, &facts_of(statement, uses), part).is_empty()
}

/// Returns whether boxes of operands show the values of a part, because it is an operand, or a minimum, a maximum or an absolute value
/// of one operand.
fn is_shown_by_boxes(part: &Expression) -> bool {
    let is_variable = matches!(
        part.kind,
        Kind::Operand(_)
            | Kind::Binary(Operator::Min | Operator::Max, ..)
            | Kind::Unary(Function::Abs, _)
    );
    is_variable && part.operands().len() <= 1
}

/// Returns the limits of a part that follow from facts.
fn limited(statement: &ExpressionStatement, facts: &[Fact], part: &Expression) -> Vec<LimitedPart> {
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

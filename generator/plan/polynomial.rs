//! Writes formulas as polynomials of operands, minima, maxima and absolute values, with exact coefficients. For example,
//! `(c - a) * (c + a)` and `c^2 - a^2` are the same polynomial.

use std::collections::{BTreeMap, BTreeSet};

use glint_formula::{Enclosure, Expression, Function, Kind, Operator, RBig};

use super::order;
use super::statement::ExpressionStatement;

/// The interval of a number without limits.
pub(super) const ANYTHING: Enclosure = Enclosure::between(f64::NEG_INFINITY, f64::INFINITY);

/// The most parts of a formula that is written as a polynomial.
const MOST_PARTS: u32 = 200;

/// The most terms of a polynomial.
const MOST_TERMS: usize = 32;

/// The largest exponent in a formula that is written as a polynomial.
const LARGEST_EXPONENT: u32 = 8;

/// The exponents above 0 of the variables in a product of powers. A variable is an operand, or a minimum, a maximum or an absolute value
/// of polynomials; its key is its text. The product without variables is 1.
type Exponents = BTreeMap<String, u32>;

/// A polynomial of operands, minima, maxima and absolute values, with exact coefficients other than 0.
#[derive(Clone, Debug)]
pub(super) struct OperandPolynomial {
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
    pub(super) fn of(formula: &Expression, statement: &ExpressionStatement) -> Option<Self> {
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

    pub(super) fn minus(&self, other: &Self) -> Self {
        self.plus(&other.times_number(&RBig::from(-1)))
    }

    pub(super) fn times_number(&self, factor: &RBig) -> Self {
        let mut product = Self { terms: BTreeMap::new(), variables: self.variables.clone() };
        for (exponents, coefficient) in &self.terms {
            product.add_term(exponents.clone(), coefficient.clone() * factor);
        }
        product
    }

    /// Returns the product, or `None` if it has too many terms.
    pub(super) fn times(&self, other: &Self) -> Option<Self> {
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
    pub(super) fn is_number(&self) -> bool {
        self.terms.keys().all(Exponents::is_empty)
    }

    /// Returns x if the polynomial is the absolute value of x; `None` for another polynomial.
    pub(super) fn size_of_number(&self) -> Option<&Expression> {
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
    pub(super) fn divided_by(&self, divisor: &Self) -> Option<(Self, Self)> {
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

    /// Returns the polynomial without its number, and the number: x^2 − 3 gives x^2 and −3.
    pub(super) fn without_number(&self) -> (Self, RBig) {
        let mut rest = self.clone();
        let number = rest.terms.remove(&Exponents::new());
        (rest, number.unwrap_or(RBig::ZERO))
    }

    /// Returns whether a term has a degree above 1.
    pub(super) fn is_curved(&self) -> bool {
        self.terms.keys().any(|exponents| exponents.values().sum::<u32>() > 1)
    }

    /// Returns whether both polynomials have a term with the same variable.
    pub(super) fn shares_variable(&self, other: &Self) -> bool {
        let names = |polynomial: &Self| -> BTreeSet<String> {
            polynomial.terms.keys().flat_map(|exponents| exponents.keys().cloned()).collect()
        };
        !names(self).is_disjoint(&names(other))
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

    /// Returns a number that divides every value of the polynomial for operands of the statement: a value above 0 is at least
    /// this number.
    pub(super) fn step(&self, statement: &ExpressionStatement) -> RBig {
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

/// A polynomial whose coefficients are intervals in `f64`.
#[derive(Clone, Debug)]
pub(super) struct EnclosedPolynomial {
    terms: Vec<(Exponents, Enclosure)>,
    variables: BTreeMap<String, Expression>,
}

impl EnclosedPolynomial {
    pub(super) fn new(polynomial: &OperandPolynomial) -> Self {
        let terms = polynomial.terms.iter();
        let terms = terms.map(|(exponents, it)| (exponents.clone(), enclosed(it))).collect();
        Self { terms, variables: polynomial.variables.clone() }
    }

    /// Returns an interval that contains all values for operands within limits.
    pub(super) fn values(&self, operands: &[(&str, Enclosure)]) -> Enclosure {
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
pub(super) fn enclosed(value: &RBig) -> Enclosure {
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

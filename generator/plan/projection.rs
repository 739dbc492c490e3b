//! Finds limits of a quotient by the length of a vector. Interval arithmetic misses them, because the same numbers are in the
//! dividend and in the divisor.
//!
//! The dividend c₁·v₁ + c₂·v₂ + … has products with the numbers of the vector, and the divisor is the vector's length, √(v₁² + v₂² + …).
//! By the inequality of Cauchy and Schwarz, the absolute value of the quotient is at most √(c₁² + c₂² + …). For example,
//! `x / sqrt(x^2 + y^2)` is from −1 to 1, and `(nx * hx + ny * hy) / sqrt(nx^2 + ny^2)` is at most the length of the vector h.

use std::sync::Arc;

use glint_base::fixed::{exp2, nearest};
use glint_formula::{Enclosure, Expression, Function, Kind, Operator, RBig, parse};

use super::constant::dyadic;

/// The most terms of a sum that is examined.
const MOST_TERMS: usize = 32;

/// The largest number of bits of a rounded constant. With a sign, a factor then has 18 bits.
const MOST_CONSTANT_BITS: i32 = 17;

/// The smallest number of bits of a rounded constant.
const FEWEST_CONSTANT_BITS: i32 = 2;

/// A factor that exceeds 1 by more than the roundings of a few operations in `f64`.
const ROUNDED_UP: f64 = 1.0 + 1e-12;

/// A term of a dividend, apart from its sign.
struct Projected {
    /// The number of the vector.
    number: Arc<Expression>,
    coefficient: Arc<Expression>,
}

/// Returns whether a formula is a quotient that [`square_of_limit`] limits.
pub(super) fn is_projection(kind: &Kind) -> bool {
    square_of_limit(kind).is_some()
}

/// Returns the square of an upper limit of a quotient's absolute value. Returns `None` for a formula of another kind. For
/// example, `(x * p + y * q) / sqrt(x^2 + y^2)` gives `p * p + q * q`, and 1 if the divisor is
/// `sqrt(x^2 + y^2) * sqrt(p^2 + q^2)`.
pub(super) fn square_of_limit(kind: &Kind) -> Option<Arc<Expression>> {
    if let Some(quotient) = multiplied_quotient(kind) {
        return square_of_limit(&quotient.kind);
    }
    let Kind::Binary(Operator::Div, dividend, divisor) = kind else { return None };
    if let Some(square) = limit_by_square(dividend, divisor) {
        return Some(square);
    }
    let squares = squares_of_lengths(divisor)?;
    let [vector, others @ ..] = squares.as_slice() else { return None };
    let numbers = numbers_of(vector)?;
    match others {
        [] => square_by_numbers(&numbers, dividend),
        [other] => {
            let products = products_with(&numbers, dividend)?;
            let mut numbers = numbers_of(other)?;
            for Projected { coefficient, .. } in &products {
                let same = numbers.iter().position(|number| number == coefficient)?;
                numbers.swap_remove(same);
            }
            Some(one())
        }
        _ => None,
    }
}

/// Returns a product of a quotient and a number as a single quotient, if the divisor is the square of a length that limits only
/// the single quotient. For example, `(x * p + y * q) / (x^2 + y^2) * x` gives `(x * p + y * q) * x / (x^2 + y^2)`. Returns
/// `None` for any other formula.
pub(super) fn multiplied_quotient(kind: &Kind) -> Option<Expression> {
    let Kind::Binary(Operator::Mul, a, b) = kind else { return None };
    for (quotient, factor) in [(a, b), (b, a)] {
        let Some((dividend, divisor)) = parts_of_quotient(quotient) else { continue };
        let product = binary(Operator::Mul, &dividend, factor);
        if limit_by_square(&product, &divisor).is_some() {
            let kind = Kind::Binary(Operator::Div, product, divisor.clone());
            return Some(Expression::new(kind, quotient.span.clone()));
        }
    }
    None
}

/// A quotient with rounded constants.
pub(super) struct RoundedProjection {
    pub(super) formula: Expression,
    /// The largest distance between the values of both formulas.
    pub(super) deviation: f64,
}

/// Rounds constant factors in the dividend of a quotient by the length of a vector to `frac` fraction bits, or as many as factors
/// of 18 bits can have. The part may also be a minimum or a maximum of such a quotient and a constant, which changes by no more.
/// Returns `None` for any other formula, and if all constants are exact with few bits.
pub(super) fn rounded(part: &Expression, frac: i32) -> Option<RoundedProjection> {
    match &part.kind {
        Kind::Binary(operator @ (Operator::Min | Operator::Max), a, b)
            if !(a.varies() && b.varies()) =>
        {
            let (constant, quotient) = if a.varies() { (b, a) } else { (a, b) };
            let RoundedProjection { formula, deviation } = rounded(quotient, frac)?;
            let kind = Kind::Binary(*operator, Arc::new(formula), constant.clone());
            Some(RoundedProjection { formula: Expression::new(kind, part.span.clone()), deviation })
        }
        Kind::Binary(Operator::Div, dividend, divisor) => {
            let squares = squares_of_lengths(divisor)?;
            let [vector] = squares.as_slice() else { return None };
            let numbers = numbers_of(vector)?;
            let mut largest: f64 = 0.0;
            for Projected { coefficient, .. } in products_with(&numbers, dividend)? {
                if is_rounded_constant(&coefficient) {
                    let value = coefficient.enclose(&[]).ok()?;
                    largest = largest.max(value.low.abs()).max(value.high.abs());
                }
            }
            if largest == 0.0 {
                return None;
            }
            let integer_bits = (largest.log2().floor() as i32 + 1).max(0);
            let frac = frac.max(FEWEST_CONSTANT_BITS).min(MOST_CONSTANT_BITS - integer_bits);
            let mut rounding = ConstantRounding { numbers: &numbers, frac, squares: 0.0 };
            let dividend = rounding.rounded(dividend)?;
            let kind = Kind::Binary(Operator::Div, dividend, divisor.clone());
            Some(RoundedProjection {
                formula: Expression::new(kind, part.span.clone()),
                deviation: rounding.squares.sqrt() * ROUNDED_UP,
            })
        }
        _ => None,
    }
}

/// Returns whether a coefficient is a constant that is not exact with few bits.
fn is_rounded_constant(coefficient: &Expression) -> bool {
    !coefficient.varies() && dyadic(coefficient).is_none()
}

/// Rounds the constants in a sum of products with the numbers of a vector.
struct ConstantRounding<'n> {
    numbers: &'n [Arc<Expression>],
    frac: i32,
    /// The sum of the squares of all roundings so far.
    squares: f64,
}

impl ConstantRounding<'_> {
    /// Returns a sum with rounded constants. Returns `None` if a constant has no value.
    fn rounded(&mut self, sum: &Arc<Expression>) -> Option<Arc<Expression>> {
        let Kind::Binary(operator, a, b) = &sum.kind else { return Some(sum.clone()) };
        let (a, b) = match operator {
            Operator::Add | Operator::Sub => (self.rounded(a)?, self.rounded(b)?),
            Operator::Mul if self.numbers.contains(a) => (a.clone(), self.constant(b)?),
            Operator::Mul => (self.constant(a)?, b.clone()),
            Operator::Div => {
                let inverse = self.constant(&binary(Operator::Div, &one(), b))?;
                return Some(binary(Operator::Mul, a, &inverse));
            }
            _ => return Some(sum.clone()),
        };
        Some(binary(*operator, &a, &b))
    }

    /// Returns a coefficient, rounded if it is a constant with many bits. Returns `None` if the constant has no value.
    fn constant(&mut self, coefficient: &Arc<Expression>) -> Option<Arc<Expression>> {
        if !is_rounded_constant(coefficient) {
            return Some(coefficient.clone());
        }
        let value = coefficient.enclose(&[]).ok()?;
        let raw = nearest(value.middle() * exp2(self.frac));
        let difference = value - Enclosure::exactly(raw * exp2(-self.frac));
        self.squares += difference.low.abs().max(difference.high.abs()).powi(2);
        // Both numbers are integers, which the text states exactly.
        let text = match self.frac {
            frac @ 0.. => format!("{raw} / {}", exp2(frac)),
            frac => format!("{raw} * {}", exp2(-frac)),
        };
        let rounded = parse(&text).ok()?;
        Some(Arc::new(rounded))
    }
}

/// Returns the dividend and the divisor of a quotient, or of a constant times a quotient. Returns `None` for any other formula. For example,
/// `2 * (x / y)` gives `2 * x` and y.
fn parts_of_quotient(part: &Expression) -> Option<(Arc<Expression>, Arc<Expression>)> {
    match &part.kind {
        Kind::Binary(Operator::Div, dividend, divisor) => Some((dividend.clone(), divisor.clone())),
        Kind::Binary(Operator::Mul, a, b) if !a.varies() || !b.varies() => {
            let (constant, quotient) = if a.varies() { (b, a) } else { (a, b) };
            let (dividend, divisor) = parts_of_quotient(quotient)?;
            Some((binary(Operator::Mul, constant, &dividend), divisor))
        }
        _ => None,
    }
}

/// Returns the square of an upper limit of a quotient's absolute value. The divisor must be the square of a length, and the
/// dividend a product of two sums that this length limits: `x * (x * p + y * q) / (x^2 + y^2)` gives `1 * (p * p + q * q)`.
/// Returns `None` for any other quotient.
fn limit_by_square(dividend: &Expression, divisor: &Arc<Expression>) -> Option<Arc<Expression>> {
    let numbers = numbers_of(divisor).filter(|numbers| !numbers.is_empty())?;
    let Kind::Binary(Operator::Mul, first, second) = &dividend.kind else { return None };
    let first = square_by_numbers(&numbers, first)?;
    let second = square_by_numbers(&numbers, second)?;
    Some(binary(Operator::Mul, &first, &second))
}

/// Returns the square of an upper limit of the absolute value of `part`, divided by the length of a vector with these numbers.
/// Returns `None` unless the part is a sum of products with these numbers, or such a sum times a constant.
fn square_by_numbers(
    numbers: &[Arc<Expression>],
    part: &Arc<Expression>,
) -> Option<Arc<Expression>> {
    match &part.kind {
        Kind::Unary(Function::Negate | Function::Abs, sum) => square_by_numbers(numbers, sum),
        // The larger of 0 and a sum is not farther from 0 than the sum.
        Kind::Binary(Operator::Min | Operator::Max, a, b) if is_zero(a) || is_zero(b) => {
            square_by_numbers(numbers, if is_zero(a) { b } else { a })
        }
        Kind::Binary(Operator::Mul, a, b) if !a.varies() || !b.varies() => {
            let (constant, sum) = if a.varies() { (b, a) } else { (a, b) };
            let square = binary(Operator::Mul, constant, constant);
            Some(binary(Operator::Mul, &square, &square_by_numbers(numbers, sum)?))
        }
        _ => sum_of_squares(&products_with(numbers, part)?),
    }
}

/// Returns the sum of the squares of the coefficients. Returns `None` without products.
fn sum_of_squares(products: &[Projected]) -> Option<Arc<Expression>> {
    let mut sum: Option<Arc<Expression>> = None;
    for Projected { coefficient, .. } in products {
        let own = binary(Operator::Mul, coefficient, coefficient);
        sum = Some(match &sum {
            None => own,
            Some(sum) => binary(Operator::Add, sum, &own),
        });
    }
    sum
}

/// Returns the squares of the lengths whose product is the divisor: each is the operand of a root. Returns `None` for a divisor of
/// another kind.
fn squares_of_lengths(divisor: &Expression) -> Option<Vec<Arc<Expression>>> {
    match &divisor.kind {
        Kind::Unary(Function::Sqrt, square) => match &square.kind {
            Kind::Binary(Operator::Mul, a, b) if a != b => Some(vec![a.clone(), b.clone()]),
            _ => Some(vec![square.clone()]),
        },
        Kind::Binary(Operator::Mul, a, b) => {
            let mut squares = squares_of_lengths(a)?;
            squares.extend(squares_of_lengths(b)?);
            Some(squares)
        }
        _ => None,
    }
}

/// Returns the different numbers whose squares a sum adds. A constant that is not negative may be added too: it makes a divisor larger.
/// Returns `None` for any other formula.
fn numbers_of(sum: &Arc<Expression>) -> Option<Vec<Arc<Expression>>> {
    let mut numbers = Vec::new();
    for term in terms_of(sum, &[Operator::Add])? {
        let number = match &term.kind {
            Kind::Binary(Operator::Power, base, exponent) if **exponent == *two() => base,
            Kind::Binary(Operator::Mul, a, b) if a == b => a,
            _ if term.rational().is_some_and(|value| value >= RBig::ZERO) => continue,
            _ => return None,
        };
        if numbers.contains(number) {
            return None;
        }
        numbers.push(number.clone());
    }
    Some(numbers)
}

/// Returns the products that a dividend adds or subtracts. Each has one of the numbers as a factor, and no two have the same. Returns
/// `None` for any other formula.
fn products_with(
    numbers: &[Arc<Expression>],
    dividend: &Arc<Expression>,
) -> Option<Vec<Projected>> {
    let mut products: Vec<Projected> = Vec::new();
    for term in terms_of(dividend, &[Operator::Add, Operator::Sub])? {
        let is_number = |part: &Arc<Expression>| numbers.contains(part);
        let (number, coefficient) = match &term.kind {
            _ if is_number(&term) => (term.clone(), one()),
            Kind::Unary(Function::Negate, a) if is_number(a) => (a.clone(), one()),
            Kind::Binary(Operator::Mul, a, b) if is_number(a) => (a.clone(), b.clone()),
            Kind::Binary(Operator::Mul, a, b) if is_number(b) => (b.clone(), a.clone()),
            Kind::Binary(Operator::Div, a, b) if is_number(a) && !b.varies() => {
                (a.clone(), binary(Operator::Div, &one(), b))
            }
            Kind::Binary(Operator::Power, base, exponent)
                if **exponent == *two() && is_number(base) =>
            {
                (base.clone(), base.clone())
            }
            _ => return None,
        };
        if products.iter().any(|known| known.number == number) {
            return None;
        }
        products.push(Projected { number, coefficient });
    }
    Some(products)
}

/// Returns the formulas that a chain of the operators joins: for sums and differences, `a - (b + c)` gives a, b and c. Returns `None` for
/// a chain of more than [`MOST_TERMS`] formulas.
fn terms_of(part: &Arc<Expression>, operators: &[Operator]) -> Option<Vec<Arc<Expression>>> {
    let mut terms = Vec::new();
    let mut open = vec![part.clone()];
    while let Some(part) = open.pop() {
        if terms.len() + open.len() >= MOST_TERMS {
            return None;
        }
        match &part.kind {
            Kind::Binary(operator, a, b) if operators.contains(operator) => {
                open.extend([a.clone(), b.clone()]);
            }
            _ => terms.push(part),
        }
    }
    Some(terms)
}

fn binary(operator: Operator, a: &Arc<Expression>, b: &Arc<Expression>) -> Arc<Expression> {
    let kind = Kind::Binary(operator, a.clone(), b.clone());
    Arc::new(Expression::new(kind, a.span.clone()))
}

fn is_zero(part: &Expression) -> bool {
    !part.varies() && part.rational().is_some_and(|value| value.is_zero())
}

fn one() -> Arc<Expression> {
    Arc::new(parse("1").expect("a number"))
}

fn two() -> Arc<Expression> {
    Arc::new(parse("2").expect("a number"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the square of the limit as text.
    fn limit_of(formula: &str) -> Option<String> {
        let formula = parse(formula).expect("a formula");
        square_of_limit(&formula.kind).map(|square| square.python())
    }

    /// Returns the value of a formula for x, y, p and q.
    fn value(formula: &str, [x, y, p, q]: [f64; 4]) -> f64 {
        let operands = [("x", x), ("y", y), ("p", p), ("q", q)]
            .map(|(name, value)| (name, glint_formula::Enclosure::exactly(value)));
        parse(formula).expect("a formula").enclose(&operands).expect("a value").middle()
    }

    #[test]
    fn a_quotient_by_a_length_is_at_most_the_length_of_the_coefficients() {
        for formula in [
            "x / sqrt(x^2 + y^2)",
            "-x / sqrt(y * y + x * x + 3)",
            "(x * p + q * y) / sqrt(x^2 + y^2)",
            "(x * p - 3 * y) / sqrt(x^2 + y^2 + 0.5)",
            "(x / 3 - y / -7) / sqrt(x^2 + y^2)",
            "(x * p + q * y) / (sqrt(x^2 + y^2) * sqrt(p^2 + q^2))",
            "(x * p + q * y) / sqrt((x^2 + y^2) * (p^2 + q^2))",
            "(x^2 + p * y) / sqrt(x^2 + y^2)",
            "x^2 * y / sqrt(x^2 + y^2)",
            "x * (x * p + y * q) / (x^2 + y^2)",
            "(y * q - p * x) * (x * p + y * 7) / (x^2 + y^2)",
            "x * ((x * p + y * q) / (x^2 + y^2))",
            "-3 * (x * p + y * q) / (x^2 + y^2) * x",
            "3 * ((x * p + y * q) / (x^2 + y^2)) * y",
            "(y * q + x * p) * 0.5 / sqrt(x^2 + y^2)",
            "max(0, y * q + x * p) / sqrt(x^2 + y^2)",
            "abs(y * q + x * p) / sqrt(x^2 + y^2)",
        ] {
            let limit = limit_of(formula).unwrap_or_else(|| panic!("{formula} has a limit"));
            for point in [[1.0, 2.0, 3.0, -4.0], [-0.5, 0.25, 2.0, 8.0], [3.0, 4.0, 3.0, 4.0]] {
                let limit = value(&limit, point).sqrt();
                let value = value(formula, point).abs();
                assert!(value <= limit * (1.0 + 1e-12), "{formula} is {value}, above {limit}");
            }
        }
    }

    #[test]
    fn other_quotients_have_no_limit() {
        for formula in [
            "z / sqrt(x^2 + y^2)",
            "x / sqrt(x^2 - y^2)",
            "x / sqrt(x^2 + y)",
            "x / sqrt(x^2 - 1)",
            "(x * p + x * q) / sqrt(x^2 + y^2)",
            "x * y * p / sqrt(x^2 + y^2)",
            "(x * p + y * q) / (sqrt(x^2 + y^2) * sqrt(p^2))",
            "(x * p + y * p) / (sqrt(x^2 + y^2) * sqrt(p^2 + q^2))",
            "x / (x^2 + y^2)",
            "x * p / (x^2 + y^2)",
            "max(1, x) / sqrt(x^2 + y^2)",
            "x * (x * p + y * q) / (x^2 - y^2)",
        ] {
            assert_eq!(limit_of(formula), None, "{formula}");
        }
    }

    #[test]
    fn rounded_constants_change_a_quotient_by_at_most_the_deviation() {
        for formula in [
            "(0.6 * x - y / 3) / sqrt(x^2 + y^2)",
            "max(0, (x * p + 0.8 * y) / sqrt(x^2 + y^2))",
            "min(1, max((x * 100.3 + y * pi) / sqrt(y^2 + x^2 + 1), 0))",
        ] {
            let part = parse(formula).expect("a formula");
            for frac in [4, 9, 14] {
                let rounded = rounded(&part, frac).expect("rounded constants");
                assert!(rounded.deviation <= exp2(-frac.min(10)), "{formula}");
                let text = rounded.formula.python();
                for point in [[1.0, 2.0, 3.0, -4.0], [-0.5, 0.25, 2.0, 8.0], [3.0, -4.0, 0.5, 0.0]]
                {
                    let difference = (value(formula, point) - value(&text, point)).abs();
                    assert!(difference <= rounded.deviation + 1e-12, "{formula}, {frac} bits");
                }
            }
        }
    }

    #[test]
    fn quotients_without_constants_to_round_are_left_as_they_are() {
        for formula in [
            "(0.5 * x - 3 * y) / sqrt(x^2 + y^2)",
            "(x * p + y * q) / sqrt(x^2 + y^2)",
            "(0.3 * x + 0.4 * z) / sqrt(x^2 + y^2)",
            "(0.3 * x + 0.4 * y) / (x^2 + y^2)",
        ] {
            let part = parse(formula).expect("a formula");
            assert!(rounded(&part, 9).is_none(), "{formula}");
        }
    }

    #[test]
    fn large_constants_are_rounded_to_integers() {
        let part = parse("(12345678901234567 * x + y) / sqrt(x^2 + y^2)").expect("a formula");
        let RoundedProjection { formula, deviation } =
            rounded(&part, 9).expect("a rounded constant");
        let text = formula.python();
        assert!(text.contains(" * 137438953472"), "{text}");
        assert!(deviation <= 137_438_953_472.0 / 2.0 * ROUNDED_UP, "{deviation}");
    }

    #[test]
    fn constants_within_other_coefficients_are_not_rounded() {
        let part = parse("(0.3 * x + (p * 0.3) * y) / sqrt(x^2 + y^2)").expect("a formula");
        let text = rounded(&part, 4).expect("a rounded constant").formula.python();
        assert_eq!(text.matches("0.3").count(), 1, "{text}");
    }
}

//! Finds quotients in formulas, and writes formulas with rational constants so that all their constants are exact in binary. For
//! example, `x / 3 + 0.1` is `(20 * x + 6) / 60`, apart from common factors.

use std::sync::Arc;

use glint_formula::{Comparison, Expression, Function, Kind, Operator, RBig};

use super::shape::number;

/// The largest exponent of a power that is written as a quotient by a number.
const LARGEST_EXPONENT: u32 = 8;

pub(super) struct QuotientParts {
    pub(super) dividend: Expression,
    pub(super) divisor: Expression,
}

/// Returns a quotient q for which `a - b` is floor(q): `b` is the remainder of `a` by 1, and `a` is q. Returns `None` if `a` is no
/// quotient.
pub(super) fn floor_of_quotient(a: &Expression, b: &Expression) -> Option<QuotientParts> {
    let is_remainder =
        matches!(&b.kind, Kind::Binary(Operator::Mod, of, one) if **of == *a && is_one(one));
    if is_remainder { rational_quotient(a) } else { None }
}

/// Returns a quotient q for which `a + b` is the ceiling of −q: `b` is the remainder of `-a` by 1, and `-a` is q. Returns `None` if
/// `a` is no quotient.
pub(super) fn ceiling_of(a: &Expression, b: &Expression) -> Option<QuotientParts> {
    let Kind::Binary(Operator::Mod, negated, one) = &b.kind else { return None };
    let is_negated = matches!(&negated.kind, Kind::Unary(Function::Negate, of) if **of == *a);
    if is_negated && is_one(one) { rational_quotient(negated) } else { None }
}

fn is_one(part: &Expression) -> bool {
    !part.varies() && *part == number("1")
}

/// Writes a formula as a quotient with a divisor that varies. For example, `x / y + 1/2` is `(x + 1/2 * y) / y`, and `x / y / 2` is
/// `x / (y * 2)`. Returns `None` for a formula without such a quotient.
pub(super) fn quotient_of(formula: &Expression) -> Option<QuotientParts> {
    let made = |kind: Kind| Expression::new(kind, formula.span.clone());
    let binary = |operator, a: &Expression, b: &Expression| {
        made(Kind::Binary(operator, Arc::new(a.clone()), Arc::new(b.clone())))
    };
    match &formula.kind {
        Kind::Binary(Operator::Div, a, b) => match quotient_of(a) {
            Some(QuotientParts { dividend, divisor }) => {
                let divisor = binary(Operator::Mul, &divisor, b);
                Some(QuotientParts { dividend, divisor })
            }
            None if b.varies() => {
                Some(QuotientParts { dividend: (**a).clone(), divisor: (**b).clone() })
            }
            None => None,
        },
        Kind::Binary(Operator::Mul, a, b) if !a.varies() || !b.varies() => {
            let (constant, other) = if a.varies() { (b, a) } else { (a, b) };
            let QuotientParts { dividend, divisor } = quotient_of(other)?;
            let dividend = binary(Operator::Mul, constant, &dividend);
            Some(QuotientParts { dividend, divisor })
        }
        Kind::Unary(Function::Negate, a) => {
            let QuotientParts { dividend, divisor } = quotient_of(a)?;
            let dividend = made(Kind::Unary(Function::Negate, Arc::new(dividend)));
            Some(QuotientParts { dividend, divisor })
        }
        Kind::Binary(operator @ (Operator::Add | Operator::Sub), a, b) if !b.varies() => {
            let QuotientParts { dividend, divisor } = quotient_of(a)?;
            let moved = binary(Operator::Mul, b, &divisor);
            Some(QuotientParts { dividend: binary(*operator, &dividend, &moved), divisor })
        }
        Kind::Binary(operator @ (Operator::Add | Operator::Sub), a, b) if !a.varies() => {
            let QuotientParts { dividend, divisor } = quotient_of(b)?;
            let moved = binary(Operator::Mul, a, &divisor);
            Some(QuotientParts { dividend: binary(*operator, &moved, &dividend), divisor })
        }
        _ => None,
    }
}

/// A formula whose constants are exact in binary, and an odd number above 0 by which it is divided.
pub(super) struct OverNumber {
    pub(super) dividend: Expression,
    pub(super) divisor: RBig,
}

impl OverNumber {
    fn undivided(dividend: Expression) -> Self {
        Self { dividend, divisor: RBig::ONE }
    }

    /// Returns the dividend for the divisor `common`, a multiple of the present divisor.
    fn over(&self, common: &RBig) -> Expression {
        times(&self.dividend, &(common.clone() / &self.divisor))
    }
}

/// Writes a formula as a quotient of formulas whose constants are exact in binary. For example, `0.1 * x / y` becomes
/// `x / (10 * y)`, and `x / 3` is a quotient with the constant divisor 3. Returns `None` for a formula that is no quotient, and for
/// one with other constants.
pub(super) fn rational_quotient(formula: &Expression) -> Option<QuotientParts> {
    let Some(QuotientParts { dividend, divisor }) = quotient_of(formula) else {
        let OverNumber { dividend, divisor } = over_number(formula)?;
        let is_divided = divisor != RBig::ONE;
        return is_divided.then(|| without_binary_places(dividend, divisor));
    };
    let (Some(above), Some(below)) = (over_number(&dividend), over_number(&divisor)) else {
        return Some(QuotientParts { dividend, divisor });
    };
    let dividend = times(&above.dividend, &below.divisor);
    let divisor = times(&below.dividend, &above.divisor);
    Some(QuotientParts { dividend, divisor })
}

/// Writes a quotient whose divisor is a sum of quotients with a single division: `1 / (1 / x + 1 / y)` is `x * y / (y + x)`. Returns
/// `None` for any other formula.
pub(super) fn with_single_division(formula: &Expression) -> Option<Expression> {
    let Kind::Binary(Operator::Div, a, b) = &formula.kind else { return None };
    let QuotientParts { dividend, divisor } = sum_of_quotients(b)?;
    let above = joined(Operator::Mul, a, &divisor);
    Some(joined(Operator::Div, &above, &dividend))
}

/// Writes a sum of at least two quotients with divisors that vary as a single quotient. Returns `None` for any other formula.
fn sum_of_quotients(formula: &Expression) -> Option<QuotientParts> {
    let Kind::Binary(operator @ (Operator::Add | Operator::Sub), a, b) = &formula.kind else {
        return None;
    };
    let parts = |part: &Expression| sum_of_quotients(part).or_else(|| quotient_of(part));
    let (first, second) = (parts(a)?, parts(b)?);
    let left = joined(Operator::Mul, &first.dividend, &second.divisor);
    let right = joined(Operator::Mul, &second.dividend, &first.divisor);
    let divisor = joined(Operator::Mul, &first.divisor, &second.divisor);
    Some(QuotientParts { dividend: joined(*operator, &left, &right), divisor })
}

fn joined(operator: Operator, a: &Expression, b: &Expression) -> Expression {
    let kind = Kind::Binary(operator, Arc::new(a.clone()), Arc::new(b.clone()));
    Expression::new(kind, a.span.clone())
}

/// Returns a quotient by a number. A dividend such as `x / 2` gives its power of two to the divisor: `(x / 2) / 5` is `x / 10`, whose
/// product with the reciprocal then serves `x % 10` too.
fn without_binary_places(dividend: Expression, divisor: RBig) -> QuotientParts {
    if let Kind::Binary(Operator::Mul, factor, rest) = &dividend.kind
        && let Some(value) = factor.rational()
    {
        let divisor = divisor * RBig::from(value.denominator().clone());
        let dividend = times(rest, &RBig::from(value.numerator().clone()));
        return QuotientParts { dividend, divisor: constant(&divisor) };
    }
    QuotientParts { dividend, divisor: constant(&divisor) }
}

/// Returns an equal comparison without divisions by odd numbers: `x / 3 > y` becomes `x > 3 * y`. Returns `None` for a comparison
/// without such a division, and for one with functions.
pub(super) fn without_fractions(comparison: &Comparison) -> Option<Comparison> {
    let ([left, right], divisor) = with_common_divisor([&comparison.left, &comparison.right])?;
    let [left, right] = [left, right].map(Arc::new);
    let or_equal = comparison.or_equal;
    (divisor != RBig::ONE).then_some(Comparison { left, right, or_equal })
}

/// Writes a formula with constants that are exact in binary, over an odd number: `x / 3 + 1/2` is x + 3/2 over 3. Returns `None`
/// for a formula with a function, a quotient by a number that varies, or an irrational constant.
pub(super) fn over_number(formula: &Expression) -> Option<OverNumber> {
    let with_kind = |kind: Kind| Expression::new(kind, formula.span.clone());
    if !formula.varies() {
        let value = formula.rational()?;
        let (places, odd) = odd_part(RBig::from(value.denominator().clone()));
        if odd == RBig::ONE {
            return Some(OverNumber::undivided(formula.clone()));
        }
        let numerator = RBig::from(value.numerator().clone());
        let dividend = constant(&(numerator / RBig::from(2).pow(places)));
        return Some(OverNumber { dividend, divisor: odd });
    }
    match &formula.kind {
        // Remainders and integer parts are whole numbers of the last place, and need no divisor.
        Kind::Operand(_) | Kind::Binary(Operator::Mod, ..) => {
            Some(OverNumber::undivided(formula.clone()))
        }
        Kind::Binary(Operator::Sub, a, b) if floor_of_quotient(a, b).is_some() => {
            Some(OverNumber::undivided(formula.clone()))
        }
        Kind::Binary(Operator::Add, a, b) if ceiling_of(a, b).is_some() => {
            Some(OverNumber::undivided(formula.clone()))
        }
        Kind::Unary(function @ (Function::Negate | Function::Abs), a) => {
            let OverNumber { dividend, divisor } = over_number(a)?;
            let dividend = with_kind(Kind::Unary(*function, Arc::new(dividend)));
            Some(OverNumber { dividend, divisor })
        }
        Kind::Binary(Operator::Mul, a, b) => {
            let (a, b) = (over_number(a)?, over_number(b)?);
            let product = Kind::Binary(Operator::Mul, Arc::new(a.dividend), Arc::new(b.dividend));
            let divisor = a.divisor * b.divisor;
            Some(OverNumber { dividend: with_kind(product), divisor })
        }
        Kind::Binary(Operator::Div, a, b) if !b.varies() => {
            let reciprocal = RBig::ONE / b.rational().filter(|value| *value != RBig::ZERO)?;
            let factor = over_number(&constant(&reciprocal))?;
            let OverNumber { dividend, divisor } = over_number(a)?;
            let factor_value = factor.dividend.rational()?;
            let dividend = times(&dividend, &factor_value);
            Some(OverNumber { dividend, divisor: divisor * factor.divisor })
        }
        Kind::Binary(Operator::Power, a, b) if !b.varies() => {
            let exponent = b.rational().filter(RBig::is_int)?;
            let exponent = u32::try_from(exponent.numerator().clone()).ok()?;
            if !(1..=LARGEST_EXPONENT).contains(&exponent) {
                return None;
            }
            let OverNumber { dividend, divisor } = over_number(a)?;
            let power = Kind::Binary(Operator::Power, Arc::new(dividend), b.clone());
            Some(OverNumber { dividend: with_kind(power), divisor: divisor.pow(exponent as isize) })
        }
        Kind::Binary(
            operator @ (Operator::Add | Operator::Sub | Operator::Min | Operator::Max),
            a,
            b,
        ) => {
            let ([a, b], divisor) = with_common_divisor([a, b])?;
            let dividend = with_kind(Kind::Binary(*operator, Arc::new(a), Arc::new(b)));
            Some(OverNumber { dividend, divisor })
        }
        Kind::If(comparison, yes, no) => {
            let ([yes, no], divisor) = with_common_divisor([yes, no])?;
            let chosen = Kind::If(comparison.clone(), Arc::new(yes), Arc::new(no));
            Some(OverNumber { dividend: with_kind(chosen), divisor })
        }
        _ => None,
    }
}

/// Returns the dividends of two formulas for the same divisor, and this divisor.
fn with_common_divisor(parts: [&Expression; 2]) -> Option<([Expression; 2], RBig)> {
    let [a, b] = [over_number(parts[0])?, over_number(parts[1])?];
    // The numerator of a fraction in lowest terms, times the divisor, is the least common multiple.
    let ratio = a.divisor.clone() / &b.divisor;
    let common = RBig::from(ratio.numerator().clone()) * &b.divisor;
    Some(([a.over(&common), b.over(&common)], common))
}

/// Returns k and an odd number whose product with 2^k is the integer `value`, which is above 0.
fn odd_part(value: RBig) -> (isize, RBig) {
    let mut odd = value;
    let mut places = 0;
    loop {
        let half = odd.clone() / RBig::from(2);
        if !half.is_int() {
            return (places, odd);
        }
        odd = half;
        places += 1;
    }
}

/// Returns a formula times a number, or the formula itself for the number 1.
pub(super) fn times(formula: &Expression, factor: &RBig) -> Expression {
    if *factor == RBig::ONE {
        return formula.clone();
    }
    let kind = Kind::Binary(Operator::Mul, Arc::new(constant(factor)), Arc::new(formula.clone()));
    Expression::new(kind, formula.span.clone())
}

fn constant(value: &RBig) -> Expression {
    number(&value.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_divisor_of_quotients_becomes_a_single_division() {
        let single = |formula: &str| with_single_division(&number(formula)).map(|it| it.python());
        assert_eq!(single("1 / (1 / x + 2 / y)").unwrap(), "1.0 * (x * y) / (1.0 * y + 2.0 * x)");
        for other in ["1 / (x + y)", "1 / (1 / x + y)", "1 / x + 1 / y", "1 / (1 / x)"] {
            assert_eq!(single(other), None, "{other}");
        }
    }

    #[test]
    fn a_quotient_and_a_remainder_by_a_constant_have_the_same_divisor() {
        let parts = rational_quotient(&number("x / 10")).unwrap();
        assert_eq!(parts.divisor.rational(), Some(RBig::from(10)));
        assert_eq!(parts.dividend, Expression::operand("x"));
    }
}

//! Computes formulas without rounding if their values are rational numbers, multiples of π, or logarithms of rational numbers.
//!
//! For example, `0.1 * 10` is 1, `16 ^ (1 / 2)` is 4, and `sin(pi * 0.5)` is 1. Intervals cannot decide about a value that lies
//! exactly on a jump. An interval around `0.1 * 10` also contains values below 1, with a floor of 0. The exact value decides the
//! floor.

use dashu_base::{Abs, BitTest, Signed, SquareRootRem};
use dashu_int::{IBig, UBig};
use dashu_ratio::RBig;

use super::{Function, Operator};

/// The largest number of bits of numerator and denominator together. A larger value is treated as not exactly known.
const MOST_BITS: usize = 1 << 14;

/// The limit of the exponents that are tried for the quotient of two logarithms.
const LARGEST_LOGARITHM: usize = 1100;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Exact {
    Rational(RBig),
    /// A rational number other than 0, times π.
    TimesPi(RBig),
    /// The natural logarithm of a rational number above 0 other than 1.
    LogarithmOf(RBig),
}

use Exact::{LogarithmOf, Rational, TimesPi};

impl Exact {
    pub(super) fn integer(value: i64) -> Self {
        Rational(value.into())
    }

    pub(super) fn is_zero(&self) -> bool {
        matches!(self, Rational(value) if value.is_zero())
    }

    /// Returns the exact number, or `None` if it has more than [`MOST_BITS`] bits.
    fn rational(value: RBig) -> Option<Self> {
        let bits = value.numerator().bit_len() + value.denominator().bit_len();
        (bits <= MOST_BITS).then_some(Rational(value))
    }

    fn times_pi(factor: RBig) -> Self {
        if factor.is_zero() { Rational(factor) } else { TimesPi(factor) }
    }

    /// Returns the exact value of a function, or `None` if it is not known. The sine, cosine and tangent are exact only at
    /// rational multiples of π where they are rational (Niven's theorem).
    pub(super) fn function(&self, function: Function) -> Option<Self> {
        match (function, self) {
            (Function::Negate, Rational(a)) => Some(Rational(-a.clone())),
            (Function::Negate, TimesPi(a)) => Some(TimesPi(-a.clone())),
            (Function::Negate, LogarithmOf(a)) => Some(LogarithmOf(RBig::ONE / a)),
            (Function::Abs, Rational(a)) => Some(Rational(a.clone().abs())),
            (Function::Abs, TimesPi(a)) => Some(TimesPi(a.clone().abs())),
            (Function::Sqrt, Rational(a)) => root(a, 2).map(Rational),
            (Function::Exp, LogarithmOf(a)) => Some(Rational(a.clone())),
            (Function::Exp, Rational(a)) if a.is_zero() => Some(Self::integer(1)),
            (Function::Exp2, Rational(a)) => Self::integer(2).power(self).filter(|_| a.is_int()),
            (Function::Ln, Rational(a)) if a.is_one() => Some(Self::integer(0)),
            (Function::Ln, Rational(a)) if a.is_positive() => Some(LogarithmOf(a.clone())),
            (Function::Log2, Rational(a)) if a.is_positive() => {
                logarithm(a, &RBig::from(2)).map(|power| Self::integer(power as i64))
            }
            (Function::Sin, _) => sine(&self.turns()?),
            (Function::Cos, _) => sine(&(self.turns()? + RBig::from(1) / RBig::from(2))),
            (Function::Tan, _) => tangent(&self.turns()?),
            (Function::Atan, Rational(a)) if a.clone().abs().is_one() => {
                Some(TimesPi(a / RBig::from(4)))
            }
            (Function::Atan | Function::Tanh | Function::Erf, Rational(a)) if a.is_zero() => {
                Some(Self::integer(0))
            }
            _ => None,
        }
    }

    /// Returns the rational factor of π, which is 0 for the number 0. Returns `None` for a number that is no such multiple.
    fn turns(&self) -> Option<RBig> {
        match self {
            TimesPi(a) => Some(a.clone()),
            Rational(a) if a.is_zero() => Some(RBig::ZERO),
            _ => None,
        }
    }

    /// Returns the exact value of a function of two numbers, or `None` if it is not known.
    pub(super) fn operator(operator: Operator, a: &Self, b: &Self) -> Option<Self> {
        match operator {
            Operator::Add => a.add(b),
            Operator::Sub => a.add(&b.function(Function::Negate)?),
            Operator::Mul => a.multiply(b),
            Operator::Div => a.divide(b),
            Operator::Power => a.power(b),
            // Remainders, minima, maxima and directions need comparisons, which the evaluation makes.
            Operator::Mod | Operator::Min | Operator::Max | Operator::Atan2 => None,
        }
    }

    fn add(&self, other: &Self) -> Option<Self> {
        match (self, other) {
            (Rational(a), Rational(b)) => Self::rational(a + b),
            (TimesPi(a), TimesPi(b)) => Some(Self::times_pi(a + b)),
            (Rational(zero), value) | (value, Rational(zero)) if zero.is_zero() => {
                Some(value.clone())
            }
            (LogarithmOf(a), LogarithmOf(b)) => Rational(a * b).function(Function::Ln),
            _ => None,
        }
    }

    fn multiply(&self, other: &Self) -> Option<Self> {
        match (self, other) {
            (Rational(a), Rational(b)) => Self::rational(a * b),
            (Rational(zero), _) | (_, Rational(zero)) if zero.is_zero() => Some(Self::integer(0)),
            (Rational(a), TimesPi(b)) | (TimesPi(b), Rational(a)) => Some(Self::times_pi(a * b)),
            (Rational(one), value) | (value, Rational(one)) if one.is_one() => Some(value.clone()),
            (Rational(a), LogarithmOf(b)) | (LogarithmOf(b), Rational(a)) => {
                let Rational(power) = Rational(b.clone()).power(&Rational(a.clone()))? else {
                    return None;
                };
                Rational(power).function(Function::Ln)
            }
            _ => None,
        }
    }

    fn divide(&self, other: &Self) -> Option<Self> {
        match (self, other) {
            (_, Rational(b)) if b.is_zero() => None,
            (_, Rational(b)) => self.multiply(&Rational(RBig::ONE / b)),
            (Rational(zero), _) if zero.is_zero() => Some(Self::integer(0)),
            (TimesPi(a), TimesPi(b)) => Self::rational(a / b),
            (LogarithmOf(a), LogarithmOf(b)) => {
                logarithm(a, b).map(|power| Self::integer(power as i64))
            }
            _ => None,
        }
    }

    fn power(&self, exponent: &Self) -> Option<Self> {
        let (Rational(base), Rational(exponent)) = (self, exponent) else { return None };
        if exponent.is_zero() || base.is_one() {
            return Some(Self::integer(1));
        }
        if base.is_zero() {
            return exponent.is_positive().then(|| Self::integer(0));
        }
        if base.is_negative() && !exponent.is_int() {
            return None;
        }
        let degree = usize::try_from(exponent.denominator().clone()).ok()?;
        let base = root(base, degree)?;
        let times = isize::try_from(exponent.numerator().clone()).ok()?;
        let bits = base.numerator().bit_len() + base.denominator().bit_len();
        if bits.saturating_mul(times.unsigned_abs()) > MOST_BITS {
            return None;
        }
        Some(Rational(base.pow(times)))
    }
}

/// Returns the root of `value`, or `None` if it is not rational. For example, the root of degree 3 of 8/27 is 2/3. A negative
/// number has a root only for a `degree` of 1. A degree above [`MOST_BITS`] also gives `None`.
fn root(value: &RBig, degree: usize) -> Option<RBig> {
    if degree == 1 {
        return Some(value.clone());
    }
    if value.is_negative() || degree > MOST_BITS {
        return None;
    }
    let numerator = UBig::try_from(value.numerator().clone()).ok()?;
    let of_integer = |integer: &UBig| {
        if degree == 2 {
            let (root, rest) = integer.sqrt_rem();
            return rest.is_zero().then_some(root);
        }
        let root = integer.nth_root(degree);
        (root.pow(degree) == *integer).then_some(root)
    };
    let (numerator, denominator) = (of_integer(&numerator)?, of_integer(value.denominator())?);
    Some(RBig::from_parts(IBig::from(numerator), denominator))
}

/// Returns the integer k from −1099 to 1099 with baseᵏ = value, or `None` without such an integer. For example, the value 1/8 and
/// the base 2 give −3. Both numbers must be above 0.
fn logarithm(value: &RBig, base: &RBig) -> Option<isize> {
    if base.is_one() {
        return None;
    }
    let grows = *base > RBig::ONE;
    let (base, sign) = if grows { (base.clone(), 1) } else { (RBig::ONE / base, -1) };
    let (value, sign) = match *value >= RBig::ONE {
        true => (value.clone(), sign),
        false => (RBig::ONE / value, -sign),
    };
    let mut power = RBig::ONE;
    for exponent in 0..LARGEST_LOGARITHM as isize {
        if power >= value {
            return (power == value).then_some(sign * exponent);
        }
        power *= &base;
    }
    None
}

/// Returns the sine of `turns` · π, or `None` if it is not 0, ±1/2 or ±1.
fn sine(turns: &RBig) -> Option<Exact> {
    // The angle in sixths of π, modulo a whole turn.
    let sixths = turns * RBig::from(6);
    if !sixths.is_int() {
        return None;
    }
    let sixth = i64::try_from(sixths.numerator() % IBig::from(12)).ok()?.rem_euclid(12);
    let doubled = match sixth {
        0 | 6 => 0,
        1 | 5 => 1,
        3 => 2,
        7 | 11 => -1,
        9 => -2,
        _ => return None,
    };
    Some(Rational(RBig::from(doubled) / RBig::from(2)))
}

/// Returns the tangent of `turns` · π, or `None` if it is not 0 or ±1.
fn tangent(turns: &RBig) -> Option<Exact> {
    let fourths = turns * RBig::from(4);
    if !fourths.is_int() {
        return None;
    }
    match i64::try_from(fourths.numerator() % IBig::from(4)).ok()?.rem_euclid(4) {
        0 => Some(Exact::integer(0)),
        1 => Some(Exact::integer(1)),
        3 => Some(Exact::integer(-1)),
        _ => None,
    }
}

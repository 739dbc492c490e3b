//! Declares the interval arithmetic in which formulas are evaluated: a fast one for `f64`, and one for numbers of any precision.

use std::cmp::Ordering;

use super::{Enclosure, Function, Literal};

/// Arithmetic on intervals. Every returned interval contains the exact result for all numbers in the operands' intervals.
///
/// An `Err` has a message for the user about the computed part of the formula. Sums, products, quotients, powers and functions of
/// precise arithmetic fail if an exponent has too many bits.
pub(super) trait Arithmetic {
    /// An interval that contains one exact value.
    type Value: Clone;

    fn literal(&self, literal: &Literal) -> Self::Value;

    /// Returns an interval for the constant π or e. `name` is the name in [`super::Kind::Constant`]. `below` is the largest `f64`
    /// that is not above the constant.
    fn constant(&self, name: &str, below: f64) -> Self::Value;

    fn integer(&self, value: i64) -> Self::Value;

    /// Converts a constant part's limits, which were computed earlier in `f64`. Returns `None` if the limits are not precise
    /// enough; the part is then computed again.
    fn folded(&self, constant: Enclosure) -> Option<Self::Value>;

    fn add(&self, a: &Self::Value, b: &Self::Value) -> Result<Self::Value, String>;

    fn subtract(&self, a: &Self::Value, b: &Self::Value) -> Result<Self::Value, String>;

    fn multiply(&self, a: &Self::Value, b: &Self::Value) -> Result<Self::Value, String>;

    /// Returns the quotient. The caller must ensure that the interval `b` does not contain 0.
    fn divide(&self, a: &Self::Value, b: &Self::Value) -> Result<Self::Value, String>;

    /// Returns the product of `exponent` factors `a`. `exponent` must be at least 1.
    fn repeated_product(&self, a: &Self::Value, exponent: u32) -> Result<Self::Value, String>;

    /// Returns `a` to the power of `b`. The caller must ensure that no number in the interval `a` is below 0.
    fn power(&self, a: &Self::Value, b: &Self::Value) -> Result<Self::Value, String>;

    /// Returns the values of `function` for `a`. The caller must ensure that the whole interval `a` is within the function's
    /// domain.
    fn function(&self, function: Function, a: &Self::Value) -> Result<Self::Value, String>;

    fn minimum(&self, a: &Self::Value, b: &Self::Value) -> Self::Value;

    fn maximum(&self, a: &Self::Value, b: &Self::Value) -> Self::Value;

    /// Returns how the lower and the upper end of the interval compare with 0. For example, an interval with `(Less, Greater)`
    /// contains 0.
    fn signs(&self, a: &Self::Value) -> (Ordering, Ordering);

    /// Returns the greatest integer that is not above the value, or `None` if it is not the same integer for the whole interval.
    fn floor(&self, a: &Self::Value) -> Option<Self::Value>;

    /// Returns the integer that equals the value. Returns `None` if the value may be no integer, or if its absolute value is
    /// above `largest`.
    fn known_integer(&self, a: &Self::Value, largest: u32) -> Option<i64>;

    /// Returns an interval that contains `a` and `b`, for a value that is either `a` or `b`. Precise arithmetic must know which,
    /// and fails with the message `what`.
    fn either(&self, a: Self::Value, b: Self::Value, what: &str) -> Result<Self::Value, String>;

    /// Returns the interval with its ends rounded outwards to `f64`.
    fn enclosure(&self, a: &Self::Value) -> Enclosure;
}

/// Intervals of `f64`. If a decision is unknown, the interval contains the results of both cases.
pub(super) struct Double;

impl Arithmetic for Double {
    type Value = Enclosure;

    fn literal(&self, literal: &Literal) -> Enclosure {
        let nearest = literal.nearest();
        if literal.is_exact() {
            Enclosure::exactly(nearest)
        } else {
            Enclosure::between(nearest.next_down(), nearest.next_up())
        }
    }

    fn constant(&self, _name: &str, below: f64) -> Enclosure {
        Enclosure::between(below, below.next_up())
    }

    fn folded(&self, constant: Enclosure) -> Option<Enclosure> {
        Some(constant)
    }

    fn integer(&self, value: i64) -> Enclosure {
        Enclosure::exactly(value as f64)
    }

    fn add(&self, a: &Enclosure, b: &Enclosure) -> Result<Enclosure, String> {
        Ok(*a + *b)
    }

    fn subtract(&self, a: &Enclosure, b: &Enclosure) -> Result<Enclosure, String> {
        Ok(*a - *b)
    }

    fn multiply(&self, a: &Enclosure, b: &Enclosure) -> Result<Enclosure, String> {
        Ok(*a * *b)
    }

    fn divide(&self, a: &Enclosure, b: &Enclosure) -> Result<Enclosure, String> {
        Ok(*a / *b)
    }

    fn repeated_product(&self, a: &Enclosure, exponent: u32) -> Result<Enclosure, String> {
        Ok(a.repeated_product(exponent))
    }

    fn power(&self, a: &Enclosure, b: &Enclosure) -> Result<Enclosure, String> {
        Ok(a.power(*b))
    }

    fn function(&self, function: Function, a: &Enclosure) -> Result<Enclosure, String> {
        Ok(match function {
            Function::Negate => -*a,
            Function::Abs => a.abs(),
            Function::Sqrt => a.sqrt(),
            Function::Ln => a.logarithm(libm::log),
            Function::Log2 => a.logarithm(libm::log2),
            Function::Exp => a.exponential(libm::exp),
            Function::Exp2 => a.exponential(libm::exp2),
            Function::Atan => a.odd_and_rising(libm::atan, f64::INFINITY),
            Function::Tanh => a.odd_and_rising(libm::tanh, 1.0),
            Function::Erf => a.odd_and_rising(libm::erf, 1.0),
            Function::Sin => a.sine(),
            Function::Cos => a.wave(libm::cos),
            Function::Tan => a.rising(libm::tan),
        })
    }

    fn minimum(&self, a: &Enclosure, b: &Enclosure) -> Enclosure {
        Enclosure::between(a.low.min(b.low), a.high.min(b.high))
    }

    fn maximum(&self, a: &Enclosure, b: &Enclosure) -> Enclosure {
        Enclosure::between(a.low.max(b.low), a.high.max(b.high))
    }

    fn signs(&self, a: &Enclosure) -> (Ordering, Ordering) {
        let sign = |value: f64| value.partial_cmp(&0.0).unwrap_or(Ordering::Equal);
        (sign(a.low), sign(a.high))
    }

    fn floor(&self, a: &Enclosure) -> Option<Enclosure> {
        (a.low.floor() == a.high.floor()).then(|| Enclosure::exactly(a.low.floor()))
    }

    fn known_integer(&self, a: &Enclosure, largest: u32) -> Option<i64> {
        let is_integer = a.low == a.high && a.low.fract() == 0.0;
        (is_integer && a.low.abs() <= f64::from(largest)).then_some(a.low as i64)
    }

    fn either(&self, a: Enclosure, b: Enclosure, _what: &str) -> Result<Enclosure, String> {
        Ok(a.hull(b))
    }

    fn enclosure(&self, a: &Enclosure) -> Enclosure {
        *a
    }
}

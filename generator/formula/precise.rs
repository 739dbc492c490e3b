//! Computes with intervals of any precision. A value that is known exactly is also stored exactly.
//!
//! The arithmetic is slow. Glint uses it for constants, such as a domain's ends, and if intervals of `f64` do not decide. For
//! example, an `f64` interval around 1 leaves open whether the `floor` of its value is 0 or 1, and `exp(1000)` in `1 / (1 +
//! exp(1000))` is beyond the range of `f64`.

use std::cmp::Ordering;

use dashu_base::{Abs, Sign};
use dashu_float::round::{ErrorBounds, mode};
use dashu_float::{Context, FBig, FpError, Repr};
use dashu_int::IBig;
use dashu_ratio::RBig;

use super::arithmetic::Arithmetic;
use super::exact::Exact;
use super::{Enclosure, Function, Literal, Operator};

/// A number m · 2ᵉ of any size.
type BigFloat = Repr<2>;

/// A number that the library rounds in the direction of the context `R`, or an error.
type Rounded<R> =
    Result<dashu_base::Approximation<FBig<R, 2>, dashu_float::round::Rounding>, FpError>;

/// An interval that contains a value, and the exact value if it is known.
#[derive(Clone, Debug)]
pub(super) struct PreciseValue {
    low: BigFloat,
    high: BigFloat,
    exact: Option<Exact>,
}

impl PreciseValue {
    fn between(low: BigFloat, high: BigFloat) -> Self {
        Self { low, high, exact: None }
    }

    /// Returns the value, or `None` if it is not known to be rational.
    pub(super) fn rational(&self) -> Option<&RBig> {
        match &self.exact {
            Some(Exact::Rational(value)) => Some(value),
            _ => None,
        }
    }
}

/// Arithmetic with numbers of a given number of bits. The lower limit of each result is rounded down, and the upper limit up.
pub(super) struct Precise {
    bits: usize,
    down: Context<mode::Down>,
    up: Context<mode::Up>,
}

impl Precise {
    pub(super) fn new(bits: usize) -> Self {
        Self { bits, down: Context::new(bits), up: Context::new(bits) }
    }

    /// Returns a rational number's interval, which is also stored exactly.
    pub(super) fn rational(&self, value: &RBig) -> PreciseValue {
        self.exactly(Exact::Rational(value.clone()))
    }

    /// Returns the smallest integer that is not below `value` · 2^`fraction`, and whether the two are equal. Returns `None` if
    /// the interval does not decide this, or if the integer has more than 127 bits.
    pub(super) fn ceiling(&self, value: &PreciseValue, fraction: u32) -> Option<(i128, bool)> {
        if let Some(exact) = value.rational() {
            let scaled = exact * RBig::from(IBig::ONE << fraction as usize);
            return Some((i128::try_from(scaled.ceil()).ok()?, scaled.is_int()));
        }
        let scaled = |number: &BigFloat| {
            FBig::<mode::Zero, 2>::from_repr(number.clone(), Context::new(self.bits))
                << fraction as isize
        };
        let (low, high) = (scaled(&value.low), scaled(&value.high));
        let ceiling = IBig::try_from(low.ceil()).ok()?;
        let is_above = FBig::<mode::Zero, 2>::from(ceiling.clone()) > high;
        if !is_above {
            return None;
        }
        Some((i128::try_from(ceiling).ok()?, false))
    }

    fn exactly(&self, exact: Exact) -> PreciseValue {
        let (low, high) = match &exact {
            Exact::Rational(value) => self.quotient(value),
            Exact::TimesPi(factor) => {
                let (low, high) = self.quotient(factor);
                let pi = self.pi();
                let product = self.corners(&PreciseValue::between(low, high), &pi, Self::product);
                product.map_or_else(
                    |_| (BigFloat::zero(), BigFloat::infinity()),
                    |it| (it.low, it.high),
                )
            }
            Exact::LogarithmOf(value) => {
                let (low, high) = self.quotient(value);
                let down = self.down.ln(&low, None).map(|it| it.value().into_repr());
                let up = self.up.ln(&high, None).map(|it| it.value().into_repr());
                (
                    down.unwrap_or_else(|_| BigFloat::neg_infinity()),
                    up.unwrap_or_else(|_| BigFloat::infinity()),
                )
            }
        };
        PreciseValue { low, high, exact: Some(exact) }
    }

    fn quotient(&self, value: &RBig) -> (BigFloat, BigFloat) {
        let numerator = BigFloat::new(value.numerator().clone(), 0);
        let denominator = BigFloat::new(IBig::from(value.denominator().clone()), 0);
        let low = self.down.div(&numerator, &denominator).map(|it| it.value().into_repr());
        let high = self.up.div(&numerator, &denominator).map(|it| it.value().into_repr());
        (
            low.unwrap_or_else(|_| BigFloat::neg_infinity()),
            high.unwrap_or_else(|_| BigFloat::infinity()),
        )
    }

    fn pi(&self) -> PreciseValue {
        let low = self.down.pi::<2>(None).value().into_repr();
        let high = self.up.pi::<2>(None).value().into_repr();
        PreciseValue::between(low, high)
    }

    /// Returns the interval between the results of an operation that were rounded down and up. Fails if a result is an error of
    /// the library, for example because an exponent has too many bits.
    fn rounded(down: Rounded<mode::Down>, up: Rounded<mode::Up>) -> Result<PreciseValue, String> {
        let beyond = |error: FpError| match error {
            FpError::Overflow(_) | FpError::Underflow(_) => {
                "a value with an exponent of more than 60 bits".to_owned()
            }
            other => other.to_string(),
        };
        let low = down.map_err(beyond)?.value().into_repr();
        let high = up.map_err(beyond)?.value().into_repr();
        Ok(PreciseValue::between(low, high))
    }

    fn product(&self, a: &BigFloat, b: &BigFloat) -> Result<PreciseValue, String> {
        Self::rounded(self.down.mul(a, b), self.up.mul(a, b))
    }

    /// Returns the smallest interval that contains an operation's results at the four combinations of the intervals' limits. The
    /// interval contains all results if the operation is monotone in each operand.
    fn corners(
        &self,
        a: &PreciseValue,
        b: &PreciseValue,
        operation: impl Fn(&Self, &BigFloat, &BigFloat) -> Result<PreciseValue, String>,
    ) -> Result<PreciseValue, String> {
        let mut hull = operation(self, &a.low, &b.low)?;
        for (a, b) in [(&a.low, &b.high), (&a.high, &b.low), (&a.high, &b.high)] {
            let corner = operation(self, a, b)?;
            hull.low = hull.low.min(corner.low);
            hull.high = hull.high.max(corner.high);
        }
        Ok(hull)
    }

    /// Returns the interval of a function that never falls, which `down` and `up` compute with the two directions of rounding.
    fn rising(
        &self,
        a: &PreciseValue,
        down: impl Fn(&Context<mode::Down>, &BigFloat) -> Rounded<mode::Down>,
        up: impl Fn(&Context<mode::Up>, &BigFloat) -> Rounded<mode::Up>,
    ) -> Result<PreciseValue, String> {
        Self::rounded(down(&self.down, &a.low), up(&self.up, &a.high))
    }

    /// Returns the interval of a sine or a cosine. The slope is never steeper than 1. The function therefore takes the value at
    /// the lower limit, and extends it by the interval's length in both directions.
    fn wave(
        &self,
        a: &PreciseValue,
        down: impl Fn(&Context<mode::Down>, &BigFloat) -> Rounded<mode::Down>,
        up: impl Fn(&Context<mode::Up>, &BigFloat) -> Rounded<mode::Up>,
    ) -> Result<PreciseValue, String> {
        let length = Self::rounded(self.down.sub(&a.high, &a.low), self.up.sub(&a.high, &a.low))?;
        let value = Self::rounded(down(&self.down, &a.low), up(&self.up, &a.low))?;
        Self::rounded(
            self.down.sub(&value.low, &length.high),
            self.up.add(&value.high, &length.high),
        )
    }

    /// Returns two values, the lower one first, or `None` if their order is not known. Equal values may have any order.
    fn in_order<'v>(
        &self,
        a: &'v PreciseValue,
        b: &'v PreciseValue,
    ) -> Option<(&'v PreciseValue, &'v PreciseValue)> {
        let difference = self.subtract(a, b).ok()?;
        match self.signs(&difference) {
            (_, Ordering::Less | Ordering::Equal) => Some((a, b)),
            (Ordering::Greater | Ordering::Equal, _) => Some((b, a)),
            _ => None,
        }
    }

    /// Computes the error function of a number that is not below 0.
    ///
    /// The series is erf(x) = 2x / √π · exp(−x²) · (1 + 2x²/3 + (2x²)²/(3·5) + …), whose terms are all positive. The series
    /// ends as soon as each further term is less than half of the previous one. Their sum is then less than the last term.
    fn error_function(&self, x: &BigFloat) -> Result<PreciseValue, String> {
        let one = self.integer(1);
        let x = PreciseValue::between(x.clone(), x.clone());
        let square = self.multiply(&x, &x)?;
        // Then 1 − erf(x) is below 2^−bits, because exp(−x²) is.
        if square.low > BigFloat::new(IBig::from(self.bits), 0) {
            let unit = BigFloat::new(IBig::ONE, -(self.bits as isize));
            return self.subtract(&one, &PreciseValue::between(BigFloat::zero(), unit));
        }
        let doubled = self.add(&square, &square)?;
        let mut term = one.clone();
        let mut sum = one.clone();
        for odd in (3..).step_by(2) {
            let ratio = self.divide(&doubled, &self.integer(odd))?;
            term = self.multiply(&term, &ratio)?;
            sum = self.add(&sum, &term)?;
            let half = BigFloat::new(IBig::ONE, -1);
            let negligible = BigFloat::new(IBig::ONE, -(self.bits as isize));
            if ratio.high < half && term.high < negligible {
                break;
            }
        }
        sum = self.add(&sum, &PreciseValue::between(BigFloat::zero(), term.high))?;
        let bell = self.function(Function::Exp, &self.function(Function::Negate, &square)?)?;
        let factor =
            self.divide(&self.add(&x, &x)?, &self.function(Function::Sqrt, &self.pi())?)?;
        let value = self.multiply(&self.multiply(&factor, &bell)?, &sum)?;
        Ok(self.minimum(&value, &one))
    }

    fn signed_error_function(&self, x: &BigFloat) -> Result<PreciseValue, String> {
        if *x < BigFloat::zero() {
            let value = self.error_function(&-x.clone())?;
            return self.function(Function::Negate, &value);
        }
        self.error_function(x)
    }
}

/// Returns the exact value if it is known, and otherwise the result of `compute`.
fn or_computed(
    arithmetic: &Precise,
    exact: Option<Exact>,
    compute: impl FnOnce() -> Result<PreciseValue, String>,
) -> Result<PreciseValue, String> {
    match exact {
        Some(exact) => Ok(arithmetic.exactly(exact)),
        None => compute(),
    }
}

/// Returns the exact result of a function of two numbers, or `None` if it is not known.
fn exact_operator(operator: Operator, a: &PreciseValue, b: &PreciseValue) -> Option<Exact> {
    let is_zero = |value: &PreciseValue| value.exact.as_ref().is_some_and(Exact::is_zero);
    if operator == Operator::Mul && (is_zero(a) || is_zero(b)) {
        return Some(Exact::integer(0));
    }
    Exact::operator(operator, a.exact.as_ref()?, b.exact.as_ref()?)
}

fn sign(number: &BigFloat) -> Ordering {
    if number.significand().is_zero() && number.is_finite() {
        return Ordering::Equal;
    }
    match number.sign() {
        Sign::Positive => Ordering::Greater,
        Sign::Negative => Ordering::Less,
    }
}

/// Rounds a number to an `f64` in the direction `R`.
fn to_f64<R: ErrorBounds>(number: &BigFloat) -> f64 {
    if number.is_infinite() {
        return if number.sign() == Sign::Negative { f64::NEG_INFINITY } else { f64::INFINITY };
    }
    let context = Context::<R>::new(53);
    FBig::<R, 2>::from_repr(number.clone(), context).to_f64().value()
}

impl Arithmetic for Precise {
    type Value = PreciseValue;

    fn literal(&self, literal: &Literal) -> PreciseValue {
        self.rational(literal.value())
    }

    fn constant(&self, name: &str, _below: f64) -> PreciseValue {
        if name == "pi" {
            return self.exactly(Exact::TimesPi(RBig::ONE));
        }
        let low = self.down.e::<2>().value().into_repr();
        let high = self.up.e::<2>().value().into_repr();
        PreciseValue::between(low, high)
    }

    /// Returns `None`, because limits in `f64` are not precise enough.
    fn folded(&self, _constant: Enclosure) -> Option<Self::Value> {
        None
    }

    fn integer(&self, value: i64) -> PreciseValue {
        self.exactly(Exact::integer(value))
    }

    fn add(&self, a: &PreciseValue, b: &PreciseValue) -> Result<PreciseValue, String> {
        or_computed(self, exact_operator(Operator::Add, a, b), || {
            Self::rounded(self.down.add(&a.low, &b.low), self.up.add(&a.high, &b.high))
        })
    }

    fn subtract(&self, a: &PreciseValue, b: &PreciseValue) -> Result<PreciseValue, String> {
        or_computed(self, exact_operator(Operator::Sub, a, b), || {
            Self::rounded(self.down.sub(&a.low, &b.high), self.up.sub(&a.high, &b.low))
        })
    }

    fn multiply(&self, a: &PreciseValue, b: &PreciseValue) -> Result<PreciseValue, String> {
        or_computed(self, exact_operator(Operator::Mul, a, b), || self.corners(a, b, Self::product))
    }

    fn divide(&self, a: &PreciseValue, b: &PreciseValue) -> Result<PreciseValue, String> {
        or_computed(self, exact_operator(Operator::Div, a, b), || {
            self.corners(a, b, |own, a, b| Self::rounded(own.down.div(a, b), own.up.div(a, b)))
        })
    }

    fn repeated_product(&self, a: &PreciseValue, exponent: u32) -> Result<PreciseValue, String> {
        let whole = PreciseValue { exact: Some(Exact::integer(exponent.into())), ..a.clone() };
        or_computed(self, exact_operator(Operator::Power, a, &whole), || {
            let is_even = exponent.is_multiple_of(2);
            let base = if is_even { self.function(Function::Abs, a)? } else { a.clone() };
            let power = || IBig::from(exponent);
            Self::rounded(self.down.powi(&base.low, power()), self.up.powi(&base.high, power()))
        })
    }

    fn power(&self, a: &PreciseValue, b: &PreciseValue) -> Result<PreciseValue, String> {
        or_computed(self, exact_operator(Operator::Power, a, b), || {
            self.corners(a, b, |own, a, b| {
                Self::rounded(own.down.powf(a, b, None), own.up.powf(a, b, None))
            })
        })
    }

    fn function(&self, function: Function, a: &PreciseValue) -> Result<PreciseValue, String> {
        let exact = a.exact.as_ref().and_then(|exact| exact.function(function));
        or_computed(self, exact, || match function {
            Function::Negate => Ok(PreciseValue::between(-a.high.clone(), -a.low.clone())),
            Function::Abs => {
                let negative = PreciseValue::between(-a.high.clone(), -a.low.clone());
                Ok(match self.signs(a) {
                    (Ordering::Greater | Ordering::Equal, _) => a.clone(),
                    (_, Ordering::Less | Ordering::Equal) => negative,
                    _ => PreciseValue::between(BigFloat::zero(), a.high.clone().max(negative.high)),
                })
            }
            Function::Sqrt => self.rising(a, Context::sqrt, Context::sqrt),
            Function::Exp => self.rising(a, |c, x| c.exp(x, None), |c, x| c.exp(x, None)),
            Function::Exp2 => {
                let logarithm = self.function(Function::Ln, &self.integer(2))?;
                let exponent = self.multiply(a, &logarithm)?;
                self.function(Function::Exp, &exponent)
            }
            Function::Ln => self.rising(a, |c, x| c.ln(x, None), |c, x| c.ln(x, None)),
            Function::Log2 => self.rising(a, |c, x| c.log2(x, None), |c, x| c.log2(x, None)),
            Function::Sin => self.wave(a, |c, x| c.sin(x, None), |c, x| c.sin(x, None)),
            Function::Cos => self.wave(a, |c, x| c.cos(x, None), |c, x| c.cos(x, None)),
            Function::Tan => self.rising(a, |c, x| c.tan(x, None), |c, x| c.tan(x, None)),
            Function::Atan => self.rising(a, |c, x| c.atan(x, None), |c, x| c.atan(x, None)),
            Function::Tanh => self.rising(a, |c, x| c.tanh(x, None), |c, x| c.tanh(x, None)),
            Function::Erf => {
                let low = self.signed_error_function(&a.low)?.low;
                let high = self.signed_error_function(&a.high)?.high;
                Ok(PreciseValue::between(low, high))
            }
        })
    }

    fn minimum(&self, a: &PreciseValue, b: &PreciseValue) -> PreciseValue {
        if let Some((lower, _)) = self.in_order(a, b) {
            return lower.clone();
        }
        let low = a.low.clone().min(b.low.clone());
        PreciseValue::between(low, a.high.clone().min(b.high.clone()))
    }

    fn maximum(&self, a: &PreciseValue, b: &PreciseValue) -> PreciseValue {
        if let Some((_, higher)) = self.in_order(a, b) {
            return higher.clone();
        }
        let low = a.low.clone().max(b.low.clone());
        PreciseValue::between(low, a.high.clone().max(b.high.clone()))
    }

    fn signs(&self, a: &PreciseValue) -> (Ordering, Ordering) {
        (sign(&a.low), sign(&a.high))
    }

    fn floor(&self, a: &PreciseValue) -> Option<PreciseValue> {
        if let Some(value) = a.rational() {
            return Some(self.rational(&value.floor().into()));
        }
        let floor = |number: &BigFloat| {
            let number = FBig::<mode::Zero, 2>::from_repr(number.clone(), Context::new(self.bits));
            IBig::try_from(number.floor()).ok()
        };
        let (low, high) = (floor(&a.low)?, floor(&a.high)?);
        (low == high).then(|| self.rational(&low.into()))
    }

    fn known_integer(&self, a: &PreciseValue, largest: u32) -> Option<i64> {
        let value = a.rational().filter(|value| value.is_int())?;
        let is_small = value.clone().abs() <= RBig::from(largest);
        if is_small { i64::try_from(value.numerator().clone()).ok() } else { None }
    }

    fn either(
        &self,
        _a: PreciseValue,
        _b: PreciseValue,
        what: &str,
    ) -> Result<PreciseValue, String> {
        Err(what.to_owned())
    }

    fn enclosure(&self, a: &PreciseValue) -> Enclosure {
        Enclosure::between(to_f64::<mode::Down>(&a.low), to_f64::<mode::Up>(&a.high))
    }
}

//! Evaluates a formula to an interval that contains its exact value.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::ptr;

use dashu_ratio::RBig;

use super::arithmetic::{Arithmetic, Double};
use super::precise::{Precise, PreciseValue};
use super::{Comparison, Enclosure, Expression, Fault, Function, Kind, Operator};

/// The largest integer exponent for which a power is computed as a repeated product, which allows a negative base. Larger
/// exponents need logarithms.
const LARGEST_PRODUCT: u32 = 64;

/// The precisions in bits, tried one after the other until every comparison and every jump is decided.
const PRECISIONS: [usize; 3] = [128, 320, 1024];

impl Expression {
    /// Evaluates the formula in `f64`, for operands within the given intervals, with all rounding errors. If a comparison or a
    /// jump such as `floor` is undecided, the interval contains the values on both sides.
    ///
    /// # Errors
    /// Fails at a part that may have no value: a pole, the root of a possibly negative number, an operand that `operands`
    /// lacks, or a word of a ROM.
    pub fn enclose(&self, operands: &[(&str, Enclosure)]) -> Result<Enclosure, Fault> {
        self.evaluate(&Double, operands)
    }

    /// Evaluates the formula for exact operands. The precision increases until all comparisons and jumps are decided, and the
    /// `f64` limits of the result are at most two steps apart. After 1024 bits, the function also returns wider limits.
    ///
    /// For example, `floor(x * 0.1)` is 3 for x = 30, although 0.1 is no `f64`. This function is about a thousand times slower
    /// than [`Expression::enclose`].
    ///
    /// # Errors
    ///
    /// Fails at a part without a value, see [`Expression::enclose`], or if 1024 bits do not decide a comparison or a jump.
    pub fn evaluate_exactly(&self, operands: &[(&str, RBig)]) -> Result<Enclosure, Fault> {
        let is_narrow = |precise: &Precise, value: &PreciseValue| {
            let Enclosure { low, high } = precise.enclosure(value);
            low.next_up().next_up() >= high
        };
        let (precise, value) = self.decided(operands, is_narrow)?;
        Ok(precise.enclosure(&value))
    }

    /// Returns the smallest integer that is not below the value times 2^`fraction`, and whether the two are equal. For example,
    /// `0.3` with two fraction bits gives (2, false), and `log2(16)` without fraction bits gives (4, true). The formula must have
    /// no operands.
    ///
    /// # Errors
    ///
    /// Fails at a part without a value, see [`Expression::evaluate_exactly`]. Fails if 1024 bits do not show whether the value is
    /// an integer, or if the integer has more than 127 bits.
    pub fn ceiling(&self, fraction: u32) -> Result<(i128, bool), Fault> {
        let (precise, value) =
            self.decided(&[], |precise, value| precise.ceiling(value, fraction).is_some())?;
        precise.ceiling(&value, fraction).ok_or_else(|| {
            let message = "this value is so near to the value of an operand that 1024 bits cannot \
                           distinguish the two";
            Fault::new(self.span.clone(), message)
        })
    }

    /// Returns the value of a formula without operands, or `None` if the value is not known to be rational. For example,
    /// `log2(16)` gives 4, and `sqrt(2)` gives `None`.
    pub fn rational(&self) -> Option<RBig> {
        if self.varies() {
            return None;
        }
        let (_, value) = self.decided(&[], |_, _| true).ok()?;
        value.rational().cloned()
    }

    /// Evaluates the formula with increasing precision until `enough` returns true for the value, or returns the last result.
    /// Fails at the first part without a value, or if 1024 bits do not decide a comparison or a jump.
    fn decided(
        &self,
        operands: &[(&str, RBig)],
        enough: impl Fn(&Precise, &PreciseValue) -> bool,
    ) -> Result<(Precise, PreciseValue), Fault> {
        let mut last = None;
        for bits in PRECISIONS {
            let precise = Precise::new(bits);
            let exact: Vec<(&str, PreciseValue)> =
                operands.iter().map(|(name, value)| (*name, precise.rational(value))).collect();
            let value = self.evaluate(&precise, &exact);
            let is_enough = value.as_ref().is_ok_and(|value| enough(&precise, value));
            last = Some(value.map(|value| (precise, value)));
            if is_enough {
                break;
            }
        }
        last.expect("there is at least one precision")
    }

    fn evaluate<A: Arithmetic>(
        &self,
        arithmetic: &A,
        operands: &[(&str, A::Value)],
    ) -> Result<A::Value, Fault> {
        Evaluation { arithmetic, operands, known: HashMap::new() }.value(self)
    }
}

/// The number of parts below which a part is evaluated without a search in the known values, because that is faster.
pub(super) const FEW_PARTS: u32 = 200;

struct Evaluation<'e, A: Arithmetic> {
    arithmetic: &'e A,
    operands: &'e [(&'e str, A::Value)],
    /// The values of parts with at least [`FEW_PARTS`] parts of their own, so no shared part is evaluated twice.
    known: HashMap<*const Expression, A::Value>,
}

impl<A: Arithmetic> Evaluation<'_, A> {
    fn value(&mut self, part: &Expression) -> Result<A::Value, Fault> {
        if part.size() < FEW_PARTS {
            return self.new_value(part);
        }
        let place = ptr::from_ref(part);
        if let Some(known) = self.known.get(&place) {
            return Ok(known.clone());
        }
        let value = self.new_value(part)?;
        self.known.insert(place, value.clone());
        Ok(value)
    }

    fn new_value(&mut self, part: &Expression) -> Result<A::Value, Fault> {
        let arithmetic = self.arithmetic;
        if let Some(value) = part.constant.and_then(|constant| arithmetic.folded(constant)) {
            return Ok(value);
        }
        let fault = |message: String| Fault::new(part.span.clone(), message);
        let value = match &part.kind {
            Kind::Number(literal) => arithmetic.literal(literal),
            Kind::Constant(name, below) => arithmetic.constant(name, *below),
            Kind::Operand(name) => match self.operands.iter().find(|(own, _)| own == name) {
                Some((_, value)) => value.clone(),
                None => return Err(fault(format!("`{name}` has no value here"))),
            },
            Kind::Word(name, _) => {
                return Err(fault(format!("the words of `{name}` have no values here")));
            }
            Kind::Unary(function, a) => {
                let a = self.value(a)?;
                unary(arithmetic, *function, &a).map_err(fault)?
            }
            Kind::Binary(operator, a, b) => {
                let a = self.value(a)?;
                let b = self.value(b)?;
                binary(arithmetic, *operator, &a, &b).map_err(fault)?
            }
            Kind::If(comparison, yes, no) => {
                let left = self.value(&comparison.left)?;
                let right = self.value(&comparison.right)?;
                match comparison.decided(arithmetic, &left, &right).map_err(fault)? {
                    Some(true) => self.value(yes)?,
                    Some(false) => self.value(no)?,
                    None => {
                        let yes = self.value(yes)?;
                        let no = self.value(no)?;
                        let doubt =
                            "1024 bits cannot decide which of the two compared values is larger";
                        arithmetic.either(yes, no, doubt).map_err(fault)?
                    }
                }
            }
        };
        let Enclosure { low, high } = arithmetic.enclosure(&value);
        if low.is_nan() || high.is_nan() {
            return Err(fault("this is not a number".to_owned()));
        }
        Ok(value)
    }
}

impl Comparison {
    /// Returns whether the comparison holds for all operands within the given intervals, or `None` if the intervals do not decide
    /// it. For x from 0 to 1, `x < 2` holds, and `x < 0.5` is undecided. Fails if a side may have no value.
    pub fn holds(&self, operands: &[(&str, Enclosure)]) -> Result<Option<bool>, Fault> {
        let left = self.left.enclose(operands)?;
        let right = self.right.enclose(operands)?;
        let fault = |message: String| Fault::new(self.left.span.clone(), message);
        self.decided(&Double, &left, &right).map_err(fault)
    }

    /// Returns whether the comparison holds for the intervals `left` and `right`, or `None` if they do not decide it. Fails if
    /// the difference of the two sides cannot be computed.
    pub(super) fn decided<A: Arithmetic>(
        &self,
        arithmetic: &A,
        left: &A::Value,
        right: &A::Value,
    ) -> Result<Option<bool>, String> {
        let difference = arithmetic.subtract(left, right)?;
        let (low, high) = arithmetic.signs(&difference);
        let holds = low == Ordering::Greater || self.or_equal && low == Ordering::Equal;
        let fails = high == Ordering::Less || !self.or_equal && high == Ordering::Equal;
        Ok(match (holds, fails) {
            (true, _) => Some(true),
            (_, true) => Some(false),
            _ => None,
        })
    }
}

/// Returns the values of a function for numbers in the interval `a`. Fails if the numbers may be outside the function's domain,
/// for example a root of a negative number.
pub(super) fn unary<A: Arithmetic>(
    arithmetic: &A,
    function: Function,
    a: &A::Value,
) -> Result<A::Value, String> {
    let (low, _) = arithmetic.signs(a);
    match function {
        Function::Sqrt if low == Ordering::Less => {
            let value = words(arithmetic.enclosure(a));
            return Err(format!("the root of a negative number, {value}"));
        }
        Function::Ln | Function::Log2 if low != Ordering::Greater => {
            let value = words(arithmetic.enclosure(a));
            return Err(format!("the logarithm of {value}, which is not above 0"));
        }
        Function::Tan => {
            // Between two poles, the tangent rises and the cosine has one sign.
            let cosine = arithmetic.function(Function::Cos, a)?;
            let Enclosure { low, high } = arithmetic.enclosure(a);
            if holds_zero(arithmetic, &cosine) || high - low > 1.0 {
                return Err(format!(
                    "a pole of the tangent near {}",
                    words(arithmetic.enclosure(a))
                ));
            }
        }
        _ => {}
    }
    arithmetic.function(function, a)
}

/// Returns the values of `operator` for numbers in the intervals `a` and `b`. Fails if the numbers may be outside the domain, for
/// example a division by an interval that contains 0.
pub(super) fn binary<A: Arithmetic>(
    arithmetic: &A,
    operator: Operator,
    a: &A::Value,
    b: &A::Value,
) -> Result<A::Value, String> {
    match operator {
        Operator::Add => arithmetic.add(a, b),
        Operator::Sub => arithmetic.subtract(a, b),
        Operator::Mul => arithmetic.multiply(a, b),
        Operator::Div if holds_zero(arithmetic, b) => {
            Err(format!("a pole: the divisor is {}", words(arithmetic.enclosure(b))))
        }
        Operator::Div => arithmetic.divide(a, b),
        Operator::Min => Ok(arithmetic.minimum(a, b)),
        Operator::Max => Ok(arithmetic.maximum(a, b)),
        Operator::Mod => remainder(arithmetic, a, b),
        Operator::Power => power(arithmetic, a, b),
        Operator::Atan2 => direction(arithmetic, a, b),
    }
}

/// Computes the remainder of a division, from 0 to below the divisor, or above it for a negative divisor. For example, the
/// remainder of −1 by 4 is 3. Fails if the divisor may be 0, or if precise arithmetic does not decide the integer quotient.
fn remainder<A: Arithmetic>(
    arithmetic: &A,
    a: &A::Value,
    b: &A::Value,
) -> Result<A::Value, String> {
    if holds_zero(arithmetic, b) {
        return Err("a remainder by 0".to_owned());
    }
    let quotient = arithmetic.divide(a, b)?;
    let Some(floor) = arithmetic.floor(&quotient) else {
        // The remainder jumps within the interval, so it can be any number from 0 to the divisor.
        let doubt = "1024 bits cannot decide on which side of a step this value is";
        return arithmetic.either(arithmetic.integer(0), b.clone(), doubt);
    };
    arithmetic.subtract(a, &arithmetic.multiply(&floor, b)?)
}

fn power<A: Arithmetic>(arithmetic: &A, a: &A::Value, b: &A::Value) -> Result<A::Value, String> {
    match arithmetic.known_integer(b, LARGEST_PRODUCT) {
        Some(0) => return Ok(arithmetic.integer(1)),
        Some(exponent @ 1..) => return arithmetic.repeated_product(a, exponent as u32),
        _ => {}
    }
    let (exponent_low, _) = arithmetic.signs(b);
    if holds_zero(arithmetic, a) && exponent_low != Ordering::Greater {
        return Err("a pole: 0 to a power that is not above 0".to_owned());
    }
    if let Some(exponent) = arithmetic.known_integer(b, LARGEST_PRODUCT) {
        let product = arithmetic.repeated_product(a, exponent.unsigned_abs() as u32)?;
        return arithmetic.divide(&arithmetic.integer(1), &product);
    }
    if arithmetic.signs(a).0 == Ordering::Less {
        let value = words(arithmetic.enclosure(a));
        return Err(format!("a power of a negative number, {value}"));
    }
    arithmetic.power(a, b)
}

/// Computes the direction of the point (x, y), an angle from −π to π. For example, (0, 1) has π/2. Fails for the origin.
///
/// The function chooses a formula whose divisor is certainly not 0. Right of the y axis, the direction is `atan(y / x)`. Above
/// the x axis it is `π/2 - atan(x / y)`, and below it `-π/2 - atan(x / y)`. Otherwise, left of the y axis, it is `atan(y / x)`
/// plus or minus π.
fn direction<A: Arithmetic>(
    arithmetic: &A,
    y: &A::Value,
    x: &A::Value,
) -> Result<A::Value, String> {
    let half_turn = arithmetic.constant("pi", std::f64::consts::PI);
    let (y_low, y_high) = arithmetic.signs(y);
    let (x_low, x_high) = arithmetic.signs(x);
    if x_low == Ordering::Greater {
        return arithmetic.function(Function::Atan, &arithmetic.divide(y, x)?);
    }
    if y_low == Ordering::Greater || y_high == Ordering::Less {
        let from_axis = arithmetic.function(Function::Atan, &arithmetic.divide(x, y)?)?;
        let quarter_turn = arithmetic.divide(&half_turn, &arithmetic.integer(2))?;
        let axis = match y_low {
            Ordering::Greater => quarter_turn,
            _ => arithmetic.function(Function::Negate, &quarter_turn)?,
        };
        return arithmetic.subtract(&axis, &from_axis);
    }
    if x_high != Ordering::Less {
        return Err("the direction of a point that can be the origin, (0, 0)".to_owned());
    }
    let from_left = arithmetic.function(Function::Atan, &arithmetic.divide(y, x)?)?;
    let above = arithmetic.add(&from_left, &half_turn)?;
    if y_low != Ordering::Less {
        return Ok(above);
    }
    let below = arithmetic.subtract(&from_left, &half_turn)?;
    let doubt = "1024 bits cannot decide on which side of the negative x axis a point is";
    arithmetic.either(above, below, doubt)
}

fn holds_zero<A: Arithmetic>(arithmetic: &A, a: &A::Value) -> bool {
    let (low, high) = arithmetic.signs(a);
    low != Ordering::Greater && high != Ordering::Less
}

/// Returns a number as text, or the two limits of a wide interval.
fn words(a: Enclosure) -> String {
    let middle = a.middle();
    if (a.high - a.low).abs() <= middle.abs() * 1e-12 {
        digits(middle)
    } else {
        format!("from {} to {}", digits(a.low), digits(a.high))
    }
}

/// Formats a number, a very large or very small one with a power of ten.
fn digits(value: f64) -> String {
    let is_moderate = value == 0.0 || (1e-6..1e9).contains(&value.abs());
    if is_moderate { format!("{value}") } else { format!("{value:e}") }
}

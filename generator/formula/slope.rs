//! Differentiates a formula: computes limits between which the derivative lies, for an operand in an interval.

use std::collections::HashMap;
use std::ptr;

use super::arithmetic::Double;
use super::evaluate::{FEW_PARTS, binary, unary};
use super::{Enclosure, Expression, Fault, Function, Kind, Operator};

#[derive(Clone, Copy)]
struct ValueAndSlope {
    value: Enclosure,
    slope: Enclosure,
}

impl Expression {
    /// Returns intervals that contain the value and the derivative of the formula, for all values of `operand` within `limits`.
    /// At a corner, such as `abs(x)` at 0, the interval contains the derivatives of both sides. For example, x · x for x from 1
    /// to 2 has values from 1 to 4, and derivatives from 2 to 4.
    ///
    /// # Errors
    ///
    /// Fails if a part of the formula has no value, may jump, or may be infinitely steep.
    pub fn slope(&self, operand: &str, limits: Enclosure) -> Result<(Enclosure, Enclosure), Fault> {
        let mut derivation = Derivation { operand, limits, known: HashMap::new() };
        derivation.pair(self).map(|it| (it.value, it.slope))
    }
}

struct Derivation<'d> {
    operand: &'d str,
    limits: Enclosure,
    /// The results of parts with at least [`FEW_PARTS`] parts of their own, so no shared part is computed twice.
    known: HashMap<*const Expression, ValueAndSlope>,
}

impl Derivation<'_> {
    fn pair(&mut self, part: &Expression) -> Result<ValueAndSlope, Fault> {
        if part.size() < FEW_PARTS {
            return self.new_pair(part);
        }
        let place = ptr::from_ref(part);
        if let Some(known) = self.known.get(&place) {
            return Ok(*known);
        }
        let pair = self.new_pair(part)?;
        self.known.insert(place, pair);
        Ok(pair)
    }

    fn new_pair(&mut self, part: &Expression) -> Result<ValueAndSlope, Fault> {
        let Self { operand, limits, .. } = *self;
        let fault = |message: String| Fault::new(part.span.clone(), message);
        let pair = match &part.kind {
            Kind::Number(..) | Kind::Constant(..) => {
                ValueAndSlope { value: part.enclose(&[])?, slope: Enclosure::exactly(0.0) }
            }
            Kind::Operand(_) | Kind::Word(..) => ValueAndSlope {
                value: part.enclose(&[(operand, limits)])?,
                slope: Enclosure::exactly(1.0),
            },
            Kind::Unary(function, a) => {
                let a = self.pair(a)?;
                let value = unary(&Double, *function, &a.value).map_err(fault)?;
                ValueAndSlope { value, slope: of_unary(*function, a, value) }
            }
            Kind::Binary(operator, a, b) => {
                let (a, b) = (self.pair(a)?, self.pair(b)?);
                let value = binary(&Double, *operator, &a.value, &b.value).map_err(fault)?;
                match of_binary(*operator, a, b, value) {
                    Some(slope) => ValueAndSlope { value, slope },
                    None => return Err(fault("the value of this part can jump".to_owned())),
                }
            }
            Kind::If(comparison, yes, no) => {
                let left = comparison.left.enclose(&[(operand, limits)])?;
                let right = comparison.right.enclose(&[(operand, limits)])?;
                match comparison.decided(&Double, &left, &right).map_err(fault)? {
                    Some(true) => self.pair(yes)?,
                    Some(false) => self.pair(no)?,
                    None => return Err(fault("the value of this part can jump".to_owned())),
                }
            }
        };
        if !pair.value.is_finite() || !pair.slope.is_finite() {
            return Err(fault("the slope of this part is infinite".to_owned()));
        }
        Ok(pair)
    }
}

fn of_unary(function: Function, a: ValueAndSlope, value: Enclosure) -> Enclosure {
    let ValueAndSlope { value: at, slope } = a;
    let number = Enclosure::exactly;
    let one = number(1.0);
    let about = |value: f64| Enclosure::between(value.next_down(), value.next_up());
    let steep = Enclosure::between(f64::NEG_INFINITY, f64::INFINITY);
    match function {
        Function::Negate => -slope,
        Function::Abs if at.low >= 0.0 => slope,
        Function::Abs if at.high <= 0.0 => -slope,
        Function::Abs => slope.hull(-slope),
        Function::Sqrt if value.low <= 0.0 => steep,
        Function::Sqrt => slope / (number(2.0) * value),
        Function::Exp => value * slope,
        Function::Exp2 => value * about(std::f64::consts::LN_2) * slope,
        Function::Ln => slope / at,
        Function::Log2 => slope / (at * about(std::f64::consts::LN_2)),
        Function::Sin => at.wave(libm::cos) * slope,
        Function::Cos => -(at.wave(libm::sin) * slope),
        Function::Tan => (one + value.repeated_product(2)) * slope,
        Function::Atan => slope / (one + at.repeated_product(2)),
        Function::Tanh => (one - value.repeated_product(2)) * slope,
        Function::Erf => {
            let bell = (-at.repeated_product(2)).rising(libm::exp);
            about(std::f64::consts::FRAC_2_SQRT_PI) * bell * slope
        }
    }
}

/// Returns the limits of the derivative of a function of two numbers, or `None` if the value may jump.
fn of_binary(
    operator: Operator,
    a: ValueAndSlope,
    b: ValueAndSlope,
    value: Enclosure,
) -> Option<Enclosure> {
    let number = Enclosure::exactly;
    Some(match operator {
        Operator::Add => a.slope + b.slope,
        Operator::Sub => a.slope - b.slope,
        Operator::Mul => a.slope * b.value + a.value * b.slope,
        Operator::Div => (a.slope - value * b.slope) / b.value,
        Operator::Min if a.value.high < b.value.low => a.slope,
        Operator::Min if b.value.high < a.value.low => b.slope,
        Operator::Max if a.value.high < b.value.low => b.slope,
        Operator::Max if b.value.high < a.value.low => a.slope,
        Operator::Min | Operator::Max => a.slope.hull(b.slope),
        Operator::Atan2 => {
            let is_left = b.value.low <= 0.0;
            let is_beside_axis = a.value.low > 0.0 || a.value.high < 0.0;
            if is_left && !is_beside_axis {
                return None;
            }
            let squares = a.value.repeated_product(2) + b.value.repeated_product(2);
            (b.value * a.slope - a.value * b.slope) / squares
        }
        Operator::Mod => {
            let times = a.value / b.value;
            if times.low.floor() != times.high.floor() {
                return None;
            }
            a.slope - number(times.low.floor()) * b.slope
        }
        Operator::Power if b.slope == number(0.0) => {
            let less = b.value - number(1.0);
            let below = binary(&Double, Operator::Power, &a.value, &less).ok()?;
            b.value * below * a.slope
        }
        Operator::Power if a.value.low > 0.0 => {
            let logarithm = a.value.rising(libm::log);
            value * (b.slope * logarithm + b.value * a.slope / a.value)
        }
        Operator::Power => return None,
    })
}

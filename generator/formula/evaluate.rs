//! Evaluates a formula: computes limits that certainly hold its value.

use super::{Comparison, Enclosure, Fault, Formula, Function, Kind, Operator};

/// Exponents up to this are products; larger ones are powers of `libm`.
const PRODUCTS: f64 = 64.0;

impl Formula {
    /// Returns the limits of the value where operands are within theirs. What errors of f64 and of `libm` may be is in them.
    ///
    /// # Errors
    /// A part that has no value: a pole, a root of a negative number, an operand without limits, a word of a ROM.
    pub fn enclose(&self, operands: &[(&str, Enclosure)]) -> Result<Enclosure, Fault> {
        let fault = |message: String| Err(Fault::new(self.span.clone(), message));
        let value = match &self.kind {
            Kind::Number(value, true) => Enclosure::exactly(*value),
            Kind::Number(value, false) => Enclosure::between(value.next_down(), value.next_up()),
            Kind::Constant(_, value) => Enclosure::between(*value, value.next_up()),
            Kind::Operand(name) => match operands.iter().find(|(own, _)| own == name) {
                Some((_, limits)) => *limits,
                None => return fault(format!("nothing is known of `{name}`")),
            },
            Kind::Word(name, _) => {
                return fault(format!("nothing is known of the words of `{name}`"));
            }
            Kind::Unary(function, a) => {
                let a = a.enclose(operands)?;
                unary(*function, a).or_else(fault)?
            }
            Kind::Binary(operator, a, b) => {
                let (a, b) = (a.enclose(operands)?, b.enclose(operands)?);
                binary(*operator, a, b).or_else(fault)?
            }
            Kind::If(Comparison { left, right, or_equal }, yes, no) => {
                let difference = left.enclose(operands)? - right.enclose(operands)?;
                if difference.low > 0.0 || *or_equal && difference.low == 0.0 {
                    yes.enclose(operands)?
                } else if difference.high < 0.0 || !*or_equal && difference.high == 0.0 {
                    no.enclose(operands)?
                } else {
                    yes.enclose(operands)?.hull(no.enclose(operands)?)
                }
            }
        };
        if value.low.is_nan() || value.high.is_nan() {
            return fault("this is no number".to_owned());
        }
        Ok(value)
    }
}

pub(super) fn unary(function: Function, a: Enclosure) -> Result<Enclosure, String> {
    let at = || words(a);
    Ok(match function {
        Function::Negate => -a,
        Function::Abs => a.abs(),
        Function::Sqrt if a.low < 0.0 => {
            return Err(format!("the root of a negative number, {}", at()));
        }
        Function::Sqrt => a.sqrt(),
        Function::Ln | Function::Log2 if a.low <= 0.0 => {
            return Err(format!("the logarithm of {}, which is not above 0", at()));
        }
        Function::Ln => a.rising(libm::log),
        Function::Log2 => a.rising(libm::log2),
        Function::Exp => a.rising(libm::exp),
        Function::Exp2 => a.rising(libm::exp2),
        Function::Atan => a.rising(libm::atan),
        Function::Tanh => a.rising(libm::tanh),
        Function::Erf => a.rising(libm::erf),
        Function::Sin => a.wave(libm::sin),
        Function::Cos => a.wave(libm::cos),
        Function::Tan => {
            // Between its poles it rises; a cosine that is not 0 is of one branch.
            let cosine = a.wave(libm::cos);
            if cosine.holds(0.0) || a.high - a.low > 1.0 {
                return Err(format!("a pole of the tangent near {}", at()));
            }
            a.rising(libm::tan)
        }
    })
}

pub(super) fn binary(operator: Operator, a: Enclosure, b: Enclosure) -> Result<Enclosure, String> {
    Ok(match operator {
        Operator::Add => a + b,
        Operator::Sub => a - b,
        Operator::Mul => a * b,
        Operator::Div if b.holds(0.0) => {
            return Err(format!("a pole: the divisor is {}", words(b)));
        }
        Operator::Div => a / b,
        Operator::Min => Enclosure { low: a.low.min(b.low), high: a.high.min(b.high) },
        Operator::Max => Enclosure { low: a.low.max(b.low), high: a.high.max(b.high) },
        Operator::Mod => {
            if b.holds(0.0) {
                return Err("a remainder by 0".to_owned());
            }
            let times = a / b;
            if times.low.floor() != times.high.floor() {
                // It jumps in between, and is anything up to the divisor.
                return Ok(Enclosure::exactly(0.0).hull(b));
            }
            a - Enclosure::exactly(times.low.floor()) * b
        }
        Operator::Power => {
            let whole = b.low == b.high && b.low.fract() == 0.0 && b.low.abs() <= PRODUCTS;
            if whole && b.low > 0.0 {
                a.times_itself(b.low as u32)
            } else if whole && b.low == 0.0 {
                Enclosure::exactly(1.0)
            } else if a.holds(0.0) && b.low <= 0.0 {
                return Err("a pole: a power of 0 that is not above 0".to_owned());
            } else if whole {
                Enclosure::exactly(1.0) / a.times_itself(-b.low as u32)
            } else if a.low < 0.0 {
                return Err(format!("a power of a negative number, {}", words(a)));
            } else {
                a.power(b)
            }
        }
    })
}

/// Returns a number, or between which two it is.
fn words(a: Enclosure) -> String {
    let middle = a.middle();
    if (a.high - a.low).abs() <= middle.abs() * 1e-12 {
        format!("{middle}")
    } else {
        format!("from {} to {}", a.low, a.high)
    }
}

//! Defines the statement of an expression: the operands with their domains, and the results with their formulas and allowed
//! errors.

use glint_approximate::Outside;
use glint_base::fixed::{Format, exp2};
use glint_base::interval;
use glint_formula::{Comparison, Enclosure, Expression, Fault, RBig};

/// The formulas that a user asks for, as formulas of operands, each with its allowed error.
#[derive(Clone, Debug)]
pub struct ExpressionStatement {
    /// The operands, in the order of the ports.
    pub operands: Vec<StatedOperand>,
    /// The results, in the order of the ports.
    pub results: Vec<StatedResult>,
}

/// An operand, with the values for which results are promised.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedOperand {
    /// The name of the port.
    pub name: String,
    /// The format of the port.
    pub format: Format,
    /// The smallest and the largest raw operand for which results are promised.
    pub domain: (i64, i64),
    /// The results that operands outside the domain get.
    pub outside: Outside,
}

/// A result: its formula, and its allowed error.
#[derive(Clone, Debug)]
pub struct StatedResult {
    /// The name of the port, without `_out`.
    pub name: String,
    /// The formula, in terms of operands alone.
    pub formula: Expression,
    /// The number of fraction bits of the result.
    pub fraction: u32,
    /// The largest error that is allowed, in units of the last place of the result.
    pub error: f64,
    /// The condition on the operands under which the error is promised; `None` if it is promised for the whole domain.
    pub promise: Option<Comparison>,
    /// The width, if it is stated; otherwise the integer bits follow from the values of the formula.
    pub width: Option<StatedWidth>,
}

/// The whole format of a result, with what happens to values beyond it.
#[derive(Clone, Debug)]
pub struct StatedWidth {
    /// The format.
    pub format: Format,
    /// What happens to a value beyond the format.
    pub overflow: StatedOverflow,
}

/// What happens to a value beyond the stated format of a result.
#[derive(Clone, Debug)]
pub enum StatedOverflow {
    /// A formula with such values is refused.
    Refuse,
    /// The nearest value of the format. The formula here is the one of the result, limited to the format.
    Saturate(Expression),
    /// The high bits are dropped, so that the value is right modulo the range of the format. For example, an angle of 1 half turn
    /// is −1.
    Wrap,
}

impl ExpressionStatement {
    /// Returns the exact value of each operand with its name, from the raw values.
    pub fn exact_operands(&self, raw: &[i64]) -> Vec<(&str, RBig)> {
        let mut values = Vec::with_capacity(raw.len());
        for (operand, &raw) in self.operands.iter().zip(raw) {
            let scale = RBig::from(2).pow(-operand.format.frac as isize);
            values.push((operand.name.as_str(), RBig::from(raw) * scale));
        }
        values
    }

    /// Returns an interval of values for each operand with its name, from intervals of raw values.
    pub fn enclosed_operands(&self, limits: &[(i64, i64)]) -> Vec<(&str, Enclosure)> {
        let mut values = Vec::with_capacity(limits.len());
        for (operand, (low, high)) in self.operands.iter().zip(limits) {
            let low = operand.format.to_f64((*low).into());
            let high = operand.format.to_f64((*high).into());
            values.push((operand.name.as_str(), Enclosure::between(low, high)));
        }
        values
    }

    /// Returns the values of the operands in intervals of raw values, as text. For example, `x from 0 to 0.5 and y = 1`.
    pub fn place(&self, limits: &[(i64, i64)]) -> String {
        let mut place = Vec::new();
        for (name, value) in self.enclosed_operands(limits) {
            place.push(if value.low == value.high {
                format!("{name} = {}", value.low)
            } else {
                format!("{name} from {} to {}", value.low, value.high)
            });
        }
        place.join(" and ")
    }

    /// Returns the smallest and the largest raw value of each operand.
    pub fn domain(&self) -> Vec<(i64, i64)> {
        self.operands.iter().map(|operand| operand.domain).collect()
    }

    /// Returns the number of combinations of operands in the domain.
    pub fn combinations(&self) -> u128 {
        interval::combinations(self.domain())
    }
}

impl StatedOperand {
    /// Returns the value with which results are computed for an operand. It is the nearer end of the domain if the operand is
    /// outside a domain that clamps. For example, 0.9 becomes 0.5 if the domain ends at 0.5.
    pub fn computed(&self, value: f64) -> f64 {
        match self.outside {
            Outside::Clamp => {
                let [low, high] =
                    [self.domain.0, self.domain.1].map(|raw| self.format.to_f64(raw.into()));
                value.clamp(low, high)
            }
            Outside::Wrap | Outside::Anything => value,
        }
    }

    /// Returns the raw value with which results are computed if the operand has the raw value `raw`. It is the nearer end of the
    /// domain if `raw` is outside a domain that clamps, and otherwise `raw`. For example, 900 becomes 500 if a domain that
    /// clamps ends at 500.
    pub fn computed_raw(&self, raw: i64) -> i64 {
        match self.outside {
            Outside::Clamp => raw.clamp(self.domain.0, self.domain.1),
            Outside::Wrap | Outside::Anything => raw,
        }
    }
}

impl StatedResult {
    /// Returns the formula that the error is measured against: [`StatedResult::formula`], limited to the format if the result
    /// saturates.
    pub fn target(&self) -> &Expression {
        match &self.width {
            Some(StatedWidth { overflow: StatedOverflow::Saturate(limited), .. }) => limited,
            _ => &self.formula,
        }
    }

    /// Returns limits of the value that the result approximates. The formula is evaluated in f64 for `operands`, and again with
    /// more bits, for the operands that `exactly` returns, if f64 does not give it within a millionth of a unit.
    ///
    /// # Errors
    /// Fails at the part of the formula that has no value.
    pub fn value<'o>(
        &self,
        operands: &[(&str, Enclosure)],
        exactly: impl FnOnce() -> Vec<(&'o str, RBig)>,
    ) -> Result<Enclosure, Fault> {
        const WIDEST: f64 = 1e-6;
        let unit = exp2(self.fraction as i32);
        match self.target().enclose(operands) {
            Ok(value) if (value.high - value.low) * unit <= WIDEST => Ok(value),
            _ => self.target().evaluate_exactly(&exactly()),
        }
    }

    /// Returns whether the error is promised for all operands within intervals. Returns `None` if it is promised for some of
    /// them, or if that is undecided.
    pub fn is_promised(&self, operands: &[(&str, Enclosure)]) -> Option<bool> {
        let Some(promise) = &self.promise else { return Some(true) };
        promise.holds(operands).unwrap_or(None)
    }
}

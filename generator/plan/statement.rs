//! Defines the statement of an expression: the operands with their domains, and the results with their formulas and allowed
//! errors.

use std::collections::BTreeSet;

use glint_approximate::Outside;
use glint_base::fixed::{Format, exp2};
use glint_base::interval;
use glint_formula::{Comparison, Enclosure, Expression, Fault, RBig};

/// The formulas that a user wants to compute, with their operands and their allowed errors.
#[derive(Clone, Debug)]
pub struct ExpressionStatement {
    /// The operands, in the order of the ports.
    pub operands: Vec<StatedOperand>,
    /// The results, in the order of the ports.
    pub results: Vec<StatedResult>,
}

/// An operand of the formulas, with the values for which results are promised.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedOperand {
    /// The name of the port.
    pub name: String,
    /// The format of the port.
    pub format: Format,
    /// The smallest and the largest raw operand for which results are promised.
    pub domain: (i64, i64),
    /// The treatment of operands outside the domain.
    pub outside: Outside,
    /// The user's remark about the operand; empty without one.
    pub doc: String,
}

/// A result: its formula, and its allowed error.
#[derive(Clone, Debug)]
pub struct StatedResult {
    /// The name of the port, without `_out`.
    pub name: String,
    /// The formula, in which only operands occur.
    pub formula: Expression,
    /// The number of fraction bits of the result.
    pub fraction: u32,
    /// The largest error that is allowed, in units of the last bit of the result.
    pub error: f64,
    /// The condition on the operands under which the error is promised; `None` if it is promised for the whole domain.
    pub promise: Option<Comparison>,
    /// The width that the user states for the result. `None` if the integer bits follow from the values of the formula.
    pub width: Option<StatedWidth>,
}

/// The whole format of a result, and the treatment of values beyond this format.
#[derive(Clone, Debug)]
pub struct StatedWidth {
    /// The format.
    pub format: Format,
    /// The treatment of a value beyond the format.
    pub overflow: StatedOverflow,
}

/// The treatment of a value beyond the stated format of a result.
#[derive(Clone, Debug)]
pub enum StatedOverflow {
    /// The planner refuses a formula that has such values.
    Refuse,
    /// The result is the nearest value of the format. The formula here is the result's formula, limited to the format.
    Saturate(Expression),
    /// The high bits are dropped, so that the value is right modulo the range of the format. For example, an angle of 1 half
    /// turn becomes −1.
    Wrap,
}

/// The largest error of rounding to the nearest value, in units of the last bit.
pub(super) const HALF_A_UNIT: f64 = 0.5;

impl ExpressionStatement {
    /// Returns the name of each operand with its exact value, from raw values in the order of the operands.
    pub fn exact_operands(&self, raw: &[i64]) -> Vec<(&str, RBig)> {
        let mut values = Vec::with_capacity(raw.len());
        for (operand, &raw) in self.operands.iter().zip(raw) {
            let scale = RBig::from(2).pow(-operand.format.frac as isize);
            values.push((operand.name.as_str(), RBig::from(raw) * scale));
        }
        values
    }

    /// Returns the name of each operand with an interval of values, from intervals of raw values in the order of the operands.
    /// Both ends are included.
    pub fn enclosed_operands(&self, limits: &[(i64, i64)]) -> Vec<(&str, Enclosure)> {
        let mut values = Vec::with_capacity(limits.len());
        for (operand, (low, high)) in self.operands.iter().zip(limits) {
            let low = operand.format.to_f64((*low).into());
            let high = operand.format.to_f64((*high).into());
            values.push((operand.name.as_str(), Enclosure::between(low, high)));
        }
        values
    }

    /// Returns the values of the operands `named` as text for a message, from intervals of raw values. For example,
    /// `x from 0 to 0.5 and y = 1`.
    pub(super) fn place(&self, limits: &[(i64, i64)], named: &BTreeSet<&str>) -> String {
        let mut place = Vec::new();
        for (name, value) in self.enclosed_operands(limits) {
            if !named.contains(name) {
                continue;
            }
            place.push(if value.low == value.high {
                format!("{name} = {}", value.low)
            } else {
                format!("{name} from {} to {}", value.low, value.high)
            });
        }
        place.join(" and ")
    }

    /// Returns the smallest and the largest raw value of each operand, in the order of the operands.
    pub fn domain(&self) -> Vec<(i64, i64)> {
        self.operands.iter().map(|operand| operand.domain).collect()
    }

    /// Returns the names of the operands on which result number `result`, or the condition of its promise, depends.
    pub(super) fn operands_of(&self, result: usize) -> BTreeSet<&str> {
        let StatedResult { formula, promise, .. } = &self.results[result];
        let mut named = BTreeSet::from_iter(formula.operands());
        if let Some(Comparison { left, right, .. }) = promise {
            named.extend(left.operands());
            named.extend(right.operands());
        }
        named
    }

    /// Returns the domain of each operand, but only its first value for an operand that is not in `named`, because the value does
    /// not matter.
    pub(super) fn domain_of(&self, named: &BTreeSet<&str>) -> Vec<(i64, i64)> {
        let limits = |operand: &StatedOperand| {
            let (first, last) = operand.domain;
            if named.contains(operand.name.as_str()) { (first, last) } else { (first, first) }
        };
        self.operands.iter().map(limits).collect()
    }

    /// Returns `count` combinations of raw operands that are spread over their domains: the smallest values, the largest values, and then
    /// numbers of a linear congruential generator.
    pub(super) fn spread_operands(&self, count: u64) -> Vec<Vec<i64>> {
        let mut state: u64 = 0x9e37_79b9_7f4a_7c15;
        let mut spread = Vec::new();
        for number in 0..count {
            let mut raw = Vec::with_capacity(self.operands.len());
            for StatedOperand { domain: (first, last), .. } in &self.operands {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(number | 1);
                let values = last.abs_diff(*first).saturating_add(1);
                raw.push(match number {
                    0 => *first,
                    1 => *last,
                    _ => first + ((state >> 16) % values) as i64,
                });
            }
            spread.push(raw);
        }
        spread
    }

    /// Returns the number of combinations of raw operands in their domains.
    pub fn combinations(&self) -> u128 {
        interval::combinations(self.domain())
    }
}

impl StatedOperand {
    /// Returns the value with which results are computed for an operand. This value is the nearer end of the domain if the
    /// operand is outside a domain that clamps. For example, 0.9 becomes 0.5 if the domain ends at 0.5.
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

    /// Returns the raw value with which results are computed if the operand has the raw value `raw`. The result is the nearer
    /// end of the domain if `raw` is outside a domain that clamps, and otherwise `raw`. For example, 900 becomes 500 if a
    /// domain that clamps ends at 500.
    pub fn computed_raw(&self, raw: i64) -> i64 {
        match self.outside {
            Outside::Clamp => raw.clamp(self.domain.0, self.domain.1),
            Outside::Wrap | Outside::Anything => raw,
        }
    }
}

impl StatedResult {
    /// Returns whether an error of at most `units` keeps the allowed error. The error must be below the allowed error. An error of
    /// exactly half a unit is also allowed if half a unit is stated, because rounding to the nearest value has this error.
    pub fn allows(&self, units: f64) -> bool {
        units < self.error || units == HALF_A_UNIT && self.error == HALF_A_UNIT
    }

    /// Returns the formula that the error is measured against: [`StatedResult::formula`], limited to the format if the result
    /// saturates.
    pub fn target(&self) -> &Expression {
        match &self.width {
            Some(StatedWidth { overflow: StatedOverflow::Saturate(limited), .. }) => limited,
            _ => &self.formula,
        }
    }

    /// Returns an interval that contains the value that the result approximates. The formula is evaluated in f64 for
    /// `operands`. If the interval is then wider than a millionth of a unit, the formula is evaluated again with more bits, for
    /// the exact operands that `exactly` returns.
    ///
    /// # Errors
    /// Fails if a part of the formula has no value. The error names the part.
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

    /// Returns whether the error is promised for all operands in the intervals. Returns `None` if the error is promised for
    /// some of them only, or if the intervals do not decide this.
    pub fn is_promised(&self, operands: &[(&str, Enclosure)]) -> Option<bool> {
        let Some(promise) = &self.promise else { return Some(true) };
        promise.holds(operands).unwrap_or(None)
    }
}

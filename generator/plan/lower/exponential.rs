//! Rewrites logarithms and exponential functions over several octaves, so that a table for a single octave serves all octaves.
//!
//! A logarithm is rewritten if the largest value of its operand is at least 4 times the smallest. The operand v is m · 2^k with m
//! from 1/2 to below 1, and log₂ v is log₂ m, from a table, plus k.
//!
//! An exponential function 2^u is rewritten if its exponent u has fraction bits and extends over at least 3, for example from 0
//! to 10. With the integer part i and the fraction part f of u, a table of 2^f and a shift compute 2^u = 2^f · 2^i.

use std::sync::Arc;

use glint_base::fixed::{Format, Rounding, exp2};
use glint_formula::{Enclosure, Expression, Function, Kind, Operator, TextSpan};

use super::Lowering;
use super::root::FEW_OCTAVES;
use super::shape::{number, products_of};
use crate::node::NodeId;
use crate::refusal::PlanRefusal;

/// If the largest exponent exceeds the smallest by less than this, one table computes the whole exponential function.
const SHORT_EXPONENTS: f64 = 3.0;

/// Returns the formula 2^(b · log₂ a), which equals a^b. All of its parts have the location `place` in the text.
pub(super) fn written_with_logarithm(
    a: &Expression,
    b: &Expression,
    place: &TextSpan,
) -> Expression {
    let part = |kind: Kind| Expression::new(kind, place.clone());
    let logarithm = part(Kind::Unary(Function::Log2, Arc::new(a.clone())));
    let exponent = part(Kind::Binary(Operator::Mul, Arc::new(b.clone()), Arc::new(logarithm)));
    part(Kind::Unary(Function::Exp2, Arc::new(exponent)))
}

/// An exponential function: the base, which is `None` for the base 2, and the exponent as a function of x.
struct ExponentialFunction<'f> {
    base: Option<Expression>,
    exponent: &'f Expression,
}

impl<'f> ExponentialFunction<'f> {
    /// Returns the base and the exponent of an exponential function: `exp(-x / 2)` has the base e and the exponent `-x / 2`.
    /// Returns `None` for any other formula, and if the exponent needs more than one product with a constant.
    fn of(function: &'f Expression) -> Option<Self> {
        let operand = Expression::operand("x");
        let it = match &function.kind {
            Kind::Unary(Function::Exp2, exponent) => Self { base: None, exponent },
            Kind::Unary(Function::Exp, exponent) => Self { base: Some(number("e")), exponent },
            Kind::Binary(Operator::Power, base, exponent) if !base.varies() => {
                let is_two = **base == number("2");
                Self { base: (!is_two).then(|| (**base).clone()), exponent }
            }
            _ => return None,
        };
        let costs = products_of(it.exponent, &operand);
        costs.is_some_and(|products| products <= 1).then_some(it)
    }
}

/// Returns the constant c if the formula is c · log₂ x. For example, `3 * ln(x)` gives 3 · ln 2. Returns `None` for any other formula.
pub(super) fn factor_of_logarithm(function: &Expression) -> Option<Expression> {
    let with_kind = |kind: Kind| Expression::new(kind, function.span.clone());
    match &function.kind {
        Kind::Unary(kind @ (Function::Log2 | Function::Ln), operand)
            if **operand == Expression::operand("x") =>
        {
            Some(number(if *kind == Function::Log2 { "1" } else { "ln(2)" }))
        }
        Kind::Unary(Function::Negate, a) => {
            let factor = factor_of_logarithm(a)?;
            Some(with_kind(Kind::Unary(Function::Negate, Arc::new(factor))))
        }
        Kind::Binary(Operator::Mul, a, b) if !a.varies() => {
            factor_of_logarithm(b).map(|factor| scaled_by(a, &factor))
        }
        Kind::Binary(Operator::Mul, a, b) if !b.varies() => {
            factor_of_logarithm(a).map(|factor| scaled_by(b, &factor))
        }
        Kind::Binary(Operator::Div, a, b) if !b.varies() => {
            let factor = factor_of_logarithm(a)?;
            Some(with_kind(Kind::Binary(Operator::Div, Arc::new(factor), b.clone())))
        }
        _ => None,
    }
}

/// Returns the product of two formulas, or the second one if the first is the constant 1.
fn scaled_by(factor: &Expression, formula: &Expression) -> Expression {
    if factor.rational().is_some_and(|factor| factor.is_one()) {
        return formula.clone();
    }
    let kind = Kind::Binary(Operator::Mul, Arc::new(factor.clone()), Arc::new(formula.clone()));
    Expression::new(kind, formula.span.clone())
}

impl Lowering<'_> {
    /// Returns the node of a constant times a logarithm, such as `3 * log2(a)`. `core` is the operand of the logarithm, here
    /// `a`, and `function` is the formula with `x` in place of `core`: `3 * log2(x)`.
    ///
    /// Returns `None` for any other function, or if `core` may be 0 or less. Also returns `None` if one table can compute the
    /// whole logarithm, because the largest value of `core` is less than `FEW_OCTAVES` times the smallest. Fails if the plan
    /// cannot compute a part.
    pub(super) fn logarithm(
        &mut self,
        core: &Expression,
        function: &Expression,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let Some(factor) = factor_of_logarithm(function) else { return Ok(None) };
        let range = self.range(core)?;
        if range.low <= 0.0 || range.high < range.low * FEW_OCTAVES {
            return Ok(None);
        }
        let node = self.part(core)?;
        let octave = self.octave(node, range, false)?;
        let finest = self.finest;
        // Twice the fraction is at least 1, so that its logarithm is not negative, as the other values of a shared table.
        let (logarithm, exponent) = match self.guards.style.shares_table {
            true => (number("log2(2 * x)"), octave.exponent - 1),
            false => (number("log2(x)"), octave.exponent),
        };
        let of_mantissa = scaled_by(&factor, &logarithm);
        let within = self.rounding(finest + 2, |own, frac| {
            let frac = frac.max(own.least_table_fraction(0));
            own.approximation("logarithm", octave.mantissa, &of_mantissa, octave.domain, frac)
        })?;
        let exponent = self.plan.constant("exponent", exponent.into(), 0)?;
        let octaves = self.plan.subtract("octaves", exponent, octave.places)?;
        let octaves = match factor.rational().is_some_and(|factor| factor.is_one()) {
            true => octaves,
            false => {
                let factor = self.number(&factor)?;
                self.plan.multiply("octaves_scaled", octaves, factor)?
            }
        };
        self.plan.add("logarithm_of_word", octaves, within).map(Some)
    }

    /// Returns the node of an exponential function. `function` must be the formula with `x` in the place of its operand, the
    /// expression `core`. Returns `None` if `function` is no exponential function, if its exponent extends over less than
    /// `SHORT_EXPONENTS`, or if the exponent has no fraction bits. Fails if the plan cannot compute a part.
    pub(super) fn exponential(
        &mut self,
        core: &Expression,
        function: &Expression,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let Some(ExponentialFunction { base, exponent }) = ExponentialFunction::of(function) else {
            return Ok(None);
        };
        let place = &core.span;
        let exponent = exponent.substitute(&Expression::operand("x"), core, place);
        let exponents = match base {
            None => exponent,
            Some(base) => {
                let part = |kind: Kind| Expression::new(kind, place.clone());
                let logarithm = part(Kind::Unary(Function::Log2, Arc::new(base)));
                part(Kind::Binary(Operator::Mul, Arc::new(exponent), Arc::new(logarithm)))
            }
        };
        let range = self.range(&exponents)?;
        if range.high - range.low < SHORT_EXPONENTS {
            return Ok(None);
        }
        let exact = self.part(&exponents)?;
        let finest = self.finest;
        let exponent = self.rounding(finest + 2, |own, frac| {
            own.plan.shorten_for_table("exponent", exact, frac.max(1))
        })?;
        if self.plan.node(exponent).format.frac < 1 {
            return Ok(None);
        }
        // The error of the exponent can make it reach the next integer.
        let largest = range.high.floor() as i32 + 1;
        let smallest = self.plan.node(exponent).range.0 >> self.plan.node(exponent).format.frac;
        if i128::from(largest) - smallest <= MOST_PLACES {
            return self.power_of_two(exponent, largest).map(Some);
        }
        // Far below the last bit of the result, the value counts as 0.
        let slack = self.exponent_slack(exponent)?;
        let mut least = 0;
        let nothing = self.rounding(finest + 4, |own, frac| {
            least = -frac;
            let values = Enclosure::between(0.0, exp2(least + slack));
            own.plan.rounded_constant("nothing", 0, frac, values)
        })?;
        let limit = self.plan.constant("least_exponent", least.into(), 0)?;
        let is_below = self.plan.less("is_nothing", exponent, limit)?;
        // Where the power counts, the exact exponent is not below this limit either.
        let lower = self.plan.constant("lowest_exponent", (least - slack).into(), 0)?;
        let limited = self.plan.maximum("exponent_limited", exponent, lower)?;
        let power = self.power_of_two(limited, largest)?;
        self.plan.choose("power_or_nothing", is_below, [power, nothing]).map(Some)
    }

    /// Returns an upper bound of the error of an exponent, in octaves, for the results that read the part that is being rewritten.
    ///
    /// # Errors
    /// Fails if the bound is above [`MOST_SLACK`], or if none is found.
    fn exponent_slack(&self, exponent: NodeId) -> Result<i32, PlanRefusal> {
        let errors = self.errors_by_result(exponent);
        let readers = self.uses.readers.iter().zip(&errors).filter(|(reads, _)| **reads);
        let units = readers.map(|(_, units)| *units).fold(0.0, f64::max);
        let octaves = (units * exp2(-self.plan.node(exponent).format.frac)).ceil();
        if octaves > MOST_SLACK {
            return Err(PlanRefusal::new(
                "Glint finds no limit of the error of this exponent",
                "limit the operands with `where`, so that the power is not far below the last bit of the result",
            ));
        }
        Ok(octaves as i32)
    }

    /// Returns the node of 2 to the power of `exponent`, whose integer part is at most `largest`. Fails if a node has too many bits.
    fn power_of_two(&mut self, exponent: NodeId, largest: i32) -> Result<NodeId, PlanRefusal> {
        let finest = self.finest;
        let [integer, fraction] = self.plan.split("exponent", exponent)?;
        let bits = self.plan.node(fraction).format.frac;
        let largest = largest.min(self.plan.node(integer).range.1 as i32);
        let domain = (0, (1i64 << bits) - 1);
        let frac = (finest + 2 + largest).max(0);
        let within = self.rounding(frac, |own, frac| {
            let frac = frac.max(own.least_table_fraction(largest));
            own.approximation("octave", fraction, &number("exp2(x)"), domain, frac)
        })?;
        let source = self.plan.node(within).source;
        let scaled = self.plan.scale("octave_scaled", within, largest)?;
        let top = self.plan.constant("top_exponent", largest.into(), 0)?;
        let places = self.plan.subtract("octaves_below", top, integer)?;
        let least = self.plan.node(places).range.0.max(0);
        let most = self.plan.node(places).range.1.clamp(least, MOST_PLACES);
        let format = Format::holding(0, most, 0);
        let places = self.plan.narrow("places", places, format, Rounding::Truncate)?;
        let shifted = self.plan.shift_right("exponential", scaled, places)?;
        self.plan.state_source(shifted, source);
        Ok(shifted)
    }
}

/// The largest error of an exponent, in octaves, with which a power far below the last bit is known to be 0.
const MOST_SLACK: f64 = 4.0;

/// The largest number of bits of a shift. A larger shift would remove all bits of any word.
const MOST_PLACES: i128 = 63;

//! Rewrites logarithms and exponential functions over several octaves, so that a table for a single octave serves all octaves.
//!
//! A logarithm is rewritten if the largest value of its operand is at least 4 times the smallest, for example from 1 to 1000.
//! The operand v is m · 2^k with m from 1/2 to below 1. Because log₂ v = log₂ m + k, a table of log₂ m and an addition compute
//! the logarithm.
//!
//! An exponential function 2^u is rewritten if its exponent u has fraction bits and extends over at least 3, for example from 0
//! to 10. With the integer part i and the fraction part f of u, 2^u = 2^f · 2^i. A table of 2^f and a shift compute the
//! function.

use std::sync::Arc;

use glint_base::fixed::Rounding;
use glint_formula::{Expression, Function, Kind, Operator, TextSpan};

use super::root::FEW_OCTAVES;
use super::{Lowering, number};
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

/// Returns the base of an exponential function of x: `Some(None)` for the base 2, and `Some(Some(base))` for any other. Returns
/// `None` if the formula is no exponential function of x.
fn base_of(function: &Expression) -> Option<Option<Expression>> {
    let operand = Expression::operand("x");
    match &function.kind {
        Kind::Unary(Function::Exp2, a) if **a == operand => Some(None),
        Kind::Unary(Function::Exp, a) if **a == operand => Some(Some(number("e"))),
        Kind::Binary(Operator::Power, a, b) if **b == operand && !a.varies() => {
            let is_two = **a == number("2");
            Some(if is_two { None } else { Some((**a).clone()) })
        }
        _ => None,
    }
}

impl Lowering<'_> {
    /// Returns the node of a logarithm. `function` must be the formula with `x` in the place of its operand, the expression
    /// `core`. Returns `None` if `function` is no logarithm of `x`, if its operand may be 0 or less, or if the largest operand
    /// is less than `FEW_OCTAVES` times the smallest. Fails if a part has too many bits, no finite values, or no rule.
    pub(super) fn logarithm(
        &mut self,
        core: &Expression,
        function: &Expression,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let Kind::Unary(kind @ (Function::Log2 | Function::Ln), operand) = &function.kind else {
            return Ok(None);
        };
        if **operand != Expression::operand("x") {
            return Ok(None);
        }
        let range = self.range(core)?;
        if range.low <= 0.0 || range.high < range.low * FEW_OCTAVES {
            return Ok(None);
        }
        let node = self.part(core)?;
        let octave = self.octave(node, range, false)?;
        let finest = self.finest;
        let within = self.rounding(finest + 2, |own, frac| {
            own.approximation("logarithm", octave.mantissa, &number("log2(x)"), octave.domain, frac)
        })?;
        let exponent = self.plan.constant("exponent", octave.exponent.into(), 0)?;
        let octaves = self.plan.subtract("octaves", exponent, octave.places)?;
        let logarithm = self.plan.add("logarithm_of_word", octaves, within)?;
        if *kind == Function::Log2 {
            return Ok(Some(logarithm));
        }
        let factor = self.number(&number("ln(2)"))?;
        self.plan.multiply("natural_logarithm", logarithm, factor).map(Some)
    }

    /// Returns the node of an exponential function. `function` must be the formula with `x` in the place of its operand, the
    /// expression `core`. Returns `None` if `function` is no exponential function, if its exponent extends over less than
    /// `SHORT_EXPONENTS`, or if the exponent has no fraction bits. Fails if a part has too many bits, no finite values, or no
    /// rule.
    pub(super) fn exponential(
        &mut self,
        core: &Expression,
        function: &Expression,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let Some(base) = base_of(function) else { return Ok(None) };
        let exponents = match &base {
            None => core.clone(),
            Some(base) => {
                let place = &core.span;
                let part = |kind: Kind| Expression::new(kind, place.clone());
                let logarithm = part(Kind::Unary(Function::Log2, Arc::new(base.clone())));
                let kind = Kind::Binary(Operator::Mul, Arc::new(core.clone()), Arc::new(logarithm));
                part(kind)
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
        let [integer, fraction] = self.plan.split("exponent", exponent)?;
        let bits = self.plan.node(fraction).format.frac;
        // The error of the exponent can make it reach the next integer.
        let largest = (range.high.floor() as i32 + 1).min(self.plan.node(integer).range.1 as i32);
        let domain = (0, (1i64 << bits) - 1);
        let frac = (finest + 2 + largest).max(0);
        let within = self.rounding(frac, |own, frac| {
            own.approximation("octave", fraction, &number("exp2(x)"), domain, frac)
        })?;
        let source = self.plan.node(within).source;
        let scaled = self.plan.scale("octave_scaled", within, largest)?;
        let top = self.plan.constant("top_exponent", largest.into(), 0)?;
        let places = self.plan.subtract("octaves_below", top, integer)?;
        let least = self.plan.node(places).range.0.max(0);
        let most = self.plan.node(places).range.1.clamp(least, MOST_PLACES);
        let format = glint_base::fixed::Format::holding(0, most, 0);
        let places = self.plan.narrow("places", places, format, Rounding::Truncate)?;
        let shifted = self.plan.shift_right("exponential", scaled, places)?;
        self.plan.nodes[shifted.0].source = source;
        Ok(Some(shifted))
    }
}

/// The largest number of bits of a shift. A larger shift would remove all bits of any word.
const MOST_PLACES: i128 = 63;

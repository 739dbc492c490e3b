//! Rewrites a power v^p, such as a square root or a reciprocal, as operations of a plan, so that a table for one octave serves
//! all octaves. The number 2p must be an integer from −8 to 8. A power is not rewritten if a single table is better, because the
//! operand has few bits and few octaves.
//!
//! The value is normalised: v = m · 2^k with m from 1/2 to below 1, so that a table of m^p and a shift compute v^p = m^p ·
//! 2^(p·k). If p is 1/2 or an odd multiple of it, k must be even, and m goes from 1/4 to below 1.

use std::sync::Arc;

use glint_base::fixed::{Format, Rounding, exp2};
use glint_formula::{Enclosure, Expression, Function, Kind, Operator, RBig};

use super::shape::number;
use super::{Lowering, PlanStyle, WIDEST_OPERAND};
use crate::node::{NodeId, Operation, PlanNode, ValueAccuracy};
use crate::refusal::PlanRefusal;

/// If the largest value of a domain is less than this times the smallest, one table covers the domain.
pub(super) const FEW_OCTAVES: f64 = 4.0;

/// The most parts of a formula that counts as a power.
const MOST_PARTS: u32 = 1000;

/// A wide word whose values are all at least 2 to the power of 1 minus this number, 2⁻¹¹, is shortened before it is normalised.
const MOST_OCTAVES_BELOW_1: i32 = 12;

/// Twice the exponent of a power. For example, −1 denotes the exponent −1/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DoubledExponent(i32);

impl DoubledExponent {
    /// Returns whether the power has no finite slope, or no finite value, at 0.
    pub(super) fn is_singular(self) -> bool {
        self.0 < 2
    }
}

/// Returns twice the exponent p of a formula that is a constant times x^p. Returns `None` for any other formula, if 2p is no
/// integer from −8 to 8, or if p is a whole number from 0 on. For example, `3 / sqrt(x)` gives −1. The slope of x^3 is largest for large x,
/// so that a table over all values, or products, need fewer bits than a table for one octave.
pub(super) fn power_of(formula: &Expression) -> Option<DoubledExponent> {
    if formula.size() > MOST_PARTS {
        return None;
    }
    let doubled = doubled_exponent(formula)?;
    let value = i32::try_from(doubled.numerator().clone()).ok()?;
    let is_whole = value >= 0 && value % 2 == 0;
    let is_power = doubled.is_int() && !is_whole && value.abs() <= 8;
    is_power.then_some(DoubledExponent(value))
}

fn doubled_exponent(formula: &Expression) -> Option<RBig> {
    if !formula.varies() {
        return Some(RBig::ZERO);
    }
    match &formula.kind {
        Kind::Operand(_) => Some(RBig::from(2)),
        Kind::Unary(Function::Negate, a) => doubled_exponent(a),
        Kind::Unary(Function::Sqrt, a) => Some(doubled_exponent(a)? / RBig::from(2)),
        Kind::Binary(Operator::Mul, a, b) => Some(doubled_exponent(a)? + doubled_exponent(b)?),
        Kind::Binary(Operator::Div, a, b) => Some(doubled_exponent(a)? - doubled_exponent(b)?),
        Kind::Binary(Operator::Power, a, b) if !b.varies() => {
            Some(doubled_exponent(a)? * b.rational()?)
        }
        _ => None,
    }
}

/// A normalised word: a fraction within one octave, and the number of bits by which the word was shifted.
#[derive(Clone, Copy)]
pub(super) struct Octave {
    /// The word before the shift, without a sign.
    pub(super) word: NodeId,
    /// The fraction after the shift, shortened to the bits that the table takes.
    pub(super) mantissa: NodeId,
    /// The number of bits of the shift, or of pairs of bits.
    pub(super) places: NodeId,
    /// A node that is 1 if the word was shifted by one bit more than the pairs of bits in `places`; `None` if it cannot be.
    pub(super) is_odd: Option<NodeId>,
    /// The word is the fraction times 2 to the power of `exponent` minus the bits of the shift.
    pub(super) exponent: i32,
    /// The smallest and the largest raw fraction that is not 0.
    pub(super) domain: (i64, i64),
}

impl Lowering<'_> {
    /// Returns the node of a power. `part` must be the formula of the power, `core` its operand, and `function` the formula in
    /// which x replaces `core`. Returns `None` if the operand may be negative. Also returns `None` if a single table is better,
    /// because the operand has few bits and few octaves. Fails if the plan cannot compute a part.
    pub(super) fn power(
        &mut self,
        part: &Expression,
        core: &Expression,
        function: &Expression,
        DoubledExponent(doubled): DoubledExponent,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let at_one = function.enclose(&[("x", Enclosure::exactly(1.0))]);
        if at_one.is_ok_and(|value| value.high < 0.0) {
            let negated = |formula: &Expression| {
                let kind = Kind::Unary(Function::Negate, Arc::new(formula.clone()));
                Expression::new(kind, formula.span.clone())
            };
            let exponent = DoubledExponent(doubled);
            let positive = self.power(&negated(part), core, &negated(function), exponent)?;
            let Some(positive) = positive else { return Ok(None) };
            return self.plan.negate("power_negated", positive).map(Some);
        }
        let range = self.range(core)?;
        let node = self.part(core)?;
        let format = self.plan.node(node).format;
        let is_narrow = format.width() <= super::WIDEST_OPERAND;
        if range.low < 0.0 || is_narrow && range.high < range.low * FEW_OCTAVES {
            return Ok(None);
        }
        let by_pairs = doubled % 2 != 0;
        let octave = self.octave(node, range, by_pairs)?;
        // The result is multiplied by the power of the factor by which the word exceeds its fraction.
        let scale = doubled * octave.exponent / 2;
        let frac = self.finest + 2 + if doubled > 0 { scale } else { 0 };
        let fewest = fewest_fraction_bits(function);
        let of_mantissa = self.rounding(frac, |own, frac| {
            let least = if doubled > 0 { own.least_table_fraction(scale) } else { fewest };
            let frac = frac.max(fewest).max(least);
            match octave.is_odd {
                Some(is_odd) => own.power_by_parity(function, &octave, is_odd, frac),
                None => own.approximation("power", octave.mantissa, function, octave.domain, frac),
            }
        })?;
        let source = self.plan.node(of_mantissa).source;
        self.give_source_to_tables(of_mantissa);
        let scaled = self.plan.scale("power_scaled", of_mantissa, scale)?;
        let places = self.multiple(octave.places, doubled.abs() / if by_pairs { 1 } else { 2 })?;
        if doubled < 0 {
            let values = self.range(part)?;
            let format = self.plan.node(scaled).format;
            let format = holding(values, format.frac);
            return self.plan.shift_left("power_shifted", scaled, places, format).map(Some);
        }
        let shifted = self.plan.shift_right("power_shifted", scaled, places)?;
        self.plan.state_source(shifted, source);
        if range.low > 0.0 {
            return Ok(Some(shifted));
        }
        let zero = self.plan.constant("zero", 0, self.plan.node(shifted).format.frac)?;
        let is_some = self.plan.nonzero("is_nonzero", octave.word)?;
        let chosen = self.plan.choose("power_or_zero", is_some, [zero, shifted])?;
        // A word that was rounded to 0 has no power in the table.
        let stated = self.stated(part, &self.uses, ValueAccuracy::FromInputs);
        self.plan.state_value(chosen, stated);
        Ok(Some(chosen))
    }

    /// Moves the number of a rounding operation from a choice between two tables to these tables, which have the error. Changes
    /// nothing for another node.
    pub(super) fn give_source_to_tables(&mut self, node: NodeId) {
        let PlanNode { operation: Operation::Choose { cases, .. }, source, .. } =
            *self.plan.node(node)
        else {
            return;
        };
        self.plan.state_source(node, None);
        for case in cases {
            self.plan.state_source(case, source);
        }
    }

    /// Returns the node of the power of a fraction m from 1/2 to below 1, or of m / 2 where `is_odd` is 1. Each of the two has a table.
    pub(super) fn power_by_parity(
        &mut self,
        function: &Expression,
        octave: &Octave,
        is_odd: NodeId,
        frac: i32,
    ) -> Result<NodeId, PlanRefusal> {
        let operand = Expression::operand("x");
        let part = |kind: Kind| Expression::new(kind, function.span.clone());
        let two = Arc::new(number("2"));
        let half = part(Kind::Binary(Operator::Div, Arc::new(operand.clone()), two));
        let of_half = function.substitute(&operand, &half, &function.span);
        let Octave { mantissa, domain, .. } = *octave;
        let even = self.approximation("power_of_even", mantissa, function, domain, frac)?;
        let odd = self.approximation("power_of_odd", mantissa, &of_half, domain, frac)?;
        self.plan.choose("power", is_odd, [even, odd])
    }

    /// Normalises a node whose values are not below 0, apart from rounding errors. The word is shifted to the left, so that a
    /// fraction from 1/2 to below 1 remains; a word of 0 gives the fraction 0. Returns the fraction, the shift, and the word
    /// before the shift. If `by_pairs` is true, the shift has an even number of bits and is counted in pairs, and the fraction
    /// is from 1/4 to below 1. `range` must contain the exact values of the node. Fails if a node has too many bits.
    pub(super) fn octave(
        &mut self,
        node: NodeId,
        range: Enclosure,
        by_pairs: bool,
    ) -> Result<Octave, PlanRefusal> {
        let node = self.without_negative_rounding(node)?;
        // If the word is far from 0, it has more bits than any result needs.
        let octaves_below_1 = -floor_of_log2(range.low);
        let is_far = octaves_below_1 < MOST_OCTAVES_BELOW_1;
        let node = self.rounding(self.finest + 3 + octaves_below_1, |own, frac| {
            let is_wide = own.plan.node(node).format.width() > WIDEST_OPERAND;
            if !is_wide || !is_far {
                return Ok(node);
            }
            own.plan.shorten("word_shortened", node, frac, Rounding::Nearest)
        })?;
        let format = self.plan.node(node).format;
        // The word has no sign, and no integer bits that are never used. By pairs, it has an even number of integer bits.
        let most = self.plan.node(node).range.1;
        let limited = match self.is_exact(node) {
            true => most.min((range.high * exp2(format.frac)).floor() as i128),
            false => most,
        };
        let word_format = Format::holding(0, limited, format.frac);
        let is_odd = by_pairs && word_format.int % 2 != 0;
        let word_format = Format { int: word_format.int + i32::from(is_odd), ..word_format };
        let word = self.plan.narrow("word", node, word_format, Rounding::Truncate)?;
        let PlanStyle { shares_table, centres_fractions, .. } = self.guards.style;
        let [normalised, places] =
            self.plan.normalise("normalised", word, by_pairs && !shares_table)?;
        let finest = self.finest;
        let is_table_word =
            shares_table && self.plan.node(normalised).format.width() <= WIDEST_OPERAND;
        let mantissa = self.rounding(finest + 1, |own, frac| {
            let frac = frac.max(2);
            match centres_fractions {
                _ if is_table_word => Ok(normalised),
                true => own.plan.shorten_for_table("mantissa", normalised, frac),
                false => own.plan.shorten("mantissa", normalised, frac, Rounding::Truncate),
            }
        })?;
        let bits = self.plan.node(mantissa).format.frac;
        let first = 1i64 << (bits - if by_pairs && !shares_table { 2 } else { 1 });
        let domain = (first, (1i64 << bits) - 1);
        let exponent = word_format.int;
        if !by_pairs || !shares_table {
            return Ok(Octave { word, mantissa, places, is_odd: None, exponent, domain });
        }
        let is_odd = self.plan.bit("places_are_odd", places, 0)?;
        let halved = self.plan.scale("places_halved", places, -1)?;
        let pairs = self.plan.integer_part("places_by_pairs", halved)?;
        Ok(Octave { word, mantissa, places: pairs, is_odd: Some(is_odd), exponent, domain })
    }

    /// Returns the node with 0 in place of its negative values, which come only from rounding. Returns the node itself if it is
    /// exact or never negative. Fails if a node has too many bits.
    fn without_negative_rounding(&mut self, node: NodeId) -> Result<NodeId, PlanRefusal> {
        let is_negative = self.plan.node(node).range.0 < 0;
        if !is_negative || self.is_exact(node) {
            return Ok(node);
        }
        let frac = self.plan.node(node).format.frac;
        let zero = self.plan.constant("zero", 0, frac)?;
        self.plan.maximum("not_negative", node, zero)
    }

    /// Returns the node of `places` times the constant `factor`, or `places` itself if the factor is 1. Fails if a node has too
    /// many bits.
    fn multiple(&mut self, places: NodeId, factor: i32) -> Result<NodeId, PlanRefusal> {
        if factor == 1 {
            return Ok(places);
        }
        let factor = self.plan.constant("shift_factor", factor.into(), 0)?;
        self.plan.multiply("shift", places, factor)
    }
}

/// Returns the smallest number of fraction bits with which the function's values at 1/4 and at 1 are at least two units. With
/// fewer bits, rounding could make a value of the table negative. For example, the square root needs 2 bits, because its value
/// 1/2 is then two units.
fn fewest_fraction_bits(function: &Expression) -> i32 {
    let mut least = f64::INFINITY;
    for mantissa in [0.25, 1.0] {
        let value = function.enclose(&[("x", Enclosure::exactly(mantissa))]);
        least = least.min(value.map_or(f64::INFINITY, |value| value.low));
    }
    1 - floor_of_log2(least)
}

/// Returns the format with `frac` fraction bits that can represent all values within limits, and values one unit beyond them.
pub(super) fn holding(values: Enclosure, frac: i32) -> Format {
    let unit = exp2(frac);
    let low = if values.low >= 0.0 { 0 } else { (values.low * unit - 1.0).floor() as i128 };
    Format::holding(low, (values.high * unit + 1.0).floor() as i128, frac)
}

/// Returns the exponent of the greatest power of two that is not above a positive number. For example, 5 gives 2.
fn floor_of_log2(value: f64) -> i32 {
    const FRACTION_BITS: u32 = f64::MANTISSA_DIGITS - 1;
    const BIAS: i32 = f64::MAX_EXP - 1;
    let exponent = (value.abs().to_bits() >> FRACTION_BITS) as i32;
    exponent - BIAS
}

//! Rewrites the integer part of α · p + β exactly, for an exact number p and constants that may be irrational. For example, the
//! number of whole turns in an angle is floor(a / (2 · π)). Also rewrites remainders by such a constant.
//!
//! A raw value A of p has the integer part (A · `factor` + `offset`) / 2^`places`, rounded down, if these constants have enough
//! bits. Only values A at which the exact sum is next to an integer can then have another integer part. They are found without a
//! trial of all values: the smallest A with A · a mod m in an interval follows from a smaller problem of the same kind, as in
//! Euclid's algorithm.

use std::sync::Arc;

use glint_base::fixed::{Rounding, exp2};
use glint_formula::{Enclosure, Expression, Function, Kind, Operator, RBig};

use super::Lowering;
use super::rational::over_number;
use super::root::holding;
use super::shape::{has_no_function, number};
use crate::node::{NodeId, Operation, PlanNode, ValueAccuracy};
use crate::refusal::PlanRefusal;

/// The fraction bits of the constants with which an integer part is known.
const KNOWN_BITS: u32 = 88;

/// The most fraction bits of the constants in hardware.
const MOST_PLACES: u32 = 50;

/// The most bits of a raw value of p, and of an integer part. With the bits in [`KNOWN_BITS`], a sum then fits an `i128`.
const MOST_BITS: u32 = 36;

/// The most raw values next to an integer that are examined one by one.
const MOST_NEAR: usize = 64;

/// A sum α · p + β with constants α and β.
struct Line {
    part: Expression,
    slope: Expression,
    start: Expression,
}

impl Line {
    /// Writes a formula as a constant times a part without functions, plus a constant. Returns `None` for another formula.
    fn of(formula: &Expression) -> Option<Self> {
        let binary = |operator, a: &Expression, b: &Expression| {
            let kind = Kind::Binary(operator, Arc::new(a.clone()), Arc::new(b.clone()));
            Expression::new(kind, formula.span.clone())
        };
        let scaled = |line: Self, operator, factor: &Expression| Self {
            part: line.part,
            slope: binary(operator, &line.slope, factor),
            start: binary(operator, &line.start, factor),
        };
        let moved = |line: Self, operator, by: &Expression| Self {
            start: binary(operator, &line.start, by),
            ..line
        };
        match &formula.kind {
            _ if is_exact_part(formula) => {
                Some(Self { part: formula.clone(), slope: number("1"), start: number("0") })
            }
            Kind::Unary(Function::Negate, a) => {
                Some(scaled(Self::of(a)?, Operator::Mul, &number("-1")))
            }
            Kind::Binary(operator @ (Operator::Mul | Operator::Div), a, b) if !b.varies() => {
                Some(scaled(Self::of(a)?, *operator, b))
            }
            Kind::Binary(Operator::Mul, a, b) if !a.varies() => {
                Some(scaled(Self::of(b)?, Operator::Mul, a))
            }
            Kind::Binary(operator @ (Operator::Add | Operator::Sub), a, b) if !b.varies() => {
                Some(moved(Self::of(a)?, *operator, b))
            }
            Kind::Binary(Operator::Add, a, b) if !a.varies() => {
                Some(moved(Self::of(b)?, Operator::Add, a))
            }
            Kind::Binary(Operator::Sub, a, b) if !a.varies() => {
                let negated = scaled(Self::of(b)?, Operator::Mul, &number("-1"));
                Some(moved(negated, Operator::Add, a))
            }
            _ => None,
        }
    }
}

/// Returns whether a formula varies and has only operations and constants that are exact in binary.
fn is_exact_part(formula: &Expression) -> bool {
    let is_divided = over_number(formula).is_none_or(|it| it.divisor != RBig::ONE);
    formula.varies() && has_no_function(formula) && !is_divided
}

/// Returns whether a formula is an integer part or a remainder with constants that are no rational numbers, such as `floor(a / pi)` and
/// `a % (2 * pi)`.
pub(super) fn is_irrational_division(formula: &Expression) -> bool {
    is_irrational_remainder(formula) || floored(formula).is_some_and(is_irrational_line)
}

fn is_irrational_line(formula: &Expression) -> bool {
    let is_irrational = |constant: &Expression| constant.rational().is_none();
    Line::of(formula).is_some_and(|line| is_irrational(&line.slope) || is_irrational(&line.start))
}

/// Returns whether a formula is a remainder by a constant that is no rational number.
pub(super) fn is_irrational_remainder(formula: &Expression) -> bool {
    match &formula.kind {
        Kind::Binary(Operator::Mod, a, b) => a.varies() && !b.varies() && b.rational().is_none(),
        _ => false,
    }
}

/// Writes a difference that is a remainder by an irrational constant as this remainder: `a - m * floor((a + c) / m)` is
/// `(a + c) % m - c`. Returns `None` for any other formula.
pub(super) fn with_remainder(formula: &Expression) -> Option<Expression> {
    let binary = |operator, a: &Expression, b: &Expression| {
        let kind = Kind::Binary(operator, Arc::new(a.clone()), Arc::new(b.clone()));
        Expression::new(kind, formula.span.clone())
    };
    let Kind::Binary(Operator::Sub, a, multiple) = &formula.kind else { return None };
    let Kind::Binary(Operator::Mul, first, second) = &multiple.kind else { return None };
    let (modulus, whole) = if first.varies() { (second, first) } else { (first, second) };
    if modulus.varies() || modulus.rational().is_some() {
        return None;
    }
    let turns = floored(whole)?;
    // round(u) is the floor of u + 1/2.
    let (quotient, added) = with_added(turns);
    let Kind::Binary(Operator::Div, dividend, divisor) = &quotient.kind else { return None };
    let (start, moved) = with_added(dividend);
    if divisor != modulus || *start != **a {
        return None;
    }
    let of_turns = added.map(|added| binary(Operator::Mul, &added, modulus));
    let offsets: Vec<Expression> = of_turns.into_iter().chain(moved).collect();
    let mut sum = (**a).clone();
    for offset in &offsets {
        sum = binary(Operator::Add, &sum, offset);
    }
    let mut rest = binary(Operator::Mod, &sum, modulus);
    for offset in &offsets {
        rest = binary(Operator::Sub, &rest, offset);
    }
    Some(rest)
}

/// Returns u if a formula is floor(u), which is u − u % 1.
fn floored(formula: &Expression) -> Option<&Expression> {
    let Kind::Binary(Operator::Sub, a, b) = &formula.kind else { return None };
    let Kind::Binary(Operator::Mod, of, one) = &b.kind else { return None };
    (of == a && **one == number("1")).then_some(a)
}

/// Returns u and c of a formula u + c or u − c with a constant c, which is negated in the second case; otherwise the formula itself.
fn with_added(formula: &Expression) -> (&Expression, Option<Expression>) {
    match &formula.kind {
        Kind::Binary(Operator::Add, a, c) if !c.varies() => (a, Some((**c).clone())),
        Kind::Binary(Operator::Add, c, a) if !c.varies() => (a, Some((**c).clone())),
        Kind::Binary(Operator::Sub, a, c) if !c.varies() => {
            let negated = Kind::Unary(Function::Negate, c.clone());
            (a, Some(Expression::new(negated, c.span.clone())))
        }
        _ => (formula, None),
    }
}

/// Integers with which floor(α · A + β) is (A · `factor` + `offset`) / 2^`places`, rounded down, for each integer A in a range.
#[derive(Debug, PartialEq)]
struct ExactLine {
    factor: i128,
    offset: i128,
    places: u32,
}

/// α · A + β with [`KNOWN_BITS`] fraction bits: each constant is rounded up to an integer.
struct KnownLine {
    slope: i128,
    start: i128,
}

impl KnownLine {
    const ONE: i128 = 1 << KNOWN_BITS;

    fn at(&self, raw: i128) -> i128 {
        self.slope * raw + self.start
    }

    /// Returns the integers in the range at which the line is less than `distance` from an integer, in units of
    /// 2^−[`KNOWN_BITS`]. Returns `None` if there are more than [`MOST_NEAR`].
    fn near_integers(&self, (low, high): (i128, i128), distance: i128) -> Option<Vec<i128>> {
        let count = (high - low + 1) as f64 * 2.0 * distance as f64 / Self::ONE as f64;
        if count > MOST_NEAR as f64 {
            return None;
        }
        if 2 * distance >= Self::ONE {
            return Some((low..=high).collect());
        }
        let mut near = Vec::new();
        let mut first = low;
        while first <= high {
            let start = self.at(first).rem_euclid(Self::ONE);
            let from = (-distance - start).rem_euclid(Self::ONE);
            let to = (distance - start).rem_euclid(Self::ONE);
            let steps = if from <= to {
                first_multiple(self.slope, Self::ONE, (from, to))
            } else {
                Some(0)
            };
            let Some(steps) = steps.filter(|steps| first + steps <= high) else { break };
            near.push(first + steps);
            if near.len() > MOST_NEAR {
                return None;
            }
            first += steps + 1;
        }
        Some(near)
    }

    /// Finds the constants with the fewest fraction bits that give the integer parts of the line. `whole_at` must return the integer
    /// part of the exact line at A. Returns `None` if no constants have these integer parts, or if an integer part is not known.
    fn exact_line(
        &self,
        range: (i128, i128),
        whole_at: &dyn Fn(i128) -> Option<i128>,
    ) -> Option<ExactLine> {
        let (low, high) = range;
        // Each constant was rounded up by less than 1.
        let unknown = low.abs().max(high.abs()) + 2;
        for places in 0..=MOST_PLACES {
            let step = 1_i128 << (KNOWN_BITS - places);
            for (factor_up, offset_up) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let factor = self.slope.div_euclid(step) + factor_up;
                let offset = self.start.div_euclid(step) + offset_up;
                let excess =
                    |raw: i128| (factor * step - self.slope) * raw + offset * step - self.start;
                let most = excess(low).abs().max(excess(high).abs()) + unknown;
                let Some(near) = self.near_integers(range, most) else { continue };
                let is_right =
                    |raw: &i128| whole_at(*raw) == Some((raw * factor + offset) >> places);
                if near.iter().all(is_right) {
                    return Some(ExactLine { factor, offset, places });
                }
            }
        }
        None
    }
}

/// Returns the smallest x that is not below 0 with `factor` · x mod `modulus` from `from` to `to`. These limits must be integers
/// from 0 to below the modulus, with `from` not above `to`. Returns `None` if no x has this property, or only one beyond 2^38.
fn first_multiple(factor: i128, modulus: i128, (from, to): (i128, i128)) -> Option<i128> {
    if from == 0 {
        return Some(0);
    }
    let factor = factor.rem_euclid(modulus);
    if factor == 0 {
        return None;
    }
    let first = (from + factor - 1) / factor;
    if first * factor <= to {
        return Some(first);
    }
    // factor · x − modulus · y lies within the limits for some y, so that modulus · y mod factor lies within the negated limits.
    let limits = ((-to).rem_euclid(factor), (-from).rem_euclid(factor));
    let turns = first_multiple(modulus, factor, limits)?;
    let product = modulus.checked_mul(turns)?.checked_add(from + factor - 1)?;
    Some(product / factor)
}

impl Lowering<'_> {
    /// Returns the node of floor(`formula`), an exact integer, if `formula` is a constant times an exact number plus a constant. `whole`
    /// must be the floor as a formula. Returns `None` for another formula, or if the operand or the floor has more than [`MOST_BITS`]
    /// bits. Fails if a constant or a node needs too many bits.
    pub(super) fn whole_of_line(
        &mut self,
        formula: &Expression,
        whole: &Expression,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let Some(Line { part, slope, start }) = Line::of(formula) else { return Ok(None) };
        let node = self.part(&part)?;
        let PlanNode { format, range, .. } = self.plan.node(node).clone();
        if !self.is_exact(node) || format.width() > MOST_BITS {
            return Ok(None);
        }
        let raw_slope = scaled(&slope, -format.frac);
        let size_of = |constant: &Expression| {
            constant.enclose(&[]).map_or(f64::INFINITY, |value| value.high.max(-value.low))
        };
        let most_raw = range.0.abs().max(range.1.abs()) as f64;
        if size_of(&raw_slope) * most_raw + size_of(&start) >= exp2(MOST_BITS as i32) {
            return Ok(None);
        }
        let known = |constant: &Expression| constant.ceiling(KNOWN_BITS).ok().map(|(raw, _)| raw);
        let (Some(known_slope), Some(known_start)) = (known(&raw_slope), known(&start)) else {
            return Ok(None);
        };
        let line = KnownLine { slope: known_slope, start: known_start };
        let whole_at = |raw: i128| {
            let value = scaled(&number(&raw.to_string()), -format.frac);
            let at = whole.substitute(&part, &value, &whole.span);
            at.evaluate_exactly(&[]).ok().map(|value| value.middle().round() as i128)
        };
        let Some(exact) = line.exact_line(range, &whole_at) else {
            let message = format!(
                "the integer part of this number needs a constant with more than {MOST_PLACES} fraction bits: the operand has {} bits, and \
                 a factor is no rational number",
                format.width()
            );
            let remedy = "give the operand fewer bits, or write the factor as a rational number, such as 355/113 for pi";
            return Err(PlanRefusal::new(message, remedy));
        };

        let integer = self.plan.scale("dividend_scaled", node, format.frac)?;
        let factor = self.plan.constant("reciprocal", exact.factor, exact.places as i32)?;
        let product = self.plan.multiply("quotient_product", integer, factor)?;
        let offset = self.plan.constant("quotient_offset", exact.offset, exact.places as i32)?;
        let sum = self.plan.add("quotient_sum", product, offset)?;
        let floor = self.plan.shorten("quotient_floor", sum, 0, Rounding::Truncate)?;
        let stated = Some(self.stated(whole, &self.uses, ValueAccuracy::Exact));
        let node =
            PlanNode { name: "whole_quotient".to_owned(), stated, ..self.plan.node(floor).clone() };
        Ok(Some(self.plan.push_copy(&node, Operation::Scale(floor))))
    }

    /// Returns the node of `part`, the remainder of `dividend` by a constant that is no rational number. The dividend must be a constant
    /// times an exact number plus a constant; for another dividend, returns `None`. Fails if a node has too many bits.
    pub(super) fn remainder_of_line(
        &mut self,
        dividend: &Expression,
        modulus: &Expression,
        part: &Expression,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let binary = |operator, a: &Expression, b: &Expression| {
            let kind = Kind::Binary(operator, Arc::new(a.clone()), Arc::new(b.clone()));
            Expression::new(kind, part.span.clone())
        };
        let quotient = binary(Operator::Div, dividend, modulus);
        let fraction = binary(Operator::Mod, &quotient, &number("1"));
        let whole = binary(Operator::Sub, &quotient, &fraction);
        let Some(turns) = self.whole_of_line(&quotient, &whole)? else { return Ok(None) };
        let values = self.range(part)?;
        let dividend = self.part(dividend)?;
        let modulus = self.part(modulus)?;
        let multiple = self.plan.multiply("multiple", turns, modulus)?;
        let rest = self.plan.subtract("rest", dividend, multiple)?;
        // The number of turns is exact, so that the exact rest is a remainder. The rounded rest may be a little beyond its limits.
        let own = self.plan.node(rest).clone();
        let frac = own.format.frac;
        let limited =
            PlanNode { limits: values, source: None, stated: None, deviation: 0.0, ..own };
        let limited = self.plan.push_copy(&limited, Operation::Scale(rest));
        let least = values.low.min(-exp2(-frac));
        let format = holding(Enclosure::between(least, values.high), frac);
        self.plan.narrow("remainder_within", limited, format, Rounding::Truncate).map(Some)
    }
}

/// Returns a formula times 2^`places`.
fn scaled(formula: &Expression, places: i32) -> Expression {
    let power =
        number(&if places < 0 { format!("1/{}", exp2(-places)) } else { exp2(places).to_string() });
    let kind = Kind::Binary(Operator::Mul, Arc::new(formula.clone()), Arc::new(power));
    Expression::new(kind, formula.span.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_multiple_within_limits() {
        for modulus in 1..40 {
            for factor in 0..modulus {
                for from in 0..modulus {
                    for to in from..modulus {
                        let within = |x: &i128| (from..=to).contains(&(factor * x % modulus));
                        let expected = (0..modulus).find(within);
                        assert_eq!(first_multiple(factor, modulus, (from, to)), expected);
                    }
                }
            }
        }
    }

    #[test]
    fn the_integer_parts_of_a_line_are_exact() {
        let cases =
            [("1 / pi", "0"), ("1 / (2 * pi)", "1/2"), ("-sqrt(2)", "pi"), ("ln(2) / 100", "-e")];
        for (slope, start) in cases {
            let known = |text: &str| number(text).ceiling(KNOWN_BITS).expect("a number").0;
            let line = KnownLine { slope: known(slope), start: known(start) };
            let formula = number(&format!("floor(x * ({slope}) + {start})"));
            let whole_at = |raw: i128| {
                let value = formula.evaluate_exactly(&[("x", RBig::from(raw))]);
                value.ok().map(|value| value.middle().round() as i128)
            };
            let range = (-3000, 5000);
            let found = line.exact_line(range, &whole_at).expect("constants");
            for raw in range.0..=range.1 {
                let whole = (raw * found.factor + found.offset) >> found.places;
                assert_eq!(Some(whole), whole_at(raw), "{slope}, {start}, {raw}");
            }
            // Twice as many bits of the operand need constants with about twice as many.
            let wide = line.exact_line((0, 1 << 24), &whole_at).expect("constants");
            assert!(wide.places > found.places, "{wide:?} {found:?}");
            assert_eq!(line.exact_line((0, 1 << 32), &whole_at), None);
        }
    }
}

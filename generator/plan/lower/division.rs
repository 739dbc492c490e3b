//! Rewrites integer parts and remainders so that they are exact. For example, floor(a) and a % 4 are bits of a value, and
//! floor(a / b) and a % b come from a quotient.
//!
//! A product with a reciprocal from a table gives an estimate of the quotient with an error below a quarter. The estimate minus a
//! quarter, rounded down, is the integer part or one less. The dividend minus this integer times the divisor is the remainder, or
//! the remainder plus one divisor; a comparison with the divisor decides which.

use std::mem;
use std::sync::Arc;

use glint_base::fixed::{Format, Rounding, exp2};
use glint_formula::{Comparison, Enclosure, Expression, Function, Kind, Operator, TextSpan};

use super::rational::{QuotientParts, quotient_of};
use super::shape::{has_no_function, number};
use super::{FixedGuard, KnownPart, Lowering};
use crate::node::{NodeId, Operation, PlanNode, ValueAccuracy};
use crate::refusal::PlanRefusal;
use crate::uses::reads_always;

/// The largest error of the estimate.
const LARGEST_ERROR: f64 = 0.25;

/// The number of bits of a digit, if a quotient is computed digit by digit.
const DIGIT_BITS: u32 = 16;

/// The widest quotient that a single estimate gives, in bits.
const MOST_QUOTIENT_BITS: u32 = 22;

/// The guard bits that the estimate has at least, and the most that are tried.
const GUARD_BITS: std::ops::RangeInclusive<i32> = 4..=8;

/// The remedy for an integer quotient of rounded numbers.
const EXACT_NUMBERS: &str =
    "divide operands, or sums, differences and products of operands, with constants such as 0.75";

/// Returns the comparison `part < 0`.
fn is_negative(part: &Expression) -> Comparison {
    let zero = Arc::new(number("0"));
    Comparison { left: zero, right: Arc::new(part.clone()), or_equal: false }
}

impl Lowering<'_> {
    /// Returns whether the dividend and the divisor of a quotient are sums, products and choices of operands, which can be exact.
    pub(super) fn is_exact_quotient(quotient: &QuotientParts) -> bool {
        [&quotient.dividend, &quotient.divisor].into_iter().all(has_no_function)
    }

    /// Returns the node of the remainder of a quotient p / q by the constant `modulus`, which is the remainder of p by q ·
    /// `modulus`, divided by q. `part` is the remainder as a formula. Fails if the plan cannot compute a part.
    pub(super) fn remainder_of_quotient(
        &mut self,
        quotient: &QuotientParts,
        modulus: &Expression,
        part: &Expression,
    ) -> Result<NodeId, PlanRefusal> {
        let binary = |operator, a: &Expression, b: &Expression| {
            let kind = Kind::Binary(operator, Arc::new(a.clone()), Arc::new(b.clone()));
            Expression::new(kind, part.span.clone())
        };
        let QuotientParts { dividend, divisor } = quotient;
        let modulus = match *modulus == number("1") {
            true => divisor.clone(),
            false => binary(Operator::Mul, modulus, divisor),
        };
        let remainder = binary(Operator::Mod, dividend, &modulus);
        match divisor.varies() {
            true => self.quotient(&remainder, divisor, part),
            false => self.part(&binary(Operator::Div, &remainder, divisor)),
        }
    }

    /// Returns the nodes of the greatest multiple of 2^`exponent` that is not above `a`, and of the remainder. Both are exact.
    /// For example, 5.75 with the exponent 1 gives 4 and 1.75. Fails if `a` is rounded, or if a part has too many bits, no finite
    /// values, or no rule.
    pub(super) fn division(
        &mut self,
        a: &Expression,
        exponent: i32,
    ) -> Result<[NodeId; 2], PlanRefusal> {
        let a = self.part(a)?;
        if !self.is_exact(a) {
            // A value just below an integer can be rounded to the integer, and the result would be wrong by a whole unit.
            return Err(PlanRefusal::new(
                "Glint computes an integer part or a remainder only of a value that is not rounded",
                "use sums, differences and products of operands inside it, with constants such as 0.75",
            ));
        }
        let scaled = self.plan.scale("scaled", a, -exponent)?;
        if self.plan.node(scaled).format.frac <= 0 {
            // Every value is a multiple of the divisor.
            return Ok([a, self.plan.constant("zero", 0, 0)?]);
        }
        let [whole, fraction] = self.plan.split("remainder", scaled)?;
        let whole = self.plan.scale("whole", whole, exponent)?;
        Ok([whole, self.plan.scale("remainder", fraction, exponent)?])
    }

    /// Returns an equivalent comparison without a quotient on one side, if the divisor is not 0 wherever the comparison matters.
    /// For example, `x / y > 2` becomes `x > 2 * y`. Products of operands are exact, so that the comparison is decided without
    /// rounding. Returns `None` if no side is a quotient with such a divisor.
    pub(super) fn without_quotients(&self, comparison: &Comparison) -> Option<Comparison> {
        let Comparison { left, right, or_equal } = comparison;
        let times = |part: &Arc<Expression>, divisor: &Expression| {
            if part.rational().is_some_and(|value| value.is_zero()) {
                return part.clone();
            }
            let kind = Kind::Binary(Operator::Mul, part.clone(), Arc::new(divisor.clone()));
            Arc::new(Expression::new(kind, part.span.clone()))
        };
        let or_equal = *or_equal;
        let quotient =
            |part: &Expression| quotient_of(part).and_then(|it| self.with_positive_divisor(it));
        if let Some(QuotientParts { dividend, divisor }) = quotient(left) {
            let right = times(right, &divisor);
            return Some(Comparison { left: Arc::new(dividend), right, or_equal });
        }
        let QuotientParts { dividend, divisor } = quotient(right)?;
        let left = times(left, &divisor);
        Some(Comparison { left, right: Arc::new(dividend), or_equal })
    }

    /// Returns an equal quotient with a divisor above 0. If the divisor may be below 0, its sign goes to the dividend: x / y is
    /// `if(y < 0, -x, x) / abs(y)`. Returns `None` if the divisor may be 0 where the quotient matters.
    pub(super) fn with_positive_divisor(&self, quotient: QuotientParts) -> Option<QuotientParts> {
        let QuotientParts { dividend, divisor } = quotient;
        if self.range_here(&divisor).is_ok_and(|values| values.low > 0.0) {
            return Some(QuotientParts { dividend, divisor });
        }
        let with_kind = |kind: Kind| Expression::new(kind, divisor.span.clone());
        let size = with_kind(Kind::Unary(Function::Abs, Arc::new(divisor.clone())));
        if !self.range_here(&size).is_ok_and(|values| values.low > 0.0) {
            return None;
        }
        let dividend = Arc::new(dividend);
        let negated = Arc::new(with_kind(Kind::Unary(Function::Negate, dividend.clone())));
        let signed = with_kind(Kind::If(is_negative(&divisor), negated, dividend));
        Some(QuotientParts { dividend: signed, divisor: size })
    }

    /// Returns the nodes of floor(a / b) and of the remainder a − b · floor(a / b), for a divisor that is not 0. Both are exact.
    /// `span` is the location of the formula. For example, 7 and 2 give 3 and 1, −7 and 2 give −4 and 1, and 7 and −2 give −4 and
    /// −1.
    ///
    /// # Errors
    /// Fails if a or b is rounded, if the divisor may be 0, or if a node has too many bits.
    pub(super) fn whole_quotient(
        &mut self,
        a: &Expression,
        b: &Expression,
        span: &TextSpan,
    ) -> Result<[NodeId; 2], PlanRefusal> {
        self.whole_quotient_within(a, b, span, None)
    }

    /// Returns the nodes of [`Self::whole_quotient`]. `values` has limits of the quotient, or is `None` if they follow from the
    /// formulas. Fails if a or b is rounded, if the divisor may be 0, or if a node has too many bits.
    fn whole_quotient_within(
        &mut self,
        a: &Expression,
        b: &Expression,
        span: &TextSpan,
        values: Option<Enclosure>,
    ) -> Result<[NodeId; 2], PlanRefusal> {
        let (dividend, divisor) = (self.part(a)?, self.part(b)?);
        if !self.is_exact(dividend) || !self.is_exact(divisor) {
            let message = "Glint computes an integer quotient or a remainder only of values that are not rounded";
            return Err(PlanRefusal::new(message, EXACT_NUMBERS));
        }
        let parts = QuotientParts { dividend: a.clone(), divisor: b.clone() };
        let Some(positive) = self.with_positive_divisor(parts) else {
            let message = "the divisor of this integer quotient or remainder may be 0";
            let remedy = format!("limit the divisor, for example where = \"{} != 0\"", b.python());
            return Err(PlanRefusal::new(message, remedy));
        };
        let binary = |operator, a: &Expression, b: &Expression| {
            let kind = Kind::Binary(operator, Arc::new(a.clone()), Arc::new(b.clone()));
            Expression::new(kind, span.clone())
        };
        let quotient = binary(Operator::Div, a, b);
        let remainder = binary(Operator::Mod, a, b);
        let whole =
            binary(Operator::Sub, &quotient, &binary(Operator::Mod, &quotient, &number("1")));
        let outer = self.uses.clone();
        self.add_readers_of(&[&whole, &remainder]);
        let values = match values {
            Some(values) => values,
            None => self.range(&quotient)?,
        };
        let bits =
            Format::holding(values.low.floor() as i128, values.high.ceil() as i128, 0).width();
        let multiplier = match b.varies() {
            true => None,
            false => self.exact_reciprocal(dividend, b),
        };
        let has_digits = bits > MOST_QUOTIENT_BITS || !b.varies();
        let nodes = match (multiplier, has_digits) {
            (Some(multiplier), _) => self.quotient_by_constant(dividend, divisor, &multiplier),
            (None, _) if positive.divisor != *b => self.quotient_of_positive(positive, b, span),
            (None, true) if values.low < 0.0 => self.quotient_of_size(a, b, span),
            (None, true) => self.quotient_by_digits(a, b, span),
            (None, false) => self.corrected_quotient(a, b, values),
        };
        let uses = mem::replace(&mut self.uses, outer);
        let nodes = nodes?;
        for (node, part) in nodes.into_iter().zip([whole, remainder]) {
            let stated = self.stated(&part, &uses, ValueAccuracy::Exact);
            self.plan.state_value(node, stated);
            let uses = uses.clone();
            self.known.push(KnownPart { part, node, uses, is_limited: false });
        }
        Ok(nodes)
    }

    /// Returns the nodes of the integer part and of the remainder of a quotient that [`Self::with_positive_divisor`] made from a
    /// quotient by `signed`. The remainder has the sign of `signed`. Fails if a node has too many bits.
    fn quotient_of_positive(
        &mut self,
        quotient: QuotientParts,
        signed: &Expression,
        span: &TextSpan,
    ) -> Result<[NodeId; 2], PlanRefusal> {
        let [whole, rest] = self.whole_quotient(&quotient.dividend, &quotient.divisor, span)?;
        let divisor = self.part(signed)?;
        let zero = self.plan.constant("zero", 0, 0)?;
        let is_negative = self.plan.less("divisor_is_negative", divisor, zero)?;
        let negated = self.plan.negate("rest_negated", rest)?;
        let rest = self.plan.choose("rest_of_divisor", is_negative, [rest, negated])?;
        // The results have stated values of their own.
        Ok([("whole_of_positive", whole), ("rest_with_sign", rest)]
            .map(|it| self.without_statement(it)))
    }

    /// Adds a copy of a node under a name of its own, and returns the copy, which states no value, so that it can state another
    /// one.
    fn without_statement(&mut self, (name, node): (&str, NodeId)) -> NodeId {
        let own = self.plan.node(node).clone();
        let copy = PlanNode { name: name.to_owned(), stated: None, deviation: 0.0, ..own };
        self.plan.push_copy(&copy, Operation::Scale(node))
    }

    /// Adds results as readers to the present uses, so that they share the nodes: results that read one of `parts` for all
    /// operands, under the condition of the present result. In a case of a choice, the uses stay.
    pub(super) fn add_readers_of(&mut self, parts: &[&Expression]) {
        if !self.uses.conditions.is_empty() {
            return;
        }
        let results = &self.statement.results;
        let Some(first) = self.uses.readers.iter().position(|reads| *reads) else { return };
        for (reads, result) in self.uses.readers.iter_mut().zip(results) {
            let reads_one = parts.iter().any(|part| reads_always(&result.formula, part));
            *reads |= reads_one && result.promise == results[first].promise;
        }
    }

    /// Returns the nodes of the integer part of the quotient a / b, and of its remainder, for a dividend that may be below 0. Let u be
    /// the last place of both. The dividend −a − u is not below 0, and floor(a / b) is −1 − floor((−a − u) / b). Fails if a node has
    /// too many bits.
    fn quotient_of_size(
        &mut self,
        a: &Expression,
        b: &Expression,
        span: &TextSpan,
    ) -> Result<[NodeId; 2], PlanRefusal> {
        let with_kind = |kind: Kind| Expression::new(kind, span.clone());
        let (dividend, divisor) = (self.part(a)?, self.part(b)?);
        let frac = self.plan.node(dividend).format.frac.max(self.plan.node(divisor).format.frac);
        let unit = Arc::new(number(&exp2(-frac).to_string()));
        let is_negative = is_negative(a);
        let a = Arc::new(a.clone());
        let negated = Arc::new(with_kind(Kind::Unary(Function::Negate, a.clone())));
        let flipped = Arc::new(with_kind(Kind::Binary(Operator::Sub, negated, unit.clone())));
        let size = with_kind(Kind::If(is_negative, flipped, a));
        let node = {
            let zero = self.plan.constant("zero", 0, 0)?;
            let is_negative = self.plan.less("dividend_is_negative", dividend, zero)?;
            let negated = self.plan.negate("dividend_negated", dividend)?;
            let unit = self.plan.constant("unit", 1, frac)?;
            let flipped = self.plan.subtract("dividend_flipped", negated, unit)?;
            self.plan.choose("dividend_size", is_negative, [dividend, flipped])?
        };
        let chosen = self.plan.node(node);
        let most = chosen.format.to_f64(chosen.range.1);
        let limits = Enclosure::between(0.0, most);
        let node = self.plan.limited("dividend_without_sign", node, limits)?;
        let uses = self.uses.clone();
        self.known.push(KnownPart { part: size.clone(), node, uses, is_limited: false });
        let [whole, rest] = self.whole_quotient(&size, b, span)?;

        let zero = self.plan.constant("zero", 0, 0)?;
        let is_negative = self.plan.less("dividend_is_negative", dividend, zero)?;
        let below = self.plan.constant("minus_one", -1, 0)?;
        let flipped = self.plan.subtract("whole_flipped", below, whole)?;
        let whole = self.plan.choose("whole_with_sign", is_negative, [whole, flipped])?;
        let unit = self.plan.constant("unit", 1, frac)?;
        let less = self.plan.subtract("divisor_less_unit", divisor, unit)?;
        let flipped = self.plan.subtract("rest_flipped", less, rest)?;
        let rest = self.plan.choose("rest_with_sign", is_negative, [rest, flipped])?;
        Ok([whole, rest])
    }

    /// Returns the nodes of the integer part of the quotient a / b, and of its remainder, for a quotient of many bits. The
    /// dividend is divided by 2^16 times the divisor, and the remainder of this by the divisor, as in a division by hand with
    /// digits of 16 bits. The products have fewer bits than with one estimate. Fails if a node has too many bits.
    fn quotient_by_digits(
        &mut self,
        a: &Expression,
        b: &Expression,
        span: &TextSpan,
    ) -> Result<[NodeId; 2], PlanRefusal> {
        let binary = |operator, a: &Expression, b: &Expression| {
            let kind = Kind::Binary(operator, Arc::new(a.clone()), Arc::new(b.clone()));
            Expression::new(kind, span.clone())
        };
        let digit = exp2(DIGIT_BITS as i32);
        let multiple = binary(Operator::Mul, b, &number(&digit.to_string()));
        let [upper_quotient, _] = self.whole_quotient(a, &multiple, span)?;
        let rest = binary(Operator::Mod, a, &multiple);
        // The remainder is less than the multiple, so that the second quotient is less than the factor.
        let values = Some(Enclosure::between(0.0, digit));
        let [lower_quotient, last] = self.whole_quotient_within(&rest, b, span, values)?;
        let upper_quotient =
            self.plan.scale("quotient_upper", upper_quotient, DIGIT_BITS as i32)?;
        let whole = self.plan.add("quotient_of_digits", upper_quotient, lower_quotient)?;
        // The results have stated values of their own.
        Ok([("whole_of_digits", whole), ("last_remainder", last)]
            .map(|it| self.without_statement(it)))
    }

    /// Returns the nodes of the integer part of the quotient a / b, and of its remainder, by an estimate and its correction.
    /// `values` has the limits of the quotient. Fails if a node has too many bits.
    fn corrected_quotient(
        &mut self,
        a: &Expression,
        b: &Expression,
        values: Enclosure,
    ) -> Result<[NodeId; 2], PlanRefusal> {
        let (dividend, divisor) = (self.part(a)?, self.part(b)?);
        let divisors = self.range_here(b)?;
        let estimate = self.estimated_quotient(a, b, values)?;

        let frac = self.plan.node(estimate).format.frac.max(2);
        let quarter = self.plan.constant("quarter", 1 << (frac - 2), frac)?;
        let below = self.plan.subtract("quotient_below", estimate, quarter)?;
        // The integer part, or one less.
        let (least, most) = (values.low.floor() as i128, values.high.floor() as i128);
        let format = Format::holding(least - 1, most, 0);
        let floor = self.plan.shorten("quotient_floor", below, 0, Rounding::Truncate)?;
        let first = self.plan.narrow("quotient_first", floor, format, Rounding::Truncate)?;
        let dividends = self.range_here(a)?;
        // If the divisor can be much larger than the dividend, a negative integer would give a rest of many bits.
        let is_clamped = least == 0 && dividends.high < divisors.high / 4.0;
        let first = match is_clamped {
            true => {
                let zero = self.plan.constant("zero", 0, 0)?;
                self.plan.maximum("quotient_not_negative", first, zero)?
            }
            false => first,
        };
        let next = {
            let one = self.plan.constant("one", 1, 0)?;
            self.plan.add("quotient_next", first, one)?
        };
        // The remainder, or the remainder plus the divisor.
        let product = self.plan.multiply("multiple", first, divisor)?;
        let most_rest = match is_clamped {
            true => 2.0 * divisors.high.min(dividends.high),
            false => 2.0 * divisors.high,
        };
        let rest = self.difference_within("rest", dividend, product, most_rest)?;
        // The divisor has no bits below its last one, so that the low bits of the rest do not matter for the comparison.
        let frac = self.plan.node(divisor).format.frac;
        let upper = self.plan.shorten("rest_upper", rest, frac, Rounding::Truncate)?;
        let is_less = self.plan.less("rest_is_less", upper, divisor)?;
        let difference = self.difference_within("rest_less_divisor", rest, divisor, most_rest)?;
        let chosen = self.plan.choose("quotient_chosen", is_less, [next, first])?;
        let wholes = Format::holding(least, most, 0);
        let whole = self.plan.narrow("whole_quotient", chosen, wholes, Rounding::Truncate)?;
        let left = self.plan.choose("remainder", is_less, [difference, rest])?;
        let frac = self.plan.node(left).format.frac;
        let largest = divisors.high.min(if is_clamped { dividends.high } else { f64::INFINITY });
        let remainders = Format::holding(0, (largest * exp2(frac)).ceil() as i128, frac);
        let left = self.plan.narrow("remainder_within", left, remainders, Rounding::Truncate)?;
        Ok([whole, left])
    }

    /// Returns the node of a − b, whose value is from 0 to `most` wherever it matters. Bits above `most` are dropped before the
    /// subtraction. Fails if a node has too many bits.
    fn difference_within(
        &mut self,
        name: &str,
        a: NodeId,
        b: NodeId,
        most: f64,
    ) -> Result<NodeId, PlanRefusal> {
        let most_raw = (most.ceil() as i128).max(1);
        let int = Format::holding(0, most_raw, 0).int;
        let mut lower = [a, b];
        for node in &mut lower {
            let own = self.plan.node(*node).format;
            if own.int > int {
                let format = Format::unsigned(int, own.frac);
                *node = self.plan.narrow(
                    &format!("{name}_input"),
                    *node,
                    format,
                    Rounding::Truncate,
                )?;
            }
        }
        let [a, b] = lower;
        let difference = self.plan.subtract(name, a, b)?;
        let format = Format::unsigned(int, self.plan.node(difference).format.frac);
        self.plan.narrow(&format!("{name}_within"), difference, format, Rounding::Truncate)
    }

    /// Returns the node of an estimate of the quotient a / b, which lies within `values`, with an error of at most a quarter.
    /// Fails if no number of guard bits shows this, or if a node has too many bits.
    fn estimated_quotient(
        &mut self,
        a: &Expression,
        b: &Expression,
        values: Enclosure,
    ) -> Result<NodeId, PlanRefusal> {
        let bits =
            Format::holding(values.low.floor() as i128, values.high.ceil() as i128, 0).width();
        for guard in GUARD_BITS {
            let fixed = FixedGuard { guard: guard - self.finest, value_bits: bits as i32 };
            let before = self.fixed_guard.replace(fixed);
            let estimate = self.quotient_within(a, b, values);
            self.fixed_guard = before;
            let estimate = estimate?;
            let unit = exp2(-self.plan.node(estimate).format.frac);
            // The claim that the corrected value is exact needs a bound for each result that reads it.
            let errors = self.errors_by_result(estimate);
            let mut readers = self.uses.readers.iter().zip(&errors).filter(|(reads, _)| **reads);
            if readers.all(|(_, units)| *units * unit <= LARGEST_ERROR) {
                return Ok(estimate);
            }
        }
        Err(PlanRefusal::new(
            "Glint finds no estimate of this quotient with an error below a quarter",
            "give the operands fewer bits",
        ))
    }
}

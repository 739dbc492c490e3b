//! Rewrites a quotient a / b as a product with a reciprocal from a table, so that no divider is needed.
//!
//! If the divisor has few bits, and its largest absolute value is less than four times its smallest, a table has the values of
//! 1/b. Any other divisor is normalised: b = m · 2^−k, and a / b = (a · 2^k) · (1/m) with a table of 1/m for 1/2 ≤ m < 1. A
//! divisor √s is computed together with its reciprocal: s = m · 2^−2k, and a / √s = (a · 2^k) · (1/√m) with a table of 1/√m for
//! 1/4 ≤ m < 1.
//!
//! Several dividends with the same divisor can share a reciprocal that needs few bits: a softmax of eight numbers shifts one
//! reciprocal in place of eight dividends.

use std::sync::Arc;

use glint_base::fixed::{Format, Rounding, exp2};
use glint_formula::{Enclosure, Expression, Function, Kind, Operator, RBig};

use super::root::{FEW_OCTAVES, Octave, holding};
use super::shape::number;
use super::{Lowering, MANY_OCTAVES, WIDEST_FACTOR, WIDEST_OPERAND};
use crate::facts::promises_less;
use crate::node::NodeId;
use crate::refusal::PlanRefusal;
use crate::statement::ExpressionStatement;

/// A factor that exceeds 1 by more than the roundings of a few operations in `f64`.
const ROUNDED_UP: f64 = 1.0 + 1e-12;

/// The widest reciprocal that is computed once for several dividends, in bits, with the guard bits that a product needs at least.
const WIDEST_RECIPROCAL: f64 = 20.0;

/// Returns the different quotients in the formulas of a statement.
fn quotients_of(statement: &ExpressionStatement) -> Vec<Expression> {
    let mut quotients: Vec<Expression> = Vec::new();
    for result in &statement.results {
        result.formula.walk(&mut |part| {
            if matches!(part.kind, Kind::Binary(Operator::Div, ..)) && !quotients.contains(part) {
                quotients.push(part.clone());
            }
        });
    }
    quotients
}

/// Returns a value for `PlanStyle::fewest_dividends`, below the usual 3, that is worth a try. The value is 1 if a divisor is a
/// root, a power or an exponential, whose reciprocal is as easy to compute, and 2 if two quotients have the same divisor. Returns
/// `None` without such quotients.
pub(crate) fn fewest_dividends(statement: &ExpressionStatement) -> Option<usize> {
    let mut divisors: Vec<(Expression, usize)> = Vec::new();
    for quotient in quotients_of(statement) {
        let Kind::Binary(_, dividend, divisor) = &quotient.kind else { continue };
        if !dividend.varies() || !divisor.varies() {
            continue;
        }
        match divisors.iter_mut().find(|(known, _)| *known == **divisor) {
            Some((_, count)) => *count += 1,
            None => divisors.push(((**divisor).clone(), 1)),
        }
    }
    let has_easy_reciprocal = |divisor: &Expression| {
        let is_function =
            matches!(divisor.kind, Kind::Unary(Function::Sqrt | Function::Exp | Function::Exp2, _));
        is_function || matches!(divisor.kind, Kind::Binary(Operator::Power, ..))
    };
    if divisors.iter().any(|(divisor, _)| has_easy_reciprocal(divisor)) {
        return Some(1);
    }
    divisors.iter().any(|(_, count)| *count == 2).then_some(2)
}

/// How a divisor follows from a word that is not negative.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum DivisorKind {
    /// The divisor is the word.
    Word,
    /// The divisor is the square root of the word.
    Root,
}

/// A divisor d with the nodes that divide by it.
#[derive(Clone, Copy)]
pub(super) struct Divisor {
    /// The normalised word.
    octave: Octave,
    /// 1/d is the table's value times 2 to the number of places of `octave`, divided by 2 to this power.
    exponent: i32,
    /// The node of the table's value.
    inverse: NodeId,
    /// An upper limit of the exact divisor divided by the rounded one: 1 if the divisor is not rounded, and `None` if no limit is
    /// known.
    excess: Option<f64>,
}

/// The dividend of a quotient.
pub(super) struct Dividend {
    pub(super) node: NodeId,
    /// The largest absolute value of the quotient.
    pub(super) largest_quotient: f64,
    pub(super) rounding: DividendRounding,
    /// How the quotient is limited; `None` without limits.
    pub(super) limits: Option<QuotientLimits>,
}

/// Limits of a quotient by a positive number. The hardware limits the dividend, so that its factor has fewer bits.
#[derive(Clone, Copy)]
pub(super) struct QuotientLimits {
    /// The largest value of the limited quotient; `None` if only 0 limits it. The smallest value is 0.
    most: Option<f64>,
}

/// A quotient between limits, as in `min(max(x / y, 0), 1)`.
struct LimitedQuotient<'e> {
    dividend: &'e Arc<Expression>,
    divisor: &'e Arc<Expression>,
    /// The quotient itself.
    quotient: &'e Arc<Expression>,
    /// The constant that limits the quotient above, if there is one. The quotient is never below 0.
    most: Option<&'e Arc<Expression>>,
}

impl<'e> LimitedQuotient<'e> {
    /// Returns the parts of the larger (or the smaller) of two numbers, if it is a quotient that is limited by 0, or by 0 and a constant
    /// above 0. Returns `None` for any other formula.
    fn of(operator: Operator, a: &'e Arc<Expression>, b: &'e Arc<Expression>) -> Option<Self> {
        let (limit, limited) = if a.varies() { (b, a) } else { (a, b) };
        let limit_value = limit.rational().filter(|_| !limit.varies())?;
        if let Kind::Binary(Operator::Div, dividend, divisor) = &limited.kind {
            let is_above_zero = operator == Operator::Max && limit_value.is_zero();
            let quotient = limited;
            return is_above_zero.then_some(Self { dividend, divisor, quotient, most: None });
        }
        let Kind::Binary(inner, first, second) = &limited.kind else { return None };
        match (operator, inner) {
            (Operator::Min, Operator::Max) if limit_value > RBig::ZERO => {
                let within = Self::of(*inner, first, second)?;
                within.most.is_none().then_some(Self { most: Some(limit), ..within })
            }
            (Operator::Max, Operator::Min) if limit_value.is_zero() => {
                let (most, quotient) =
                    if first.varies() { (second, first) } else { (first, second) };
                let is_positive = most.rational().is_some_and(|value| value > RBig::ZERO);
                let Kind::Binary(Operator::Div, dividend, divisor) = &quotient.kind else {
                    return None;
                };
                is_positive.then_some(Self { dividend, divisor, quotient, most: Some(most) })
            }
            _ => None,
        }
    }
}

/// Whether a dividend is rounded.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum DividendRounding {
    Exact,
    /// The hardware's dividend can be larger than the exact one.
    Rounded,
    /// The hardware's dividend may be rounded, but is never larger than the hardware's divisor.
    NeverLarger,
}

/// A dividend that was shifted by as many places as its divisor.
struct ShiftedDividend {
    node: NodeId,
    /// The limits of its value before a rounding.
    values: Enclosure,
    /// Whether the dividend can reach the power of two that is above the shifted divisor.
    can_be_equal: bool,
}

/// A divisor of several quotients. All of them read the same table.
pub(super) struct KnownDivisor {
    kind: DivisorKind,
    /// The node of the word, and the interval of its values where the quotients matter.
    word: (NodeId, Enclosure),
    divisor: Divisor,
}

/// Returns the operands of two roots whose product is the divisor: `sqrt(x) * sqrt(y)` and `sqrt(x * y)` give x and y. Returns `None` for any
/// other formula.
fn operands_of_roots(divisor: &Expression) -> Option<[&Arc<Expression>; 2]> {
    match &divisor.kind {
        Kind::Unary(Function::Sqrt, operand) => match &operand.kind {
            Kind::Binary(Operator::Mul, x, y) if x != y => Some([x, y]),
            _ => None,
        },
        Kind::Binary(Operator::Mul, first, second) => match (&first.kind, &second.kind) {
            (Kind::Unary(Function::Sqrt, x), Kind::Unary(Function::Sqrt, y)) if x != y => {
                Some([x, y])
            }
            _ => None,
        },
        _ => None,
    }
}

impl Lowering<'_> {
    /// Returns the node of the quotient a / b. `part` must be this quotient as a formula. Fails if the plan cannot compute a
    /// part. For example, a divisor that may be 0 gives no finite values.
    pub(super) fn quotient(
        &mut self,
        a: &Expression,
        b: &Expression,
        part: &Expression,
    ) -> Result<NodeId, PlanRefusal> {
        if let Some(quotients) = self.quotients_by(a, b)? {
            let one = Arc::new(number("1"));
            let kind = Kind::Binary(Operator::Div, one, Arc::new(b.clone()));
            let reciprocal = Expression::new(kind, part.span.clone());
            // All results with such a quotient share the reciprocal.
            let outer = self.uses.clone();
            self.add_readers_of(&quotients.iter().collect::<Vec<_>>());
            let reciprocal = self.part(&reciprocal);
            self.uses = outer;
            let dividend = self.factor(a)?;
            return self.plan.multiply("ratio", dividend, reciprocal?);
        }
        let values = self.range(part)?;
        if let Some(quotient) = self.quotient_by_root(a, b, values)? {
            return Ok(quotient);
        }
        self.quotient_within(a, b, values)
    }

    /// Returns the node of the quotient a / b, whose values lie within `values`, by a table of reciprocal roots. Returns `None`
    /// if b is no root of an exact number with several octaves, and no product of two such roots. Fails if the plan cannot
    /// compute a part.
    fn quotient_by_root(
        &mut self,
        a: &Expression,
        b: &Expression,
        values: Enclosure,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let dividend = self.part(a)?;
        let dividend = self.dividend(dividend, sizes_of(values).high);
        if let Some(operands) = operands_of_roots(b)
            && let Some(node) = self.quotient_by_roots(a, &dividend, operands)?
        {
            return Ok(Some(node));
        }
        let Kind::Unary(Function::Sqrt, operand) = &b.kind else { return Ok(None) };
        let Some(divisor) = self.root_divisor(operand)? else { return Ok(None) };
        self.ratio(&dividend, &divisor).map(Some)
    }

    /// Returns the node of a dividend, which is the node of `a`, divided by the roots of both operands. Returns `None` unless
    /// both are exact numbers with several octaves. Fails if the plan cannot compute a part.
    ///
    /// The product of both operands would need a normaliser and a multiplier for twice the bits.
    fn quotient_by_roots(
        &mut self,
        a: &Expression,
        dividend: &Dividend,
        operands: [&Arc<Expression>; 2],
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let Some(first) = self.root_divisor(operands[0])? else { return Ok(None) };
        let Some(second) = self.root_divisor(operands[1])? else { return Ok(None) };
        let root = Kind::Unary(Function::Sqrt, operands[0].clone());
        let root = Arc::new(Expression::new(root, a.span.clone()));
        let kind = Kind::Binary(Operator::Div, Arc::new(a.clone()), root);
        let by_first = self.range(&Expression::new(kind, a.span.clone()))?;
        let of_first = Dividend { largest_quotient: sizes_of(by_first).high, ..*dividend };
        let shifted = self.shifted(&of_first, &first)?;
        let excess = first.excess.unwrap_or(2.0) * exp2(first.exponent);
        let of_second = Dividend {
            node: shifted.node,
            largest_quotient: dividend.largest_quotient * excess,
            rounding: dividend.rounding,
            limits: None,
        };
        let ratio = self.ratio(&of_second, &second)?;
        let factor = self.rounding(self.finest - first.exponent, |own, frac| {
            own.plan.shorten("ratio_shortened", ratio, frac, Rounding::Nearest)
        })?;
        let product = self.plan.multiply("ratio", factor, first.inverse)?;
        self.scaled_ratio(product, dividend, &first).map(Some)
    }

    /// Returns the divisor √operand. Returns `None` if the operand is not exact, or does not have several octaves. Fails if the
    /// plan cannot compute a part.
    fn root_divisor(&mut self, operand: &Expression) -> Result<Option<Divisor>, PlanRefusal> {
        let operands = self.range(operand)?;
        if operands.low < 0.0 || operands.high < operands.low * MANY_OCTAVES {
            return Ok(None);
        }
        let node = self.part(operand)?;
        if !self.is_exact(node) {
            return Ok(None);
        }
        self.divisor((node, operands), DivisorKind::Root).map(Some)
    }

    /// Returns a node as the dividend of a quotient whose absolute value is at most `largest_quotient`.
    fn dividend(&self, node: NodeId, largest_quotient: f64) -> Dividend {
        let rounding = match self.is_exact(node) {
            true => DividendRounding::Exact,
            false => DividendRounding::Rounded,
        };
        Dividend { node, largest_quotient, rounding, limits: None }
    }

    /// Returns the divisor of a word, which is a node with the interval of its values. Quotients by the same divisor share its nodes.
    /// Fails if a node has too many bits, or if the reciprocal is not finite.
    fn divisor(
        &mut self,
        word: (NodeId, Enclosure),
        kind: DivisorKind,
    ) -> Result<Divisor, PlanRefusal> {
        // An estimate has roundings of its own.
        let is_shared = self.fixed_guard.is_none();
        let is_same = |known: &&KnownDivisor| known.kind == kind && known.word == word;
        if let Some(known) = self.divisors.iter().find(is_same).filter(|_| is_shared) {
            return Ok(known.divisor);
        }
        let octave = self.octave(word.0, word.1, kind == DivisorKind::Root)?;
        let divisor = self.divisor_in_octave(octave, kind)?;
        let excess = self.excess(word, octave.word);
        let divisor = Divisor { excess, ..divisor };
        if is_shared {
            self.divisors.push(KnownDivisor { kind, word, divisor });
        }
        Ok(divisor)
    }

    /// Returns an upper limit of the exact word divided by `rounded`, the word after a rounding to the nearest value. Returns
    /// `None` if the word is not exact, or if the rounded word can be 0.
    fn excess(&self, (exact, values): (NodeId, Enclosure), rounded: NodeId) -> Option<f64> {
        if self.is_exact(rounded) {
            return Some(1.0);
        }
        let half = exp2(-self.plan.node(rounded).format.frac) / 2.0;
        let is_known = self.is_exact(exact) && values.low > 2.0 * half;
        is_known.then(|| 1.0 + half / (values.low - half) * ROUNDED_UP)
    }

    /// Returns the divisor of a normalised word. The word of a root must be shifted by pairs of bits. Fails if a node has too many bits, or
    /// if the reciprocal is not finite.
    pub(super) fn divisor_in_octave(
        &mut self,
        octave: Octave,
        kind: DivisorKind,
    ) -> Result<Divisor, PlanRefusal> {
        let (reciprocal, exponent) = match kind {
            DivisorKind::Word => ("1 / x", octave.exponent),
            DivisorKind::Root => ("1 / sqrt(x)", octave.exponent / 2),
        };
        let reciprocal = number(reciprocal);
        let inverse = self.rounding(self.finest + 2, |own, frac| match octave.is_odd {
            Some(is_odd) => own.power_by_parity(&reciprocal, &octave, is_odd, frac),
            None => own.approximation("inverse", octave.mantissa, &reciprocal, octave.domain, frac),
        })?;
        self.give_source_to_tables(inverse);
        let excess = self.is_exact(octave.word).then_some(1.0);
        Ok(Divisor { octave, exponent, inverse, excess })
    }

    /// Returns all quotients with the divisor `b`, if the reciprocal of `b` is to be computed once: there are several, and the reciprocal
    /// needs few bits for the dividend `a`. Otherwise returns `None`. Fails if a or b has no finite values.
    fn quotients_by(
        &self,
        a: &Expression,
        b: &Expression,
    ) -> Result<Option<Vec<Expression>>, PlanRefusal> {
        if !a.varies() || self.fixed_guard.is_some() {
            return Ok(None);
        }
        let mut quotients = quotients_of(self.statement);
        quotients.retain(
            |quotient| matches!(&quotient.kind, Kind::Binary(_, _, divisor) if **divisor == *b),
        );
        if quotients.len() < self.guards.style.fewest_dividends {
            return Ok(None);
        }
        let largest_dividend = sizes_of(self.range(a)?).high;
        let smallest_divisor = sizes_of(self.range(b)?).low;
        let bits = f64::from(self.finest) + 2.0 + (largest_dividend / smallest_divisor).log2();
        Ok((bits <= WIDEST_RECIPROCAL).then_some(quotients))
    }

    /// Returns the node of the quotient a / b, whose values lie within `values`. Fails if the plan cannot compute a part.
    pub(super) fn quotient_within(
        &mut self,
        a: &Expression,
        b: &Expression,
        values: Enclosure,
    ) -> Result<NodeId, PlanRefusal> {
        let dividend = self.part(a)?;
        let divisor = self.part(b)?;
        let divisors = self.range(b)?;
        let largest = match self.is_proper(a, b) {
            true => 1.0,
            false => values.low.abs().max(values.high.abs()),
        };
        let size = self.plan.absolute("divisor_size", divisor)?;
        let sizes = sizes_of(divisors);
        let is_short = self.plan.node(size).format.width() <= WIDEST_OPERAND;
        let quotient = if is_short && sizes.high < sizes.low * FEW_OCTAVES {
            let inverse = self.function("inverse", size, &number("1 / x"), sizes)?;
            let dividend = self.factor(a)?;
            self.plan.multiply("ratio", dividend, inverse)?
        } else {
            let divisor = self.divisor((size, sizes), DivisorKind::Word)?;
            let dividend = self.dividend(dividend, largest);
            self.ratio(&dividend, &divisor)?
        };
        if divisors.low >= 0.0 {
            return Ok(quotient);
        }
        let frac = self.plan.node(divisor).format.frac;
        let zero = self.plan.constant("zero", 0, frac)?;
        let is_negative = self.plan.less("divisor_is_negative", divisor, zero)?;
        let negated = self.plan.negate("quotient_negated", quotient)?;
        self.plan.choose("quotient", is_negative, [quotient, negated])
    }

    /// Returns the node of a maximum or a minimum of `a` and `b` that limits a quotient by a root to values from 0 on, or from 0
    /// to a constant. The hardware limits the dividend. Returns `None` for any other numbers. Fails if the plan cannot compute a
    /// part.
    pub(super) fn limited_quotient(
        &mut self,
        operator: Operator,
        a: &Arc<Expression>,
        b: &Arc<Expression>,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let Some(limited) = LimitedQuotient::of(operator, a, b) else { return Ok(None) };
        let LimitedQuotient { dividend, divisor, quotient, most } = limited;
        let Kind::Unary(Function::Sqrt, operand) = &divisor.kind else { return Ok(None) };
        if self.quotients_by(dividend, divisor)?.is_some() {
            return Ok(None);
        }
        let values = self.range(quotient)?;
        let Some(divisor) = self.root_divisor(operand)? else { return Ok(None) };
        let node = self.part(dividend)?;
        let number = most.and_then(|most| most.enclose(&[]).ok());
        let limits = Some(QuotientLimits { most: number.map(|number| number.high) });
        let dividend = Dividend { limits, ..self.dividend(node, sizes_of(values).high) };
        let ratio = self.ratio(&dividend, &divisor)?;
        let Some(most) = most else { return Ok(Some(ratio)) };
        let (ratio, most) = (self.short_term(ratio)?, self.part(most)?);
        self.plan.minimum("smaller", ratio, most).map(Some)
    }

    /// Returns whether every result of the statement is promised only for a < b, and a is never below 0. The quotient a / b is
    /// then at most 1.
    fn is_proper(&self, a: &Expression, b: &Expression) -> bool {
        let is_not_negative = self.range(a).is_ok_and(|values| values.low >= 0.0);
        let mut results = self.statement.results.iter();
        is_not_negative && results.all(|result| promises_less(self.statement, result, a, b))
    }

    /// Returns the node of a dividend divided by a divisor. Fails if a node has too many bits.
    pub(super) fn ratio(
        &mut self,
        dividend: &Dividend,
        divisor: &Divisor,
    ) -> Result<NodeId, PlanRefusal> {
        let ShiftedDividend { node, values, can_be_equal } = self.shifted(dividend, divisor)?;
        // The dividend is as large as the quotient, up to the weight of the divisor's octave.
        let value_bits = self.fixed_guard.map_or(0, |fixed| fixed.value_bits);
        let first_frac = self.finest - divisor.exponent - value_bits;
        let shortened = self.rounding(first_frac, |own, frac| {
            let format = own.plan.node(node).format;
            let name = "dividend_shortened";
            match format.width() <= WIDEST_FACTOR {
                true => Ok(node),
                false if can_be_equal && frac < format.frac => {
                    own.plan.narrow(name, node, holding(values, frac), Rounding::Nearest)
                }
                false => own.plan.shorten(name, node, frac, Rounding::Nearest),
            }
        })?;
        let factor = match dividend.limits {
            Some(limits) => self.limited_dividend(shortened, limits, divisor)?,
            None => shortened,
        };
        let product = self.plan.multiply("ratio", factor, divisor.inverse)?;
        self.scaled_ratio(product, dividend, divisor)
    }

    /// Returns the node of a shifted dividend, limited so that the quotient keeps its limits. A negative dividend becomes 0. Let
    /// d be the power of two that is just above every shifted divisor, times the excess of the divisor. A dividend above d times
    /// the largest quotient becomes nearly this product, so that its quotient stays above the limit or close to it. Without a
    /// known excess, there is no upper limit. Fails if a node has too many bits.
    fn limited_dividend(
        &mut self,
        shifted: NodeId,
        QuotientLimits { most }: QuotientLimits,
        divisor: &Divisor,
    ) -> Result<NodeId, PlanRefusal> {
        let frac = self.plan.node(shifted).format.frac;
        let zero = self.plan.constant("zero", 0, frac)?;
        let positive = self.plan.maximum("dividend_positive", shifted, zero)?;
        let (Some(most), Some(excess)) = (most, divisor.excess) else { return Ok(positive) };
        let most = most * exp2(divisor.exponent) * excess;
        let raw = (most * exp2(frac)).ceil() as i128 - 1;
        if self.plan.node(positive).range.1 <= raw {
            return Ok(positive);
        }
        let value = Enclosure::exactly(most);
        let largest = self.plan.rounded_constant("largest_dividend", raw, frac, value)?;
        self.plan.minimum("dividend_limited", positive, largest)
    }

    /// Returns the node of a quotient, from the product of its shifted dividend and the table's value for its divisor. Fails if a node has
    /// too many bits.
    fn scaled_ratio(
        &mut self,
        product: NodeId,
        dividend: &Dividend,
        divisor: &Divisor,
    ) -> Result<NodeId, PlanRefusal> {
        let ratio = self.plan.scale("ratio_scaled", product, -divisor.exponent)?;
        let is_signed = self.plan.node(dividend.node).range.0 < 0 && dividend.limits.is_none();
        let least = if is_signed { -dividend.largest_quotient } else { 0.0 };
        self.plan.state_limits(ratio, Enclosure::between(least, dividend.largest_quotient));
        Ok(ratio)
    }

    /// Returns a dividend, shifted by as many places as the divisor's word. Fails if a node has too many bits.
    fn shifted(
        &mut self,
        &Dividend { node: dividend, largest_quotient, rounding, .. }: &Dividend,
        &Divisor { octave, exponent, excess, .. }: &Divisor,
    ) -> Result<ShiftedDividend, PlanRefusal> {
        let frac = self.plan.node(dividend).format.frac;
        let is_signed = self.plan.node(dividend).range.0 < 0;
        let excess = excess.filter(|_| rounding == DividendRounding::Exact);
        let is_never_larger = rounding == DividendRounding::NeverLarger;
        let fits_below = is_never_larger || excess == Some(1.0) && largest_quotient <= 1.0;
        // The dividend is at most the largest quotient times the divisor. If the limit is not known because a value was rounded, the proof
        // shows that one more bit is enough.
        let most = largest_quotient * exp2(exponent) * excess.unwrap_or(2.0);
        let values = Enclosure::between(if is_signed { -most } else { 0.0 }, most);
        let format = if fits_below {
            // The shifted divisor is below 2^exponent, and the shifted dividend is not larger than it.
            let above = exp2(exponent + frac) as i128;
            Format::holding(if is_signed { 1 - above } else { 0 }, above - 1, frac)
        } else {
            holding(values, frac)
        };
        let limits = Enclosure::between(
            format.to_f64(if is_signed { format.min_raw() } else { 0 }),
            format.to_f64(format.max_raw()),
        );
        // The limits of a format of many bits are rounded up to numbers that need one bit more.
        let is_rounded = format.width() > f64::MANTISSA_DIGITS;
        let format = Format { int: format.int + i32::from(is_rounded), ..format };
        let node = self.plan.shift_left("dividend_shifted", dividend, octave.places, format)?;
        if excess.is_some() {
            self.plan.state_limits(
                node,
                Enclosure::between(limits.low.max(values.low), limits.high.min(values.high)),
            );
        }
        if is_never_larger {
            self.plan.state_actual_limits(node, limits);
        }
        Ok(ShiftedDividend { node, values, can_be_equal: !fits_below })
    }
}

/// Returns limits of the absolute values of values within limits. For example, values from −3 to −1 have absolute values from 1
/// to 3.
fn sizes_of(values: Enclosure) -> Enclosure {
    let (low, high) = (values.low.abs(), values.high.abs());
    let has_both_signs = values.low < 0.0 && values.high > 0.0;
    let least = if has_both_signs { 0.0 } else { low.min(high) };
    Enclosure::between(least, low.max(high))
}

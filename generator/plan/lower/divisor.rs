//! Divides exact numbers by a constant, so that the integer part and the remainder are exact.
//!
//! The dividend times a rounded reciprocal, rounded down, is the integer part if the reciprocal has enough bits (T. Granlund and P. L.
//! Montgomery, "Division by Invariant Integers using Multiplication", PLDI 1994). No correction is needed.

use glint_base::fixed::{Format, Rounding};
use glint_formula::{Expression, RBig};

use super::Lowering;
use crate::node::NodeId;
use crate::refusal::PlanRefusal;

/// The most bits of the product with a reciprocal, without its sign.
const MOST_BITS: u32 = 63;

/// A reciprocal of a constant, with which floor(A / d) is the integer part of (A · `factor` + `offset`) / 2^`places` for each raw
/// dividend A in a range.
#[derive(Debug, PartialEq)]
pub(super) struct ExactReciprocal {
    /// The low bits of the dividend that do not matter, because the divisor is a multiple of 2^`dropped`. They are dropped first.
    dropped: i32,
    factor: i128,
    offset: i128,
    places: i32,
}

impl ExactReciprocal {
    /// Finds the reciprocal with the fewest bits for the quotient A · `above` / `below` with A from `low` to `high`. `above` and
    /// `below` must be above 0. Returns `None` if the product has more than 63 bits.
    ///
    /// The reciprocal is above the exact one by less than 2^−`places`. The product then exceeds the quotient, and must exceed it by less
    /// than 1 / `below`, which is the smallest distance from a quotient up to the next integer.
    fn find((low, high): (i128, i128), above: i128, below: i128) -> Option<Self> {
        let dropped = if above == 1 { below.trailing_zeros() as i32 } else { 0 };
        let (low, high, below) = (low >> dropped, high >> dropped, below >> dropped);
        for places in 0..MOST_BITS {
            let one = 1_i128 << places;
            let exact = above.checked_mul(one)?;
            let factor = exact / below + i128::from(exact % below != 0);
            // The excess of the reciprocal, in units of 2^−places / below.
            let excess = factor * below - exact;
            let least = low.checked_mul(excess)?;
            let offset = if least < 0 { (-least + below - 1) / below } else { 0 };
            let largest = high.checked_mul(excess)?.checked_add(offset.checked_mul(below)?)?;
            if largest >= one {
                continue;
            }
            // The multiplier gives both factors a sign.
            let width =
                Format::holding(low, high, 0).width() + Format::holding(0, factor, 0).width();
            let is_short = width + 2 <= MOST_BITS + 1;
            let places = places as i32;
            return is_short.then_some(Self { dropped, factor, offset, places });
        }
        None
    }
}

impl Lowering<'_> {
    /// Returns the reciprocal of the constant `divisor` for all values of a node. Returns `None` if the constant is not a rational number
    /// above 0, or if the product has too many bits.
    pub(super) fn exact_reciprocal(
        &self,
        dividend: NodeId,
        divisor: &Expression,
    ) -> Option<ExactReciprocal> {
        let node = self.plan.node(dividend);
        let places = u32::try_from(node.format.frac).ok()?;
        let value = divisor.rational().filter(|value| *value > RBig::ZERO)?;
        // A raw dividend A has the value A / 2^places.
        let ratio = RBig::ONE / (value * RBig::from(1_u128.checked_shl(places)?));
        let above = i128::try_from(ratio.numerator().clone()).ok()?;
        let below = i128::try_from(ratio.denominator().clone()).ok()?;
        ExactReciprocal::find(node.range, above, below)
    }

    /// Returns the nodes of floor(a / b) and of the remainder a − b · floor(a / b), for a constant b with the node `divisor` and its
    /// reciprocal. Fails if a node has too many bits.
    pub(super) fn quotient_by_constant(
        &mut self,
        dividend: NodeId,
        divisor: NodeId,
        reciprocal: &ExactReciprocal,
    ) -> Result<[NodeId; 2], PlanRefusal> {
        let ExactReciprocal { dropped, factor, offset, places } = *reciprocal;
        let frac = self.plan.node(dividend).format.frac;
        let integer = self.plan.scale("dividend_scaled", dividend, frac - dropped)?;
        let integer = self.plan.shorten("dividend_upper", integer, 0, Rounding::Truncate)?;
        let factor = self.plan.constant("reciprocal", factor, places)?;
        let product = self.plan.multiply("quotient_product", integer, factor)?;
        let offset = self.plan.constant("quotient_offset", offset, places)?;
        let sum = self.plan.add("quotient_sum", product, offset)?;
        let whole = self.plan.shorten("whole_quotient", sum, 0, Rounding::Truncate)?;
        let multiple = self.plan.multiply("multiple", whole, divisor)?;
        let rest = self.plan.subtract("rest", dividend, multiple)?;
        let Format { frac, .. } = self.plan.node(rest).format;
        let divisor = self.plan.node(divisor);
        // The constant has one raw value.
        let (_, raw) = divisor.range;
        let largest = (raw << (frac - divisor.format.frac).max(0)) - 1;
        let remainders = Format::holding(0, largest.max(0), frac);
        let rest = self.plan.narrow("remainder_within", rest, remainders, Rounding::Truncate)?;
        Ok([whole, rest])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the number of dividends for which a reciprocal gives another integer part than the division of integers.
    fn faults(low: i128, high: i128, above: i128, below: i128) -> usize {
        let found = ExactReciprocal::find((low, high), above, below).expect("a reciprocal");
        let ExactReciprocal { dropped, factor, offset, places } = found;
        let whole = |raw: i128| ((raw >> dropped) * factor + offset) >> places;
        (low..=high).filter(|raw| whole(*raw) != (raw * above).div_euclid(below)).count()
    }

    #[test]
    fn a_product_with_a_reciprocal_has_the_integer_part_of_every_quotient() {
        for below in 1..60 {
            for above in 1..8 {
                assert_eq!(faults(-700, 900, above, below), 0, "{above} / {below}");
                assert_eq!(faults(0, 255, above, below), 0, "{above} / {below}");
                assert_eq!(faults(-256, -1, above, below), 0, "{above} / {below}");
            }
        }
    }

    #[test]
    fn a_reciprocal_has_no_more_bits_than_it_needs() {
        let found = ExactReciprocal::find((0, 255), 1, 10).expect("a reciprocal");
        assert_eq!(found, ExactReciprocal { dropped: 1, factor: 103, offset: 0, places: 9 });
        assert_eq!(ExactReciprocal::find((0, i128::from(u64::MAX)), 1, 7), None);
    }
}

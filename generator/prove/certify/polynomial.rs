//! Computes the range of polynomials of degree at most 2 in one operand, which interval arithmetic overestimates.
//!
//! For example, x² − 16·x for x from 0 to 16 lies between −64 and 0; interval arithmetic gives −256 to 256. Coefficients and
//! operands are raw integers. A result is `None` if the polynomial would have two operands or a higher degree, or if numbers are
//! too large.

use glint_base::interval::Interval;
use glint_rtl::pipeline::NodeId;

/// The polynomial `factors[0] + factors[1]·x + factors[2]·x²` in the raw value x of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawPolynomial {
    /// The node whose raw value is x; `None` for a constant polynomial.
    pub of: Option<NodeId>,
    pub factors: [i128; 3],
}

/// The largest absolute value of a coefficient.
const MOST: i128 = 1 << 80;

impl RawPolynomial {
    pub fn constant(value: i128) -> Self {
        Self { of: None, factors: [value, 0, 0] }
    }

    pub fn operand(id: NodeId) -> Self {
        Self { of: Some(id), factors: [0, 1, 0] }
    }

    /// Returns the polynomial `factors` in the operand of `self` and `other`. Returns `None` if they have different operands, or
    /// if a coefficient is too large.
    fn with(self, other: Self, factors: [i128; 3]) -> Option<Self> {
        let of = match (self.of, other.of) {
            (Some(a), Some(b)) if a != b => return None,
            (a, b) => a.or(b),
        };
        let small = factors.iter().all(|factor| (-MOST..=MOST).contains(factor));
        small.then_some(Self { of, factors })
    }

    /// Returns `self` plus `times` times `other`. Returns `None` for different operands or too large a coefficient.
    pub fn plus(self, other: Self, times: i128) -> Option<Self> {
        let sum = |at: usize| self.factors[at] + times * other.factors[at];
        self.with(other, [sum(0), sum(1), sum(2)])
    }

    /// Returns the product of two polynomials in the same operand. Returns `None` if its degree may be above two, for different
    /// operands, or for too large a coefficient.
    pub fn times(self, other: Self) -> Option<Self> {
        let ([a, b, c], [d, e, f]) = (self.factors, other.factors);
        let small = |factors: [i128; 3]| factors.iter().all(|factor| factor.abs() <= 1 << 60);
        if !small(self.factors) || !small(other.factors) || b * f + c * e != 0 || c * f != 0 {
            return None;
        }
        self.with(other, [a * d, a * e + b * d, a * f + b * e + c * d])
    }

    /// Returns the smallest and the largest value for integers x in an interval. Returns `None` if numbers are too large.
    pub fn range(self, (low, high): Interval) -> Option<Interval> {
        let [a, b, c] = self.factors;
        if low.abs().max(high.abs()) > 1 << 32 || [a, b, c].iter().any(|it| it.abs() > 1 << 62) {
            return None;
        }
        let at = |x: i128| a + b * x + c * x * x;
        let mut places = vec![low, high];
        if c != 0 {
            let vertex = (-b).div_euclid(2 * c);
            places.extend([vertex, vertex + 1].map(|x| x.clamp(low, high)));
        }
        let values = places.into_iter().map(at);
        Some((values.clone().min()?, values.max()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_has_its_vertex() {
        let x = RawPolynomial::operand(NodeId(0));
        let square = x.times(x).unwrap();
        // x² − 16·x has its smallest value, −64, at 8.
        let parabola = square.plus(x, -16).unwrap();
        assert_eq!(parabola.range((0, 16)), Some((-64, 0)));
        assert_eq!(parabola.range((9, 20)), Some((-63, 80)));
        // 7 − x² is largest at 0, and x² − 3·x is smallest at 1 and 2.
        let open = RawPolynomial::constant(7).plus(square, -1).unwrap();
        assert_eq!(open.range((-2, 3)), Some((-2, 7)));
        assert_eq!(square.plus(x, -3).unwrap().range((0, 3)), Some((-2, 0)));
    }

    #[test]
    fn only_one_operand_and_two_degrees_are_followed() {
        let (x, y) = (RawPolynomial::operand(NodeId(0)), RawPolynomial::operand(NodeId(1)));
        assert_eq!(x.plus(y, 1), None);
        assert_eq!(x.times(x).unwrap().times(x), None);
        let line = x.times(RawPolynomial::constant(3)).unwrap();
        assert_eq!(line.factors, [0, 3, 0]);
    }
}

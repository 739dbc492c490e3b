//! Rewrites choices, such as `if(a < b, x, y)`, and finds maxima and minima among them.

use std::sync::Arc;

use glint_base::fixed::exp2;
use glint_formula::{Comparison, Enclosure, Expression, Function, Kind, Operator, RBig};

use super::Lowering;
use super::rational::without_fractions;
use super::shape::number;
use crate::constant::dyadic;
use crate::node::NodeId;
use crate::refusal::PlanRefusal;

/// The largest raw value that takes the place of a compared constant.
const LARGEST_LIMIT: f64 = (1u64 << 50) as f64;

/// The name of an operand that takes the place of the compared part. A user's operand has no blank in its name.
const BEYOND: &str = "the compared part";

/// The nodes of both sides of a comparison.
pub(super) struct ComparedNodes {
    /// The comparison holds where the first number is larger than the second.
    nodes: [NodeId; 2],
    /// Whether the comparison also holds where both numbers are equal.
    or_equal: bool,
    /// Whether no number is rounded, so that the hardware decides like the formula.
    pub(super) is_exact: bool,
}

/// Returns the largest raw value with `frac` fraction bits that is below a constant. Returns `None` if the constant may be such a value
/// itself, or if the raw value has many bits.
fn raw_below(constant: &Expression, frac: i32) -> Option<i128> {
    let value = constant.enclose(&[]).ok()?;
    let [low, high] = [value.low, value.high].map(|end| end * exp2(frac));
    let below = low.floor();
    let is_between = below < low && high < below + 1.0;
    (is_between && below.abs() < LARGEST_LIMIT).then_some(below as i128)
}

/// Returns the comparison of the squares of both sides, if one side is a root and the other one a root or a rational constant that is not
/// negative. Returns `None` for any other comparison.
fn without_roots(comparison: &Comparison) -> Option<Comparison> {
    let Comparison { left, right, or_equal } = comparison;
    let operand_of_root = |part: &Expression| match &part.kind {
        Kind::Unary(Function::Sqrt, operand) if part.varies() => Some(operand.clone()),
        _ => None,
    };
    let squared = |part: &Expression| {
        let constant = part.rational().filter(|value| !part.varies() && *value >= RBig::ZERO)?;
        Some(Arc::new(number(&(&constant * &constant).to_string())))
    };
    let (left, right) = match (operand_of_root(left), operand_of_root(right)) {
        (Some(left), Some(right)) => (left, right),
        (Some(left), None) => (left, squared(right)?),
        (None, Some(right)) => (squared(left)?, right),
        (None, None) => return None,
    };
    Some(Comparison { left, right, or_equal: *or_equal })
}

impl Lowering<'_> {
    /// Returns whether a comparison holds for all operands for which the present part matters, or for none of them. Returns `None` if
    /// the domains of the operands, and limits of the difference of both sides, do not decide it.
    pub(super) fn decided(&self, comparison: &Comparison) -> Option<bool> {
        let operands = self.statement.enclosed_operands(&self.statement.domain());
        if let Ok(Some(holds)) = comparison.holds(&operands) {
            return Some(holds);
        }
        let Comparison { left, right, or_equal } = comparison;
        let kind = Kind::Binary(Operator::Sub, left.clone(), right.clone());
        let difference = self.range_here(&Expression::new(kind, left.span.clone())).ok()?;
        let holds = difference.low > 0.0 || *or_equal && difference.low == 0.0;
        let fails = difference.high < 0.0 || !or_equal && difference.high == 0.0;
        if holds || fails { Some(holds) } else { None }
    }

    /// Returns a case of a choice that has the right value for all operands, so that no choice is needed. For example,
    /// `if(u > 0, u / (1 + u), 0)` is `u / (1 + u)` if u is never below 0. Returns `None` without such a case.
    fn case_with_all_values<'e>(
        &self,
        comparison: &Comparison,
        yes: &'e Expression,
        no: &'e Expression,
    ) -> Option<&'e Expression> {
        let Comparison { left, right, .. } = comparison;
        let (compared, limit) = if left.varies() { (left, right) } else { (right, left) };
        let limit = limit.enclose(&[]).ok().filter(|_| !limit.varies())?;
        let values = self.range_here(compared).ok()?;
        let is_above = std::ptr::eq(compared, left);
        for (case, other, is_case_above) in [(yes, no, is_above), (no, yes, !is_above)] {
            if other.varies() || case.count(&|part| part == &**compared) == 0 {
                continue;
            }
            let beyond = match is_case_above {
                true => Enclosure::between(values.low, values.high.min(limit.high)),
                false => Enclosure::between(values.low.max(limit.low), values.high),
            };
            let operand = Expression::operand(BEYOND);
            let beyond_case = case.substitute(compared, &operand, &case.span);
            let mut operands = self.statement.enclosed_operands(&self.statement.domain());
            operands.push((BEYOND, beyond));
            let is_same = beyond.low <= beyond.high
                && beyond_case
                    .enclose(&operands)
                    .ok()
                    .zip(other.enclose(&[]).ok())
                    .is_some_and(|(case, other)| case == other && case.low == case.high);
            if is_same && self.range_here(case).is_ok() {
                return Some(case);
            }
        }
        None
    }

    /// Returns the node of a choice: `yes` if the comparison holds, and `no` otherwise. Fails if a part has too many bits, or no finite
    /// values under its condition.
    pub(super) fn choice(
        &mut self,
        comparison: &Comparison,
        yes: &Expression,
        no: &Expression,
    ) -> Result<NodeId, PlanRefusal> {
        if let Some(outcome) = self.decided(comparison) {
            return self.part(if outcome { yes } else { no });
        }
        if let Some(case) = self.case_with_all_values(comparison, yes, no) {
            return self.part(case);
        }
        if let Some(comparison) = self.without_quotients(comparison) {
            return self.choice(&comparison, yes, no);
        }
        let compared = self.compared(comparison)?;
        if !compared.is_exact {
            let (first, second) = (&*comparison.left, &*comparison.right);
            let [left, right] = compared.nodes;
            if (yes, no) == (second, first) {
                // If two numbers are nearly equal, rounding can make the other one larger, but the error stays small.
                return self.plan.minimum("smaller", left, right);
            }
            if (yes, no) == (first, second) {
                return self.plan.maximum("larger", left, right);
            }
            // Rounding can make the hardware take the other case, so that the value of each case matters for all operands.
            let [yes, no] = [(yes, true), (no, false)]
                .map(|(case, outcome)| self.case_for_all(case, comparison, outcome));
            let cases = [self.part(&yes)?, self.part(&no)?];
            return self.chosen(&compared, cases);
        }
        let yes = self.under(comparison, true, |own| own.part(yes))?;
        let no = self.under(comparison, false, |own| own.part(no))?;
        self.chosen(&compared, [yes, no])
    }

    /// Returns the nodes of both sides of a comparison. Where possible, the comparison is rewritten so that its sides are exact:
    /// - `x > 0.1` with 4 fraction bits of x becomes `x > 1/16`, and `0.1 > x` becomes `1/16 >= x`: an exact node is compared
    ///   with a multiple of its last place, the nearest one below the constant;
    /// - `x / 3 > y` becomes `x > 3 * y`, and `sqrt(x) > 0.5` becomes `x > 0.25`.
    ///
    /// Fails if a part has too many bits.
    pub(super) fn compared(
        &mut self,
        comparison: &Comparison,
    ) -> Result<ComparedNodes, PlanRefusal> {
        if let Some(squares) = without_roots(comparison)
            && let Ok(exact) = self.compared(&squares)
            && exact.is_exact
        {
            return Ok(exact);
        }
        let Comparison { left, right, .. } = comparison;
        let (limit, other) = if left.varies() { (right, left) } else { (left, right) };
        if !limit.varies() && dyadic(limit).is_none() {
            let node = self.part(other)?;
            let frac = self.plan.node(node).format.frac;
            if self.is_exact(node)
                && let Some(raw) = raw_below(limit, frac)
            {
                let limit = self.plan.constant("limit", raw, frac)?;
                return Ok(match left.varies() {
                    true => ComparedNodes { nodes: [node, limit], or_equal: false, is_exact: true },
                    false => ComparedNodes { nodes: [limit, node], or_equal: true, is_exact: true },
                });
            }
        }
        let compared = self.compared_as_written(comparison)?;
        if !compared.is_exact
            && let Some(multiple) = without_fractions(comparison)
            && let Ok(exact) = self.compared_as_written(&multiple)
            && exact.is_exact
        {
            return Ok(exact);
        }
        Ok(compared)
    }

    fn compared_as_written(
        &mut self,
        comparison: &Comparison,
    ) -> Result<ComparedNodes, PlanRefusal> {
        let nodes = [self.part(&comparison.left)?, self.part(&comparison.right)?];
        let is_exact = nodes.iter().all(|node| self.is_exact(*node));
        Ok(ComparedNodes { nodes, or_equal: comparison.or_equal, is_exact })
    }

    /// Returns a formula that equals `case` wherever the comparison has the outcome `outcome`, and that has a value where
    /// rounding makes the hardware take this case for another outcome. For example, `if(x < 0, 0, sqrt(x))` has the case
    /// `sqrt(max(x, 0))`. Returns `case` itself if it has values for all operands, or if no side of the comparison limits it.
    fn case_for_all(
        &self,
        case: &Expression,
        comparison: &Comparison,
        outcome: bool,
    ) -> Expression {
        if self.range(case).is_ok() {
            return case.clone();
        }
        let Comparison { left, right, .. } = comparison;
        let (larger, smaller) = if outcome { (left, right) } else { (right, left) };
        for (side, operator, limit) in
            [(larger, Operator::Max, smaller), (smaller, Operator::Min, larger)]
        {
            if side.varies() && case.count(&|part| part == &**side) > 0 {
                let kind = Kind::Binary(operator, side.clone(), limit.clone());
                let limited = Expression::new(kind, side.span.clone());
                return case.substitute(side, &limited, &case.span);
            }
        }
        case.clone()
    }

    /// Returns the node of the value of `yes` where the comparison holds, and of `no` elsewhere. Fails if a node has too many bits.
    pub(super) fn chosen(
        &mut self,
        compared: &ComparedNodes,
        [yes, no]: [NodeId; 2],
    ) -> Result<NodeId, PlanRefusal> {
        let [left, right] = compared.nodes;
        if compared.or_equal {
            // Equivalent to `left >= right`, because the cases are swapped.
            let is_less = self.plan.less("is_less", left, right)?;
            self.plan.choose("chosen", is_less, [yes, no])
        } else {
            let is_larger = self.plan.less("is_larger", right, left)?;
            self.plan.choose("chosen", is_larger, [no, yes])
        }
    }
}

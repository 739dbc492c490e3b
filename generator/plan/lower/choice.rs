//! Rewrites choices, such as `if(a < b, x, y)`, and finds maxima and minima among them.

use glint_formula::{Comparison, Expression};

use super::Lowering;
use crate::node::NodeId;
use crate::refusal::PlanRefusal;

impl Lowering<'_> {
    /// Returns the node of a choice: `yes` if the comparison holds, and `no` otherwise. Fails if a part has too many bits, or no finite
    /// values under its condition.
    pub(super) fn choice(
        &mut self,
        comparison: &Comparison,
        yes: &Expression,
        no: &Expression,
    ) -> Result<NodeId, PlanRefusal> {
        let operands = self.statement.enclosed_operands(&self.statement.domain());
        if let Ok(Some(outcome)) = comparison.holds(&operands) {
            // No operand takes the other case.
            return self.part(if outcome { yes } else { no });
        }
        if let Some(comparison) = self.without_quotients(comparison) {
            return self.choice(&comparison, yes, no);
        }
        let (first, second) = (&*comparison.left, &*comparison.right);
        let (left, right) = (self.part(first)?, self.part(second)?);
        if (yes, no) == (second, first) {
            // If two numbers are nearly equal, rounding can make the other one larger, but the error stays small.
            return self.plan.minimum("smaller", left, right);
        }
        if (yes, no) == (first, second) {
            return self.plan.maximum("larger", left, right);
        }
        let [yes, no] = if self.is_exact(left) && self.is_exact(right) {
            let yes = self.under(comparison, true, |own| own.part(yes))?;
            let no = self.under(comparison, false, |own| own.part(no))?;
            [yes, no]
        } else {
            // Rounding can make the hardware take the other case, so that the value of each case matters for all operands.
            [self.part(yes)?, self.part(no)?]
        };
        self.chosen(comparison.or_equal, [left, right], [yes, no])
    }

    /// Returns the node of the value of `yes` where the first number is larger than the second, or equal if `or_equal`, and of `no`
    /// elsewhere. Fails if a node has too many bits.
    pub(super) fn chosen(
        &mut self,
        or_equal: bool,
        [left, right]: [NodeId; 2],
        [yes, no]: [NodeId; 2],
    ) -> Result<NodeId, PlanRefusal> {
        if or_equal {
            // Equivalent to `left >= right`, because the cases are swapped.
            let is_less = self.plan.less("is_less", left, right)?;
            self.plan.choose("chosen", is_less, [yes, no])
        } else {
            let is_larger = self.plan.less("is_larger", right, left)?;
            self.plan.choose("chosen", is_larger, [no, yes])
        }
    }
}

//! Rounds the constants of a quotient by the length of a vector before the quotient becomes nodes.
//!
//! In `(0.6 * x + 0.8 * y) / sqrt(x^2 + y^2)`, the constants 0.6 and 0.8 are rounded. As errors of the dividend, these roundings
//! would count without limit, because a short vector is shifted far. As errors of the quotient, they are limited by the
//! inequality of Cauchy and Schwarz: the quotient changes by at most the length of the vector of the roundings.

use glint_formula::Expression;

use super::Lowering;
use crate::node::{NodeId, Operation, PlanNode};
use crate::projection;
use crate::refusal::PlanRefusal;

impl Lowering<'_> {
    /// Returns the node of a weighted sum divided by the length of its vector, or of a minimum or a maximum of such a quotient
    /// and a constant. Returns `None` for any other part, and if all constants are exact in binary. Fails if the plan cannot
    /// compute a part.
    pub(super) fn projection_with_rounded_constants(
        &mut self,
        part: &Expression,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        if self.fixed_guard.is_some() || projection::rounded(part, 0).is_none() {
            return Ok(None);
        }
        let limits = self.range(part)?;
        let node = self.rounding(self.finest + 2, |own, frac| {
            let Some(rounded) = projection::rounded(part, frac) else {
                unreachable!("a projection with other constants is one with any number of bits")
            };
            let near = own.part(&rounded.formula)?;
            let copy = PlanNode {
                name: "projection".to_owned(),
                limits,
                stated: None,
                deviation: rounded.deviation,
                agreement: None,
                source: None,
                ..own.plan.node(near).clone()
            };
            Ok(own.plan.push_copy(&copy, Operation::Scale(near)))
        })?;
        Ok(Some(node))
    }
}

//! Bounds the errors of nodes while formulas are rewritten. A table must cover all values that its operand can have, and an
//! estimate must be near enough for its correction.

use std::cell::RefCell;
use std::collections::HashMap;

use glint_base::fixed::exp2;

use super::Lowering;
use crate::boxes::{FEW_OPERANDS, ResultProof};
use crate::frontier::PlanOfParts;
use crate::node::{NodeId, StatedValue, ValueAccuracy};
use crate::statement::StatedResult;

/// The number of divisions of the domain in a proof of the error of a single node.
const DIVISIONS_FOR_AN_ERROR: usize = 64;

/// The errors of nodes that were bounded for a statement. Most plans of a search differ in few nodes, so that most nodes have the same
/// error in all of them.
#[derive(Default)]
pub(super) struct ErrorMemo(RefCell<HashMap<u64, f64>>);

impl ErrorMemo {
    /// Returns an upper bound of the error of a result as a whole number of `unit` units, and infinity if none was found.
    fn units_of(&self, proof: &ResultProof<'_>, unit: f64) -> f64 {
        let digest = proof.digest(DIVISIONS_FOR_AN_ERROR);
        if let Some(known) = self.0.borrow().get(&digest) {
            return *known;
        }
        let units = proof.whole_units(unit, DIVISIONS_FOR_AN_ERROR).unwrap_or(0.0);
        self.0.borrow_mut().insert(digest, units);
        units
    }
}

impl Lowering<'_> {
    /// Returns an upper bound of the error of a node in units of its last bit, rounded up. The bound holds for all operands for
    /// which a result is promised under the conditions of the present uses. If no bound is found, the error counts as 1.
    pub(super) fn largest_error(&self, node: NodeId) -> f64 {
        let unit = exp2(-self.plan.node(node).format.frac);
        let errors = self.errors_by_result(node);
        // The promise of a result that does not depend on the node can allow operands for which the node has no value.
        let finite = errors.into_iter().filter(|units| units.is_finite());
        finite.reduce(f64::max).unwrap_or_else(|| (1.0 / unit).ceil())
    }

    /// Returns for each result an upper bound of the error of a node in units of its last bit, rounded up. The bound holds for
    /// all operands for which the result is promised under the conditions of the present uses. It is infinite if none is found,
    /// or if the result does not read the part that is being rewritten.
    pub(super) fn errors_by_result(&self, node: NodeId) -> Vec<f64> {
        let unit = exp2(-self.plan.node(node).format.frac);
        let mut ending = self.plan.clone();
        ending.end_at(node);
        let plan = ending.so_far();
        let mut errors = Vec::new();
        for (result, reads) in self.statement.results.iter().zip(&self.uses.readers) {
            if !reads {
                errors.push(f64::INFINITY);
                continue;
            }
            let mut statement = self.statement.clone();
            let mut alone = StatedResult { fraction: 0, ..result.clone() };
            for (comparison, outcome) in &self.uses.conditions {
                let condition = match outcome {
                    true => comparison.clone(),
                    false => comparison.negated(),
                };
                alone.promise = Some(match alone.promise {
                    None => condition,
                    Some(promise) => promise.and(condition),
                });
            }
            let count = alone.formula.operands().len();
            if count > FEW_OPERANDS
                && let Some(parts) = PlanOfParts::of(plan, node, &alone, count)
            {
                let proof = ResultProof::new(&parts.statement, &parts.plan, 0);
                let units = self.memo.errors.units_of(&proof, unit);
                if units.is_finite() {
                    errors.push(units);
                    continue;
                }
            }
            statement.results = vec![alone];
            let proof = ResultProof::new(&statement, plan, 0);
            errors.push(self.memo.errors.units_of(&proof, unit));
        }
        errors
    }

    /// Returns whether the value of a node has no rounding error.
    pub(super) fn is_exact(&self, node: NodeId) -> bool {
        let plan = self.plan.so_far();
        let mut nodes = plan.nodes().iter().zip(plan.needed_by(node));
        nodes.all(|(node, is_needed)| {
            let is_nearest = |stated: &StatedValue| stated.accuracy == ValueAccuracy::Nearest;
            let is_rounded = node.source.is_some()
                || node.deviation > 0.0
                || node.stated.as_ref().is_some_and(is_nearest);
            !is_needed || !is_rounded
        })
    }
}

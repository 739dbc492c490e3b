//! Proves a bound of the error of a result over all of its operands, box by box.
//!
//! The box with the largest error is divided first. A box in which nothing can be said, because a part may leave its format
//! or a function may have no value there, counts as the largest.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glint_base::fixed::exp2;

use super::analyse::{ErrorAnalysis, NodeError, Undecided};
use super::plan::ExpressionPlan;
use super::statement::ExpressionStatement;

/// Raw limits of each operand, both included.
pub(super) type OperandBox = Vec<(i64, i64)>;

/// The error of a result within a box, in units of its last place.
#[derive(Clone, Debug)]
pub(super) struct BoxError {
    pub(super) limits: OperandBox,
    pub(super) units: f64,
    /// Why there is no error, if `units` is infinite.
    pub(super) undecided: Option<Undecided>,
}

impl PartialEq for BoxError {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for BoxError {}

impl PartialOrd for BoxError {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for BoxError {
    fn cmp(&self, other: &Self) -> Ordering {
        // Among boxes without a limit of the error, the largest is divided first.
        let size = |it: &Self| size_of(&it.limits);
        self.units.total_cmp(&other.units).then_with(|| size(self).cmp(&size(other)))
    }
}

impl BoxError {
    /// Returns the error in words, with the part of the plan that has no limit. For example, `cannot be proved below 1.250
    /// units`.
    pub(super) fn words(&self, plan: &ExpressionPlan) -> String {
        match &self.undecided {
            None => format!("cannot be proved below {:.3} units", self.units),
            Some(Undecided { node, what }) => {
                format!("has no limit, because of the part `{}`: {what},", plan.node(*node).name)
            }
        }
    }
}

/// Returns the number of combinations of operands in a box, or the largest number there is.
fn size_of(limits: &OperandBox) -> u128 {
    let mut size: u128 = 1;
    for (low, high) in limits {
        size = size.saturating_mul(u128::from(high.abs_diff(*low)) + 1);
    }
    size
}

/// The proof of one result of a plan.
pub(super) struct ResultProof<'p> {
    pub(super) statement: &'p ExpressionStatement,
    pub(super) plan: &'p ExpressionPlan,
    pub(super) result: usize,
    /// For each node, whether the result reads it.
    pub(super) needed: Vec<bool>,
}

impl<'p> ResultProof<'p> {
    pub(super) fn new(
        statement: &'p ExpressionStatement,
        plan: &'p ExpressionPlan,
        result: usize,
    ) -> Self {
        Self { statement, plan, result, needed: plan.needed_for(result) }
    }

    /// Returns the box with the largest error, after as many divisions as bring the error below `enough` units, at most
    /// `divisions`.
    ///
    /// No error of any operand is larger than the error of the box.
    pub(super) fn worst(&self, enough: f64, divisions: usize) -> Option<BoxError> {
        let mut open = BinaryHeap::new();
        open.extend(self.error_in(self.statement.domain()));
        for _ in 0..divisions {
            let worst = open.peek()?;
            if worst.units <= enough {
                break;
            }
            let Some(halves) = best_halves(&worst.limits, &|limits| self.error_in(limits.clone()))
            else {
                break;
            };
            open.pop();
            open.extend(halves);
        }
        open.pop()
    }

    /// Returns the error within a box; `None` if nothing is promised there.
    fn error_in(&self, limits: OperandBox) -> Option<BoxError> {
        let operands = self.statement.enclosed_operands(&limits);
        if self.statement.results[self.result].is_promised(&operands) == Some(false) {
            return None;
        }
        let mut units: f64 = 0.0;
        let mut first_undecided = None;
        self.run(&limits, None, &mut |value, undecided| {
            units = units.max(self.units(value));
            if !value.is_limited() && first_undecided.is_none() {
                first_undecided = undecided.cloned();
            }
        });
        Some(BoxError { limits, units, undecided: first_undecided })
    }

    /// Calls `visit` with each value that the result can have within a box.
    fn run(
        &self,
        limits: &OperandBox,
        only: Option<usize>,
        visit: &mut dyn FnMut(&NodeError, Option<&Undecided>),
    ) {
        let analysis = ErrorAnalysis { plan: self.plan, needed: &self.needed, only };
        let node = self.plan.proved[self.result];
        let operands = self.statement.enclosed_operands(limits);
        analysis.run(&operands, &mut |values, undecided| visit(&values[node.0], undecided));
    }

    /// Returns the largest error of a value, in units of the last place of the result.
    fn units(&self, value: &NodeError) -> f64 {
        if !value.is_limited() {
            return f64::INFINITY;
        }
        let fraction = self.statement.results[self.result].fraction as i32;
        value.error.low.abs().max(value.error.high.abs()) * exp2(fraction)
    }

    /// Returns how many units of the error within a box come from one source alone.
    pub(super) fn share(&self, limits: &OperandBox, source: usize) -> f64 {
        let mut units: f64 = 0.0;
        self.run(limits, Some(source), &mut |value, _| units = units.max(self.units(value)));
        units
    }
}

/// Something that is known of a box, for the choice of the operand along which a box is divided.
pub(super) trait BoxScore {
    /// Returns a number that is smaller the more is known; infinite if nothing is.
    fn score(&self) -> f64;
}

impl BoxScore for BoxError {
    fn score(&self) -> f64 {
        self.units
    }
}

/// Returns a number with its leading digits alone: two numbers that differ by less than a per cent are mostly the same.
fn coarse(value: f64) -> f64 {
    const DROPPED_BITS: u32 = 46;
    f64::from_bits(value.to_bits() >> DROPPED_BITS << DROPPED_BITS)
}

/// Returns the two halves of a box, divided along the operand on which its score depends most; `None` for a single
/// combination. A half for which `known` gives nothing is left out.
///
/// The score depends most on an operand if it is smallest where the operand has its middle value alone.
pub(super) fn best_halves<K: BoxScore>(
    limits: &OperandBox,
    known: &dyn Fn(&OperandBox) -> Option<K>,
) -> Option<Vec<K>> {
    let mut best: Option<(f64, u64, usize)> = None;
    for operand in 0..limits.len() {
        let (low, high) = limits[operand];
        if low == high {
            continue;
        }
        let middle = low + (high - low) / 2;
        let mut slice = limits.clone();
        slice[operand] = (middle, middle);
        let score = known(&slice).map_or(f64::NEG_INFINITY, |slice| coarse(slice.score()));
        // Of operands that are equally good, the one with the most values.
        let rank = (score, u64::MAX - high.abs_diff(low), operand);
        if best.is_none_or(|other| rank < other) {
            best = Some(rank);
        }
    }
    let (_, _, operand) = best?;
    let halves = halves_along(limits, operand)?;
    Some(halves.iter().filter_map(known).collect())
}

/// Returns the two halves of a box along one operand; `None` if it has a single value of this operand.
fn halves_along(limits: &OperandBox, operand: usize) -> Option<[OperandBox; 2]> {
    let (low, high) = limits[operand];
    if low == high {
        return None;
    }
    let middle = low + (high - low) / 2;
    let mut first = limits.clone();
    first[operand] = (low, middle);
    let mut second = limits.clone();
    second[operand] = (middle + 1, high);
    Some([first, second])
}

//! Proves a bound of the error of a result, over all operands for which the result is promised.
//!
//! Interval arithmetic bounds the error in a box: a range of raw values for each operand, such as x from 0 to 255 and y from 16
//! to 31. The search begins with the box of the whole domain, and always divides the box with the largest error in two. The
//! search ends when this error is small enough for the caller, when this box is a single combination, or after a given number of
//! divisions. If a part may exceed its format in a box, or a function may have no value there, the error has no limit and counts
//! as the largest.

use std::cmp::Ordering;
use std::collections::{BTreeSet, BinaryHeap};
use std::fmt::{self, Write};
use std::hash::{DefaultHasher, Hash, Hasher};

use glint_base::fixed::exp2;

use super::analyse::{ErrorAnalysis, NodeError, Undecided, joins};
use super::node::{NodeId, Operation, PlanNode};
use super::plan::ExpressionPlan;
use super::statement::{ExpressionStatement, StatedResult};

/// The smallest and the largest raw value of each operand, both included.
pub(super) type OperandBox = Vec<(i64, i64)>;

/// The largest error of a result in a box of operands, in units of the result's last bit.
#[derive(Clone, Debug)]
pub(super) struct BoxError {
    pub(super) limits: OperandBox,
    pub(super) units: f64,
    /// The reason why the error has no limit, if `units` is infinite.
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
        // Among boxes whose error has no limit, the box with the most combinations is divided first.
        let size = |it: &Self| size_of(&it.limits);
        self.units.total_cmp(&other.units).then_with(|| size(self).cmp(&size(other)))
    }
}

impl BoxError {
    /// Returns the error as a phrase, with the part of the plan that has no limit, if there is one. For example, `cannot be
    /// proved below 1.250 units`.
    pub(super) fn words(&self, plan: &ExpressionPlan) -> String {
        match &self.undecided {
            None => format!("cannot be proved below {:.3} units", self.units),
            Some(Undecided { node, what }) => {
                format!("has no limit (the part `{}`: {what})", plan.node(*node).name)
            }
        }
    }
}

/// Returns the number of combinations of operands in a box, at most the largest `u128`.
fn size_of(limits: &OperandBox) -> u128 {
    let mut size: u128 = 1;
    for (low, high) in limits {
        size = size.saturating_mul(u128::from(high.abs_diff(*low)) + 1);
    }
    size
}

/// Boxes with which a search begins count as divisions. The search still makes at least the allowed divisions divided by this
/// number.
const LEAST_SHARE_OF_DIVISIONS: usize = 4;

/// The most operands of an expression for which the number of divisions is not reduced.
pub(super) const FEW_OPERANDS: usize = 3;

/// The least number of divisions of a domain with many operands.
const LEAST_DIVISIONS: usize = 8;

/// The memory of a search for an excessive error of a result, which makes the search for a similar plan faster.
#[derive(Clone)]
pub(super) struct ErrorSearch {
    /// Boxes that together contain all operands for which the result is promised.
    boxes: Vec<OperandBox>,
    /// Single combinations with large errors, if the expression has many operands. They are tried first.
    examples: Vec<OperandBox>,
    /// The last outcome, with the digest of the nodes for which it holds.
    last: Option<(u64, Option<BoxError>)>,
}

/// A digest of the text that is written to it.
struct TextDigest(DefaultHasher);

impl Write for TextDigest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.hash(&mut self.0);
        Ok(())
    }
}

pub(super) type ErrorSearches = Vec<ErrorSearch>;

/// Returns the searches with which the planner begins: for each result, the domain of the operands on which it depends, as one
/// box.
pub(super) fn undivided(statement: &ExpressionStatement) -> ErrorSearches {
    let mut searches = Vec::new();
    for result in 0..statement.results.len() {
        let named = statement.operands_of(result);
        let domain = statement.domain_of(&named);
        let examples = if named.len() <= FEW_OPERANDS { Vec::new() } else { corners(&domain) };
        searches.push(ErrorSearch { boxes: vec![domain], examples, last: None });
    }
    searches
}

/// Returns whether a statement has so few operands that the number of divisions is not reduced.
pub(super) fn has_few_operands(statement: &ExpressionStatement) -> bool {
    statement.operands.len() <= FEW_OPERANDS
}

/// Returns an affordable number of divisions for a domain of `operands` operands, at least 8: `wished` with up to 3 operands, a
/// 16th of it with 4, and half as many with each further operand.
pub(super) fn affordable(operands: usize, wished: usize) -> usize {
    affordable_with(operands.saturating_sub(FEW_OPERANDS), wished)
}

/// Returns the number of divisions, from the number `wished`, for an expression with `more` operands beyond [`FEW_OPERANDS`].
fn affordable_with(more: usize, wished: usize) -> usize {
    match more {
        0 => wished,
        more => (wished >> (3 + more).min(16)).max(LEAST_DIVISIONS),
    }
}

/// Returns combinations of operands with which large errors are tried first: all operands at the same end of the domain, or all
/// but one.
fn corners(domain: &OperandBox) -> Vec<OperandBox> {
    let end = |(low, high): (i64, i64), is_high: bool| {
        let value = if is_high { high } else { low };
        (value, value)
    };
    let mut corners = Vec::new();
    for is_high in [false, true] {
        let all: OperandBox = domain.iter().map(|limits| end(*limits, is_high)).collect();
        for (operand, limits) in domain.iter().enumerate() {
            let mut corner = all.clone();
            corner[operand] = end(*limits, !is_high);
            corners.push(corner);
        }
        corners.push(all);
    }
    corners
}

/// The proof of an error bound for one result of a plan.
pub(super) struct ResultProof<'p> {
    pub(super) statement: &'p ExpressionStatement,
    pub(super) plan: &'p ExpressionPlan,
    pub(super) result: usize,
    /// For each node, whether the result depends on it.
    pub(super) needed: Vec<bool>,
    /// For each node, the node at which the branches of its values end ([`joins`]).
    joins: Vec<Option<NodeId>>,
    /// The names of the operands on which the result or its promise depends.
    named: BTreeSet<&'p str>,
}

impl<'p> ResultProof<'p> {
    pub(super) fn new(
        statement: &'p ExpressionStatement,
        plan: &'p ExpressionPlan,
        result: usize,
    ) -> Self {
        let needed = plan.needed_for(result);
        let joins = joins(plan, &needed, plan.proved()[result]);
        Self { statement, plan, result, needed, joins, named: statement.operands_of(result) }
    }

    /// Returns whether an error is computed fast: with few operands, and without several integer parts.
    fn is_fast(&self) -> bool {
        self.named.len() <= FEW_OPERANDS && !self.joins_integers()
    }

    /// Returns whether the branches of several integer parts end where they meet.
    fn joins_integers(&self) -> bool {
        let is_integer =
            |at: usize| matches!(self.plan.nodes()[at].operation, Operation::IntegerPart(_));
        self.joins.iter().enumerate().any(|(at, join)| join.is_some() && is_integer(at))
    }

    /// Returns an affordable number of divisions, from the number `wished`. Several integer parts count as a fourth operand.
    fn affordable(&self, wished: usize) -> usize {
        let more = self.named.len().saturating_sub(FEW_OPERANDS);
        affordable_with(if self.is_fast() { 0 } else { more.max(1) }, wished)
    }

    /// Returns the box with the largest error. Boxes are divided until this error is at most `enough` units, or `divisions`
    /// times, or until this box is a single combination. No operands have a larger error than this box states. Returns `None`
    /// if the result is promised for no operands.
    pub(super) fn worst(&self, enough: f64, divisions: usize) -> Option<BoxError> {
        let mut open = self.errors_in(&[self.statement.domain_of(&self.named)]);
        let divisions = self.affordable(divisions);
        self.divide(&mut open, divisions, &mut |worst| worst.units <= enough);
        open.pop()
    }

    /// Returns an upper limit of the error as a multiple of `unit` units of the result's last bit: with `unit` = 0.25, the limit
    /// 3 means 0.75 units. Boxes are divided up to `divisions` times, but not if a single combination of operands already reaches
    /// the limit. Returns `None` if the result is promised for no operands, and infinity if no limit was found.
    pub(super) fn whole_units(&self, unit: f64, divisions: usize) -> Option<f64> {
        let whole = |error: &BoxError| (error.units / unit).ceil();
        let mut open = self.errors_in(&[self.statement.domain_of(&self.named)]);
        let divisions = self.affordable(divisions);
        self.divide(&mut open, divisions, &mut |worst| {
            let single = self.error_in(middle_of(&worst.limits));
            single.is_some_and(|single| whole(&single) == whole(worst))
        });
        open.peek().map(whole)
    }

    /// Returns a box whose error exceeds the allowed error, or `None` if the error is allowed for all operands for which the
    /// result is promised. The box is a single combination, in the middle of a box that was tried, if such a combination exceeds
    /// the error. Otherwise it is the box with the largest error after `divisions` divisions.
    ///
    /// A single combination ends the search early, because no division shows a smaller error for it. The search begins with the
    /// examples and the boxes in `search`. If the error is allowed, the boxes that show this replace the earlier ones, because
    /// they mostly show it for similar plans. Otherwise, a single combination becomes an example if the expression has many
    /// operands.
    ///
    /// If the result depends on the same nodes as in the last search, the function returns the last outcome.
    pub(super) fn excess(&self, divisions: usize, search: &mut ErrorSearch) -> Option<BoxError> {
        let digest = self.digest(divisions);
        if let Some((last, outcome)) = &search.last
            && *last == digest
        {
            return outcome.clone();
        }
        let outcome = self.new_excess(divisions, search);
        search.last = Some((digest, outcome.clone()));
        outcome
    }

    /// Returns a digest of all that decides the outcome of [`Self::excess`]: the nodes on which the result depends, its promise
    /// and allowed error, and `divisions`.
    pub(super) fn digest(&self, divisions: usize) -> u64 {
        let mut digest = TextDigest(DefaultHasher::new());
        divisions.hash(&mut digest.0);
        let StatedResult { promise, error, fraction, .. } = &self.statement.results[self.result];
        // Writing to a digest does not fail.
        let _ = write!(digest, "{promise:?}{error:?}{fraction}");
        for (at, node) in self.plan.nodes().iter().enumerate() {
            if self.needed[at] {
                let PlanNode { operation, format, range, limits, actual_limits, deviation, .. } =
                    node;
                let _ = write!(
                    digest,
                    "{at}{operation:?}{format:?}{range:?}{limits:?}{actual_limits:?}{deviation}"
                );
            }
        }
        digest.0.finish()
    }

    fn new_excess(&self, divisions: usize, search: &mut ErrorSearch) -> Option<BoxError> {
        let stated = &self.statement.results[self.result];
        let exceeds = |error: &BoxError| !stated.allows(error.units);
        if let Some(example) = self.errors_in(&search.examples).pop().filter(exceeds) {
            return Some(example);
        }
        let mut open = self.errors_in(&search.boxes);
        let divisions = self.affordable(divisions);
        let least = divisions / LEAST_SHARE_OF_DIVISIONS;
        let divisions = divisions.saturating_sub(open.len()).max(least);
        let mut single = None;
        let has_few_operands = self.is_fast();
        self.divide(&mut open, divisions, &mut |worst| {
            // With many operands, few divisions lower an error that has a limit.
            if !has_few_operands && worst.units.is_finite() {
                return true;
            }
            if exceeds(worst) {
                single = self.error_in(middle_of(&worst.limits)).filter(exceeds);
            }
            !exceeds(worst) || single.is_some()
        });
        if let Some(single) = single {
            if !has_few_operands {
                search.examples.push(single.limits.clone());
            }
            return Some(single);
        }
        if open.peek().is_some_and(exceeds) {
            return open.pop();
        }
        search.boxes = open.into_iter().map(|error| error.limits).collect();
        None
    }

    /// Returns the errors in boxes, except for boxes in which nothing is promised.
    fn errors_in(&self, boxes: &[OperandBox]) -> BinaryHeap<BoxError> {
        boxes.iter().filter_map(|limits| self.error_in(limits.clone())).collect()
    }

    /// Divides the box with the largest error in two, until `is_done` returns true for this box, or `divisions` times, or until this
    /// box is a single combination.
    fn divide(
        &self,
        open: &mut BinaryHeap<BoxError>,
        divisions: usize,
        is_done: &mut dyn FnMut(&BoxError) -> bool,
    ) {
        for _ in 0..divisions {
            let Some(worst) = open.peek().filter(|worst| !is_done(worst)) else { return };
            let Some(halves) = best_halves(&worst.limits, &|limits| self.error_in(limits.clone()))
            else {
                return;
            };
            open.pop();
            open.extend(halves);
        }
    }

    /// Returns the largest error in a box; `None` if nothing is promised in the box.
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

    /// Analyses the result in a box, and calls `visit` with the values of each branch of the analysis. If `only` is the number of
    /// a rounding operation, no other operation has rounding errors.
    fn run(
        &self,
        limits: &OperandBox,
        only: Option<usize>,
        visit: &mut dyn FnMut(&NodeError, Option<&Undecided>),
    ) {
        let (plan, needed, joins) = (self.plan, &self.needed, &self.joins);
        let analysis = ErrorAnalysis { plan, needed, joins, only };
        let node = self.plan.proved()[self.result];
        let operands = self.statement.enclosed_operands(limits);
        analysis.run(&operands, &mut |values, undecided| visit(&values[node.0], undecided));
    }

    /// Returns the largest error of a value, in units of the last bit of the result. The error is infinite if the value has no
    /// limits.
    fn units(&self, value: &NodeError) -> f64 {
        if !value.is_limited() {
            return f64::INFINITY;
        }
        let fraction = self.statement.results[self.result].fraction as i32;
        value.error.low.abs().max(value.error.high.abs()) * exp2(fraction)
    }

    /// Returns the error in a box if only rounding operation number `source` rounds, in units of the result's last bit.
    pub(super) fn share(&self, limits: &OperandBox, source: usize) -> f64 {
        let mut units: f64 = 0.0;
        self.run(limits, Some(source), &mut |value, _| units = units.max(self.units(value)));
        units
    }
}

/// Facts about a box of operands that decide along which operand the box is divided.
pub(super) trait BoxScore {
    /// Returns a measure of the width of the limits in the box, such as the largest error. It is infinite without limits.
    fn score(&self) -> f64;
}

impl BoxScore for BoxError {
    fn score(&self) -> f64 {
        self.units
    }
}

/// Returns a positive number without its low bits. Numbers that differ by less than a per cent mostly become equal.
fn coarse(value: f64) -> f64 {
    const DROPPED_BITS: u32 = 46;
    f64::from_bits(value.to_bits() >> DROPPED_BITS << DROPPED_BITS)
}

/// Divides a box along the operand on which the box's score depends most, and returns the outcomes of `known` for the halves.
/// Returns `None` for a single combination. A half without an outcome is left out.
///
/// The score depends most on the operand that gives the smallest score when it has only its middle value.
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
        // Among equally good operands, the one with the most values is best.
        let rank = (score, u64::MAX - high.abs_diff(low), operand);
        if best.is_none_or(|other| rank < other) {
            best = Some(rank);
        }
    }
    let (_, _, operand) = best?;
    let halves = halves_along(limits, operand)?;
    Some(halves.iter().filter_map(known).collect())
}

/// Returns the combination of operands in the middle of a box, as a box.
fn middle_of(limits: &OperandBox) -> OperandBox {
    let mut middle = limits.clone();
    for (low, high) in &mut middle {
        *low += (*high - *low) / 2;
        *high = *low;
    }
    middle
}

/// Returns the two halves of a box along one operand; `None` if the box has a single value of this operand.
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

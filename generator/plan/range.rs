//! Computes an interval that contains the values of a part of a formula, for all operands for which a result with this part is
//! promised. The module divides the operands' domain into boxes, which have narrower intervals.

use std::cmp::Ordering;
use std::collections::{BTreeSet, BinaryHeap};
use std::sync::Arc;

use glint_formula::{Comparison, Enclosure, Expression, Function, Kind, Operator};

use super::boxes::{BoxScore, OperandBox, affordable, best_halves};
use super::guarded::GuardedFormula;
use super::memo::FormulaMemo;
use super::refusal::{PartToLimit, PlanRefusal};
use super::statement::{ExpressionStatement, StatedResult};
use super::uses::PartUses;

/// The largest number of divisions of the domain in the search for boxes with finite values.
const DIVISIONS_TO_LIMITS: usize = 1 << 12;

/// The number of divisions of the domain that bring each end of the interval nearer to the true end.
const DIVISIONS_OF_AN_END: usize = 300;

/// The remedy for a formula that has no finite value.
pub(super) const LIMIT_THE_OPERANDS: &str =
    "limit the operands with `where`, or with `from` and `to`";

/// Returns the part that a condition could limit so that `part` has a value for these operands: `1 / (x - y)` gives `x - y`. A
/// divisor or the operand of a logarithm must be above 0, and the operand of a root not below 0. Returns `None` if no such part
/// is found, or if it is a constant.
fn limited_part(part: &Expression, operands: &[(&str, Enclosure)]) -> Option<PartToLimit> {
    for inner in part.parts() {
        if inner.enclose(operands).map_or(true, |value| !value.is_finite()) {
            return limited_part(inner, operands);
        }
    }
    let (limited, sign) = match &part.kind {
        Kind::Binary(Operator::Div | Operator::Mod, _, divisor) => (divisor, ">"),
        Kind::Binary(Operator::Power, base, _) => (base, ">"),
        Kind::Unary(Function::Ln | Function::Log2, operand) => (operand, ">"),
        Kind::Unary(Function::Sqrt, operand) => (operand, ">="),
        _ => return None,
    };
    // All parts of a function that is written out have the location of the call.
    let is_written = limited.span != part.span && !limited.span.bytes.is_empty();
    let place = is_written.then(|| limited.span.clone());
    limited.varies().then(|| PartToLimit { place, formula: limited.python(), sign })
}

/// The reason why no interval for the values of a part was found.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum NoRange {
    /// The part is not finite, or has no value, for operands in this box.
    NotFinite(OperandBox),
    /// No operands satisfy `where`.
    NothingPromised,
}

impl NoRange {
    /// Returns the refusal of `part` for this reason.
    pub(super) fn refusal(self, statement: &ExpressionStatement, part: &Expression) -> PlanRefusal {
        match self {
            Self::NotFinite(limits) => {
                let place = statement.place(&limits, &part.operands().into_iter().collect());
                let message = format!("this is not finite, or has no value, for {place}");
                let limited = limited_part(part, &statement.enclosed_operands(&limits));
                let limited = limited.map(Box::new);
                PlanRefusal { limited, ..PlanRefusal::new(message, LIMIT_THE_OPERANDS) }
                    .at(&part.span)
            }
            Self::NothingPromised => PlanRefusal::new(
                "no operands in the domains satisfy `where`",
                "change `where`, or the domains of the operands",
            ),
        }
    }
}

/// A box of operands with an interval that contains the values of the part in this box.
#[derive(Clone)]
struct BoxValues {
    limits: OperandBox,
    values: Enclosure,
}

impl BoxScore for BoxValues {
    fn score(&self) -> f64 {
        if self.values.is_finite() { self.values.high - self.values.low } else { f64::INFINITY }
    }
}

/// A box of operands with an upper limit of the values in this box. The box with the largest limit comes first in a heap.
struct BoxEnd {
    limits: OperandBox,
    end: f64,
}

impl BoxScore for BoxEnd {
    fn score(&self) -> f64 {
        self.end
    }
}

impl PartialEq for BoxEnd {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for BoxEnd {}

impl PartialOrd for BoxEnd {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for BoxEnd {
    fn cmp(&self, other: &Self) -> Ordering {
        self.end.total_cmp(&other.end)
    }
}

/// The intervals of parts that were computed for a statement, so that each is computed once.
#[derive(Default)]
pub(super) struct RangeMemo(FormulaMemo<PartUses, Result<Enclosure, NoRange>>);

impl RangeMemo {
    /// Returns the interval of [`range_of`], which it computes only once. All calls must have the same statement.
    ///
    /// # Errors
    /// Fails if the values have no finite limits, or if no operands satisfy the condition of the promise.
    pub(super) fn range_of(
        &self,
        statement: &ExpressionStatement,
        uses: &PartUses,
        part: &Expression,
    ) -> Result<Enclosure, NoRange> {
        self.0.value(part, uses, || range_of(statement, uses, part))
    }
}

/// Returns an interval that contains the values of `formula`, for all operands for which the value matters by `uses`.
///
/// The domain is divided where the part has no finite limits, and then where its largest and its smallest values are.
///
/// # Errors
/// Fails if the values have no finite limits, for example near a pole, or if no operands satisfy the condition of the promise.
/// In the first case, the error has a box of operands without finite limits.
fn range_of(
    statement: &ExpressionStatement,
    uses: &PartUses,
    formula: &Expression,
) -> Result<Enclosure, NoRange> {
    let guarded = GuardedFormula::new(statement, uses, formula);
    let named = operands_that_matter(statement, uses, formula);
    let values_in = |limits: &OperandBox| {
        let operands = statement.enclosed_operands(limits);
        let may_be_promised = |(result, reads): (&StatedResult, &bool)| {
            *reads && result.is_promised(&operands) != Some(false)
        };
        if !statement.results.iter().zip(&uses.readers).any(may_be_promised) {
            return None;
        }
        let is_excluded = |(comparison, outcome): &(Comparison, bool)| {
            comparison.holds(&operands).is_ok_and(|holds| holds == Some(!outcome))
        };
        if uses.conditions.iter().any(is_excluded) {
            return None;
        }
        let values = guarded.values(&operands)?;
        Some(BoxValues { limits: limits.clone(), values })
    };
    let mut finite = Vec::new();
    let mut open: Vec<BoxValues> = values_in(&statement.domain_of(&named)).into_iter().collect();
    let mut divisions = 0;
    while let Some(next) = open.pop() {
        if next.values.is_finite() {
            finite.push(next);
            continue;
        }
        divisions += 1;
        let halves = best_halves(&next.limits, &values_in);
        match halves {
            Some(halves) if divisions <= DIVISIONS_TO_LIMITS => open.extend(halves),
            _ => return Err(NoRange::NotFinite(next.limits)),
        }
    }
    if finite.is_empty() {
        return Err(NoRange::NothingPromised);
    }
    let high_of = |it: BoxValues| BoxEnd { limits: it.limits, end: it.values.high };
    let low_of = |it: BoxValues| BoxEnd { limits: it.limits, end: -it.values.low };
    let divisions = affordable(named.len(), DIVISIONS_OF_AN_END);
    let boxes = finite.iter().cloned();
    let high =
        largest(divisions, boxes.clone().map(high_of), &|limits| values_in(limits).map(high_of));
    let low = largest(divisions, boxes.map(low_of), &|limits| values_in(limits).map(low_of));
    Ok(Enclosure::between(-low, high))
}

/// Returns the names of the operands on which a formula, or a condition of its uses, depends.
fn operands_that_matter<'f>(
    statement: &'f ExpressionStatement,
    uses: &'f PartUses,
    formula: &'f Expression,
) -> BTreeSet<&'f str> {
    let mut named = BTreeSet::from_iter(formula.operands());
    let promises = statement.results.iter().zip(&uses.readers).filter(|(_, reads)| **reads);
    let promises = promises.filter_map(|(result, _)| result.promise.as_ref());
    for comparison in promises.chain(uses.conditions.iter().map(|(comparison, _)| comparison)) {
        named.extend(comparison.left.operands());
        named.extend(comparison.right.operands());
    }
    named
}

/// Returns a lower limit of the absolute values of a result, for all operands for which it is promised. The limit is at least
/// 0. For example, it is 0.5 or a little less for `1 / x` with x from 1 to 2.
///
/// # Errors
/// Fails if the values have no finite limits, or if the result is promised for no operands.
pub fn least_size(statement: &ExpressionStatement, result: usize) -> Result<f64, PlanRefusal> {
    let stated = &statement.results[result];
    let target = stated.target();
    let kind = Kind::Unary(Function::Abs, Arc::new(target.clone()));
    let size = Expression::new(kind, target.span.clone());
    // The condition of this result alone counts.
    let alone = ExpressionStatement {
        operands: statement.operands.clone(),
        results: vec![StatedResult { formula: size.clone(), width: None, ..stated.clone() }],
    };
    let uses = PartUses { readers: vec![true], conditions: Vec::new() };
    let values = range_of(&alone, &uses, &size).map_err(|error| error.refusal(statement, target));
    values.map(|values| values.low.max(0.0)).map_err(|refusal| refusal.of_result(result))
}

/// Returns an upper limit of the values in all boxes, after up to `divisions` divisions of the box with the largest limit.
/// `end_in` returns the upper limit in a box, or `None` if nothing is promised in the box.
fn largest(
    divisions: usize,
    boxes: impl Iterator<Item = BoxEnd>,
    end_in: &dyn Fn(&OperandBox) -> Option<BoxEnd>,
) -> f64 {
    let mut open: BinaryHeap<BoxEnd> = boxes.collect();
    let mut end = f64::NEG_INFINITY;
    for _ in 0..divisions {
        let Some(first) = open.pop() else { break };
        end = first.end;
        match best_halves(&first.limits, end_in) {
            Some(halves) => open.extend(halves),
            None => return end,
        }
    }
    open.pop().map_or(end, |first| first.end)
}

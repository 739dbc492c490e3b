//! Encloses the values of a part of the formulas over all operands for which a result with this part is promised.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glint_formula::{Enclosure, Expression};

use super::boxes::{OperandBox, halves};
use super::statement::{StatedResult, Statement};

/// The divisions of the domain, at most, until the values have limits.
const DIVISIONS_TO_LIMITS: usize = 1 << 14;

/// The divisions of the domain that bring each limit nearer to the true one.
const DIVISIONS_OF_AN_END: usize = 600;

/// A box with the limits of the values in it. The box with the largest limit comes first.
struct BoxValues {
    limits: OperandBox,
    high: f64,
}

impl PartialEq for BoxValues {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for BoxValues {}

impl PartialOrd for BoxValues {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for BoxValues {
    fn cmp(&self, other: &Self) -> Ordering {
        self.high.total_cmp(&other.high)
    }
}

/// Returns limits of the values of a part of the formulas, where a result that has the part is promised; `None` if they are not finite, as near a pole.
///
/// The domain is divided where the formula has no finite limits, and then where its largest and its smallest values are.
pub(super) fn range_of(statement: &Statement, formula: &Expression) -> Option<Enclosure> {
    // A part that is made of others, as a size, is in no formula: it counts for every result.
    let reads = |result: &&StatedResult| result.formula.count(&|part| part == formula) > 0;
    let mut readers: Vec<&StatedResult> = statement.results.iter().filter(reads).collect();
    if readers.is_empty() {
        readers = statement.results.iter().collect();
    }
    let values_in = |limits: &OperandBox| {
        let operands = statement.enclosed_operands(limits);
        let may_be_promised = |it: &&StatedResult| it.is_promised(&operands) != Some(false);
        if !readers.iter().any(may_be_promised) {
            return None;
        }
        Some(match formula.enclose(&operands) {
            Ok(values) => values,
            Err(_) => Enclosure::between(f64::NEG_INFINITY, f64::INFINITY),
        })
    };
    let mut finite = Vec::new();
    let mut open = vec![statement.domain()];
    for _ in 0..DIVISIONS_TO_LIMITS {
        let Some(limits) = open.pop() else { break };
        match values_in(&limits) {
            None => {}
            Some(values) if values.is_finite() => finite.push(limits),
            Some(_) => open.extend(halves(&limits)?),
        }
    }
    if !open.is_empty() {
        return None;
    }
    let high = largest(&finite, &|limits| values_in(limits).map(|values| values.high))?;
    let low = largest(&finite, &|limits| values_in(limits).map(|values| -values.low))?;
    Some(Enclosure::between(-low, high))
}

/// Returns a limit of the largest value in any of the boxes. `value` gives a limit within a box, or nothing if the box has no
/// values.
fn largest(boxes: &[OperandBox], value: &dyn Fn(&OperandBox) -> Option<f64>) -> Option<f64> {
    let with_value = |limits: &OperandBox| {
        let high = value(limits)?;
        Some(BoxValues { limits: limits.clone(), high })
    };
    let mut open: BinaryHeap<BoxValues> = boxes.iter().filter_map(with_value).collect();
    for _ in 0..DIVISIONS_OF_AN_END {
        let first = open.peek()?;
        let Some(halves) = halves(&first.limits) else { break };
        open.pop();
        open.extend(halves.iter().filter_map(with_value));
    }
    open.pop().map(|first| first.high)
}

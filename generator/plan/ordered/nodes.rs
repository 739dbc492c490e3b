//! Shows from the operations of a plan that the results of a list rise or fall with their own operands.
//!
//! Rules decide sums, products, roundings and shifts. Where no rule applies, such as at a table of polynomials, the values of the node are
//! computed for every value of an earlier node.

use std::collections::HashMap;

use glint_base::fixed::exp2;
use glint_base::interval::Interval;

use super::Change;
use super::alike::{NodePair, inputs_of_pair, pairs};
use super::formulas::OrderedList;
use crate::find::ProvedPlan;
use crate::node::{NodeId, Operation};
use crate::plan::ExpressionPlan;
use crate::refusal::PlanRefusal;

/// The most values of a node for which a later node is computed.
const MOST_VALUES: i128 = 1 << 20;

/// Checks that all results of a list change with their own operands as their values do.
///
/// # Errors
/// Fails if two results are not computed by the same operations, or if an operation is not known to rise or to fall.
pub(super) fn check_list(found: &ProvedPlan, list: &OrderedList) -> Result<(), PlanRefusal> {
    let plan = &found.plan;
    let operand =
        |name: &String| found.statement.operands.iter().position(|operand| operand.name == *name);
    let mut computed = HashMap::new();
    let equal = plan.first_of_equal_nodes();
    for first in list.results.clone() {
        for second in first + 1..list.results.end {
            let own = [first, second].map(|number| operand(&list.own[number - list.results.start]));
            let results = (plan.results()[first], plan.results()[second]);
            let pairs = pairs(plan, &equal, results, own).map_err(|(node, _)| {
                let name = &plan.node(node).name;
                refusal(first, &format!("the numbers are not computed alike at the part `{name}`"))
            })?;
            let mut chain = Chain {
                plan,
                first: &equal,
                pairs,
                changes: HashMap::new(),
                computed: &mut computed,
            };
            if chain.change_of(results) != list.change {
                let name = &plan.node(chain.obstacle(results)).name;
                let reason = format!("the hardware of the part `{name}` does not keep the order");
                return Err(refusal(first, &reason));
            }
        }
    }
    Ok(())
}

fn refusal(result: usize, reason: &str) -> PlanRefusal {
    let message = format!("no plan with `ordered` was found: {reason}");
    let remedy =
        "allow a smaller error, so that the steps of the tables are finer, or remove `ordered`";
    PlanRefusal::new(message, remedy).of_result(result)
}

/// The operations of two results of a list.
struct Chain<'p> {
    plan: &'p ExpressionPlan,
    /// For each node, the first one with the same value.
    first: &'p [NodeId],
    /// The pairs of nodes, each after the pairs that it reads.
    pairs: Vec<NodePair>,
    changes: HashMap<NodePair, Change>,
    /// For an earlier node, a node, and the range of the earlier node, the change of the node's values while the earlier node rises.
    computed: &'p mut HashMap<(NodeId, NodeId, Interval), Change>,
}

impl Chain<'_> {
    /// Finds the changes of all pairs, and returns the change of `results`, the last pair.
    fn change_of(&mut self, results: NodePair) -> Change {
        for at in 0..self.pairs.len() {
            let pair = self.pairs[at];
            let change = match self.by_rule(pair) {
                Change::Unknown => self.by_values(at),
                known => known,
            };
            self.changes.insert(pair, change);
        }
        self.changes[&(self.first[results.0.0], self.first[results.1.0])]
    }

    /// Returns the last table of polynomials whose change is not known, or the result if there is none.
    fn obstacle(&self, results: NodePair) -> NodeId {
        let is_unknown_table = |(a, b): &&NodePair| {
            let is_table = matches!(self.plan.node(*a).operation, Operation::Polynomial(..));
            is_table && self.changes[&(*a, *b)] == Change::Unknown
        };
        let table = self.pairs.iter().rev().find(is_unknown_table);
        table.map_or(results.0, |(table, _)| *table)
    }

    fn by_rule(&self, (a, b): NodePair) -> Change {
        if a == b {
            return Change::Constant;
        }
        let plan = self.plan;
        let inputs = inputs_of_pair(plan, self.first, (a, b));
        let change = |input: usize| self.changes[&inputs[input]];
        let sign = |input: usize| is_negative(plan, inputs[input]);
        match &plan.node(a).operation {
            Operation::Operand(_) => Change::Rises,
            Operation::Constant { .. } => Change::Constant,
            Operation::Add(..) | Operation::Minimum(..) | Operation::Maximum(..) => {
                change(0).with(change(1))
            }
            Operation::Subtract(..) => change(0).with(change(1).reversed()),
            Operation::Less(..) => change(0).reversed().with(change(1)),
            Operation::Multiply(..) => change(0).times(sign(1)).with(change(1).times(sign(0))),
            Operation::Absolute(_) | Operation::NonZero(_) => change(0).times(sign(0)),
            Operation::Choose { .. } if change(0) == Change::Constant => change(1).with(change(2)),
            Operation::Scale(_)
            | Operation::Narrow(..)
            | Operation::Middle(_)
            | Operation::IntegerPart(_) => change(0),
            Operation::ShiftLeft(..) | Operation::ShiftRight(..)
                if change(1) == Change::Constant =>
            {
                change(0)
            }
            _ => Change::Unknown,
        }
    }

    /// Computes the values of a node for all values of an earlier node that is known to rise or to fall. Among several such earlier nodes,
    /// the one with the fewest values is taken.
    fn by_values(&mut self, at: usize) -> Change {
        let mut best: Option<(i128, NodePair, Vec<NodeId>)> = None;
        for &base in &self.pairs[..at] {
            if !self.changes[&base].is_known() {
                continue;
            }
            let Some((low, high)) = value_range(self.plan, base) else { continue };
            let count = high - low + 1;
            let is_better = best.as_ref().is_none_or(|(least, ..)| count < *least);
            if count > MOST_VALUES || !is_better {
                continue;
            }
            if let Some(path) = self.path(base, self.pairs[at]) {
                best = Some((count, base, path));
            }
        }
        let Some((_, base, path)) = best else { return Change::Unknown };
        let Some(range) = value_range(self.plan, base) else { return Change::Unknown };
        let node = self.pairs[at].0;
        let (plan, first) = (self.plan, self.first);
        let known = self.computed.entry((base.0, node, range));
        let rises = *known.or_insert_with(|| change_of_values((plan, first), base.0, &path, range));
        if self.changes[&base] == Change::Falls { rises.reversed() } else { rises }
    }

    /// Returns the nodes that compute `last` from `base` and constants alone, in the order of the plan, or `None` if `last` depends on
    /// something else.
    fn path(&self, base: NodePair, last: NodePair) -> Option<Vec<NodeId>> {
        let plan = self.plan;
        let mut path = Vec::new();
        let mut open = vec![last];
        while let Some((a, b)) = open.pop() {
            if (a, b) == base || path.contains(&a) {
                continue;
            }
            let is_constant = matches!(plan.node(a).operation, Operation::Constant { .. });
            let is_operand = matches!(plan.node(a).operation, Operation::Operand(_));
            if is_operand || a == b && !is_constant || a.0 <= base.0.0 && !is_constant {
                return None;
            }
            path.push(a);
            open.extend(inputs_of_pair(plan, self.first, (a, b)));
        }
        path.sort_by_key(|node| node.0);
        Some(path)
    }
}

/// Returns the smallest and the largest raw value of both nodes of a pair, for operands for which results are promised. Returns `None` if
/// they are not known.
fn value_range(plan: &ExpressionPlan, (a, b): NodePair) -> Option<Interval> {
    let mut range: Option<Interval> = None;
    for id in [a, b] {
        let node = plan.node(id);
        let (low, high) = node.range;
        let scale = exp2(node.format.frac);
        let limits = node.actual_limits;
        let mut low = low.max((limits.low * scale).ceil() as i128);
        let mut high = high.min((limits.high * scale).floor() as i128);
        if let Operation::Subtract(minuend, subtrahend) = node.operation {
            if is_at_least(plan, subtrahend, minuend) {
                high = high.min(0);
            }
            if is_at_least(plan, minuend, subtrahend) {
                low = low.max(0);
            }
        }
        range = Some(range.map_or((low, high), |(l, h)| (l.min(low), h.max(high))));
    }
    range.filter(|(low, high)| low < high)
}

/// Returns whether node `a` is certainly not below node `b`, because `a` is a maximum with `b` among its numbers, or `b` a minimum with
/// `a` among its numbers.
fn is_at_least(plan: &ExpressionPlan, a: NodeId, b: NodeId) -> bool {
    let is_maximum = match plan.node(a).operation {
        Operation::Maximum(one, other) => is_at_least(plan, one, b) || is_at_least(plan, other, b),
        _ => false,
    };
    let is_minimum = match plan.node(b).operation {
        Operation::Minimum(one, other) => is_at_least(plan, a, one) || is_at_least(plan, a, other),
        _ => false,
    };
    a == b || is_maximum || is_minimum
}

/// Computes the last node of `path` for every value of `base` in the range, and returns its change. `first` has for each node the first
/// one with the same value; the path has only such nodes.
fn change_of_values(
    (plan, first): (&ExpressionPlan, &[NodeId]),
    base: NodeId,
    path: &[NodeId],
    (low, high): Interval,
) -> Change {
    let Some(last) = path.last() else { return Change::Unknown };
    let mut values = vec![0; plan.nodes().len()];
    let mut change = Change::Constant;
    let mut before = None;
    for raw in low..=high {
        values[base.0] = raw;
        for &node in path {
            values[node.0] = plan.value(node, &[], &|id| values[first[id.0].0]);
        }
        let value: i128 = values[last.0];
        if let Some(before) = before {
            let step = match value.cmp(&before) {
                std::cmp::Ordering::Equal => Change::Constant,
                std::cmp::Ordering::Greater => Change::Rises,
                std::cmp::Ordering::Less => Change::Falls,
            };
            change = change.with(step);
            if change == Change::Unknown {
                return change;
            }
        }
        before = Some(value);
    }
    change
}

/// Returns whether the values of a pair of nodes are at most 0 (`true`), or at least 0 (`false`); `None` if they have both signs.
fn is_negative(plan: &ExpressionPlan, (a, b): NodePair) -> Option<bool> {
    let [a, b] = [a, b].map(|node| plan.node(node).range);
    match (a.0.min(b.0) >= 0, a.1.max(b.1) <= 0) {
        (true, _) => Some(false),
        (_, true) => Some(true),
        (false, false) => None,
    }
}

//! Finds the exact parts of a plan from which the rounded parts are computed, so that an error can be bounded over the values of these
//! parts. For example, the error of the root of `a^2 + b^2 + c^2 + d^2` depends on the sum alone, one number in place of four operands.

use std::sync::Arc;

use glint_approximate::Outside;
use glint_base::fixed::exp2;
use glint_formula::{Expression, Kind, Operator};

use super::node::{NodeId, Operation, PlanNode, ValueAccuracy};
use super::plan::{ExpressionPlan, PlanBuilder};
use super::statement::{ExpressionStatement, StatedOperand, StatedResult};

/// A plan whose operands are exact parts of another plan, with a statement of these operands.
pub(super) struct PlanOfParts {
    pub(super) statement: ExpressionStatement,
    pub(super) plan: ExpressionPlan,
}

impl PlanOfParts {
    /// Returns a plan that computes `node` of `plan` from exact parts, and a statement of these parts with the allowed error of
    /// `result`, but without its condition. Returns `None` if the parts are not fewer than `most`, or if a rounded part has a
    /// stated value, which depends on the operands of `plan`.
    pub(super) fn of(
        plan: &ExpressionPlan,
        node: NodeId,
        result: &StatedResult,
        most: usize,
    ) -> Option<Self> {
        let needed = plan.needed_by(node);
        let is_plain = plain_nodes(plan);
        let mut parts: Vec<NodeId> = Vec::new();
        for (at, reader) in plan.nodes().iter().enumerate() {
            if !needed[at] || is_plain[at] {
                continue;
            }
            if reader.stated.is_some() || reader.agreement.is_some() {
                return None;
            }
            for input in reader.operation.inputs() {
                let is_constant = matches!(plan.node(input).operation, Operation::Constant { .. });
                if is_plain[input.0] && !is_constant && !parts.contains(&input) {
                    parts.push(input);
                }
            }
        }
        if parts.is_empty() || parts.len() >= most {
            return None;
        }
        let mut of_parts = PlanBuilder::of_plan(plan.clone());
        of_parts.end_at(node);
        let mut operands = Vec::new();
        let mut sum: Option<Expression> = None;
        for (number, part) in parts.into_iter().enumerate() {
            let PlanNode { name, format, .. } = plan.node(part).clone();
            let domain = domain_of(plan.node(part))?;
            let operand = Expression::operand(&name);
            sum = Some(match sum {
                None => operand,
                Some(sum) => {
                    let kind = Kind::Binary(Operator::Add, Arc::new(sum), Arc::new(operand));
                    Expression::new(kind, 0..0)
                }
            });
            let (outside, doc) = (Outside::Anything, String::new());
            operands.push(StatedOperand { name, format, domain, outside, doc });
            of_parts.make_operand(part, number);
        }
        // The formula only names the operands on which the error depends.
        let result = StatedResult { formula: sum?, promise: None, ..result.clone() };
        let statement = ExpressionStatement { operands, results: vec![result] };
        Some(Self { statement, plan: of_parts.finish().ok()? })
    }
}

/// Returns for each node whether it is exact and depends on no node that branches the analysis: a shift that depends on a word,
/// or an integer part.
fn plain_nodes(plan: &ExpressionPlan) -> Vec<bool> {
    let mut is_plain: Vec<bool> = Vec::new();
    for node in plan.nodes() {
        let has_branches = matches!(
            node.operation,
            Operation::Normalise { .. } | Operation::Places(_) | Operation::IntegerPart(_)
        );
        let is_rounded = node.source.is_some()
            || node.deviation > 0.0
            || node.stated.as_ref().is_some_and(|it| it.accuracy == ValueAccuracy::Nearest);
        let of_plain = node.operation.inputs().iter().all(|input| is_plain[input.0]);
        is_plain.push(!has_branches && !is_rounded && of_plain);
    }
    is_plain
}

/// Returns the raw values that an exact node can have where its value matters. Returns `None` if they have more than 64 bits.
fn domain_of(node: &PlanNode) -> Option<(i64, i64)> {
    let unit = exp2(node.format.frac);
    let least = (node.limits.low * unit).ceil().max(node.range.0 as f64);
    let most = (node.limits.high * unit).floor().min(node.range.1 as f64);
    let fits = |raw: f64| raw.abs() < exp2(62);
    (fits(least) && fits(most) && least <= most).then_some((least as i64, most as i64))
}

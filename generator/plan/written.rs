//! Plans a function whose table can be written at run time: one polynomial over the whole domain of its one operand, without any other
//! operation.

use std::sync::Arc;

use glint_approximate::{Curve, Piecewise, TargetFunction};
use glint_formula::Expression;

use super::find::{ProofKind, ProvedPlan};
use super::node::Operation;
use super::plan::ExpressionPlan;
use super::refusal::PlanRefusal;
use super::statement::ExpressionStatement;

/// The name of the operand of a [`TargetFunction`].
const OPERAND: &str = "x";

/// Returns the function that the statement states.
///
/// # Errors
/// Fails if the statement has several operands or results, a condition, or a stated width of the result.
pub fn target_function(statement: &ExpressionStatement) -> Result<TargetFunction, PlanRefusal> {
    let ([operand], [result]) = (&statement.operands[..], &statement.results[..]) else {
        return Err(PlanRefusal::new(
            "a function whose table can be written has one operand and one result",
            "set table = \"fixed\", or state one operand and one result",
        ));
    };
    if result.promise.is_some() || result.width.is_some() {
        return Err(PlanRefusal::new(
            "a function whose table can be written has the format that its values need, for the whole domain of its operand",
            "remove where, bits, signed and overflow, or set table = \"fixed\"",
        ));
    }
    let renamed =
        |name: &str| (name == operand.name).then(|| Arc::new(Expression::operand(OPERAND)));
    Ok(TargetFunction {
        curve: Curve::Formula(result.formula.with_operands(&renamed)),
        domain: operand.domain,
        operand: operand.format,
        outside: operand.outside,
        fraction: result.fraction,
        error: result.error,
    })
}

impl ProvedPlan {
    /// Returns the plan of a statement whose function ([`target_function`]) has polynomials that are found and proved already.
    ///
    /// # Errors
    /// Fails if the operand or the result has too many bits.
    pub fn of_table(
        statement: ExpressionStatement,
        function: &TargetFunction,
        polynomials: &Arc<Piecewise>,
    ) -> Result<Self, PlanRefusal> {
        let plan = ExpressionPlan::of_function(function, polynomials)?;
        let bound = polynomials.bound;
        let is_polynomial = |operation: &Operation| matches!(operation, Operation::Polynomial(..));
        let nodes = plan.nodes().iter();
        let shares = nodes.map(|node| if is_polynomial(&node.operation) { bound } else { 0.0 });
        Ok(Self {
            statement,
            whole_functions: plan.clone(),
            bounds: vec![bound],
            enclosed: vec![bound],
            shares: vec![shares.collect()],
            proof: ProofKind::EveryCombination,
            ordered: Vec::new(),
            plan,
        })
    }
}

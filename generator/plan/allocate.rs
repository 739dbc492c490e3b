//! Distributes the allowed error of an expression among the operations of its plan that round.
//!
//! Each such operation starts with few fraction bits. The operation with the largest share of the error gets one more bit, until
//! every result is within its allowed error. Afterwards the module removes bits that are not needed.

use super::boxes::{BoxError, ResultProof};
use super::lower::{FoundPolynomials, Guards, PlanStyle, lowered};
use super::plan::ExpressionPlan;
use super::refusal::PlanRefusal;
use super::statement::ExpressionStatement;

/// The guard with which each place begins.
const FIRST_GUARD: i32 = -3;

/// The guard with which the places begin at most, where no plan has fewer bits.
const MOST_FIRST_GUARD: i32 = 9;

/// The most bits that a place gets beyond the bits of the results.
const MOST_GUARD: i32 = 24;

/// The divisions of the domain for an estimate of the error, in the order in which they are tried. Few divisions are faster. With
/// more, a decision that rounding can make wrong is seen to be wrong for few operands.
const DIVISIONS: [usize; 2] = [400, 1500];

/// The fraction bits of a plan's parts with which every result keeps its error.
pub(super) struct Allocation {
    pub(super) guards: Guards,
    /// The plan with these guards. Its polynomials are estimates.
    pub(super) plan: ExpressionPlan,
    /// The divisions of the domain by which the errors are known.
    pub(super) divisions: usize,
}

/// Returns guards with which every result keeps its error, as far as the estimates of the polynomials' errors tell, and the
/// plan with them.
///
/// # Errors
/// Fails if a formula has no plan, or if no number of bits is enough.
pub(super) fn allocated(
    statement: &ExpressionStatement,
    style: PlanStyle,
) -> Result<Allocation, PlanRefusal> {
    let [few, many] = DIVISIONS;
    let none = Guards::new(style);
    allocated_with(statement, &none, few).or_else(|_| allocated_with(statement, &none, many))
}

/// Returns guards with which every result keeps its error, where the errors are computed with so many divisions of the domain.
fn allocated_with(
    statement: &ExpressionStatement,
    none: &Guards,
    divisions: usize,
) -> Result<Allocation, PlanRefusal> {
    let (mut guards, mut plan) = match grown(statement, none, divisions) {
        Ok(enough) => enough,
        Err(refusal) => equally_many(statement, none, divisions).ok_or(refusal)?,
    };
    for source in 0..guards.bits.len() {
        while guards.bits[source] > FIRST_GUARD {
            let mut fewer = guards.clone();
            fewer.bits[source] -= 1;
            let Ok(candidate) = with_guards(statement, &mut fewer, FIRST_GUARD) else { break };
            if largest_excess(statement, &candidate, divisions).is_some() {
                break;
            }
            guards = fewer;
            plan = candidate;
        }
    }
    Ok(Allocation { guards, plan, divisions })
}

/// Returns guards that grow, where the largest share of an error is, until every result keeps its error.
fn grown(
    statement: &ExpressionStatement,
    none: &Guards,
    divisions: usize,
) -> Result<(Guards, ExpressionPlan), PlanRefusal> {
    let (mut guards, mut plan) = first_plan(statement, none)?;
    while let Some(excess) = largest_excess(statement, &plan, divisions) {
        let source = excess.source(statement, &plan, &guards)?;
        guards.add_bit(source);
        plan = with_guards(statement, &mut guards, FIRST_GUARD)
            .map_err(|_| excess.refusal(statement, &plan))?;
    }
    Ok((guards, plan))
}

/// Returns the same guard for all operations, with which every result keeps its error; `None` if there is none. This finds a plan
/// where one operation alone gets so many bits that a product is too wide.
fn equally_many(
    statement: &ExpressionStatement,
    none: &Guards,
    divisions: usize,
) -> Option<(Guards, ExpressionPlan)> {
    for guard in (0..=MOST_FIRST_GUARD).step_by(3) {
        let mut guards = none.clone();
        let Ok(plan) = with_guards(statement, &mut guards, guard) else { continue };
        if largest_excess(statement, &plan, divisions).is_none() {
            return Some((guards, plan));
        }
    }
    None
}

/// Returns the first plan, with the fewest bits for which there is one. With fewer bits a divisor may be rounded to 0, for
/// example.
fn first_plan(
    statement: &ExpressionStatement,
    none: &Guards,
) -> Result<(Guards, ExpressionPlan), PlanRefusal> {
    let mut guards = none.clone();
    let mut refusal = match with_guards(statement, &mut guards, FIRST_GUARD) {
        Ok(plan) => return Ok((guards, plan)),
        Err(refusal) => refusal,
    };
    for first in FIRST_GUARD + 1..=MOST_FIRST_GUARD {
        let mut guards = none.clone();
        match with_guards(statement, &mut guards, first) {
            Ok(plan) => return Ok((guards, plan)),
            // With very many bits a part is too wide, which is not the reason.
            Err(other) if first <= 0 => refusal = other,
            Err(_) => {}
        }
    }
    Err(refusal)
}

/// Returns the plan with these guards. An operation that has no guard yet gets the guard `first`.
fn with_guards(
    statement: &ExpressionStatement,
    guards: &mut Guards,
    first: i32,
) -> Result<ExpressionPlan, PlanRefusal> {
    loop {
        let (plan, sources) = lowered(statement, guards, first, &FoundPolynomials::default())?;
        if sources <= guards.bits.len() {
            return Ok(plan);
        }
        guards.bits.resize(sources, first);
    }
}

/// A result that does not keep its error yet.
pub(super) struct ExcessiveResult {
    result: usize,
    /// The box of operands in which the error is largest.
    worst: BoxError,
}

/// Returns the result that exceeds its error by the largest factor; `None` if every result keeps its error.
pub(super) fn largest_excess(
    statement: &ExpressionStatement,
    plan: &ExpressionPlan,
    divisions: usize,
) -> Option<ExcessiveResult> {
    let mut largest: Option<(f64, ExcessiveResult)> = None;
    for (result, stated) in statement.results.iter().enumerate() {
        let proof = ResultProof::new(statement, plan, result);
        let Some(worst) = proof.worst(stated.error, divisions) else { continue };
        let factor = worst.units / stated.error;
        if factor < 1.0 || largest.as_ref().is_some_and(|(most, _)| *most >= factor) {
            continue;
        }
        largest = Some((factor, ExcessiveResult { result, worst }));
    }
    largest.map(|(_, excess)| excess)
}

impl ExcessiveResult {
    /// Returns the place with the largest share of the error. A place that cannot have more bits does not count.
    pub(super) fn source(
        &self,
        statement: &ExpressionStatement,
        plan: &ExpressionPlan,
        guards: &Guards,
    ) -> Result<usize, PlanRefusal> {
        let proof = ResultProof::new(statement, plan, self.result);
        let mut largest = (0.0, None);
        for (node, needed) in plan.nodes.iter().zip(&proof.needed) {
            let Some(source) = node.source.filter(|_| *needed) else { continue };
            if guards.bits.get(source).is_some_and(|guard| *guard >= MOST_GUARD) {
                continue;
            }
            let share = proof.share(&self.worst.limits, source);
            // A part that alone has no limit tells nothing where all together have one.
            let share = match share.is_finite() || self.worst.units.is_infinite() {
                true => share,
                false => f64::MIN_POSITIVE,
            };
            if share > largest.0 {
                largest = (share, Some(source));
            }
        }
        largest.1.ok_or_else(|| self.refusal(statement, plan))
    }

    fn refusal(&self, statement: &ExpressionStatement, plan: &ExpressionPlan) -> PlanRefusal {
        let message = format!(
            "the error of `{}` {} for {}, whatever the widths of the parts are",
            statement.results[self.result].name,
            self.worst.words(plan),
            statement.place(&self.worst.limits)
        );
        let remedy = "allow a larger error, or leave these operands out by `where`";
        PlanRefusal::new(message, remedy).of_result(self.result)
    }
}

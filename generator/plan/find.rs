//! Finds the plan for the formulas of a statement, and proves the error of each result. It remembers the plans that it found
//! before.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex};

use glint_approximate::{FULL_CELL, Identity, Piecewise, TargetFunction, Wish};
use glint_base::fixed::MAX_WIDTH;

use super::allocate::{Allocation, allocated, largest_excess};
use super::boxes::ResultProof;
use super::cost::cells_of_function;
use super::exhaust::largest_errors;
use super::lower::{FoundPolynomials, Guards, PlanStyle, has_functions_of_operands, lowered};
use super::node::{NodeId, Operation};
use super::plan::ExpressionPlan;
use super::refusal::PlanRefusal;
use super::statement::ExpressionStatement;

/// The divisions of the domain for the last bound, at least.
pub(super) const DIVISIONS: usize = 4000;

/// Every combination of operands is computed if there are at most 2 to this power.
const MOST_COMBINATIONS: u32 = 20;

/// The styles that the planner tries. If a table may have a little less than a whole unit of error, a single table needs no
/// further bit beside the rounding of the result by half a unit.
const STYLES: [PlanStyle; 6] = [
    PlanStyle { table_error: 1.0, centres_fractions: false, keeps_functions: false },
    PlanStyle { table_error: 0.96, centres_fractions: false, keeps_functions: false },
    PlanStyle { table_error: 1.0, centres_fractions: true, keeps_functions: false },
    PlanStyle { table_error: 0.96, centres_fractions: true, keeps_functions: false },
    PlanStyle { table_error: 1.0, centres_fractions: false, keeps_functions: true },
    PlanStyle { table_error: 0.96, centres_fractions: false, keeps_functions: true },
];

/// A number that no source has.
const NO_SOURCE: usize = usize::MAX;

/// The identities by which a table of a short domain serves a longer one.
const IDENTITIES: [Identity; 5] =
    [Identity::Odd, Identity::Even, Identity::Quadrants, Identity::Octaves, Identity::Exponent];

/// The method by which an error bound was proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProofKind {
    /// The result of every combination of operands was computed and compared with the formula.
    EveryCombination,
    /// Interval arithmetic enclosed the error. The tables of polynomials within the plan were proved at each of their operands.
    Enclosed,
}

impl ProofKind {
    /// Returns a description of the method.
    pub fn words(self) -> &'static str {
        match self {
            Self::EveryCombination => "every combination of operands was computed",
            Self::Enclosed => "enclosed from parts that are proved at every operand",
        }
    }
}

/// A plan for the formulas of a statement, with a proven error bound for each result.
#[derive(Clone, Debug)]
pub struct ProvedPlan {
    /// The formulas that the plan computes.
    pub statement: ExpressionStatement,
    /// The operations that compute the formulas.
    pub plan: ExpressionPlan,
    /// The same plan with a single node for each function that has a range reduction. The errors are proved for this plan.
    pub whole_functions: ExpressionPlan,
    /// The proven error bound of each result, in units of the result's last place.
    pub bounds: Vec<f64>,
    /// The share that each node has in the error of each result, in units of the result's last place, by result and node. It is
    /// what the rounding of this node alone adds to the error, in the box of operands with the largest error; 0 for a node that
    /// is exact.
    pub shares: Vec<Vec<f64>>,
    /// The method by which the bounds were proved.
    pub proof: ProofKind,
}

type FindResult = Result<Arc<ProvedPlan>, PlanRefusal>;

/// Returns the plan for a statement, with proven error bounds. If the same plan was found before, it is returned without a new
/// search.
///
/// # Errors
/// Fails if a formula has no plan, or if the plan does not keep the errors. The refusal says why.
pub fn find(statement: &ExpressionStatement) -> FindResult {
    static FOUND: LazyLock<Mutex<HashMap<String, FindResult>>> = LazyLock::new(Mutex::default);
    let key = format!("{statement:?}");
    if let Some(known) = FOUND.lock().expect("no search panics").get(&key) {
        return known.clone();
    }
    let found = searched(statement).map(Arc::new);
    FOUND.lock().expect("no search panics").insert(key, found.clone());
    found
}

/// A plan with its polynomials.
struct PlanCandidate {
    plan: ExpressionPlan,
    /// The divisions of the domain by which the errors are known.
    divisions: usize,
}

fn searched(statement: &ExpressionStatement) -> Result<ProvedPlan, PlanRefusal> {
    let PlanCandidate { plan: whole, divisions } = smallest_candidate(statement)?;
    let (plan, renumbered) = whole.with_reductions()?;
    let [first, second] = plan.multiplier_widths();
    if first + second > MAX_WIDTH {
        return Err(PlanRefusal::too_wide("product_of_factors", (first + second) as i32));
    }
    let mut bounds = enclosed_errors(statement, &whole, divisions.max(DIVISIONS))?;
    let mut proof = ProofKind::Enclosed;
    if statement.combinations() <= 1 << MOST_COMBINATIONS {
        proof = ProofKind::EveryCombination;
        for (bound, largest) in bounds.iter_mut().zip(largest_errors(statement, &plan)?) {
            *bound = bound.min(largest);
        }
    }
    let mut shares = Vec::new();
    for of_result in error_shares(statement, &whole, divisions) {
        let mut of_nodes = vec![0.0; plan.nodes.len()];
        for (at, share) in of_result.iter().enumerate() {
            of_nodes[rounding_node(&plan, &renumbered, at).0] += share;
        }
        shares.push(of_nodes);
    }
    let statement = statement.clone();
    Ok(ProvedPlan { statement, plan, whole_functions: whole, bounds, shares, proof })
}

/// Returns the node of the plan that has the rounding error of node number `at` before it got range reductions. It is the table
/// of a function with a range reduction, and otherwise the node itself.
fn rounding_node(plan: &ExpressionPlan, renumbered: &[NodeId], at: usize) -> NodeId {
    let first = if at == 0 { 0 } else { renumbered[at - 1].0 + 1 };
    let is_table = |node: &usize| matches!(plan.nodes[*node].operation, Operation::Polynomial(..));
    match (first..=renumbered[at].0).find(is_table) {
        Some(table) => NodeId(table),
        None => renumbered[at],
    }
}

/// Returns the plan that takes the fewest look-up tables by the estimate.
///
/// # Errors
/// Fails if no style has a plan, with the refusal of the first style.
fn smallest_candidate(statement: &ExpressionStatement) -> Result<PlanCandidate, PlanRefusal> {
    let mut smallest: Option<(f64, PlanCandidate)> = None;
    let mut first_refusal = None;
    let has_functions = has_functions_of_operands(statement);
    for style in STYLES {
        if style.keeps_functions && !has_functions {
            continue;
        }
        let candidate = match candidate_with(statement, style) {
            Ok(candidate) => candidate,
            Err(refusal) => {
                first_refusal.get_or_insert(refusal);
                continue;
            }
        };
        let cells = candidate.plan.total_cells();
        if smallest.as_ref().is_none_or(|(least, _)| cells < *least) {
            smallest = Some((cells, candidate));
        }
    }
    match (smallest, first_refusal) {
        (Some((_, candidate)), _) => Ok(candidate),
        (None, Some(refusal)) => Err(refusal),
        (None, None) => unreachable!("there are styles to try"),
    }
}

/// Returns a plan of a style that keeps the errors.
fn candidate_with(
    statement: &ExpressionStatement,
    style: PlanStyle,
) -> Result<PlanCandidate, PlanRefusal> {
    let Allocation { mut guards, plan: estimate, divisions } = allocated(statement, style)?;
    let mut plan = with_polynomials(statement, &guards, estimate)?;
    // The polynomials can have other formats than was estimated, and then another error.
    while let Some(excess) = largest_excess(statement, &plan, divisions) {
        let source = excess.source(statement, &plan, &guards)?;
        guards.add_bit(source);
        let estimate = lowered(statement, &guards, 0, &FoundPolynomials::default())?.0;
        plan = with_polynomials(statement, &guards, estimate)?;
    }
    Ok(PlanCandidate { plan, divisions })
}

/// Returns the plan with polynomials for all of its functions.
///
/// Polynomials may have results of another width than was estimated, and then a function that reads them has another
/// operand. So the plan is made anew until each function has the polynomials that were found for it.
fn with_polynomials(
    statement: &ExpressionStatement,
    guards: &Guards,
    estimate: ExpressionPlan,
) -> Result<ExpressionPlan, PlanRefusal> {
    let mut found = FoundPolynomials::default();
    let mut plan = estimate;
    loop {
        let mut is_complete = true;
        for approximation in plan.approximations() {
            if approximation.polynomials.is_some() {
                continue;
            }
            is_complete = false;
            let function = &approximation.function;
            found.insert(function, cheapest_polynomials(function)?);
        }
        if is_complete {
            return Ok(plan);
        }
        plan = lowered(statement, guards, 0, &found)?.0;
    }
}

/// Returns the polynomials of a function with the least cost in a pipeline: each degree more needs a product, a sum, and
/// registers for all that waits for them.
fn cheapest_polynomials(function: &TargetFunction) -> Result<Arc<Piecewise>, PlanRefusal> {
    let mut wishes = Vec::new();
    for degree in [1, 2, 3] {
        wishes.push(Wish { degree: Some(degree), least_words: FULL_CELL, ..Wish::default() });
    }
    for identity in IDENTITIES {
        wishes.push(Wish { identity, least_words: FULL_CELL, ..Wish::default() });
    }
    let mut cheapest: Option<(f64, Arc<Piecewise>)> = None;
    for wish in wishes {
        let Ok(found) = glint_approximate::find(function, wish) else { continue };
        let cost = cells_of_function(function, &found);
        if cheapest.as_ref().is_none_or(|(least, _)| cost < *least) {
            cheapest = Some((cost, found));
        }
    }
    if let Some((_, found)) = cheapest {
        return Ok(found);
    }
    glint_approximate::find(function, Wish::default())
        .map_err(|refusal| PlanRefusal::new(refusal.message, refusal.remedy))
}

/// Returns the share that each node has in the error of each result.
fn error_shares(
    statement: &ExpressionStatement,
    plan: &ExpressionPlan,
    divisions: usize,
) -> Vec<Vec<f64>> {
    let mut shares = Vec::new();
    for result in 0..statement.results.len() {
        let proof = ResultProof::new(statement, plan, result);
        let mut of_result = vec![0.0; plan.nodes.len()];
        if let Some(worst) = proof.worst(0.0, divisions) {
            // The rounding of the result itself has no source, and is in every share.
            let own = proof.share(&worst.limits, NO_SOURCE);
            for (node, share) in plan.nodes.iter().zip(&mut of_result) {
                if let Some(source) = node.source {
                    *share = (proof.share(&worst.limits, source) - own).max(0.0);
                }
            }
            of_result[plan.proved[result].0] += own;
        }
        shares.push(of_result);
    }
    shares
}

/// Returns a proved bound of the error of each result, after so many divisions of the domain.
pub(super) fn enclosed_errors(
    statement: &ExpressionStatement,
    plan: &ExpressionPlan,
    divisions: usize,
) -> Result<Vec<f64>, PlanRefusal> {
    let mut bounds = Vec::new();
    for (result, stated) in statement.results.iter().enumerate() {
        let proof = ResultProof::new(statement, plan, result);
        let Some(worst) = proof.worst(0.0, divisions) else {
            // Nothing is promised for any operand.
            bounds.push(0.0);
            continue;
        };
        if worst.units >= stated.error {
            let message = format!(
                "the error of `{}` {} for {}",
                stated.name,
                worst.words(plan),
                statement.place(&worst.limits)
            );
            return Err(PlanRefusal::new(message, "allow a larger error").of_result(result));
        }
        bounds.push(worst.units);
    }
    Ok(bounds)
}

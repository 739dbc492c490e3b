//! Finds a plan for an [`ExpressionStatement`], which has the formulas, the domains of the operands and the allowed errors, and
//! proves a bound on the error of each result.
//!
//! The search tries several plans, and chooses the one with the fewest estimated look-up tables. If no plan keeps the allowed
//! errors, the search fails with a [`PlanRefusal`].

use std::collections::HashSet;
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

use glint_approximate::{
    FULL_CELL, Identity, Layout, Piecewise, RefusalKind, SharedWidths, TargetFunction, Wish,
};
use glint_base::fixed::MAX_WIDTH;

use super::allocate::{Allocation, BitOrder, allocated, largest_excess, siblings_of};
use super::boxes::ResultProof;
use super::cost::cells_of_function;
use super::exhaust::{largest_errors, sampled_errors};
use super::lower::{
    FoundPolynomials, Guards, PlanSearch, PlanStyle, PolynomialMemo, TableRule, WidthTies,
    fewest_dividends, has_functions_of_operands, lowered,
};
use super::memory::TableMemory;
use super::node::{NodeId, Operation};
use super::plan::ExpressionPlan;
use super::refusal::PlanRefusal;
use super::statement::ExpressionStatement;

/// The smallest number of divisions of the domain for the final bound.
pub(super) const DIVISIONS: usize = 4000;

/// The plan is computed for every combination of operands if there are at most 2 to this power.
const MOST_COMBINATIONS: u32 = 20;

/// The number of combinations of operands at which a proof by intervals is compared with the formulas, if there are more of them.
const SAMPLES: u64 = 512;

/// The styles that the planner tries. The final rounding has an error of up to half a unit. If a table has an error a little
/// below one unit, a result from a single table may keep its bound with one guard bit less.
const STYLES: [PlanStyle; 6] = [
    FIRST_STYLE,
    PlanStyle { table_error: 0.96, ..FIRST_STYLE },
    PlanStyle { centres_fractions: true, ..FIRST_STYLE },
    PlanStyle { table_error: 0.96, centres_fractions: true, ..FIRST_STYLE },
    PlanStyle { keeps_functions: true, ..FIRST_STYLE },
    PlanStyle { table_error: 0.96, keeps_functions: true, ..FIRST_STYLE },
];

/// The style that is tried first, from which the others differ.
const FIRST_STYLE: PlanStyle = PlanStyle {
    table_error: 1.0,
    centres_fractions: false,
    keeps_functions: false,
    fewest_dividends: 3,
    cuts_terms_early: false,
    narrows_factors: false,
    shares_table: false,
};

/// With at most this many combinations of operands, tables of whole functions are found fast.
const FEW_COMBINATIONS: u128 = 1 << 12;

/// A table with at least this many operands is searched in one style only.
const LONG_DOMAIN: u64 = 1 << 22;

/// The numbers of segments that the tables of a unit may have, as powers of two.
const PREFIXES: std::ops::RangeInclusive<u32> = 3..=7;

/// A function of a unit may take 2 to this power pages of the table.
const MOST_PAGE_BITS: u32 = 2;

/// The assumed width of a coefficient without guard bits, for an estimate of the size of a table.
const WIDTH_WITHOUT_GUARD: i32 = 12;

/// The bits of a table that a look-up table stores.
const BITS_OF_CELL: f64 = 16.0;

/// The approximate look-up tables of a table of one function alone in a unit, with the steps of Horner's rule.
const CELLS_OF_OWN_TABLE: f64 = 300.0;

/// The most guard bits that the planner adds because polynomials have other errors than estimated. Polynomials are searched again
/// each time.
const MOST_CORRECTIONS: usize = 12;

/// The most by which an evaluation of a formula can exceed an error, in units of the last bit.
const EVALUATION_ERROR: f64 = 1e-6;

/// A number that no rounding operation has.
const NO_SOURCE: usize = usize::MAX;

/// A plan with reciprocals must have fewer look-up tables than this times the present ones, because the estimate is not exact.
const CLEARLY_FEWER: f64 = 0.9;

/// The identities by which a table for a short domain serves a longer domain.
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
    /// Returns a phrase that describes the method.
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
    /// The formulas, operands and allowed errors for which the plan was made.
    pub statement: ExpressionStatement,
    /// The operations that compute the formulas.
    pub plan: ExpressionPlan,
    /// The same plan with a single node for each function that has a range reduction. The errors are proved for this form of
    /// the plan.
    pub whole_functions: ExpressionPlan,
    /// The proven error bound of each result, in units of the result's last bit.
    pub bounds: Vec<f64>,
    /// The bound of each result that interval arithmetic proves. It is at least [`Self::bounds`], which may be the largest error of
    /// all combinations of operands.
    pub enclosed: Vec<f64>,
    /// For each result and each node of `plan`, the node's share in the error of the result, in units of the result's last bit.
    /// The share is the error that the rounding of this node adds, in the box of operands with the largest error. The share is
    /// 0 for an exact node.
    pub shares: Vec<Vec<f64>>,
    /// The method by which the bounds were proved.
    pub proof: ProofKind,
    /// The lists of results that have the order of their values, as ranges of indices.
    pub ordered: Vec<Range<usize>>,
}

/// A plan whose functions have polynomials.
struct PlanCandidate {
    plan: ExpressionPlan,
    /// The number of divisions of the domain with which the errors were computed.
    divisions: usize,
    /// Whether low bits of products can be dropped in front of sums and comparisons.
    has_terms: bool,
}

/// Returns the plan for a statement, with proven error bounds.
///
/// # Errors
/// Fails if a formula has no plan, or if no plan keeps the allowed errors. The refusal says why, and how to change the
/// statement.
pub fn find(statement: &ExpressionStatement) -> Result<ProvedPlan, PlanRefusal> {
    find_stored(statement, TableMemory::Logic)
}

/// Returns the plan for a statement, with its tables in the given memory. Fails if no plan keeps the allowed errors.
pub(super) fn find_stored(
    statement: &ExpressionStatement,
    memory: TableMemory,
) -> Result<ProvedPlan, PlanRefusal> {
    let mut search = PlanSearch::new(statement, TableRule::Cheapest);
    search.memory = memory;
    find_with(&search)
}

/// Returns the plan for a statement, in which the numbers of a list are computed by operations of the same widths
/// (`WidthTies::Alike`). `polynomials` has the results of earlier searches. Fails if no plan keeps the allowed errors.
pub(super) fn find_alike(
    statement: &ExpressionStatement,
    polynomials: &Rc<PolynomialMemo>,
    memory: TableMemory,
) -> Result<ProvedPlan, PlanRefusal> {
    let mut search = PlanSearch::new(statement, TableRule::Cheapest);
    search.ties = WidthTies::Alike;
    search.polynomials = polynomials.clone();
    search.memory = memory;
    find_with(&search)
}

/// Returns a plan for each of several statements, with tables that have the same bit widths as far as possible. The plans of a
/// unit with one datapath can then share the hardware of a table.
///
/// # Errors
/// Fails if a statement has no plan that keeps the allowed errors. The failure has the number of the statement.
pub(super) fn find_set(
    statements: &[ExpressionStatement],
) -> Result<Vec<ProvedPlan>, (usize, PlanRefusal)> {
    let mut functions: Vec<TargetFunction> = Vec::new();
    for (number, statement) in statements.iter().enumerate() {
        let search = PlanSearch::new(statement, TableRule::Cheapest);
        let style = PlanStyle { shares_table: true, table_error: 0.96, ..FIRST_STYLE };
        let estimate = allocated(&search, style).map_err(|refusal| (number, refusal))?;
        for approximation in estimate.plan.approximations() {
            functions.push(approximation.function.clone());
        }
    }
    let rule = shared_widths(&functions).map_or(TableRule::Cheapest, TableRule::Shared);
    let mut plans = Vec::new();
    for (number, statement) in statements.iter().enumerate() {
        let plan = find_with(&PlanSearch::new(statement, rule.clone()));
        plans.push(plan.map_err(|refusal| (number, refusal))?);
    }
    Ok(plans)
}

/// Returns the widths with which the tables of the functions are smallest by the estimate. A function without polynomials of so
/// few segments counts with a table of its own. Returns `None` if no function has such polynomials.
fn shared_widths(functions: &[TargetFunction]) -> Option<SharedWidths> {
    let functions: Vec<&TargetFunction> = functions.iter().collect();
    let mut best: Option<(f64, SharedWidths)> = None;
    for prefix in PREFIXES {
        let widths = glint_approximate::widths_with_prefix(&functions, prefix);
        let found: Vec<SharedWidths> = widths.into_iter().flatten().collect();
        let count = found.len();
        let Some(all) = found.into_iter().reduce(|a, b| a.max(&b)) else { continue };
        // One more bit lets nearly every function have coefficients of the widths that the others need.
        let all = all.with_guard(1).with_equal_offsets();
        let word: i32 = all.guard.iter().map(|guard| guard + WIDTH_WITHOUT_GUARD).sum();
        let pages = f64::from(1u32 << prefix) * count as f64;
        let own_tables = (functions.len() - count) as f64 * CELLS_OF_OWN_TABLE;
        let cells = pages * f64::from(word) / BITS_OF_CELL + own_tables;
        if best.as_ref().is_none_or(|(least, _)| cells < *least) {
            best = Some((cells, all));
        }
    }
    best.map(|(_, widths)| widths)
}

fn find_with(search: &PlanSearch<'_>) -> Result<ProvedPlan, PlanRefusal> {
    let statement = search.statement;
    let PlanCandidate { plan: whole, divisions, .. } = smallest_candidate(search)?;
    let (plan, renumbered) = whole.with_reductions()?;
    check_multiplier(&plan)?;
    let enclosed = enclosed_errors(statement, &whole, divisions.max(DIVISIONS))?;
    let mut bounds = enclosed.clone();
    let mut proof = ProofKind::Enclosed;
    if statement.combinations() <= 1 << MOST_COMBINATIONS {
        proof = ProofKind::EveryCombination;
        let largest = largest_errors(statement, &plan)?;
        check_agreement(statement, &enclosed, &largest)?;
        for (bound, largest) in bounds.iter_mut().zip(largest) {
            *bound = bound.min(largest);
        }
    } else {
        check_agreement(statement, &enclosed, &sampled_errors(statement, &plan, SAMPLES))?;
    }
    let mut shares = Vec::new();
    for of_result in error_shares(statement, &whole, divisions) {
        let mut of_nodes = vec![0.0; plan.nodes().len()];
        for (at, share) in of_result.iter().enumerate() {
            of_nodes[rounding_node(&plan, &renumbered, at).0] += share;
        }
        shares.push(of_nodes);
    }
    let statement = statement.clone();
    Ok(ProvedPlan {
        statement,
        plan,
        whole_functions: whole,
        bounds,
        enclosed,
        shares,
        proof,
        ordered: Vec::new(),
    })
}

/// Checks that no combination of operands has an error above the bound of the proof by intervals. `largest` has the largest error of
/// each result that was found. Fails if a rewriting of a formula or a rule of the proof is wrong.
fn check_agreement(
    statement: &ExpressionStatement,
    bounds: &[f64],
    largest: &[f64],
) -> Result<(), PlanRefusal> {
    for (number, (bound, largest)) in bounds.iter().zip(largest).enumerate() {
        if *largest > *bound + EVALUATION_ERROR {
            let name = &statement.results[number].name;
            let message = format!(
                "the two proofs of the error of `{name}` disagree: by intervals it is at most {bound:.4} units, and a \
                 combination of operands has {largest:.4}"
            );
            let remedy =
                "this is a fault of Glint: please report the formula, and write it in another way";
            return Err(PlanRefusal::new(message, remedy).of_result(number));
        }
    }
    Ok(())
}

/// Checks that one multiplier can compute all products of a plan. Fails if a product would have more bits than a net; the refusal
/// concerns the first result that reads the widest product.
fn check_multiplier(plan: &ExpressionPlan) -> Result<(), PlanRefusal> {
    let [first, second] = plan.multiplier_widths();
    let width = first + second;
    if width <= MAX_WIDTH {
        return Ok(());
    }
    let message = match plan.count_products() {
        1 => format!("the product would have {width} bits with its sign, more than {MAX_WIDTH}"),
        _ => format!(
            "one multiplier for all products would have {width} bits, more than {MAX_WIDTH}"
        ),
    };
    let remedy = "give the operands fewer bits, or the results fewer fraction bits";
    let refusal = PlanRefusal::new(message, remedy);
    let is_product = |id: &usize| matches!(plan.nodes()[*id].operation, Operation::Multiply(..));
    let products = (0..plan.nodes().len()).filter(is_product);
    let Some(widest) = products.max_by_key(|id| plan.nodes()[*id].format.width()) else {
        return Err(refusal);
    };
    let reader = (0..plan.results().len()).find(|result| plan.needed_for(*result)[widest]);
    Err(match reader {
        Some(result) => refusal.of_result(result),
        None => refusal,
    })
}

/// Returns the node of `plan` that has the rounding error of node number `at` of the plan without range reductions. This node
/// is the table of a function with a range reduction, and otherwise the node itself. `renumbered` has the new index of each
/// node.
fn rounding_node(plan: &ExpressionPlan, renumbered: &[NodeId], at: usize) -> NodeId {
    let first = if at == 0 { 0 } else { renumbered[at - 1].0 + 1 };
    let is_table =
        |node: &usize| matches!(plan.nodes()[*node].operation, Operation::Polynomial(..));
    match (first..=renumbered[at].0).find(is_table) {
        Some(table) => NodeId(table),
        None => renumbered[at],
    }
}

/// Returns the plan with the fewest look-up tables by the estimate, among the plans of all styles. A style that keeps functions
/// is tried only if a formula has a function of an operand. The best style is also tried with reciprocals of divisors where they may be
/// smaller ([`fewest_dividends`]).
///
/// # Errors
/// Fails if no style has a plan, with the refusal of the first style.
fn smallest_candidate(search: &PlanSearch<'_>) -> Result<PlanCandidate, PlanRefusal> {
    let statement = search.statement;
    let mut smallest: Option<(f64, PlanStyle, PlanCandidate)> = None;
    let mut first_refusal = None;
    // A single table with a range reduction has steps of its own, which a unit cannot share.
    let may_keep_functions = matches!(search.tables, TableRule::Cheapest);
    let has_functions = may_keep_functions && has_functions_of_operands(statement);
    let is_short = statement.combinations() <= FEW_COMBINATIONS;
    let mut styles = STYLES;
    if is_short {
        // A single table of few operands is found soon, and is often smaller than the rest of another plan.
        styles.sort_by_key(|style| !style.keeps_functions);
    }
    let shares_table = matches!(search.tables, TableRule::Shared(_));
    for style in styles {
        if style.keeps_functions && !has_functions {
            continue;
        }
        let style = PlanStyle { shares_table, ..style };
        let most_cells = smallest.as_ref().filter(|_| is_short).map(|(cells, ..)| *cells);
        let candidate = match candidate_below(search, style, most_cells) {
            Ok(Some(candidate)) => candidate,
            Ok(None) => continue,
            Err(refusal) => {
                first_refusal.get_or_insert(refusal);
                continue;
            }
        };
        let cells = candidate.plan.total_cells();
        let has_long_table = has_long_table(&candidate.plan);
        let is_smaller = |(least, best, _): &(f64, PlanStyle, PlanCandidate)| {
            cells < *least || cells == *least && best.keeps_functions
        };
        if smallest.as_ref().is_none_or(is_smaller) {
            smallest = Some((cells, style, candidate));
        }
        if has_long_table {
            // Each search of such a table takes seconds, and the other styles would save few look-up tables.
            break;
        }
    }
    let best_style = smallest.as_ref().map_or(FIRST_STYLE, |(_, style, _)| *style);
    let fewest_dividends = fewest_dividends(statement);
    let has_terms = smallest.as_ref().is_some_and(|(.., best)| best.has_terms);
    let by_dividends = fewest_dividends
        .map(|fewest_dividends| (CLEARLY_FEWER, PlanStyle { fewest_dividends, ..best_style }));
    let by_terms = has_terms.then_some((1.0, PlanStyle { cuts_terms_early: true, ..best_style }));
    for (share, style) in by_dividends.into_iter().chain(by_terms) {
        keep_smaller(search, &mut smallest, style, share);
    }
    if let Some((_, style, best)) = &smallest
        && !best.plan.wide_factors().is_empty()
    {
        let style = PlanStyle { narrows_factors: true, ..*style };
        keep_smaller(search, &mut smallest, style, 1.0);
    }
    match (smallest, first_refusal) {
        (Some((_, _, candidate)), _) => Ok(candidate),
        (None, Some(refusal)) => Err(refusal),
        (None, None) => unreachable!("there are styles to try"),
    }
}

/// Replaces the plan `smallest` by a plan in the style `style`, if this takes fewer look-up tables than `share` times `smallest`.
fn keep_smaller(
    search: &PlanSearch<'_>,
    smallest: &mut Option<(f64, PlanStyle, PlanCandidate)>,
    style: PlanStyle,
    share: f64,
) {
    let Ok(candidate) = candidate_with(search, style) else { return };
    let cells = candidate.plan.total_cells();
    if smallest.as_ref().is_none_or(|(least, ..)| cells < share * least) {
        *smallest = Some((cells, style, candidate));
    }
}

/// Returns whether a table of the plan has so many operands that the planner searches it only once.
fn has_long_table(plan: &ExpressionPlan) -> bool {
    plan.approximations().iter().any(|approximation| {
        let (first, last) = approximation.function.domain;
        last.abs_diff(first) >= LONG_DOMAIN
    })
}

/// Returns a plan in the style `style` that has polynomials and keeps the allowed errors, as far as some divisions of the domain
/// show. Fails if the style has no such plan.
fn candidate_with(search: &PlanSearch<'_>, style: PlanStyle) -> Result<PlanCandidate, PlanRefusal> {
    let candidate = candidate_below(search, style, None)?;
    Ok(candidate.expect("a plan of any size"))
}

/// Returns the plan of [`candidate_with`]. With a limit `most_cells`, returns `None` if the plan has more look-up tables even
/// without polynomials, or if the search of its polynomials would take seconds.
fn candidate_below(
    search: &PlanSearch<'_>,
    style: PlanStyle,
    most_cells: Option<f64>,
) -> Result<Option<PlanCandidate>, PlanRefusal> {
    let Allocation { mut guards, plan: estimate, divisions, mut searches, has_terms } =
        allocated(search, style)?;
    if most_cells.is_some_and(|most| estimate.total_cells() > most || has_long_table(&estimate)) {
        return Ok(None);
    }
    let statement = search.statement;
    let mut plan = with_polynomials(search, &guards, estimate)?;
    // The polynomials can have other formats than estimated, and then other errors.
    for _ in 0..MOST_CORRECTIONS {
        let excess = largest_excess(statement, &plan, divisions, &mut searches);
        let Some(excess) = excess else {
            return Ok(Some(PlanCandidate { plan, divisions, has_terms }));
        };
        let source = excess.source(statement, &plan, &guards, BitOrder::UnknownShares)?;
        for sibling in siblings_of(search, &plan, source) {
            guards.add_bit(sibling);
        }
        let estimate = lowered(search, &guards, 0, &FoundPolynomials::default())?.plan;
        plan = with_polynomials(search, &guards, estimate)?;
    }
    match largest_excess(statement, &plan, divisions, &mut searches) {
        Some(excess) => Err(excess.refusal(statement, &plan)),
        None => Ok(Some(PlanCandidate { plan, divisions, has_terms })),
    }
}

/// Returns the plan with polynomials for all of its functions. Fails if a function has no polynomials, or if the plan cannot be
/// rebuilt with the polynomials.
///
/// Polynomials may have results of another width than estimated. A function that reads them then has another operand. The plan
/// is therefore rebuilt until each function has polynomials that were found for exactly this function.
fn with_polynomials(
    search: &PlanSearch<'_>,
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
            found.insert(function, polynomials_by(search, function)?);
        }
        if is_complete {
            return Ok(plan);
        }
        plan = lowered(search, guards, 0, &found)?.plan;
    }
}

/// Returns the polynomials of a function by the rule of a search. Fails if the function has no polynomials.
fn polynomials_by(
    search: &PlanSearch<'_>,
    function: &TargetFunction,
) -> Result<Arc<Piecewise>, PlanRefusal> {
    if let TableRule::Shared(widths) = &search.tables {
        // A steep function may take several pages of the shared table.
        for prefix in widths.prefix..=widths.prefix + MOST_PAGE_BITS {
            let own = SharedWidths { prefix, ..widths.clone() };
            if let Ok(found) = glint_approximate::find_with_widths(function, &own) {
                return Ok(Arc::new(found));
            }
        }
    }
    search.polynomials.found(function, |function| cheapest_polynomials(function, search.memory))
}

/// Returns the polynomials of a function with the lowest estimated cost in a pipeline, among degrees 1, 2 and 3 and the range
/// reductions. If none of these exists, returns the polynomials that [`glint_approximate::find`] chooses. Fails if the function
/// has no polynomials.
fn cheapest_polynomials(
    function: &TargetFunction,
    memory: TableMemory,
) -> Result<Arc<Piecewise>, PlanRefusal> {
    let mut wishes = Vec::new();
    // Degree 2 is often the cheapest, and its cost ends the search of the others early.
    for degree in [2, 3, 1] {
        wishes.push(Wish { degree: Some(degree), ..Wish::default() });
    }
    if memory == TableMemory::Block {
        // Octaves would save bits of the memory, and cost look-up tables.
        for degree in [1, 2] {
            let layout = Some(Layout::Uniform);
            wishes.push(Wish { degree: Some(degree), layout, ..Wish::default() });
        }
    }
    for identity in IDENTITIES {
        wishes.push(Wish { identity, ..Wish::default() });
    }
    let mut cheapest: Option<(f64, Arc<Piecewise>)> = None;
    for wish in wishes {
        // A block memory costs less than the look-up tables with the same bits.
        let is_limited = memory == TableMemory::Logic;
        let cheapest_so_far = cheapest.as_ref().filter(|_| is_limited);
        let most_cells = cheapest_so_far.map(|(least, _)| least.ceil() as u32);
        let wish = Wish { least_words: FULL_CELL, most_cells, ..wish };
        let Ok(found) = glint_approximate::find(function, wish) else { continue };
        let cost = cells_of_function(function, &found, memory);
        if cheapest.as_ref().is_none_or(|(least, _)| cost < *least) {
            cheapest = Some((cost, found));
        }
    }
    if let Some((_, found)) = cheapest {
        return Ok(found);
    }
    glint_approximate::find(function, Wish::default()).map_err(|refusal| {
        let remedy = match refusal.kind {
            RefusalKind::NoValue => {
                "exclude such operands with `where`, or with the domains of the operands"
            }
            _ => "give the operands or the results fewer fraction bits, or allow a larger error",
        };
        PlanRefusal::new(refusal.message, remedy)
    })
}

/// Returns the share that each node of `plan` has in the error of each result, by result and node, in units of the result's
/// last bit.
fn error_shares(
    statement: &ExpressionStatement,
    plan: &ExpressionPlan,
    divisions: usize,
) -> Vec<Vec<f64>> {
    let mut shares = Vec::new();
    for result in 0..statement.results.len() {
        let proof = ResultProof::new(statement, plan, result);
        let mut of_result = vec![0.0; plan.nodes().len()];
        if let Some(worst) = proof.worst(0.0, divisions) {
            // The rounding of the result itself has no source, and is a part of every share.
            let own = proof.share(&worst.limits, NO_SOURCE);
            let mut counted = HashSet::new();
            for (node, share) in plan.nodes().iter().zip(&mut of_result) {
                // A table and the shift behind it can be one rounding operation, which counts at the table.
                if let Some(source) = node.source
                    && counted.insert(source)
                {
                    *share = (proof.share(&worst.limits, source) - own).max(0.0);
                }
            }
            of_result[plan.proved()[result].0] += own;
        }
        shares.push(of_result);
    }
    shares
}

/// Returns a proven error bound for each result, in units of its last bit, after `divisions` divisions of the domain. Fails if
/// a bound is not below the allowed error.
pub(super) fn enclosed_errors(
    statement: &ExpressionStatement,
    plan: &ExpressionPlan,
    divisions: usize,
) -> Result<Vec<f64>, PlanRefusal> {
    let mut bounds = Vec::new();
    for (result, stated) in statement.results.iter().enumerate() {
        let proof = ResultProof::new(statement, plan, result);
        let Some(worst) = proof.worst(0.0, divisions) else {
            // The result is promised for no operands.
            bounds.push(0.0);
            continue;
        };
        if !stated.allows(worst.units) {
            let message = format!(
                "the error of `{}` {} for {}",
                stated.name,
                worst.words(plan),
                statement.place(&worst.limits, &statement.operands_of(result))
            );
            let remedy = match worst.units.is_finite() {
                true => "allow a larger error",
                false => "exclude these operands with `where`, or with the domains of the operands",
            };
            return Err(PlanRefusal::new(message, remedy).of_result(result));
        }
        bounds.push(worst.units);
    }
    Ok(bounds)
}

//! Distributes the allowed error of an expression among the rounding operations of its plan.
//!
//! Rounding operations begin with few guard bits: fraction bits beyond the result with the most fraction bits. While a result
//! exceeds its allowed error, the operation with the largest share of this error gets one more bit. If this finds no plan, all
//! operations get the same number of guard bits. Finally, bits that the allowed errors do not need are removed.

use super::boxes::{BoxError, ErrorSearches, ResultProof, undivided};
use super::lower::{FoundPolynomials, Guards, PlanSearch, PlanStyle, WidthTies, lowered};
use super::plan::ExpressionPlan;
use super::refusal::PlanRefusal;
use super::statement::{ExpressionStatement, HALF_A_UNIT};

/// The guard bits with which each operation begins.
const FIRST_GUARD: i32 = -3;

/// The largest number of guard bits with which all operations begin, if formulas have no plan with fewer.
const MOST_FIRST_GUARD: i32 = 9;

/// The largest number of guard bits of an operation.
const MOST_GUARD: i32 = 24;

/// The most guard bits that one operation gets if another operation loses one.
const MOST_EXCHANGED: usize = 2;

/// The numbers of divisions of the domain for an estimate of the error, in the order in which they are tried. Few divisions are
/// faster. With more divisions, the operands for which rounding can make a decision wrong are confined to smaller boxes.
const DIVISIONS: [usize; 2] = [400, 1500];

/// The guard bits of a plan's operations with which every result keeps its allowed error.
pub(super) struct Allocation {
    pub(super) guards: Guards,
    /// The plan with these guard bits. The errors of its polynomials are estimates.
    pub(super) plan: ExpressionPlan,
    /// The number of divisions of the domain with which the errors were computed.
    pub(super) divisions: usize,
    /// The boxes of operands with which the errors were computed.
    pub(super) searches: ErrorSearches,
    /// Whether low bits of products can be dropped in front of sums and comparisons.
    pub(super) has_terms: bool,
}

/// Returns guard bits for a plan in the style `style` with which every result keeps its allowed error, and this plan. Its tables
/// have no polynomials yet, so that their errors are estimates.
///
/// # Errors
/// Fails if a formula has no plan in this style, or if no number of bits keeps the errors.
pub(super) fn allocated(
    search: &PlanSearch<'_>,
    style: PlanStyle,
) -> Result<Allocation, PlanRefusal> {
    let [few, many] = DIVISIONS;
    let none = Guards::new(style);
    allocated_with(search, &none, few).or_else(|_| allocated_with(search, &none, many))
}

/// Returns guard bits and their plan for [`allocated`], with errors that are estimated by `divisions` divisions of the domain.
/// `none` has the style of the plan and no guard bits. Fails if a formula has no plan, or if no number of bits keeps the errors.
fn allocated_with(
    search: &PlanSearch<'_>,
    none: &Guards,
    divisions: usize,
) -> Result<Allocation, PlanRefusal> {
    let mut searches = undivided(search.statement);
    let by_known = grown(search, none, divisions, &mut searches, BitOrder::KnownShares);
    let (guards, plan) = match by_known {
        Ok(enough) => enough,
        Err(refusal) => grown(search, none, divisions, &mut searches, BitOrder::UnknownShares)
            .ok()
            .or_else(|| equally_many(search, none, divisions, &mut searches))
            .ok_or(refusal)?,
    };
    let terms = lowered(search, &guards, FIRST_GUARD, &FoundPolynomials::default())?.terms;
    let mut is_kept = |guards: &mut Guards| -> Option<ExpressionPlan> {
        let candidate = with_guards(search, guards, FIRST_GUARD).ok()?;
        let excess = largest_excess(search.statement, &candidate, divisions, &mut searches);
        excess.is_none().then_some(candidate)
    };
    let has_terms = !terms.is_empty();
    let mut best = (guards, plan);
    for source in 0..best.0.bits.len() {
        let siblings = siblings_of(search, &best.1, source);
        let is_first = siblings.first().is_none_or(|first| *first >= source);
        if is_first && !terms.contains(&source) {
            shrink(&mut best, &siblings, &mut is_kept);
        }
    }
    if none.style.narrows_factors {
        narrow_factors(search, &mut best, &mut is_kept);
    }
    if has_terms && !none.style.cuts_terms_early {
        cut_alike(&mut best, &terms, &mut is_kept);
    }
    if search.ties == WidthTies::Alike {
        shrink(&mut best, &terms, &mut is_kept);
    } else {
        for term in terms {
            shrink(&mut best, &[term], &mut is_kept);
        }
    }
    let (guards, plan) = best;
    Ok(Allocation { guards, plan, divisions, searches, has_terms })
}

/// Guard bits that keep the allowed errors, and their plan.
type KeptBits = (Guards, ExpressionPlan);

/// Removes guard bits from the operations `sources` of `best`, one from each at a time, while every result keeps its allowed
/// error. `is_kept` returns the plan with the given guard bits, or `None` if a result exceeds its error.
fn shrink(
    best: &mut KeptBits,
    sources: &[usize],
    is_kept: &mut dyn FnMut(&mut Guards) -> Option<ExpressionPlan>,
) {
    let can_shrink = |guards: &Guards| sources.iter().any(|it| guards.bits[*it] > FIRST_GUARD);
    while can_shrink(&best.0) {
        let mut fewer = best.0.clone();
        for source in sources {
            fewer.bits[*source] = (fewer.bits[*source] - 1).max(FIRST_GUARD);
        }
        let Some(plan) = is_kept(&mut fewer) else { return };
        *best = (fewer, plan);
    }
}

/// Saves look-up tables at factors that have more bits than a multiplier's input: the factors lose bits, and in exchange other
/// operations get a few. An exchange counts only if the estimate of look-up tables becomes smaller.
fn narrow_factors(
    search: &PlanSearch<'_>,
    best: &mut KeptBits,
    is_kept: &mut dyn FnMut(&mut Guards) -> Option<ExpressionPlan>,
) {
    let mut sources: Vec<usize> = Vec::new();
    for factor in best.1.wide_factors() {
        if let Some(source) = best.1.rounding_before(factor)
            && !sources.contains(&source)
        {
            sources.push(source);
        }
    }
    for source in sources {
        while let Some(smaller) = exchanged(search, best, source, is_kept) {
            *best = smaller;
        }
    }
}

/// Returns guard bits and their plan, which takes fewer look-up tables by the estimate. The operation `source` has one bit less,
/// and another operation up to [`MOST_EXCHANGED`] bits more. Returns `None` if no such exchange keeps the errors.
fn exchanged(
    search: &PlanSearch<'_>,
    best: &KeptBits,
    source: usize,
    is_kept: &mut dyn FnMut(&mut Guards) -> Option<ExpressionPlan>,
) -> Option<KeptBits> {
    let (guards, plan) = best;
    let siblings = siblings_of(search, plan, source);
    if siblings.iter().any(|sibling| guards.bits[*sibling] <= FIRST_GUARD) {
        return None;
    }
    let cells = plan.cells_without_polynomials();
    let mut fewer = guards.clone();
    for sibling in &siblings {
        fewer.bits[*sibling] -= 1;
    }
    for other in 0..guards.bits.len() {
        let others = siblings_of(search, plan, other);
        let is_first = others.first().is_none_or(|first| *first >= other);
        if siblings.contains(&other) || !is_first {
            continue;
        }
        let mut attempt = fewer.clone();
        for _ in 0..MOST_EXCHANGED {
            for sibling in &others {
                attempt.bits[*sibling] = (attempt.bits[*sibling] + 1).min(MOST_GUARD);
            }
            if let Some(plan) = is_kept(&mut attempt) {
                if plan.cells_without_polynomials() < cells {
                    return Some((attempt, plan));
                }
                break;
            }
        }
    }
    None
}

/// Gives the operations `terms`, which drop low bits of products, the same number of guard bits: the smallest that keeps the
/// errors.
fn cut_alike(
    best: &mut KeptBits,
    terms: &[usize],
    is_kept: &mut dyn FnMut(&mut Guards) -> Option<ExpressionPlan>,
) {
    let (mut least, mut most) = (FIRST_GUARD, MOST_GUARD);
    while least < most {
        let middle = (least + most).div_euclid(2);
        let mut fewer = best.0.clone();
        for term in terms {
            fewer.bits[*term] = middle;
        }
        match is_kept(&mut fewer) {
            Some(plan) => {
                *best = (fewer, plan);
                most = middle;
            }
            None => least = middle + 1,
        }
    }
}

/// The order in which rounding operations get bits, if the analysis finds no limit for the shares of some operations in the
/// error.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum BitOrder {
    /// The operation with the largest known share. Operations with unknown shares get bits when all others have the most bits.
    KnownShares,
    /// An operation with an unknown share, while the known shares together are less than half of the error. For example, the quotient in
    /// `(ln(s / k) + v) / v` needs its bits first.
    UnknownShares,
}

/// Returns guard bits with which every result keeps its allowed error, and their plan. The function begins with few bits, and
/// adds one at a time to the operation that causes most of the error, by `order`. Fails if a formula has no plan, or if no number
/// of bits keeps the errors.
fn grown(
    search: &PlanSearch<'_>,
    none: &Guards,
    divisions: usize,
    searches: &mut ErrorSearches,
    order: BitOrder,
) -> Result<(Guards, ExpressionPlan), PlanRefusal> {
    let (mut guards, mut plan) = first_plan(search, none)?;
    let statement = search.statement;
    while let Some(excess) = largest_excess(statement, &plan, divisions, searches) {
        let source = excess.source(statement, &plan, &guards, order)?;
        for sibling in siblings_of(search, &plan, source) {
            guards.add_bit(sibling);
        }
        plan = with_guards(search, &mut guards, FIRST_GUARD)
            .or_else(|_| with_idle_operations(search, &plan, &mut guards))
            .map_err(|_| excess.refusal(statement, &plan))?;
    }
    Ok((guards, plan))
}

/// Returns a plan for `guards`, although the formulas have none because one more bit made a value too wide. The function gives
/// more bits, in `guards`, to operations that round nothing in the plan `before`. For example, the operand of a table is
/// shortened only if it has too many bits. Fails if no number of bits gives a plan.
fn with_idle_operations(
    search: &PlanSearch<'_>,
    before: &ExpressionPlan,
    guards: &mut Guards,
) -> Result<ExpressionPlan, PlanRefusal> {
    let rounds = |source: usize| before.nodes().iter().any(|node| node.source == Some(source));
    let idle: Vec<usize> = (0..guards.bits.len()).filter(|source| !rounds(*source)).collect();
    let mut more = FIRST_GUARD;
    loop {
        more += 1;
        let mut attempt = guards.clone();
        for source in &idle {
            attempt.bits[*source] = attempt.bits[*source].max(more);
        }
        match with_guards(search, &mut attempt, FIRST_GUARD) {
            Ok(plan) => {
                *guards = attempt;
                return Ok(plan);
            }
            Err(refusal) if more == MOST_GUARD || idle.is_empty() => return Err(refusal),
            Err(_) => {}
        }
    }
}

/// Returns the numbers of the rounding operations that get and lose guard bits together with the operation `source`, in ascending
/// order. They are all operations with its name, such as `exponent` and `exponent2`, or `source` alone if the search ties no
/// widths.
pub(super) fn siblings_of(
    search: &PlanSearch<'_>,
    plan: &ExpressionPlan,
    source: usize,
) -> Vec<usize> {
    let name_of = |source: usize| {
        let node = plan.nodes().iter().find(|node| node.source == Some(source))?;
        Some(node.name.trim_end_matches(|c: char| c.is_ascii_digit()))
    };
    let own = name_of(source);
    if search.ties == WidthTies::None || own.is_none() {
        return vec![source];
    }
    let most = plan.nodes().iter().filter_map(|node| node.source).max().unwrap_or(source);
    (0..=most).filter(|other| name_of(*other) == own).collect()
}

/// Returns the same number of guard bits for all operations, with which every result keeps its allowed error, and their plan.
/// Returns `None` if no number is enough. This can succeed if [`grown`] gives one operation so many bits that a product is too
/// wide.
fn equally_many(
    search: &PlanSearch<'_>,
    none: &Guards,
    divisions: usize,
    searches: &mut ErrorSearches,
) -> Option<(Guards, ExpressionPlan)> {
    for guard in (0..=MOST_FIRST_GUARD).step_by(3) {
        let mut guards = none.clone();
        let Ok(plan) = with_guards(search, &mut guards, guard) else { continue };
        if largest_excess(search.statement, &plan, divisions, searches).is_none() {
            return Some((guards, plan));
        }
    }
    None
}

/// Returns the plan from which a search begins, and its guard bits: the same number for all operations, and the smallest with
/// which there is a plan. With fewer bits, for example, a divisor could be rounded to 0. Fails if no number up to
/// [`MOST_FIRST_GUARD`] gives a plan.
fn first_plan(
    search: &PlanSearch<'_>,
    none: &Guards,
) -> Result<(Guards, ExpressionPlan), PlanRefusal> {
    let mut guards = none.clone();
    let mut refusal = match with_guards(search, &mut guards, FIRST_GUARD) {
        Ok(plan) => return Ok((guards, plan)),
        Err(refusal) => refusal,
    };
    for first in FIRST_GUARD + 1..=MOST_FIRST_GUARD {
        let mut guards = none.clone();
        match with_guards(search, &mut guards, first) {
            Ok(plan) => return Ok((guards, plan)),
            // With very many bits, a part is too wide, and this error would hide the actual reason.
            Err(other) if first <= 0 => refusal = other,
            Err(_) => {}
        }
    }
    Err(refusal)
}

/// Returns the plan with the guard bits `guards`. Operations beyond the end of the list get `first` guard bits, and the
/// function adds these bits to the list. Fails if a formula has no plan with these bits.
fn with_guards(
    search: &PlanSearch<'_>,
    guards: &mut Guards,
    first: i32,
) -> Result<ExpressionPlan, PlanRefusal> {
    loop {
        let lowered = lowered(search, guards, first, &FoundPolynomials::default())?;
        let known = guards.bits.len();
        if lowered.sources <= known {
            return Ok(lowered.plan);
        }
        guards.bits.resize(lowered.sources, first);
        for term in lowered.terms {
            if term >= known && !guards.style.cuts_terms_early {
                // Terms lose bits when all other operations have theirs.
                guards.bits[term] = MOST_GUARD;
            }
        }
    }
}

/// A result whose error exceeds the allowed error.
pub(super) struct ExcessiveResult {
    result: usize,
    /// The box of operands in which the error is largest.
    worst: BoxError,
}

/// Returns the result of `plan` that exceeds its allowed error by the largest factor; `None` if every result keeps its error. The
/// function begins with the boxes in `searches`, from similar plans, and replaces them.
pub(super) fn largest_excess(
    statement: &ExpressionStatement,
    plan: &ExpressionPlan,
    divisions: usize,
    searches: &mut ErrorSearches,
) -> Option<ExcessiveResult> {
    let mut largest: Option<(f64, ExcessiveResult)> = None;
    for (result, stated) in statement.results.iter().enumerate() {
        let proof = ResultProof::new(statement, plan, result);
        let Some(worst) = proof.excess(divisions, &mut searches[result]) else { continue };
        let factor = worst.units / stated.error;
        if largest.as_ref().is_some_and(|(most, _)| *most >= factor) {
            continue;
        }
        largest = Some((factor, ExcessiveResult { result, worst }));
    }
    largest.map(|(_, excess)| excess)
}

impl ExcessiveResult {
    /// Returns the number of the rounding operation that gets the next guard bit: the operation with the largest share of the
    /// error. Operations with [`MOST_GUARD`] guard bits do not count. A share without a limit is unknown if the error has a
    /// limit; `order` decides when its operation counts. Fails if no operation is left.
    pub(super) fn source(
        &self,
        statement: &ExpressionStatement,
        plan: &ExpressionPlan,
        guards: &Guards,
        order: BitOrder,
    ) -> Result<usize, PlanRefusal> {
        let proof = ResultProof::new(statement, plan, self.result);
        let mut largest = (0.0, None);
        let mut fewest_unknown: Option<(i32, usize)> = None;
        let mut known = 0.0;
        for (node, needed) in plan.nodes().iter().zip(&proof.needed) {
            let Some(source) = node.source.filter(|_| *needed) else { continue };
            let guard = guards.bits.get(source).copied().unwrap_or(0);
            if guard >= MOST_GUARD {
                continue;
            }
            let share = proof.share(&self.worst.limits, source);
            if share.is_infinite() && self.worst.units.is_finite() {
                let unknown = (guard, source);
                fewest_unknown = Some(fewest_unknown.map_or(unknown, |it| it.min(unknown)));
                continue;
            }
            known += share;
            if share > largest.0 {
                largest = (share, Some(source));
            }
        }
        let is_known = order == BitOrder::KnownShares || known >= self.worst.units / 2.0;
        let unknown = fewest_unknown.map(|(_, source)| source);
        let source = match is_known {
            true => largest.1.or(unknown),
            false => unknown.or(largest.1),
        };
        source.ok_or_else(|| self.refusal(statement, plan))
    }

    pub(super) fn refusal(
        &self,
        statement: &ExpressionStatement,
        plan: &ExpressionPlan,
    ) -> PlanRefusal {
        let message = format!(
            "the error of `{}` {} for {}, with any widths of the parts",
            statement.results[self.result].name,
            self.worst.words(plan),
            statement.place(&self.worst.limits, &statement.operands_of(self.result))
        );
        let is_nearest = statement.results[self.result].error <= HALF_A_UNIT;
        let remedy = match self.worst.units.is_finite() {
            true if is_nearest => {
                "allow a larger error, such as 0.6: the nearest value, with error = 0.5, is possible only for sqrt(s), hypot, and a / b with a b that varies and is not 0, of sums and products of operands"
            }
            true => "allow a larger error, or exclude these operands with `where`",
            // No error that can be stated is large enough.
            false => "exclude these operands with `where`, or with the domains of the operands",
        };
        PlanRefusal::new(message, remedy).of_result(self.result)
    }
}

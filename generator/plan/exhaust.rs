//! Computes the results of a plan for every combination of operands, and compares them with the formulas. This proves the
//! largest errors; `find` uses it for at most 2^20 combinations.

use glint_base::fixed::exp2;
use glint_formula::Fault;
use rayon::prelude::*;

use super::plan::ExpressionPlan;
use super::refusal::PlanRefusal;
use super::statement::ExpressionStatement;

/// Returns the largest error of each result, in units of its last bit, over every combination of operands for which the result
/// is promised. The error is 0 for a result that is promised for none. The list is empty if the statement has no operands.
///
/// # Errors
/// Fails if a formula has no value for a combination.
pub(super) fn largest_errors(
    statement: &ExpressionStatement,
    plan: &ExpressionPlan,
) -> Result<Vec<f64>, PlanRefusal> {
    let domain = statement.domain();
    let Some((first, rest)) = domain.split_first() else { return Ok(Vec::new()) };
    let none = || vec![0.0; statement.results.len()];
    let larger = |mut all: Vec<f64>, other: Vec<f64>| {
        for (most, other) in all.iter_mut().zip(other) {
            *most = f64::max(*most, other);
        }
        Ok(all)
    };
    (first.0..=first.1)
        .into_par_iter()
        .map(|raw| errors_at(statement, plan, raw, rest))
        .try_reduce(none, larger)
}

/// Returns the largest error of each result, in units of its last bit, over `count` combinations of operands for which the result is
/// promised. Errors at other combinations can be larger. A combination for which a formula has no value is left out.
pub(super) fn sampled_errors(
    statement: &ExpressionStatement,
    plan: &ExpressionPlan,
    count: u64,
) -> Vec<f64> {
    let mut largest = vec![0.0; statement.results.len()];
    for raw in statement.spread_operands(count) {
        let mut errors = largest.clone();
        if add_errors(statement, plan, &raw, &mut errors).is_ok() {
            largest = errors;
        }
    }
    largest
}

/// Returns the largest error of each result over all combinations in which the first operand has the raw value `first`, in
/// units of the result's last bit. `rest` has the domains of the other operands. Fails if a formula has no value for a
/// combination.
fn errors_at(
    statement: &ExpressionStatement,
    plan: &ExpressionPlan,
    first: i64,
    rest: &[(i64, i64)],
) -> Result<Vec<f64>, PlanRefusal> {
    let mut largest = vec![0.0; statement.results.len()];
    let mut raw = vec![first];
    raw.extend(rest.iter().map(|(low, _)| *low));
    loop {
        add_errors(statement, plan, &raw, &mut largest)?;
        // The next combination: the last operand changes fastest.
        let mut at = raw.len();
        loop {
            at -= 1;
            if at == 0 {
                return Ok(largest);
            }
            let (low, high) = rest[at - 1];
            if raw[at] < high {
                raw[at] += 1;
                break;
            }
            raw[at] = low;
        }
    }
}

/// Raises the entries of `largest` to the errors for the raw operands `raw`, if these errors are larger. Fails if a formula has
/// no value for these operands.
fn add_errors(
    statement: &ExpressionStatement,
    plan: &ExpressionPlan,
    raw: &[i64],
    largest: &mut [f64],
) -> Result<(), PlanRefusal> {
    let limits: Vec<(i64, i64)> = raw.iter().map(|raw| (*raw, *raw)).collect();
    let operands = statement.enclosed_operands(&limits);
    let mut values = None;
    for (number, result) in statement.results.iter().enumerate() {
        if result.is_promised(&operands) == Some(false) {
            continue;
        }
        let unit = exp2(result.fraction as i32);
        let exact = result
            .value(&operands, || statement.exact_operands(raw))
            .map_err(|fault| without_value(statement, number, raw, fault))?;
        let values = values.get_or_insert_with(|| plan.values(raw));
        let hardware = values[plan.proved()[number].0] as f64;
        let off = (hardware - exact.low * unit).abs().max((hardware - exact.high * unit).abs());
        // A difference of 0 is exact. Any other difference may have been rounded down.
        let error = if off == 0.0 { 0.0 } else { off.next_up() };
        largest[number] = largest[number].max(error);
    }
    Ok(())
}

/// Makes the refusal for a result whose formula has no value for the raw operands `raw`.
fn without_value(
    statement: &ExpressionStatement,
    result: usize,
    raw: &[i64],
    fault: Fault,
) -> PlanRefusal {
    let limits: Vec<(i64, i64)> = raw.iter().map(|raw| (*raw, *raw)).collect();
    let message = format!(
        "at {}: {}",
        statement.place(&limits, &statement.operands_of(result)),
        fault.message
    );
    let remedy = "exclude these operands with `where`";
    PlanRefusal::new(message, remedy).at(&fault.span).of_result(result)
}

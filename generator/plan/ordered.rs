//! Finds plans whose results have the order of the values that they approximate: the largest of the results of a softmax is then
//! a result of the largest number.
//!
//! The numbers of such a list have one formula with different operands, such as `exp(v0 - m) / s` and `exp(v1 - m) / s` with the
//! common parts m and s. If the formula rises with a number's own operand while the common parts stay constant, the values have
//! the order of these operands. If the same operations compute each number, and each operation keeps this order, the results have
//! it whatever the errors of the common parts are.

mod alike;
mod formulas;
mod nodes;
#[cfg(test)]
mod tests;

use std::ops::Range;
use std::rc::Rc;

use super::find::{ProvedPlan, find_alike, find_stored};
use super::memory::TableMemory;
use super::refusal::PlanRefusal;
use super::statement::{ExpressionStatement, HALF_A_UNIT, StatedOverflow};

/// The direction in which a value changes with a number's own operand, while the parts that all numbers of the list have in common do
/// not change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    /// The value does not depend on the own operand.
    Constant,
    /// The value never falls while the operand rises.
    Rises,
    /// The value never rises while the operand rises.
    Falls,
    Unknown,
}

impl Change {
    fn reversed(self) -> Self {
        match self {
            Self::Rises => Self::Falls,
            Self::Falls => Self::Rises,
            other => other,
        }
    }

    /// Returns the change of a sum, a minimum or a maximum of two values.
    fn with(self, other: Self) -> Self {
        match (self, other) {
            (Self::Constant, change) | (change, Self::Constant) => change,
            (one, two) if one == two => one,
            _ => Self::Unknown,
        }
    }

    /// Returns the change of a product with a value of the given sign, which does not change. The sign is `None` if it is not known.
    fn times(self, is_negative: Option<bool>) -> Self {
        match (self, is_negative) {
            (Self::Constant, _) => Self::Constant,
            (_, None) => Self::Unknown,
            (change, Some(false)) => change,
            (change, Some(true)) => change.reversed(),
        }
    }

    fn is_known(self) -> bool {
        matches!(self, Self::Rises | Self::Falls)
    }
}

/// The number of plans that are tried. Each further plan allows smaller errors, so that the steps of its tables are finer.
const ATTEMPTS: u32 = 5;

/// The factor by which a further plan lowers the allowed errors of an ordered list.
const TIGHTER: f64 = 0.8;

/// Returns the plan for a statement, in which the results of each list have the order of their values: if the value of one number is
/// larger than the value of another, its result is not smaller. `lists` has the indices of the results of each list. `memory` is the memory
/// for the tables.
///
/// # Errors
/// Fails if no plan keeps the allowed errors, or if no plan has this order. Also fails if the formulas of a list are not alike,
/// or do not rise or fall with their own operands.
pub fn find_ordered(
    statement: &ExpressionStatement,
    lists: &[Range<usize>],
    memory: TableMemory,
) -> Result<ProvedPlan, PlanRefusal> {
    if lists.is_empty() {
        return find_stored(statement, memory);
    }
    let mut formulas = Vec::new();
    for list in lists {
        refuse_wrapping(statement, list)?;
        formulas.push(formulas::ordered_list(statement, list)?);
    }
    let mut tightened = statement.clone();
    let mut refusal: Option<PlanRefusal> = None;
    let polynomials = Rc::default();
    for _ in 0..ATTEMPTS {
        let found = find_alike(&tightened, &polynomials, memory)
            .map_err(|own| refusal.clone().unwrap_or(own))?;
        let fault = formulas.iter().find_map(|list| nodes::check_list(&found, list).err());
        let Some(fault) = fault else {
            let statement = statement.clone();
            return Ok(ProvedPlan { statement, ordered: lists.to_vec(), ..found });
        };
        refusal.get_or_insert(fault);
        for list in lists {
            for result in &mut tightened.results[list.clone()] {
                result.error = (result.error * TIGHTER).max(HALF_A_UNIT);
            }
        }
    }
    Err(refusal.expect("a fault of each attempt"))
}

/// Checks that no result of the list wraps. Fails if one does: a value beyond the format would become the smallest result.
fn refuse_wrapping(
    statement: &ExpressionStatement,
    list: &Range<usize>,
) -> Result<(), PlanRefusal> {
    for number in list.clone() {
        let width = statement.results[number].width.as_ref();
        if width.is_some_and(|width| matches!(width.overflow, StatedOverflow::Wrap)) {
            let message = "a result that wraps has no order: the largest value can become the smallest result";
            let remedy = "remove `ordered`, or set overflow = \"saturate\"";
            return Err(PlanRefusal::new(message, remedy).of_result(number));
        }
    }
    Ok(())
}

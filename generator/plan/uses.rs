//! Describes for which operands the value of a part of a formula matters: a result that reads the part is promised, and no choice
//! takes another case.

use std::collections::HashSet;
use std::ptr;

use glint_formula::{Comparison, Expression, Kind};

/// The operands for which the value of a part matters.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PartUses {
    /// For each result, whether it reads the part. The operands count for which one of these results is promised.
    pub(super) readers: Vec<bool>,
    /// Comparisons of operands, each with its outcome. The value does not matter for operands with another outcome, because a
    /// choice (`if`) then takes its other case.
    pub(super) conditions: Vec<(Comparison, bool)>,
}

impl PartUses {
    /// Returns whether a node with the right value for these uses also has the right value for `other`.
    pub(super) fn contain(&self, other: &Self) -> bool {
        let mut readers = self.readers.iter().zip(&other.readers);
        readers.all(|(own, other)| *own || !other)
            && self.conditions.iter().all(|condition| other.conditions.contains(condition))
    }
}

/// Returns whether a formula reads `part` for all operands, and not only in a case of a choice. For example, `if(y > 0, x / y, 0)`
/// reads y for all operands, and `x / y` only for some.
pub(super) fn reads_always(formula: &Expression, part: &Expression) -> bool {
    reads_under(formula, part, &[])
}

/// Returns whether a formula reads `part` in the cases of choices that `conditions` name, and in no case of a further choice. For example,
/// `if(y > 0, x / y, 0)` reads `x / y` under the condition that y > 0 is true.
pub(super) fn reads_under(
    formula: &Expression,
    part: &Expression,
    conditions: &[(Comparison, bool)],
) -> bool {
    reads_unseen(&mut HashSet::new(), formula, part, conditions)
}

/// Returns the outcome of [`reads_under`], but searches no subformula twice, because several operations may share it. `seen` has
/// the address of each searched subformula, with the number of conditions that were left. If one comes again, the result is
/// false: a search that finds `part` ends at once, so the earlier one found nothing.
fn reads_unseen(
    seen: &mut HashSet<(*const Expression, usize)>,
    formula: &Expression,
    part: &Expression,
    conditions: &[(Comparison, bool)],
) -> bool {
    if conditions.is_empty() && formula == part {
        return true;
    }
    if !seen.insert((ptr::from_ref(formula), conditions.len())) {
        return false;
    }
    let Kind::If(comparison, yes, no) = &formula.kind else {
        let mut inner = formula.parts().into_iter();
        return inner.any(|inner| reads_unseen(seen, inner, part, conditions));
    };
    let mut compared = [&comparison.left, &comparison.right].into_iter();
    if compared.any(|side| reads_unseen(seen, side, part, conditions)) {
        return true;
    }
    let [(first, outcome), rest @ ..] = conditions else { return false };
    let case = if *outcome { yes } else { no };
    first == comparison && reads_unseen(seen, case, part, rest)
}

//! Defines the operands for which the value of a part of a formula matters: those for which some results are promised, and for
//! which no choice takes its other case.

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
    /// Returns whether a node that has the right value for these uses has it for `other`, too.
    pub(super) fn contain(&self, other: &Self) -> bool {
        let mut readers = self.readers.iter().zip(&other.readers);
        readers.all(|(own, other)| *own || !other)
            && self.conditions.iter().all(|condition| other.conditions.contains(condition))
    }
}

/// Returns whether a formula reads `part` for all operands, and not only in a case of a choice. For example, `if(y > 0, x / y, 0)`
/// reads y for all operands, and `x / y` only for some.
pub(super) fn reads_always(formula: &Expression, part: &Expression) -> bool {
    reads_unseen(&mut HashSet::new(), formula, part)
}

/// Returns what [`reads_always`] does. The result for a part in `seen`, which several operations may share, is false: the part was
/// searched before.
fn reads_unseen(
    seen: &mut HashSet<*const Expression>,
    formula: &Expression,
    part: &Expression,
) -> bool {
    if formula == part {
        return true;
    }
    if !seen.insert(ptr::from_ref(formula)) {
        return false;
    }
    let inner = match &formula.kind {
        Kind::If(comparison, ..) => vec![&*comparison.left, &*comparison.right],
        _ => formula.parts(),
    };
    inner.into_iter().any(|inner| reads_unseen(seen, inner, part))
}

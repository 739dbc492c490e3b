//! Defines the operands for which the value of a part of a formula matters: those for which some results are promised, and for
//! which no choice takes its other case.

use glint_formula::Comparison;

/// The operands for which the value of a part matters.
#[derive(Clone, Debug, Default)]
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

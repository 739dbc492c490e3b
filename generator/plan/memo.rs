//! Remembers values that depend on a formula. The planner rewrites the same formulas for every choice of widths, and most of what it
//! computes about a formula does not depend on the widths.

use std::cell::RefCell;
use std::collections::HashMap;

use glint_formula::Expression;

/// Values that were computed for a formula and a key. For example, the key of a part's interval is the set of operands for which the
/// part matters.
pub(super) struct FormulaMemo<K, V> {
    /// The entries by the digest of their formula.
    known: RefCell<HashMap<u64, Vec<MemoEntry<K, V>>>>,
}

struct MemoEntry<K, V> {
    formula: Expression,
    key: K,
    value: V,
}

impl<K, V> Default for FormulaMemo<K, V> {
    fn default() -> Self {
        Self { known: RefCell::default() }
    }
}

impl<K: Clone + PartialEq, V: Clone> FormulaMemo<K, V> {
    /// Returns the value for this formula and this key. `compute` is called if no earlier call had the same.
    pub(super) fn value(&self, formula: &Expression, key: &K, compute: impl FnOnce() -> V) -> V {
        let digest = formula.digest();
        if let Some(entries) = self.known.borrow().get(&digest) {
            let is_same = |entry: &&MemoEntry<K, V>| entry.key == *key && entry.formula == *formula;
            if let Some(entry) = entries.iter().find(is_same) {
                return entry.value.clone();
            }
        }
        let value = compute();
        let entry = MemoEntry { formula: formula.clone(), key: key.clone(), value: value.clone() };
        self.known.borrow_mut().entry(digest).or_default().push(entry);
        value
    }
}

//! Searches graphs for the nodes on which given nodes depend, and for the nodes that can be reached from given nodes.

use std::collections::HashSet;
use std::hash::Hash;

/// Marks the nodes on which any of the `roots` depends, and the roots themselves, among `count` nodes. A node must have a higher
/// number than its operands, which `operands` returns. For example, with y = a + b, the root y marks y, a and b.
pub fn needed<I: IntoIterator<Item = usize>>(
    count: usize,
    roots: impl IntoIterator<Item = usize>,
    operands: impl Fn(usize) -> I,
) -> Vec<bool> {
    let mut needed = vec![false; count];
    roots.into_iter().for_each(|root| needed[root] = true);
    for at in (0..count).rev() {
        if needed[at] {
            operands(at).into_iter().for_each(|operand| needed[operand] = true);
        }
    }
    needed
}

/// Returns all nodes that can be reached in zero or more steps from the nodes `from`. `steps` returns the nodes one step from a
/// node.
pub fn reached<T: Copy + Eq + Hash, I: IntoIterator<Item = T>>(
    from: impl IntoIterator<Item = T>,
    steps: impl Fn(T) -> I,
) -> HashSet<T> {
    let mut reached = HashSet::new();
    let mut pending: Vec<T> = from.into_iter().collect();
    while let Some(at) = pending.pop() {
        if reached.insert(at) {
            pending.extend(steps(at));
        }
    }
    reached
}

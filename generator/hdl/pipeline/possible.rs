//! Finds out whether a condition can ever be 1, by trying all combinations of the bits on which it depends.

use std::collections::{HashMap, HashSet};

use super::graph::{Cell, Graph, NodeId};
use crate::netlist::eval;
use glint_base::fixed::mask;

/// With more bits, there are too many combinations to try.
const MOST_BITS: u32 = 16;

/// The largest width of the leaf of [`count`], so that a list has at most 64 entries.
const MOST_SELECTED: u32 = 6;

/// Returns whether `condition`, a node of one bit, can be 1: `count > 3` can if `count` is a leaf of 3 bits, and cannot if it has
/// 2. Leaves are operands, unknown values, ROM words and the nodes `free`; each may have any value in its range. Returns `None`
/// if `condition` depends on more than 16 bits.
pub fn ever(graph: &Graph, condition: NodeId, free: &[NodeId]) -> Option<bool> {
    let cone = Cone::of(graph, &[condition], free);
    if cone.bits > MOST_BITS {
        return None;
    }
    let mut cases = (0..1u64 << cone.bits).filter_map(|number| cone.values(graph, number));
    Some(cases.any(|values| values[&condition] == [1]))
}

/// Counts the `conditions` that are 1, for each bit pattern of the one leaf on which all of them depend. `None` marks patterns
/// outside the leaf's range. For example, the conditions `count > 0` and `count > 1` give 0, 1, 2 and 2 for a `count` of two
/// bits. Leaves are as in [`ever`].
///
/// Returns `None` if the conditions depend on no leaf or on several, or if the leaf has more than 6 bits.
pub fn count(
    graph: &Graph,
    conditions: &[NodeId],
    free: &[NodeId],
) -> Option<(NodeId, Vec<Option<usize>>)> {
    let cone = Cone::of(graph, conditions, free);
    let [leaf] = cone.leaves[..] else { return None };
    if cone.bits > MOST_SELECTED {
        return None;
    }
    let mut counts = Vec::new();
    for number in 0..1 << cone.bits {
        let values = cone.values(graph, number);
        counts.push(
            values.map(|values| {
                conditions.iter().filter(|condition| values[condition] == [1]).count()
            }),
        );
    }
    Some((leaf, counts))
}

/// The nodes on which some conditions depend.
struct Cone {
    leaves: Vec<NodeId>,
    /// The number of bits of all leaves together.
    bits: u32,
    /// The nodes from the leaves to the conditions, each after its operands.
    inside: Vec<NodeId>,
}

impl Cone {
    /// Searches from `conditions` to the leaves.
    fn of(graph: &Graph, conditions: &[NodeId], free: &[NodeId]) -> Self {
        let free: HashSet<NodeId> = free.iter().copied().collect();
        let (mut seen, mut pending) = (HashSet::new(), conditions.to_vec());
        let (mut leaves, mut inside) = (Vec::new(), Vec::new());
        while let Some(id) = pending.pop() {
            if !seen.insert(id) {
                continue;
            }
            match &graph.node(id).cell {
                Cell::Constant(_) => inside.push(id),
                Cell::Op(op) if !free.contains(&id) => {
                    inside.push(id);
                    pending.extend(op.operands());
                }
                _ => leaves.push(id),
            }
        }
        inside.sort_unstable();
        let bits = leaves.iter().map(|&id| graph.width(id)).sum();
        Self { leaves, bits, inside }
    }

    /// Returns the bit pattern of every node for one combination of leaf values; the first leaf has the lowest bits of `number`.
    /// Returns `None` if a leaf's value is outside its range.
    fn values(&self, graph: &Graph, number: u64) -> Option<HashMap<NodeId, [u64; 1]>> {
        let mut values: HashMap<NodeId, [u64; 1]> = HashMap::new();
        let mut rest = number;
        for &leaf in &self.leaves {
            let (node, width) = (graph.node(leaf), graph.width(leaf));
            let bits = rest & mask(width);
            rest >>= width;
            if !(node.range.0..=node.range.1).contains(&node.format.raw(bits)) {
                return None;
            }
            values.insert(leaf, [bits]);
        }
        for &id in &self.inside {
            let node = graph.node(id);
            let bits = match &node.cell {
                Cell::Op(op) => {
                    let format = |net: NodeId| graph.node(net).format;
                    eval::cell(op, node.format.width(), &format, &|net| &values[&net])
                }
                Cell::Constant(bits) => [*bits],
                _ => unreachable!("leaves are not inside"),
            };
            values.insert(id, bits);
        }
        Some(values)
    }
}

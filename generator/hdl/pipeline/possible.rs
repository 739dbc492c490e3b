//! Decides whether a condition can ever be 1, by trying all combinations of the bits on which it depends.

use std::collections::{HashMap, HashSet};

use super::graph::{Cell, Graph, NodeId};
use crate::netlist::eval;
use glint_base::fixed::mask;

/// The number of bits that a condition may depend on. With more, the combinations cannot all be tried.
const MOST_BITS: u32 = 16;

/// The most bits of a node that selects among a number for each of its values.
const MOST_SELECTED: u32 = 6;

/// Returns whether some values of the leaves make `condition`, one bit, 1. The nodes `free` count as leaves: they may have any
/// value in their range. Returns `None` if `condition` depends on more than 16 bits. For example, `count > 3` can be 1 if `count`
/// is a leaf of 3 bits, and cannot if it has 2.
pub fn ever(graph: &Graph, condition: NodeId, free: &[NodeId]) -> Option<bool> {
    let cone = Cone::of(graph, &[condition], free);
    if cone.bits > MOST_BITS {
        return None;
    }
    let mut cases = (0..1u64 << cone.bits).filter_map(|number| cone.values(graph, number));
    Some(cases.any(|values| values[&condition] == [1]))
}

/// Counts the `conditions` that are 1, for each value of the one node on which all of them depend. This node is a leaf or one of
/// `free`. Returns the node, and for each of its bit patterns the number of conditions that are 1. The number is `None` for a bit
/// pattern that the node never has. Returns `None` if the conditions depend on several nodes, or on a node with too many bits.
///
/// For example, the conditions `count > 0` and `count > 1` give 0, 1, 2 and 2 for a `count` of two bits.
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

/// The nets on which conditions depend.
struct Cone {
    leaves: Vec<NodeId>,
    /// The bits of all leaves.
    bits: u32,
    /// The nodes from the leaves to the conditions, each after its operands.
    inside: Vec<NodeId>,
}

impl Cone {
    /// Finds the nodes on which conditions depend, down to leaves and the nodes `free`.
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

    /// Returns the values of all nodes if `number` gives the bits of the leaves. Returns `None` if a leaf never has
    /// its value.
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

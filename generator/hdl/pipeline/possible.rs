//! Whether a condition can hold at all.

use std::collections::{HashMap, HashSet};

use super::graph::{Cell, Graph};
use crate::hdl::netlist::{NetId, eval};

/// The most bits of which all combinations are tried.
const MOST_BITS: u32 = 16;

/// Whether `condition`, one bit, is ever 1, whatever the nodes `free` and all leaves are; `None` if it
/// depends on too many bits to try them all.
pub fn ever(graph: &Graph, condition: NetId, free: &[NetId]) -> Option<bool> {
    let free: HashSet<NetId> = free.iter().copied().collect();
    let (mut seen, mut pending) = (HashSet::new(), vec![condition]);
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
    let widths: Vec<u32> = leaves.iter().map(|&id| graph.width(id)).collect();
    let bits: u32 = widths.iter().sum();
    if bits > MOST_BITS {
        return None;
    }
    let mut values: HashMap<NetId, [u64; 1]> = HashMap::new();
    for number in 0..1u64 << bits {
        let mut rest = number;
        for (&leaf, &width) in leaves.iter().zip(&widths) {
            values.insert(leaf, [rest & crate::base::fixed::mask(width)]);
            rest >>= width;
        }
        let within = |&id: &NetId| {
            let (node, [bits]) = (graph.node(id), values[&id]);
            (node.range.0..=node.range.1).contains(&node.format.raw(bits))
        };
        if !leaves.iter().all(within) {
            continue;
        }
        for &id in &inside {
            let node = graph.node(id);
            let bits = match &node.cell {
                Cell::Op(op) => {
                    let format = |net: NetId| graph.node(net).format;
                    eval::cell(op, node.format.width(), &format, &|net| &values[&net])
                }
                Cell::Constant(bits) => [*bits],
                _ => unreachable!("leaves are not inside"),
            };
            values.insert(id, bits);
        }
        if values[&condition] == [1] {
            return Some(true);
        }
    }
    Some(false)
}

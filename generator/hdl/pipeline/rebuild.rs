//! Copies a computation into a new graph, and replaces some of its nodes.

use super::graph::{Cell, Graph, Node, NodeId, NodeOp};
use super::unroll::Unrolled;

/// Copies a computation. `replace` gets each combinational cell, with operands in the new graph, and the original node.
/// `replace` returns a substitute in the new graph, or `None` to copy the cell.
pub fn rebuilt(
    unrolled: &Unrolled,
    mut replace: impl FnMut(&mut Graph, &NodeOp, &Node) -> Option<NodeId>,
) -> Unrolled {
    let mut graph = Graph::default();
    let mut place: Vec<NodeId> = Vec::with_capacity(unrolled.graph.nodes.len());
    for node in &unrolled.graph.nodes {
        graph.step = node.step;
        let cell = match &node.cell {
            Cell::Op(op) => Cell::Op(op.map(|operand| place[operand.index()])),
            Cell::Read { rom, address } => {
                Cell::Read { rom: *rom, address: place[address.index()] }
            }
            leaf => leaf.clone(),
        };
        let replaced = match &cell {
            Cell::Op(op) => replace(&mut graph, op, node),
            _ => None,
        };
        let id =
            replaced.unwrap_or_else(|| graph.insert(cell, node.format, node.range, &node.label));
        graph.refine(id, node.range);
        if node.held {
            graph.name_after(id, &node.label);
        }
        place.push(id);
    }
    let mut steps = unrolled.steps.clone();
    for step in &mut steps {
        for (_, node) in &mut step.registers {
            *node = place[node.index()];
        }
    }
    let mut results = unrolled.results.clone();
    for (_, node) in &mut results {
        *node = place[node.index()];
    }
    // A microprogram that dispatches never becomes a pipeline.
    let dispatched = None;
    Unrolled { steps, operands: unrolled.operands.clone(), results, graph, dispatched }
}

//! Merges two limits of a value into one. Two limits follow each other if the computation repeats a step that limits its result.
//!
//! For example, in `over₂ ? most : f(over₁ ? most : x)`, the condition `over₂` tests a bit of the inner choice. The pass merges
//! both choices: the result is `most` if either condition holds, and otherwise `f(x)`.

use super::graph::{Cell, Graph, Label, NodeId, NodeOp};
use glint_base::fixed::Format;

/// Merges a choice between a constant and a value with an earlier such choice inside the value, and returns the new node. Returns
/// `id` if the node is no choice of this kind.
pub fn settled(graph: &mut Graph, id: NodeId) -> NodeId {
    let node = graph.node(id).clone();
    let Some((over, rest, most)) = limit(graph, id) else { return id };
    let over = flag(graph, over);
    let rest = below(graph, rest, over);
    graph.op(NodeOp::Mux { select: over, inputs: vec![rest, most] }, node.format, &node.label)
}

/// Matches `over ? most : rest` with a constant: `over`, `rest` and the constant.
fn limit(graph: &Graph, id: NodeId) -> Option<(NodeId, NodeId, NodeId)> {
    let Cell::Op(NodeOp::Mux { select, inputs }) = &graph.node(id).cell else { return None };
    match inputs[..] {
        [rest, most] if graph.constant_of(most).is_some() => Some((*select, rest, most)),
        _ => None,
    }
}

/// Returns a condition that tests a bit of a choice, rewritten to read the choice's inputs instead.
fn flag(graph: &mut Graph, id: NodeId) -> NodeId {
    let node = graph.node(id).clone();
    let Cell::Op(NodeOp::Slice { of, low }) = node.cell else { return id };
    let Some((over, rest, most)) = limit(graph, of) else { return id };
    if node.format.width() != 1 || graph.constant_of(most).is_none_or(|most| most >> low & 1 == 0) {
        return id;
    }
    let label = Label { named: false, ..node.label };
    let bit = graph.op(NodeOp::Slice { of: rest, low }, Format::BIT, &label);
    either(graph, over, bit, &label)
}

/// Returns whether one of two bits is 1; of bits side by side, whether any is.
fn either(graph: &mut Graph, a: NodeId, b: NodeId, label: &Label) -> NodeId {
    if let (Some((of, low, width)), Some((other, below, 1))) = (run(graph, a), run(graph, b))
        && of == other
        && below + 1 == low
    {
        let format = Format::unsigned(width as i32 + 1, 0);
        let bits = graph.op(NodeOp::Slice { of, low: below }, format, label);
        return graph.op(NodeOp::Any(bits), Format::BIT, label);
    }
    graph.op(NodeOp::Or(a, b), Format::BIT, label)
}

/// Returns the bits that a condition tests for any 1: their net, the lowest bit and the number of bits.
fn run(graph: &Graph, id: NodeId) -> Option<(NodeId, u32, u32)> {
    match graph.node(id).cell {
        Cell::Op(NodeOp::Any(of)) => run(graph, of),
        Cell::Op(NodeOp::Slice { of, low }) => Some((of, low, graph.width(id))),
        _ => None,
    }
}

/// Returns `id` for the case that `over` is 0, looking through wiring. If this implies that the condition of an inner
/// choice is 0 too, the choice is replaced by its value below the limit.
fn below(graph: &mut Graph, id: NodeId, over: NodeId) -> NodeId {
    let node = graph.node(id).clone();
    if let Some((inner, rest, _)) = limit(graph, id) {
        return if follows(graph, over, inner) { below(graph, rest, over) } else { id };
    }
    match node.cell {
        Cell::Op(
            op
            @ (NodeOp::Slice { .. } | NodeOp::Concat(_) | NodeOp::Extend(_) | NodeOp::Relabel(_)),
        ) => {
            let replaced = op.map(|&operand| below(graph, operand, over));
            graph.op(replaced, node.format, &node.label)
        }
        _ => id,
    }
}

/// Returns whether `inner` is 0 wherever `over` is.
fn follows(graph: &Graph, over: NodeId, inner: NodeId) -> bool {
    match (run(graph, over), run(graph, inner)) {
        _ if over == inner => true,
        (Some((of, low, width)), Some((other, from, count))) => {
            of == other && low <= from && from + count <= low + width
        }
        _ => match graph.node(over).cell {
            Cell::Op(NodeOp::Or(a, b)) => follows(graph, a, inner) || follows(graph, b, inner),
            _ => false,
        },
    }
}

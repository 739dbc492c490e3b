//! Merges muxes that limit a value to a constant, when one follows another, as in a computation that repeats a saturating step.
//!
//! For example, in `y = over₁ ? most : x` and `z = over₂ ? most : f(y)`, `f` is wiring, and `over₂` is a bit of `y` that is 1 in
//! `most`. If `over₁` is 1, `over₂` is therefore 1 too. So `z` is `most` if `over₁` or the same bit of `x` is 1, and `f(x)`
//! otherwise: one mux, which does not wait for `y`.

use super::graph::{Cell, Graph, Label, NodeId, NodeOp};
use glint_base::fixed::Format;

/// Returns a node with the value of node `id`. For a mux `over ? most : rest` with a constant `most`, bypasses each mux of this
/// kind in `rest` whose condition [`follows`] from `over`.
pub fn settled(graph: &mut Graph, id: NodeId) -> NodeId {
    let node = graph.node(id).clone();
    let Some((over, rest, most)) = limit(graph, id) else { return id };
    let over = flag(graph, over);
    let rest = below(graph, rest, over);
    graph.op(NodeOp::Mux { select: over, inputs: vec![rest, most] }, node.format, &node.label)
}

/// Matches the form `over ? most : rest` with a constant `most`. Returns `over`, `rest` and `most`.
fn limit(graph: &Graph, id: NodeId) -> Option<(NodeId, NodeId, NodeId)> {
    let Cell::Op(NodeOp::Mux { select, inputs }) = &graph.node(id).cell else { return None };
    match inputs[..] {
        [rest, most] if graph.constant_of(most).is_some() => Some((*select, rest, most)),
        _ => None,
    }
}

/// Rewrites the condition `id` if it is one bit of a mux `over ? most : rest` whose constant `most` has a 1 at this bit. The
/// condition is 1 if `over` or the same bit of `rest` is 1, and so need not wait for the mux.
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

/// Returns a node that is 1 if bit `a` or bit `b` is 1. If `b` is the bit directly below the bits that `a` tests, the node is
/// one [`NodeOp::Any`] of all these bits.
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

/// Returns which bits the condition `id` tests for a 1: the node with the bits, the lowest bit, and their number. `Any` of the
/// bits 4 to 6 of `x` gives `(x, 4, 3)`. Returns `None` for any other condition.
fn run(graph: &Graph, id: NodeId) -> Option<(NodeId, u32, u32)> {
    match graph.node(id).cell {
        Cell::Op(NodeOp::Any(of)) => run(graph, of),
        Cell::Op(NodeOp::Slice { of, low }) => Some((of, low, graph.width(id))),
        _ => None,
    }
}

/// Returns a node that equals `id` whenever `over` is 0. The search passes through wiring to an inner choice between a value and
/// a constant. The value replaces the choice if the condition of this choice [`follows`] from `over`.
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

/// Returns whether the condition `inner` must be 0 whenever the condition `over` is 0.
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

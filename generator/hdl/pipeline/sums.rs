//! Rewrites sums and differences so that they take fewer look-up tables. For example, `a + ~b + 1` becomes `a - b`.
//!
//! If an operand of a sum has zeros in its lowest bits, the lowest bits of the other operand bypass the adder. A choice between a
//! value and a constant moves behind a subtraction from a constant: `7 - (s ? 5 : x)` becomes `s ? 2 : 7 - x`, and a register can
//! make the choice by its reset. Behind a sum with a constant, only a choice that contains another one moves, such as
//! `(s ? 5 : (t ? 9 : x)) + 3`.

use super::graph::{Cell, Graph, Label, NodeId, NodeOp};
use crate::netlist::interval::of_cell;
use glint_base::fixed::Format;
use glint_base::interval::Interval;

/// Returns the node for the cell `op`. In a sum or a difference, low bits that need no carry bypass the adder: the lowest two
/// bits of `x + 4` equal the lowest two of `x`. A sum of `a`, `~b` and the carry 1 becomes `a - b`.
pub fn shortened(
    graph: &mut Graph,
    op: NodeOp,
    format: Format,
    range: Interval,
    label: &Label,
) -> NodeId {
    // A single choice stays in front of an adder. A choice between choices moves behind it.
    let behind = match op {
        NodeOp::Add { a, .. } => choice(graph, a)
            .is_some_and(|(_, inputs)| inputs.iter().any(|&it| choice(graph, it).is_some())),
        _ => true,
    };
    within(graph, op, format, range, label, behind)
}

/// Does the work of [`shortened`]. With `behind`, a choice between a value and a constant moves behind a sum with a constant, or
/// a subtraction from a constant.
fn within(
    graph: &mut Graph,
    op: NodeOp,
    format: Format,
    range: Interval,
    label: &Label,
    behind: bool,
) -> NodeId {
    let op = match op {
        NodeOp::Add { a, b, carry: Some(one) } if graph.constant_of(one) == Some(1) => {
            match (&graph.node(a).cell, &graph.node(b).cell) {
                (_, Cell::Op(NodeOp::Not(b))) => NodeOp::Sub(a, *b),
                (Cell::Op(NodeOp::Not(a)), _) => NodeOp::Sub(b, *a),
                _ => op,
            }
        }
        _ => op,
    };
    if behind && let Some(id) = chosen_behind(graph, &op, format, range, label) {
        return id;
    }
    let width = format.width();
    let (passing, other) = match op {
        NodeOp::Add { a, b, carry: None } if zeros(graph, a) > zeros(graph, b) => (b, a),
        NodeOp::Add { a, b, carry: None } | NodeOp::Sub(a, b) => (a, b),
        _ => return graph.insert(Cell::Op(op), format, range, label),
    };
    let low = zeros(graph, other);
    if low == 0 || low >= width {
        return graph.insert(Cell::Op(op), format, range, label);
    }
    let label_of_part = Label { named: false, ..label.part("upper") };
    let part = Format::unsigned((width - low) as i32, 0);
    let [upper, addend] =
        [passing, other].map(|of| graph.op(NodeOp::Slice { of, low }, part, &label_of_part));
    let upper = match (op, graph.constant_of(addend)) {
        // The constant is 1: its lowest bit is not 0.
        (_, Some(_)) if width - low == 1 => graph.op(NodeOp::Not(upper), part, &label_of_part),
        (NodeOp::Sub(..), _) => graph.op(NodeOp::Sub(upper, addend), part, &label_of_part),
        _ => graph.op(NodeOp::Add { a: upper, b: addend, carry: None }, part, &label_of_part),
    };
    let lower = Format::unsigned(low as i32, 0);
    let lower = graph.op(NodeOp::Slice { of: passing, low: 0 }, lower, &label_of_part);
    graph.insert(Cell::Op(NodeOp::Concat(vec![upper, lower])), format, range, label)
}

/// Moves a choice between a value and a constant behind the sum or difference `op` with another constant: `(s ? 5 : x) + 3`
/// becomes `s ? 8 : x + 3`, and `7 - (s ? 5 : x)` becomes `s ? 2 : 7 - x`. Returns `None` if `op` has another form.
fn chosen_behind(
    graph: &mut Graph,
    op: &NodeOp,
    format: Format,
    range: Interval,
    label: &Label,
) -> Option<NodeId> {
    let (constant, from) = match *op {
        NodeOp::Sub(constant, from) => (constant, from),
        NodeOp::Add { a: from, b: constant, carry: None } => (constant, from),
        _ => return None,
    };
    graph.constant_of(constant)?;
    let (select, inputs) = choice(graph, from)?;
    let same = graph.node(from).format;
    let each = Label { named: false, ..label.part("before") };
    let mut sums = Vec::new();
    for choice in inputs {
        let input = graph.op(NodeOp::Relabel(choice), same, &each);
        let each_op = match op {
            NodeOp::Sub(..) => NodeOp::Sub(constant, input),
            _ => NodeOp::Add { a: input, b: constant, carry: None },
        };
        let range =
            of_cell(&each_op, format, &|id| graph.node(id).format, &|id| graph.node(id).range);
        sums.push(match graph.constant_of(input) {
            Some(_) => graph.op(each_op, format, &each),
            None => within(graph, each_op, format, range, &each, true),
        });
    }
    Some(graph.insert(Cell::Op(NodeOp::Mux { select, inputs: sums }), format, range, label))
}

/// Returns the select and the two inputs if node `id` is a mux between a value and a constant, or renames one.
fn choice(graph: &Graph, id: NodeId) -> Option<(NodeId, Vec<NodeId>)> {
    match &graph.node(id).cell {
        Cell::Op(NodeOp::Relabel(of)) => choice(graph, *of),
        Cell::Op(NodeOp::Mux { select, inputs }) => {
            let constants = inputs.iter().filter(|it| graph.constant_of(**it).is_some()).count();
            (inputs.len() == 2 && constants == 1).then(|| (*select, inputs.clone()))
        }
        _ => None,
    }
}

/// Returns how many of the lowest bits of node `id` are always 0, as far as constants and wiring show it. A value with the
/// constant `00` joined below it has 2.
fn zeros(graph: &Graph, id: NodeId) -> u32 {
    let width = graph.width(id);
    match &graph.node(id).cell {
        Cell::Constant(bits) => bits.trailing_zeros().min(width),
        Cell::Op(NodeOp::Relabel(of)) => zeros(graph, *of),
        Cell::Op(NodeOp::Extend(of)) => match zeros(graph, *of) {
            all if all == graph.width(*of) => width,
            some => some,
        },
        Cell::Op(NodeOp::Concat(parts)) => {
            let mut total = 0;
            for part in parts.iter().rev() {
                let these = zeros(graph, *part);
                total += these;
                if these < graph.width(*part) {
                    break;
                }
            }
            total
        }
        _ => 0,
    }
}

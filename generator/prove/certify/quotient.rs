//! Finds restoring dividers in an unrolled computation: chains of steps that each compute one bit of a quotient.
//!
//! A step doubles the remainder r and subtracts the divisor d if it fits: r' = 2·r − b·d with b = (2·r ≥ d). If d is positive and
//! 0 ≤ r ≤ d, the same holds for r'. After k steps from r₀, the bits are the number q = Σ bᵢ·2^(k−i), and the last remainder is
//! 2^k·r₀ − q·d, between 0 and d. Therefore q·2^−k is at most r₀/d, and less than r₀/d by at most 2^−k. The module `premises`
//! lets Gappa prove that d is positive and 0 ≤ r₀ ≤ d, unless the intervals of r₀ and d show it.

use std::collections::BTreeMap;

use glint_rtl::pipeline::{Cell, Graph, NodeId, NodeOp};

/// A divider, which computes a quotient bit by bit. For example, 1/3 in two bits is the raw value 1: 0.25 is below 1/3 by less
/// than 2⁻².
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quotient {
    pub dividend: NodeId,
    pub divisor: NodeId,
    pub bits: u32,
}

/// Returns the dividers on which `results` depend. A divider's key is the node that concatenates the bits of its quotient.
pub fn quotients(graph: &Graph, results: &[NodeId]) -> BTreeMap<NodeId, Quotient> {
    let mut found = BTreeMap::new();
    let mut pending = results.to_vec();
    let mut seen = vec![false; graph.nodes.len()];
    while let Some(id) = pending.pop() {
        if std::mem::replace(&mut seen[id.index()], true) {
            continue;
        }
        match quotient(graph, id) {
            Some(quotient) => {
                found.insert(id, quotient);
                pending.extend([quotient.dividend, quotient.divisor]);
            }
            None => pending.extend(graph.node(id).cell.operands()),
        }
    }
    found
}

/// Returns the divider whose quotient node `id` concatenates, the top bit first. Returns `None` if `id` is no such concatenation,
/// or if the quotient has only one bit.
fn quotient(graph: &Graph, id: NodeId) -> Option<Quotient> {
    let Cell::Op(NodeOp::Concat(_)) = graph.node(id).cell else { return None };
    let mut bits = Vec::new();
    joined(graph, id, &mut bits);
    let steps: Option<Vec<DivisionStep>> = bits.iter().map(|&bit| step(graph, bit)).collect();
    let steps = steps.filter(|steps| steps.len() > 1)?;
    let DivisionStep { remainder: dividend, divisor, .. } = steps[0];
    let follows = steps
        .windows(2)
        .all(|pair| pair[1].divisor == divisor && is_left(graph, pair[1].remainder, &pair[0]));
    follows.then_some(Quotient { dividend, divisor, bits: steps.len() as u32 })
}

/// Appends the nodes that node `id` concatenates to `parts`, the top one first, including a nested concatenation's parts.
fn joined(graph: &Graph, id: NodeId, parts: &mut Vec<NodeId>) {
    match &graph.node(id).cell {
        Cell::Op(NodeOp::Concat(inner)) => {
            inner.iter().for_each(|&part| joined(graph, part, parts))
        }
        _ => parts.push(id),
    }
}

/// A step of a restoring divider: `doubled` is twice the remainder, `trial` is `doubled` minus the divisor, and `bit` is 1 if
/// the divisor fits into `doubled`.
struct DivisionStep {
    remainder: NodeId,
    divisor: NodeId,
    doubled: NodeId,
    trial: NodeId,
    bit: NodeId,
}

fn step(graph: &Graph, bit: NodeId) -> Option<DivisionStep> {
    let op = |id: NodeId| match &graph.node(id).cell {
        Cell::Op(op) => Some(op),
        _ => None,
    };
    let NodeOp::Not(negative) = op(bit)? else { return None };
    let NodeOp::Slice { of: trial, low } = op(*negative)? else { return None };
    let NodeOp::Sub(doubled, divisor) = op(*trial)? else { return None };
    // `negative` must be the sign bit of a difference whose format contains all its values.
    let ((least, most), (from, to)) = (graph.node(*trial).format.range(), {
        let (a, b) = (graph.node(*doubled).range, graph.node(*divisor).range);
        (a.0 - b.1, a.1 - b.0)
    });
    let is_sign = graph.node(*trial).format.signed
        && graph.width(*negative) == 1
        && low + 1 == graph.width(*trial)
        && least <= from
        && to <= most;
    let NodeOp::Concat(parts) = op(widened(graph, *doubled))? else { return None };
    let [remainder, zero] = parts[..] else { return None };
    let is_doubled = graph.constant_of(zero) == Some(0) && graph.width(zero) == 1;
    let (doubled, trial, divisor) = (*doubled, *trial, widened(graph, *divisor));
    let natural = [remainder, divisor].iter().all(|&id| !graph.node(id).format.signed);
    (is_sign && is_doubled && natural).then_some(DivisionStep {
        remainder,
        divisor,
        doubled,
        trial,
        bit,
    })
}

/// Returns whether node `id` is the remainder that `step` leaves, with at least as many bits as the divisor.
fn is_left(graph: &Graph, id: NodeId, step: &DivisionStep) -> bool {
    let Cell::Op(NodeOp::Slice { of, low: 0 }) = graph.node(id).cell else { return false };
    let left = NodeOp::Mux { select: step.bit, inputs: vec![step.doubled, step.trial] };
    graph.node(of).cell == Cell::Op(left) && graph.width(id) >= graph.width(step.divisor)
}

/// Returns the node that node `id` extends by zeros, or `id` itself.
pub fn widened(graph: &Graph, id: NodeId) -> NodeId {
    match &graph.node(id).cell {
        Cell::Op(NodeOp::Extend(of)) if !graph.node(*of).format.signed => *of,
        _ => id,
    }
}

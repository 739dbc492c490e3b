//! Replaces two-input muxes by gates if one input has constant bits, to shorten the longest path of a pipeline.
//!
//! Synthesis implements such a mux by the set or the reset of the register behind it. A look-up table combines the select of the
//! mux with the clock enable. The path from this table to the register is too long for clocks at which products need output
//! registers. The pass treats each bit separately, as synthesis does.

use super::graph::{Cell, Graph, Label, NodeId, NodeOp};
use super::rebuild::rebuilt;
use super::unroll::Unrolled;
use glint_base::fixed::Format;

/// Replaces every two-input mux with constant bits by gates, bit by bit: `s ? 0 : x` becomes `x & ~s`.
pub fn gated(unrolled: &Unrolled) -> Unrolled {
    rebuilt(unrolled, |graph, op, node| match op {
        NodeOp::Mux { select, inputs } => {
            let [zero, one] = inputs[..] else { return None };
            let bits: Vec<BitPair> =
                known(graph, zero).into_iter().zip(known(graph, one)).collect();
            if bits.iter().all(|bit| *bit == (None, None)) {
                return None;
            }
            let label = Label { named: false, ..node.label.part("part") };
            let mut parts = Vec::new();
            let mut low = 0;
            for run in bits.chunk_by(|a, b| a == b) {
                let width = run.len() as u32;
                parts.push(part(graph, *select, (zero, one), run[0], (low, width), &label));
                low += width;
            }
            parts.reverse();
            Some(graph.op(NodeOp::Concat(parts), node.format, &node.label))
        }
        _ => None,
    })
}

/// The bits of both inputs of a mux at one position, `None` if not constant.
type BitPair = (Option<bool>, Option<bool>);

/// Returns `width` bits, from bit `low` on, of the mux of `zero` and `one`. `pair` states which constant all these bits have in
/// each input. For example, with constant 0 in `zero` only, the result is `one & select`.
fn part(
    graph: &mut Graph,
    select: NodeId,
    (zero, one): (NodeId, NodeId),
    pair: BitPair,
    (low, width): (u32, u32),
    label: &Label,
) -> NodeId {
    let format = Format::unsigned(width as i32, 0);
    let (value, inverse, ones) = match pair {
        (None, None) => {
            let zero = graph.op(NodeOp::Slice { of: zero, low }, format, label);
            let one = graph.op(NodeOp::Slice { of: one, low }, format, label);
            return graph.op(NodeOp::Mux { select, inputs: vec![zero, one] }, format, label);
        }
        (Some(a), Some(b)) if a == b => {
            let bits = if a { u64::MAX } else { 0 };
            return graph.constant(bits, format, label);
        }
        (Some(_), Some(one)) => {
            let all = spread(graph, select, !one, width, label);
            return graph.op(NodeOp::Relabel(all), format, label);
        }
        // The input that is not constant passes while `select` chooses it. Otherwise the gate forces the constant.
        (Some(constant), None) => (one, false, constant),
        (None, Some(constant)) => (zero, true, constant),
    };
    let slice = graph.op(NodeOp::Slice { of: value, low }, format, label);
    let all = spread(graph, select, inverse != ones, width, label);
    let gate = graph.op(NodeOp::Relabel(all), format, label);
    let op = if ones { NodeOp::Or(slice, gate) } else { NodeOp::And(slice, gate) };
    graph.op(op, format, label)
}

/// Returns a node whose `width` bits all equal the bit `select`, or its inverse if `inverted`.
fn spread(graph: &mut Graph, select: NodeId, inverted: bool, width: u32, label: &Label) -> NodeId {
    let bit = if inverted { graph.op(NodeOp::Not(select), Format::BIT, label) } else { select };
    let sign = graph.op(NodeOp::Relabel(bit), Format::signed(0, 0), label);
    graph.resize(sign, width, true)
}

/// Returns the bits of a node, from the lowest up, as far as constants and wiring alone determine them. For example, the
/// concatenation of a variable bit and the constant `01` gives 1, 0, `None`.
fn known(graph: &Graph, id: NodeId) -> Vec<Option<bool>> {
    let node = graph.node(id);
    let width = graph.width(id) as usize;
    match &node.cell {
        Cell::Constant(bits) => (0..width).map(|bit| Some(bits >> bit & 1 == 1)).collect(),
        Cell::Op(NodeOp::Relabel(a)) => known(graph, *a),
        Cell::Op(NodeOp::Extend(a)) => {
            let mut bits = known(graph, *a);
            let sign =
                if graph.node(*a).format.signed { bits[bits.len() - 1] } else { Some(false) };
            bits.resize(width, sign);
            bits
        }
        Cell::Op(NodeOp::Slice { of, low }) => {
            known(graph, *of)[*low as usize..*low as usize + width].to_vec()
        }
        Cell::Op(NodeOp::Concat(parts)) => {
            parts.iter().rev().flat_map(|part| known(graph, *part)).collect()
        }
        _ => vec![None; width],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::parse_text::{computed, parsed};

    /// Has every kind of bit pair: both bits constant, only one, none.
    const MUX: &str = "
select u1.0
a u2.0
b u3.0
high u3.0 = constant 5
low u2.0 = constant 1
zero u7.0 = concat high a low
ends u4.0 = constant 12
one u7.0 = concat ends b
value u7.0 = mux select zero one
result value
";

    #[test]
    fn a_mux_with_bits_that_are_constants_is_the_same_without_them() {
        let before = parsed(MUX).expect("a computation");
        let after = gated(&before);
        let muxes = after.graph.cone([after.results[0].1]);
        let muxes = muxes
            .into_iter()
            .filter(|&id| matches!(after.graph.node(id).cell, Cell::Op(NodeOp::Mux { .. })));
        for mux in muxes {
            let known = after.graph.node(mux).cell.operands();
            assert!(known.iter().skip(1).all(|&it| super::known(&after.graph, it).contains(&None)));
        }
        for combination in 0..64 {
            assert_eq!(computed(&after, combination), computed(&before, combination));
        }
        assert_eq!(computed(&before, 0).1, 64);
    }
}

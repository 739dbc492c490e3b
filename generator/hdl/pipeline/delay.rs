//! Estimates the delay of each operation of a computation on an FPGA target, in nanoseconds.

use super::graph::{Cell, Graph, NodeId};
use crate::netlist::Op;
use glint_base::target::Timing;

/// Returns the delay of the cell `op`; wiring and inverters take 0 ns. `width` gives the width of each operand in bits.
pub fn delay_of<N: Copy>(timing: &Timing, op: &Op<N>, width: &impl Fn(N) -> u32) -> f64 {
    match op {
        Op::Relabel(_) | Op::Extend(_) | Op::Slice { .. } | Op::Concat(_) | Op::Not(_) => 0.0,
        Op::And(..) | Op::Or(..) | Op::Xor(..) => timing.logic,
        Op::Add { a, .. } | Op::Sub(a, _) => timing.chain(width(*a)),
        Op::Less(a, _) => timing.chain(width(*a)) + 0.4 * timing.logic,
        Op::Mul(..) => timing.product,
        Op::Equal(a, _) => tables(timing, 2 * width(*a)),
        Op::Any(a) | Op::All(a) => tables(timing, width(*a)),
        Op::Mux { select, inputs } => tables(timing, inputs.len() as u32 + width(*select)),
    }
}

/// Returns the delay of a tree of four-input look-up tables that combines `inputs` bits. For example, 5 to 16 bits take two
/// levels.
fn tables(timing: &Timing, inputs: u32) -> f64 {
    let bits = u32::BITS - (inputs.max(2) - 1).leading_zeros();
    timing.logic * f64::from(bits.div_ceil(2))
}

/// Returns the delay of a multiplexer with `values` inputs: 4 inputs and 2 select bits take two levels of look-up tables.
pub fn of_choice(timing: &Timing, values: usize) -> f64 {
    let select = usize::BITS - values.saturating_sub(1).leading_zeros();
    delay_of(timing, &Op::Mux { select: 0, inputs: vec![0; values] }, &|_| select)
}

/// Returns the delay from the operands of a node to its value. For an operand of the design, this is the time that the
/// environment takes to deliver it. A word of a block memory has the time from the clock edge.
pub fn node_delay(timing: &Timing, graph: &Graph, id: NodeId) -> f64 {
    match &graph.node(id).cell {
        Cell::Operand(_) => timing.input,
        Cell::Constant(_) | Cell::Unknown(_) => 0.0,
        Cell::Read { address, .. } => {
            if is_block(timing, graph, id) {
                timing.block
            } else {
                timing.word_bit * f64::from(graph.width(*address).max(5) - 3)
            }
        }
        Cell::Op(op) => delay_of(timing, op, &|operand| graph.width(operand)),
    }
}

/// Returns the additional setup time of the register behind a mux with a constant input and more than one bit.
///
/// Synthesis turns such a mux into the set or the reset of the register. A look-up table then combines the select with the clock
/// enable, and its path to the register is longer.
pub fn setup(timing: &Timing, graph: &Graph, id: NodeId) -> f64 {
    let Cell::Op(Op::Mux { inputs, .. }) = &graph.node(id).cell else { return 0.0 };
    let has_constant = inputs.iter().any(|input| graph.constant_of(*input).is_some());
    if has_constant && graph.width(id) > 1 { timing.logic } else { 0.0 }
}

/// Returns the select of a mux that takes no look-up tables, because synthesis implements it by the reset of the register behind
/// it. Such a mux has more than one bit and two inputs, one of them a constant.
pub fn reset_by(graph: &Graph, id: NodeId) -> Option<NodeId> {
    let Cell::Op(Op::Mux { select, inputs }) = &graph.node(id).cell else { return None };
    let constants = inputs.iter().filter(|input| graph.constant_of(**input).is_some()).count();
    (graph.width(id) > 1 && inputs.len() == 2 && constants == 1).then_some(*select)
}

/// Returns whether a node reads a ROM that synthesis puts into a block memory, whose word comes one clock after the address.
pub fn is_block(timing: &Timing, graph: &Graph, id: NodeId) -> bool {
    match graph.node(id).cell {
        Cell::Read { address, .. } => {
            let words = u64::try_from(graph.node(address).range.1 + 1);
            words.is_ok_and(|words| timing.blocks.takes(words, u64::from(graph.width(id))))
        }
        _ => false,
    }
}

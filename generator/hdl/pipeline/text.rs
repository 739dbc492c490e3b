//! Prints computations as text, as the tests of the passes and `glint schedule --after` show them.
//!
//! Each value is a line, `name format [low, high] = operation operands`, such as `sum u6.0 = add a b`. The range `[low, high]`
//! of raw values is left out if the format allows no other values. An operand of the computation, or an unknown value, is a
//! line without an operation. The last lines are `result name`.
//!
//! A bit pattern follows `constant`, and the number of a ROM and its address follow `read`. The value and the lowest bit
//! follow `slice`, and the select and the inputs follow `mux`. `add` has a third operand if it has a carry input.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use super::graph::{Cell, NodeOp};
use super::unroll::Unrolled;

/// Prints each value that the results need, and then each result. Values with the same name get numbers: the second `sum`
/// becomes `sum.2`.
pub fn printed(unrolled: &Unrolled) -> String {
    let graph = &unrolled.graph;
    let results = unrolled.results.iter().map(|it| it.1);
    let (mut names, mut taken) = (HashMap::new(), HashSet::new());
    let mut text = String::new();
    for id in graph.cone(results.clone()) {
        let node = graph.node(id);
        let mut name = node.label.name.clone();
        let mut number = 2;
        while !taken.insert(name.clone()) {
            name = format!("{}.{number}", node.label.name);
            number += 1;
        }
        let operands = node.cell.operands().into_iter();
        let operands: String = operands.map(|it| format!(" {}", names[&it])).collect();
        let _ = write!(text, "{name} {}", node.format);
        if node.range != node.format.range() && !matches!(node.cell, Cell::Constant(_)) {
            let _ = write!(text, " [{}, {}]", node.range.0, node.range.1);
        }
        let _ = match &node.cell {
            Cell::Op(NodeOp::Slice { low, .. }) => writeln!(text, " = slice{operands} {low}"),
            Cell::Op(op) => writeln!(text, " = {}{operands}", op.mnemonic()),
            Cell::Constant(bits) => writeln!(text, " = constant {bits}"),
            Cell::Read { rom, .. } => writeln!(text, " = read {}{operands}", rom.index()),
            Cell::Operand(_) | Cell::Unknown(_) => writeln!(text),
        };
        names.insert(id, name);
    }
    for id in results {
        let _ = writeln!(text, "result {}", names[&id]);
    }
    text
}

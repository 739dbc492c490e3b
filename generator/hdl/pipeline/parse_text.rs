//! Parses computations from the notation of `text`, and evaluates them, for tests of the passes.
//!
//! A line may leave out its range if the format allows no other values. The operation `read` of a ROM cannot be parsed. Lines
//! that begin with `#` are comments.

use std::collections::HashMap;
use std::panic::Location;

use super::graph::{Cell, Graph, Label, NodeId, NodeOp};
use super::unroll::Unrolled;
use crate::netlist::{NetId, eval};
use glint_base::fixed::{Format, mask};

/// Parses a computation: `sum u6.0 = sub a b` is the difference of two operands. The error has the reason, in most cases with
/// the line.
#[track_caller]
pub fn parsed(text: &str) -> Result<Unrolled, String> {
    let mut graph = Graph::default();
    let mut names: HashMap<&str, NodeId> = HashMap::new();
    let mut unrolled = Unrolled {
        graph: Graph::default(),
        operands: Vec::new(),
        results: Vec::new(),
        steps: Vec::new(),
        dispatched: None,
    };
    for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let wrong = |what: &str| format!("`{line}`: {what}");
        if let Some(name) = line.strip_prefix("result ") {
            let id = *names.get(name).ok_or_else(|| wrong("no such value"))?;
            unrolled.results.push((NetId(unrolled.results.len() as u32), id));
            continue;
        }
        let (value, operation) = line.split_once(" = ").unwrap_or((line, ""));
        let (value, stated_range) = match value.split_once(" [") {
            Some((value, range)) => {
                let (low, high) = range
                    .trim_end_matches(']')
                    .split_once(", ")
                    .ok_or_else(|| wrong("no range"))?;
                (value, low.parse().ok().zip(high.parse().ok()))
            }
            None => (value, None),
        };
        let (name, format) = value.split_once(' ').ok_or_else(|| wrong("no format"))?;
        let format: Format = format.parse()?;
        let range = stated_range.unwrap_or_else(|| format.range());
        let label = Label::new(name.to_owned(), Location::caller());
        let mut words = operation.split_whitespace();
        let operation = words.next();
        let numbers: Vec<Option<u64>> = words.clone().map(|word| word.parse().ok()).collect();
        let operands: Vec<Option<NodeId>> = words.map(|word| names.get(word).copied()).collect();
        let of =
            |at: usize| operands.get(at).copied().flatten().ok_or_else(|| wrong("no such value"));
        let number =
            |at: usize| numbers.get(at).copied().flatten().ok_or_else(|| wrong("no number"));
        let op = match operation {
            None => {
                let cell = Cell::Operand(unrolled.operands.len());
                unrolled.operands.push(NetId(unrolled.operands.len() as u32));
                names.insert(name, graph.insert(cell, format, range, &label));
                continue;
            }
            Some("constant") => {
                names.insert(name, graph.constant(number(0)?, format, &label));
                continue;
            }
            Some("relabel") => NodeOp::Relabel(of(0)?),
            Some("extend") => NodeOp::Extend(of(0)?),
            Some("slice") => NodeOp::Slice { of: of(0)?, low: number(1)? as u32 },
            Some("concat") => {
                NodeOp::Concat((0..operands.len()).map(of).collect::<Result<_, _>>()?)
            }
            Some("not") => NodeOp::Not(of(0)?),
            Some("and") => NodeOp::And(of(0)?, of(1)?),
            Some("or") => NodeOp::Or(of(0)?, of(1)?),
            Some("xor") => NodeOp::Xor(of(0)?, of(1)?),
            Some("add") => {
                let carry = (operands.len() > 2).then(|| of(2)).transpose()?;
                NodeOp::Add { a: of(0)?, b: of(1)?, carry }
            }
            Some("sub") => NodeOp::Sub(of(0)?, of(1)?),
            Some("mul") => NodeOp::Mul(of(0)?, of(1)?),
            Some("equal") => NodeOp::Equal(of(0)?, of(1)?),
            Some("less") => NodeOp::Less(of(0)?, of(1)?),
            Some("any") => NodeOp::Any(of(0)?),
            Some("all") => NodeOp::All(of(0)?),
            Some("mux") => NodeOp::Mux {
                select: of(0)?,
                inputs: (1..operands.len()).map(of).collect::<Result<_, _>>()?,
            },
            Some(_) => return Err(wrong("no such operation")),
        };
        let id = graph.op(op, format, &label);
        names.insert(name, graph.refine(id, range));
    }
    unrolled.graph = graph;
    Ok(unrolled)
}

/// Evaluates a computation for one combination of operand values. Returns the bit patterns of its results, and the number of all
/// combinations. `combination` counts through the operands' intervals; the first operand changes fastest. ROM words and unknown
/// values count as 0.
pub fn computed(unrolled: &Unrolled, combination: u64) -> (Vec<u64>, u64) {
    let graph = &unrolled.graph;
    let mut values: HashMap<NodeId, [u64; 1]> = HashMap::new();
    let mut combinations = 1;
    for (at, node) in graph.nodes.iter().enumerate() {
        let id = NodeId(at as u32);
        let bits = match &node.cell {
            Cell::Operand(_) => {
                let (low, high) = node.range;
                let count = (high - low + 1) as u64;
                let raw = low + i128::from(combination / combinations % count);
                combinations *= count;
                node.format.bits(raw)
            }
            Cell::Constant(bits) => *bits,
            Cell::Op(op) => {
                let width = node.format.width();
                eval::cell(op, width, &|it| graph.node(it).format, &|it| &values[&it])[0]
                    & mask(width)
            }
            Cell::Read { .. } | Cell::Unknown(_) => 0,
        };
        values.insert(id, [bits]);
    }
    (unrolled.results.iter().map(|(_, id)| values[id][0]).collect(), combinations)
}

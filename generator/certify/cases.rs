//! The ways that a computation can go, and the raw values that everything has on each.

use std::collections::BTreeMap;

use crate::base::fixed::{Format, mask};
use crate::hdl::netlist::{NetId, Op, RomId};
use crate::hdl::pipeline::{Cell, Graph, Interval};

/// More ways than this are not looked at, those that turn out to be none too.
const MOST: usize = 4096;

/// What is known of values beside where they come from: intervals of raw values by node.
pub type Known = BTreeMap<NetId, Interval>;

/// One way.
#[derive(Clone, Debug)]
pub struct Case {
    /// What this way presupposes. It is implied by the operands' values that lead here.
    pub known: Known,
    /// The raw values of every node.
    pub ranges: Vec<Interval>,
}

/// The raw value of a word of a ROM.
pub type Words<'a> = &'a dyn Fn(RomId, u64) -> i128;

/// All ways to compute `results`, given `known` of the operands: together they cover every combination of operands.
///
/// # Errors
/// There are too many.
pub fn cases(
    graph: &Graph,
    words: Words,
    results: &[NetId],
    known: &Known,
) -> Result<Vec<Case>, String> {
    let cone = graph.cone(results.iter().copied());
    let mut found = Vec::new();
    let mut pending = vec![known.clone()];
    let mut looked_at = 0;
    while let Some(known) = pending.pop() {
        looked_at += 1;
        match ranges(graph, words, &cone, &known) {
            Way::Whole(ranges) => found.push(Case { known, ranges }),
            Way::Never => {}
            Way::Splits(node, (low, high)) => {
                if high - low > 63 {
                    let name = &graph.node(node).label.name;
                    return Err(format!("`{name}` selects among too many values"));
                }
                for value in (low..=high).rev() {
                    let mut known = known.clone();
                    if learn(graph, &mut known, node, (value, value)) {
                        pending.push(known);
                    }
                }
            }
        }
        if looked_at + pending.len() > MOST {
            return Err(format!("there are more than {MOST} ways to go through it"));
        }
    }
    Ok(found)
}

enum Way {
    /// Every selection is decided.
    Whole(Vec<Interval>),
    /// No operands lead here.
    Never,
    /// This node decides, and has several values.
    Splits(NetId, Interval),
}

fn ranges(graph: &Graph, words: Words, cone: &[NetId], known: &Known) -> Way {
    let mut ranges = vec![(0, 0); graph.nodes.len()];
    for &id in cone {
        let node = graph.node(id);
        let of = |id: &NetId| ranges[id.index()];
        let mut range = match &node.cell {
            Cell::Op(Op::Mux { select, inputs }) => {
                let (low, high) = of(select);
                if low != high {
                    let decider = decider(graph, *select, &of);
                    return Way::Splits(decider, of(&decider));
                }
                of(&inputs[(low as usize).min(inputs.len() - 1)])
            }
            Cell::Op(op) => computed(graph, id, op, &of),
            Cell::Read { rom, address } if of(address).0 == of(address).1 => {
                let word = words(*rom, of(address).0 as u64);
                (word, word)
            }
            _ => node.range,
        };
        let other = known.get(&id).copied().unwrap_or(node.range);
        for (low, high) in [node.range, other] {
            range = (range.0.max(low), range.1.min(high));
        }
        if range.0 > range.1 {
            return Way::Never;
        }
        ranges[id.index()] = range;
    }
    Way::Whole(ranges)
}

/// What to decide first, so that this undecided selection becomes known: a condition of which it is made.
fn decider(graph: &Graph, id: NetId, of: &dyn Fn(&NetId) -> Interval) -> NetId {
    let operands = match &graph.node(id).cell {
        Cell::Op(op @ (Op::And(..) | Op::Or(..) | Op::Not(_) | Op::Relabel(_)))
            if graph.width(id) == 1 =>
        {
            op.operands()
        }
        _ => return id,
    };
    let open = operands.into_iter().find(|operand| of(operand).0 != of(operand).1);
    open.map_or(id, |operand| decider(graph, operand, of))
}

/// The multiple of the modulus that brings numbers of this range into the format, as hardware that drops what is
/// above its bits does; `None` if it is not one for all.
pub fn turns((low, high): Interval, format: Format) -> Option<i128> {
    let (least, most) = format.range();
    let modulus = most - least + 1;
    let turn =
        (least - low).div_euclid(modulus) + i128::from((least - low).rem_euclid(modulus) != 0);
    let turn = turn * modulus;
    (low + turn >= least && high + turn <= most).then_some(turn)
}

/// The raw values of a cell whose operands have theirs; all that the format has where nothing closer is said.
fn computed(graph: &Graph, id: NetId, op: &Op, of: &dyn Fn(&NetId) -> Interval) -> Interval {
    let format = graph.node(id).format;
    let all = format.range();
    let fits = |range: Interval| match turns(range, format) {
        Some(turn) => (range.0 + turn, range.1 + turn),
        None => all,
    };
    let corners = |a: Interval, b: Interval| {
        let products = [a.0 * b.0, a.0 * b.1, a.1 * b.0, a.1 * b.1];
        let low = products.into_iter().fold(products[0], i128::min);
        (low, products.into_iter().fold(products[0], i128::max))
    };
    let bit = |never: bool, always: bool| (i128::from(always), i128::from(!never));
    match op {
        Op::Relabel(a) | Op::Extend(a) => fits(of(a)),
        Op::Slice { of: a, low } => fits((of(a).0 >> low, of(a).1 >> low)),
        Op::Concat(parts) => fits(parts.iter().fold((0, 0), |(low, high), part| {
            let width = graph.width(*part);
            // Of a signed part the bits count, whose values are not in order.
            let own = if of(part).0 < 0 { (0, mask(width).into()) } else { of(part) };
            ((low << width) + own.0, (high << width) + own.1)
        })),
        Op::Not(a) if format.signed => (!of(a).1, !of(a).0),
        Op::Not(a) => (all.1 - of(a).1, all.1 - of(a).0),
        Op::Add { a, b, carry } => {
            let carry = carry.as_ref().map_or((0, 0), of);
            fits((of(a).0 + of(b).0 + carry.0, of(a).1 + of(b).1 + carry.1))
        }
        Op::Sub(a, b) => fits((of(a).0 - of(b).1, of(a).1 - of(b).0)),
        Op::Mul(a, b) => fits(corners(of(a), of(b))),
        Op::Equal(a, b) => {
            let (a, b) = (of(a), of(b));
            bit(a.1 < b.0 || b.1 < a.0, a.0 == a.1 && a == b)
        }
        Op::Less(a, b) => bit(of(a).0 >= of(b).1, of(a).1 < of(b).0),
        Op::Any(a) => bit(of(a) == (0, 0), of(a).0 > 0 || of(a).1 < 0),
        Op::All(a) => {
            let format = graph.node(*a).format;
            let ones = if format.signed { -1 } else { format.range().1 };
            bit(of(a).1 < ones || of(a).0 > ones, of(a) == (ones, ones))
        }
        Op::And(a, b) if format.width() == 1 => (of(a).0.min(of(b).0), of(a).1.min(of(b).1)),
        Op::Or(a, b) if format.width() == 1 => (of(a).0.max(of(b).0), of(a).1.max(of(b).1)),
        Op::And(..) | Op::Or(..) | Op::Xor(..) | Op::Mux { .. } => all,
    }
}

/// Notes that a node has the values of `range` alone, and what follows for those that it comes from; false if
/// that cannot be.
pub fn learn(graph: &Graph, known: &mut Known, id: NetId, range: Interval) -> bool {
    let node = graph.node(id);
    let before = known.get(&id).copied().unwrap_or(node.range);
    let range = (range.0.max(before.0), range.1.min(before.1));
    if range.0 > range.1 {
        return false;
    }
    known.insert(id, range);
    let unsigned = |id: NetId| !graph.node(id).format.signed;
    let all = |id: NetId| graph.node(id).format.range();
    let Cell::Op(op) = &node.cell else { return true };
    let is = (range.0 == range.1).then_some(range.0);
    match (op, is) {
        (Op::Relabel(a) | Op::Extend(a), _) if unsigned(*a) == unsigned(id) => {
            learn(graph, known, *a, range)
        }
        (Op::Not(a), _) if unsigned(*a) && unsigned(id) => {
            let most = all(id).1;
            learn(graph, known, *a, (most - range.1, most - range.0))
        }
        // The bits above all others.
        (Op::Slice { of, low }, _) if reaches_top(graph, *of, low + graph.width(id)) => {
            if unsigned(*of) && unsigned(id) {
                learn(graph, known, *of, (range.0 << low, ((range.1 + 1) << low) - 1))
            } else if let (Some(bit), 1, false) = (is, graph.width(id), unsigned(*of)) {
                // The sign.
                let (least, most) = all(*of);
                let half = if bit == 0 { (0, most) } else { (least, -1) };
                learn(graph, known, *of, half)
            } else {
                true
            }
        }
        // The bits below a sign that is known.
        (Op::Slice { of, low }, _)
            if !unsigned(*of) && unsigned(id) && low + graph.width(id) + 1 == graph.width(*of) =>
        {
            let (least, _) = all(*of);
            let base = match known.get(of) {
                Some((from, _)) if *from >= 0 => 0,
                Some((_, to)) if *to < 0 => least,
                _ => return true,
            };
            let range = (base + (range.0 << low), base + ((range.1 + 1) << low) - 1);
            learn(graph, known, *of, range)
        }
        // Of a mux that is decided, the input that it passes on.
        (Op::Mux { select, inputs }, _) => match known.get(select) {
            Some((low, high)) if low == high => {
                let input = inputs[(*low as usize).min(inputs.len() - 1)];
                unsigned(input) != unsigned(id) || learn(graph, known, input, range)
            }
            _ => true,
        },
        (Op::Any(a), Some(0)) => learn(graph, known, *a, (0, 0)),
        (Op::Any(a), Some(_)) if unsigned(*a) => learn(graph, known, *a, (1, all(*a).1)),
        (Op::All(a), Some(0)) if unsigned(*a) => learn(graph, known, *a, (0, all(*a).1 - 1)),
        (Op::All(a), Some(_)) if unsigned(*a) => learn(graph, known, *a, (all(*a).1, all(*a).1)),
        (Op::And(a, b), Some(1)) if graph.width(id) == 1 => {
            learn(graph, known, *a, (1, 1)) && learn(graph, known, *b, (1, 1))
        }
        (Op::Or(a, b), Some(0)) if graph.width(id) == 1 => {
            learn(graph, known, *a, (0, 0)) && learn(graph, known, *b, (0, 0))
        }
        (Op::Less(a, b), Some(less)) => {
            let value = |id: NetId| known.get(&id).copied().unwrap_or(graph.node(id).range);
            let ((a_low, a_high), (b_low, b_high)) = (value(*a), value(*b));
            let (for_a, for_b) = match less {
                1 => ((a_low, b_high - 1), (a_low + 1, b_high)),
                _ => ((b_low, a_high), (b_low, a_high)),
            };
            learn(graph, known, *a, for_a) && learn(graph, known, *b, for_b)
        }
        _ => true,
    }
}

/// Whether a value has no bits that count from this one up.
fn reaches_top(graph: &Graph, id: NetId, from: u32) -> bool {
    let node = graph.node(id);
    from == graph.width(id) || !node.format.signed && node.range.1 < 1 << from
}

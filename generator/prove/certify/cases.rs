//! Splits a computation into cases, one for each possible combination of outcomes of its conditions: the selects of
//! multiplexers, and the carries of sums.
//!
//! For example, a saturation with one limit has two cases: the value is inside the limit, or the limit replaces it. For each
//! case, the module finds the interval of raw values of every node on which the results depend.

use std::collections::BTreeMap;

use super::polynomial::RawPolynomial;
use super::quotient::Quotient;
use glint_base::cone;
use glint_base::interval::{self, Interval, common, wrap};
use glint_rtl::netlist::{RomId, interval::of_cell};
use glint_rtl::pipeline::{Cell, Graph, NodeId, NodeOp};

/// The largest number of cases that are examined, including impossible ones.
const MOST: usize = 4096;

/// For some nodes, an interval of raw values that is narrower than the interval from the operands alone.
pub type NodeIntervals = BTreeMap<NodeId, Interval>;

/// A case of a computation: one combination of outcomes of its conditions.
#[derive(Clone, Debug)]
pub struct Case {
    /// The case's hypotheses: intervals of nodes that follow from the outcomes of the conditions.
    pub known: NodeIntervals,
    /// The interval of raw values of every node in this case.
    pub ranges: Vec<Interval>,
    /// The nodes with a value that is a quadratic polynomial in one operand, if the polynomial narrows the node's interval.
    pub parabolas: BTreeMap<NodeId, RawPolynomial>,
}

pub type WordLookup<'a> = &'a dyn Fn(RomId, u64) -> i128;

/// A computation as a graph of values, with the words of its ROMs and with its dividers.
#[derive(Clone, Copy)]
pub struct UnrolledComputation<'a> {
    pub graph: &'a Graph,
    /// A function that returns the word of a ROM at an address, as a raw value.
    pub words: WordLookup<'a>,
    /// The dividers. A divider's key is the node that concatenates the bits of its quotient.
    pub quotients: &'a BTreeMap<NodeId, Quotient>,
}

impl UnrolledComputation<'_> {
    /// Returns `roots` and every node that they depend on, in the graph's order. A quotient's bits are left out: a quotient
    /// depends directly on its dividend and divisor.
    fn cone(&self, roots: &[NodeId]) -> Vec<NodeId> {
        let operands = |at| self.operands(NodeId(at as u32)).into_iter().map(NodeId::index);
        let roots = roots.iter().map(|root| root.index());
        let live = cone::needed(self.graph.nodes.len(), roots, operands);
        (0..live.len()).filter(|&at| live[at]).map(|at| NodeId(at as u32)).collect()
    }

    fn operands(&self, id: NodeId) -> Vec<NodeId> {
        match self.quotients.get(&id) {
            Some(quotient) => vec![quotient.dividend, quotient.divisor],
            None => self.graph.node(id).cell.operands(),
        }
    }
}

/// Returns all cases of the computation of `results`, with the intervals `known` of the operands. Together the cases cover
/// every combination of operands.
///
/// # Errors
/// Fails if more than 4096 cases are examined, or if a condition has more than 64 values.
pub fn cases(
    view: UnrolledComputation,
    results: &[NodeId],
    known: &NodeIntervals,
) -> Result<Vec<Case>, String> {
    let cone = view.cone(results);
    let graph = view.graph;
    let mut found = Vec::new();
    let mut pending = vec![known.clone()];
    let mut looked_at = 0;
    while let Some(known) = pending.pop() {
        looked_at += 1;
        let mut way = Case {
            known,
            ranges: graph.nodes.iter().map(|node| node.range).collect(),
            parabolas: BTreeMap::new(),
        };
        match way.follow(view, &cone) {
            Decision::Whole => found.push(way),
            Decision::Never => {}
            Decision::Splits(node, (low, high)) => {
                if high - low > 63 {
                    let name = &graph.node(node).label.name;
                    return Err(format!("`{name}` selects among too many values"));
                }
                for value in (low..=high).rev() {
                    let mut known = way.known.clone();
                    if learn(graph, &mut known, &way.ranges, node, (value, value)) {
                        pending.push(known);
                    }
                }
            }
        }
        if looked_at + pending.len() > MOST {
            return Err(format!("the computation has more than {MOST} cases"));
        }
    }
    Ok(found)
}

/// Returns the interval of raw values of `node`. Returns `None` if the value depends on an undecided condition, or if no operands
/// lie in the intervals `known`.
pub fn range(view: UnrolledComputation, node: NodeId, known: &NodeIntervals) -> Option<Interval> {
    let ranges = view.graph.nodes.iter().map(|node| node.range).collect();
    let mut case = Case { known: known.clone(), ranges, parabolas: BTreeMap::new() };
    match case.follow(view, &view.cone(&[node])) {
        Decision::Whole => Some(case.ranges[node.index()]),
        Decision::Never | Decision::Splits(..) => None,
    }
}

enum Decision {
    /// Every condition is decided, so the intervals of all nodes are known.
    Whole,
    /// No operands satisfy the hypotheses.
    Never,
    /// A condition depends on this node, which still has several values: the interval.
    Splits(NodeId, Interval),
}

impl Case {
    /// Computes the intervals of the nodes in `cone`, in order. Ends at the first undecided condition, or at the first node that
    /// has no possible value.
    fn follow(&mut self, view: UnrolledComputation, cone: &[NodeId]) -> Decision {
        let graph = view.graph;
        let mut polynomials: BTreeMap<NodeId, RawPolynomial> = BTreeMap::new();
        for &id in cone {
            let node = graph.node(id);
            if let Some(selection) = selection(&node.cell)
                && !view.quotients.contains_key(&id)
                && is_open(&self.ranges, selection)
            {
                let decider = decider(graph, selection, &self.ranges);
                return Decision::Splits(decider, self.ranges[decider.index()]);
            }
            let computed = self.computed(view, id);
            let known = self.known.get(&id).copied().unwrap_or(node.range);
            let Some(representable) = common(computed, node.range) else { return Decision::Never };
            let Some(mut range) = common(representable, known) else { return Decision::Never };
            if let Some(polynomial) = polynomial(graph, id, &polynomials, &self.ranges) {
                polynomials.insert(id, polynomial);
                if let Some(x) = polynomial.of
                    && let Some(values) = polynomial.range(self.ranges[x.index()])
                    && (values.0 > range.0 || values.1 < range.1)
                {
                    let Some(both) = common(range, values) else { return Decision::Never };
                    range = both;
                    if polynomial.factors[2] != 0 {
                        self.parabolas.insert(id, polynomial);
                    }
                }
            }
            self.ranges[id.index()] = range;
        }
        Decision::Whole
    }

    /// Computes a node's interval from the intervals of its operands. If the node is a mux or a sum with a carry, its condition
    /// must be decided.
    fn computed(&self, view: UnrolledComputation, id: NodeId) -> Interval {
        let graph = view.graph;
        let node = graph.node(id);
        let of = |id: NodeId| self.ranges[id.index()];
        if let Some(&Quotient { dividend, divisor, bits }) = view.quotients.get(&id) {
            let (over, under) = (of(dividend), of(divisor));
            let most = (1 << bits) - 1;
            let least_quotient = (over.0 << bits) / under.1.max(1);
            let largest_quotient = (over.1 << bits) / under.0.max(1);
            return (least_quotient.min(most), largest_quotient.min(most));
        }
        match &node.cell {
            Cell::Op(NodeOp::Mux { select, inputs }) => of(selected(*select, inputs, &self.ranges)),
            Cell::Op(NodeOp::All(a)) => {
                let format = graph.node(*a).format;
                let ones = if format.signed { -1 } else { format.max_raw() };
                let possible = common(of(*a), (ones, ones)).is_some();
                (i128::from(of(*a) == (ones, ones)), i128::from(possible))
            }
            Cell::Op(op) => of_cell(op, node.format, &|id| graph.node(id).format, &of),
            Cell::Read { rom, address } => {
                let (low, high) = of(*address);
                let words = (low..=high).map(|at| (view.words)(*rom, at as u64));
                interval::of_values(words).unwrap_or(node.range)
            }
            _ => node.range,
        }
    }
}

/// Returns a cell's condition: the select of a mux, or a sum's carry. Its value must be known before the cell is computed.
fn selection(cell: &Cell) -> Option<NodeId> {
    match cell {
        Cell::Op(NodeOp::Mux { select, .. }) => Some(*select),
        Cell::Op(NodeOp::Add { carry, .. }) => *carry,
        _ => None,
    }
}

fn is_open(ranges: &[Interval], id: NodeId) -> bool {
    let (low, high) = ranges[id.index()];
    low != high
}

fn selected(select: NodeId, inputs: &[NodeId], ranges: &[Interval]) -> NodeId {
    let (number, _) = ranges[select.index()];
    inputs[(number as usize).min(inputs.len() - 1)]
}

/// Returns the raw value of a node as a polynomial in the raw value of an operand. `polynomials` has the polynomials of earlier
/// nodes. Returns `None` if there is no such polynomial, or if the node drops bits differently within its interval.
fn polynomial(
    graph: &Graph,
    id: NodeId,
    polynomials: &BTreeMap<NodeId, RawPolynomial>,
    ranges: &[Interval],
) -> Option<RawPolynomial> {
    let node = graph.node(id);
    let of = |id: &NodeId| ranges[id.index()];
    let known = |id: &NodeId| match of(id) {
        (low, high) if low == high => Some(RawPolynomial::constant(low)),
        _ => polynomials.get(id).copied(),
    };
    // The value is wrapped to the node's format: the same multiple of the modulus is added for the whole interval.
    let wrapped = |whole: Interval, polynomial: RawPolynomial| {
        polynomial.plus(RawPolynomial::constant(wrap(whole, node.format)?), 1)
    };
    match &node.cell {
        Cell::Operand(_) => Some(RawPolynomial::operand(id)),
        Cell::Op(NodeOp::Relabel(a) | NodeOp::Extend(a)) => wrapped(of(a), known(a)?),
        Cell::Op(NodeOp::Slice { of: a, low: 0 }) => wrapped(of(a), known(a)?),
        Cell::Op(NodeOp::Not(a)) => {
            let most = if node.format.signed { -1 } else { node.format.range().1 };
            RawPolynomial::constant(most).plus(known(a)?, -1)
        }
        Cell::Op(NodeOp::Concat(parts)) => {
            let [a, zeros] = parts[..] else { return None };
            let is_raised =
                graph.constant_of(zeros) == Some(0) && of(&a).0 >= 0 && !node.format.signed;
            if !is_raised {
                return None;
            }
            known(&a)?.times(RawPolynomial::constant(1 << graph.width(zeros)))
        }
        Cell::Op(NodeOp::Mux { select, inputs }) => known(&selected(*select, inputs, ranges)),
        Cell::Op(NodeOp::Add { a, b, carry }) => {
            let carried = match carry {
                Some(carry) => of(carry),
                None => (0, 0),
            };
            let whole = (of(a).0 + of(b).0 + carried.0, of(a).1 + of(b).1 + carried.1);
            let constant = RawPolynomial::constant(carried.0);
            wrapped(whole, known(a)?.plus(known(b)?, 1)?.plus(constant, 1)?)
        }
        Cell::Op(NodeOp::Sub(a, b)) => {
            wrapped((of(a).0 - of(b).1, of(a).1 - of(b).0), known(a)?.plus(known(b)?, -1)?)
        }
        Cell::Op(NodeOp::Mul(a, b)) => known(a)?.times(known(b)?),
        _ => None,
    }
}

/// Returns the node with values that must be distinguished first to decide the condition `id`. For example, it is `b` for the
/// select `a & b` of one bit, if only `b` is undecided.
fn decider(graph: &Graph, id: NodeId, ranges: &[Interval]) -> NodeId {
    let operands =
        match &graph.node(id).cell {
            Cell::Op(
                op @ (NodeOp::And(..) | NodeOp::Or(..) | NodeOp::Not(_) | NodeOp::Relabel(_)),
            ) if graph.width(id) == 1 => op.operands(),
            _ => return id,
        };
    for operand in operands {
        if is_open(ranges, operand) {
            return decider(graph, operand, ranges);
        }
    }
    id
}

/// Narrows the interval of node `id` in `known` to `range`. Also narrows the intervals of the nodes from which `id` is computed,
/// if the operation allows it. For example, if the inverse of an 8-bit node `a` is 0, then `a` is 255. `ranges` are the intervals
/// without this restriction. Returns false if no value is left.
pub fn learn(
    graph: &Graph,
    known: &mut NodeIntervals,
    ranges: &[Interval],
    id: NodeId,
    range: Interval,
) -> bool {
    let node = graph.node(id);
    let before = known.get(&id).copied().unwrap_or(node.range);
    let value = |known: &NodeIntervals, id: NodeId| {
        let ((low, high), own) = (ranges[id.index()], known.get(&id));
        own.map_or((low, high), |own| (low.max(own.0), high.min(own.1)))
    };
    let Some(range) = common(range, before) else { return false };
    known.insert(id, range);
    let unsigned = |id: NodeId| !graph.node(id).format.signed;
    let all = |id: NodeId| graph.node(id).format.range();
    let Cell::Op(op) = &node.cell else { return true };
    let is = (range.0 == range.1).then_some(range.0);
    match (op, is) {
        (NodeOp::Relabel(a) | NodeOp::Extend(a), _) if unsigned(*a) == unsigned(id) => {
            learn(graph, known, ranges, *a, range)
        }
        (NodeOp::Not(a), _) if unsigned(*a) && unsigned(id) => {
            let most = all(id).1;
            learn(graph, known, ranges, *a, (most - range.1, most - range.0))
        }
        // The slice contains the top bits of the value.
        (NodeOp::Slice { of, low }, _) if reaches_top(graph, *of, low + graph.width(id)) => {
            if unsigned(*of) && unsigned(id) {
                learn(graph, known, ranges, *of, (range.0 << low, ((range.1 + 1) << low) - 1))
            } else if let (Some(bit), 1, false) = (is, graph.width(id), unsigned(*of)) {
                // The slice is the sign bit.
                let (least, most) = all(*of);
                let half = if bit == 0 { (0, most) } else { (least, -1) };
                learn(graph, known, ranges, *of, half)
            } else {
                true
            }
        }
        // The slice contains the bits below the sign, and the sign is known.
        (NodeOp::Slice { of, low }, _)
            if !unsigned(*of) && unsigned(id) && low + graph.width(id) + 1 == graph.width(*of) =>
        {
            let (least, _) = all(*of);
            let base = match value(known, *of) {
                (from, _) if from >= 0 => 0,
                (_, to) if to < 0 => least,
                _ => return true,
            };
            let range = (base + (range.0 << low), base + ((range.1 + 1) << low) - 1);
            learn(graph, known, ranges, *of, range)
        }
        // If a mux's select is decided, the interval narrows the input that the mux passes on.
        (NodeOp::Mux { select, inputs }, _) => match value(known, *select) {
            (low, high) if low == high => {
                let input = inputs[(low as usize).min(inputs.len() - 1)];
                unsigned(input) != unsigned(id) || learn(graph, known, ranges, input, range)
            }
            _ => true,
        },
        (NodeOp::Any(a), Some(0)) => learn(graph, known, ranges, *a, (0, 0)),
        (NodeOp::Any(a), Some(_)) if unsigned(*a) => {
            learn(graph, known, ranges, *a, (1, all(*a).1))
        }
        (NodeOp::All(a), Some(0)) if unsigned(*a) => {
            learn(graph, known, ranges, *a, (0, all(*a).1 - 1))
        }
        (NodeOp::All(a), Some(_)) if unsigned(*a) => {
            learn(graph, known, ranges, *a, (all(*a).1, all(*a).1))
        }
        (NodeOp::And(a, b), Some(1)) if graph.width(id) == 1 => {
            learn(graph, known, ranges, *a, (1, 1)) && learn(graph, known, ranges, *b, (1, 1))
        }
        (NodeOp::Or(a, b), Some(0)) if graph.width(id) == 1 => {
            learn(graph, known, ranges, *a, (0, 0)) && learn(graph, known, ranges, *b, (0, 0))
        }
        (NodeOp::Less(a, b), Some(less)) => {
            let ((a_low, a_high), (b_low, b_high)) = (value(known, *a), value(known, *b));
            let (for_a, for_b) = match less {
                1 => ((a_low, b_high - 1), (a_low + 1, b_high)),
                _ => ((b_low, a_high), (b_low, a_high)),
            };
            learn(graph, known, ranges, *a, for_a) && learn(graph, known, ranges, *b, for_b)
        }
        _ => true,
    }
}

/// Returns whether a node has only zeros from bit `from` up.
fn reaches_top(graph: &Graph, id: NodeId, from: u32) -> bool {
    let node = graph.node(id);
    from == graph.width(id) || !node.format.signed && node.range.1 < 1 << from
}

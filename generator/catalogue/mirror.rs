//! Builds a chain of mirrored values with a single adder. For example, three conditions mirror an angle from one of eight octants
//! into the first octant.
//!
//! A mirror is a choice between a value v and the difference c − v from a constant c. A chain of up to three such choices, with
//! the rounding after it, has the value ±v + base. The sign is negative if an odd number of the conditions is 1, and each
//! combination of conditions has a constant base. One adder therefore computes the whole chain, although the plan has a
//! difference and a choice for each mirror.

use glint_base::fixed::{Format, Overflow, Rounding};
use glint_plan::{ExpressionPlan, NodeId, Operation};
use glint_rtl::dsl::{Designer, Signal};

/// Each mirror in a chain doubles the number of constants.
const MOST_MIRRORS: usize = 3;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Mirror {
    /// If this node is 1, the mirror replaces the value v by c − v.
    condition: NodeId,
    /// The raw value and the fraction bits of c.
    constant: (i128, i32),
}

/// A value that several conditions mirror, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MirrorChain {
    /// The value before the first mirror.
    start: NodeId,
    /// The condition and the cases of `start`, if it is a choice that only the first mirror reads.
    choice: Option<(NodeId, [NodeId; 2])>,
    /// The mirrors, in the order in which they are applied.
    mirrors: Vec<Mirror>,
    /// The node that rounds the mirrored value to the nearest, if there is one.
    rounded: Option<NodeId>,
    /// The nodes that the chain replaces, so that they are not built.
    inner: Vec<NodeId>,
}

impl MirrorChain {
    /// Returns the chain of mirrors that ends at node `end`, unless it would save no adder, as one mirror without rounding.
    /// `held` says for each node whether it has a register.
    pub(super) fn ending_at(plan: &ExpressionPlan, end: NodeId, held: &[bool]) -> Option<Self> {
        let mut chain = Self {
            start: end,
            choice: None,
            mirrors: Vec::new(),
            rounded: None,
            inner: Vec::new(),
        };
        if let Operation::Narrow(a, Rounding::Nearest) = plan.node(end).operation {
            let drops_bits = plan.node(a).format.frac > plan.node(end).format.frac;
            if drops_bits && readers(plan, a) == [end] && !held[a.0] {
                chain.rounded = Some(end);
                chain.start = a;
            }
        }
        let before_mirrors = chain.start;
        while let Some((mirror, before, difference)) = mirror_at(plan, chain.start) {
            let top = chain.start;
            if chain.mirrors.len() == MOST_MIRRORS || held[difference.0] {
                break;
            }
            if top != before_mirrors && (held[top.0] || readers(plan, top).len() > 2) {
                break;
            }
            chain.mirrors.insert(0, mirror);
            chain.inner.push(difference);
            chain.inner.push(top);
            chain.start = before;
        }
        // Two operations read this value: the difference and the choice of the first mirror.
        let is_inner = !held[chain.start.0] && readers(plan, chain.start).len() == 2;
        if let Operation::Choose { condition, cases } = plan.node(chain.start).operation
            && is_inner
            && !chain.mirrors.is_empty()
        {
            chain.choice = Some((condition, cases));
            chain.inner.push(chain.start);
        }
        chain.inner.retain(|node| *node != end);
        let adders = chain.mirrors.len() + usize::from(chain.rounded.is_some());
        (!chain.mirrors.is_empty() && adders > 1).then_some(chain)
    }

    pub(super) fn inner(&self) -> &[NodeId] {
        &self.inner
    }

    /// Builds the chain; its value may be wider than the format of its last node. `signal` returns the signal of a node that is
    /// already built.
    pub(super) fn build<'d>(
        &self,
        d: &'d Designer,
        plan: &ExpressionPlan,
        name: &str,
        signal: &dyn Fn(NodeId) -> Signal<'d>,
    ) -> Signal<'d> {
        let mut frac = plan.node(self.start).format.frac;
        for mirror in &self.mirrors {
            frac = frac.max(mirror.constant.1);
        }
        let half = match self.rounded {
            Some(node) => 1i128 << (frac - plan.node(node).format.frac - 1),
            None => 0,
        };
        let mut conditions = Vec::new();
        for mirror in &self.mirrors {
            conditions.push(signal(mirror.condition));
        }
        let base =
            chosen_base(d, &format!("{name}_base"), &self.bases(frac, half), frac, &conditions);
        let mut is_negative = conditions[0];
        for (number, condition) in conditions.iter().enumerate().skip(1) {
            is_negative = d.xor(&format!("{name}_is_negative{number}"), is_negative, *condition);
        }
        // −v equals ~v with a carry into the sum.
        let [value, inverted] = match self.choice {
            Some((condition, cases)) => {
                let cases = cases.map(|case| signal(case).as_signed().with_fraction(frac));
                let inverted = [
                    d.not(&format!("{name}_zero_inverted"), cases[0]),
                    d.not(&format!("{name}_one_inverted"), cases[1]),
                ];
                let condition = signal(condition);
                [
                    d.choose(&format!("{name}_chosen"), condition, cases),
                    d.choose(&format!("{name}_inverted_chosen"), condition, inverted),
                ]
            }
            None => {
                let value = signal(self.start).as_signed().with_fraction(frac);
                [value, d.not(&format!("{name}_inverted"), value)]
            }
        };
        let value = d.choose(&format!("{name}_mirrored"), is_negative, [value, inverted]);
        let sum = d.add_carry(&format!("{name}_sum"), base, value, is_negative);
        match self.rounded {
            Some(node) => {
                let format = plan.node(node).format;
                d.narrow(name, sum, format, Rounding::Truncate, Overflow::Wrap)
            }
            None => sum,
        }
    }

    /// Returns the constant for each combination of conditions, as a raw value with `frac` fraction bits, plus `half`. Bit 0 of
    /// the index is the first condition.
    fn bases(&self, frac: i32, half: i128) -> Vec<i128> {
        let mut bases = Vec::new();
        for combination in 0..1usize << self.mirrors.len() {
            let mut base = 0;
            for (number, mirror) in self.mirrors.iter().enumerate() {
                if combination >> number & 1 == 1 {
                    let (raw, own) = mirror.constant;
                    base = (raw << (frac - own)) - base;
                }
            }
            bases.push(base + half);
        }
        bases
    }
}

/// Returns the mirror at node `id`, and the nodes of the value v and of the difference c − v. Another node must not read the
/// difference.
fn mirror_at(plan: &ExpressionPlan, id: NodeId) -> Option<(Mirror, NodeId, NodeId)> {
    let Operation::Choose { condition, cases: [value, mirrored] } = plan.node(id).operation else {
        return None;
    };
    let Operation::Subtract(constant, subtrahend) = plan.node(mirrored).operation else {
        return None;
    };
    let Operation::Constant { raw, .. } = plan.node(constant).operation else { return None };
    if subtrahend != value || readers(plan, mirrored) != [id] {
        return None;
    }
    let constant = (raw, plan.node(constant).format.frac);
    Some((Mirror { condition, constant }, value, mirrored))
}

fn readers(plan: &ExpressionPlan, id: NodeId) -> Vec<NodeId> {
    let mut readers = Vec::new();
    for (at, node) in plan.nodes.iter().enumerate() {
        if node.operation.inputs().contains(&id) {
            readers.push(NodeId(at));
        }
    }
    readers
}

/// Chooses a constant by the conditions from `bases`, in which bit 0 of an index is the first condition. Equal constants share
/// one net.
fn chosen_base<'d>(
    d: &'d Designer,
    name: &str,
    bases: &[i128],
    frac: i32,
    conditions: &[Signal<'d>],
) -> Signal<'d> {
    let mut row = Vec::new();
    for (number, raw) in bases.iter().enumerate() {
        let same = bases.iter().position(|other| other == raw).unwrap_or(number);
        let constant = match same < number {
            true => row[same],
            false => {
                d.raw_constant(&format!("{name}{number}"), *raw, Format::holding(*raw, *raw, frac))
            }
        };
        row.push(constant);
    }
    for (number, condition) in conditions.iter().enumerate() {
        let mut next = Vec::new();
        for (place, pair) in row.chunks(2).enumerate() {
            let is_same = pair[0].name() == pair[1].name();
            next.push(match is_same {
                true => pair[0],
                false => {
                    let level = format!("{name}_of{number}_{place}");
                    d.choose(&level, *condition, [pair[0], pair[1]])
                }
            });
        }
        row = next;
    }
    row[0]
}

//! Finds chains of mirrored values, whose hardware is a single adder. For example, three conditions mirror an angle from one of
//! eight octants into the first octant.
//!
//! A mirror is a choice between a value v and the difference c − v from a constant c. A chain of up to three such choices, with a
//! sum and the rounding after it, has the value ±v + base. The sign is negative if an odd number of the conditions is 1, and each
//! combination of conditions has a constant base.

use glint_base::fixed::{Format, Rounding};

use super::node::{NodeId, Operation};
use super::plan::ExpressionPlan;

/// Each mirror in a chain doubles the number of constants.
const MOST_MIRRORS: usize = 3;

/// A choice between a value v and the difference c − v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// If this node is 1, the mirror replaces the value v by c − v.
    pub condition: NodeId,
    /// The raw value and the fraction bits of c.
    pub constant: (i128, i32),
}

/// A value that several conditions mirror, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct MirrorChain {
    /// The value before the first mirror.
    pub start: NodeId,
    /// The condition and the cases of `start`, if it is a choice that only the first mirror reads.
    pub choice: Option<(NodeId, [NodeId; 2])>,
    /// The mirrors, in the order in which they are applied.
    pub mirrors: Vec<Mirror>,
    /// The node that is added to the mirrored value, if there is one.
    pub addend: Option<NodeId>,
    /// The node that rounds the sum to the nearest, if there is one.
    pub rounded: Option<NodeId>,
    /// The nodes that the chain replaces, so that they are not built.
    pub inner: Vec<NodeId>,
}

impl MirrorChain {
    /// Returns the chain of mirrors that ends at node `end`; `None` if no mirror is there. `held` says for each node whether it has a
    /// register, which the chain cannot replace.
    pub fn ending_at(plan: &ExpressionPlan, end: NodeId, held: &[bool]) -> Option<Self> {
        let mut chain = Self {
            start: end,
            choice: None,
            mirrors: Vec::new(),
            addend: None,
            rounded: None,
            inner: Vec::new(),
        };
        let is_inner = |node: NodeId| readers(plan, node).len() == 1 && !held[node.0];
        if let Operation::Narrow(a, Rounding::Nearest) = plan.node(end).operation {
            let drops_bits = plan.node(a).format.frac > plan.node(end).format.frac;
            if drops_bits && is_inner(a) {
                chain.rounded = Some(end);
                chain.start = a;
            }
        }
        if let Operation::Add(addend, mirrored) = plan.node(chain.start).operation
            && is_inner(mirrored)
            && mirror_at(plan, mirrored).is_some()
        {
            chain.addend = Some(addend);
            chain.inner.push(chain.start);
            chain.start = mirrored;
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
        let is_choice_inner = !held[chain.start.0] && readers(plan, chain.start).len() == 2;
        if let Operation::Choose { condition, cases } = plan.node(chain.start).operation
            && is_choice_inner
            && chain.addend.is_none()
            && !chain.mirrors.is_empty()
        {
            chain.choice = Some((condition, cases));
            chain.inner.push(chain.start);
        }
        chain.inner.retain(|node| *node != end);
        (!chain.mirrors.is_empty()).then_some(chain)
    }

    /// Returns the number of adders of the operations that the chain replaces.
    pub fn adders(&self) -> usize {
        let others = [self.addend, self.rounded].iter().flatten().count();
        self.mirrors.len() + others
    }

    /// Returns the number of fraction bits of the sum of the chain.
    pub fn fraction_bits(&self, plan: &ExpressionPlan) -> i32 {
        let mut frac = plan.node(self.start).format.frac;
        if let Some(addend) = self.addend {
            frac = frac.max(plan.node(addend).format.frac);
        }
        for mirror in &self.mirrors {
            frac = frac.max(mirror.constant.1);
        }
        frac
    }

    /// Returns the constant for each combination of conditions, as a raw value with `frac` fraction bits, plus half a unit of the
    /// result if it is rounded. Bit 0 of the index is the first condition.
    pub fn bases(&self, plan: &ExpressionPlan, frac: i32) -> Vec<i128> {
        let half = match self.rounded {
            Some(node) => 1i128 << (frac - plan.node(node).format.frac - 1),
            None => 0,
        };
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
    // The opposite of a bit needs no adder.
    let is_bit = plan.node(value).format == Format::BIT;
    if subtrahend != value || is_bit || readers(plan, mirrored) != [id] {
        return None;
    }
    let constant = (raw, plan.node(constant).format.frac);
    Some((Mirror { condition, constant }, value, mirrored))
}

fn readers(plan: &ExpressionPlan, id: NodeId) -> Vec<NodeId> {
    let mut readers = Vec::new();
    for (at, node) in plan.nodes().iter().enumerate() {
        if node.operation.inputs().contains(&id) {
            readers.push(NodeId(at));
        }
    }
    readers
}

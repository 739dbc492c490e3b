//! Finds a minimum cut in a netlist: a set of nets with the fewest bits that together determine some wanted nets.
//!
//! For example, a sum of 5 bits is a smaller cut than its two operands of 4 bits each. The method is a maximum flow; the
//! capacities are the bits of the nets.

use std::collections::{BTreeMap, BTreeSet};

use glint_rtl::netlist::{Design, Driver, NetId};

/// A net and one of its two ends. The edge from (net, `false`) to (net, `true`) has the net's bits as its capacity.
type Vertex = (NetId, bool);

/// Returns the nets with the fewest bits, as `bits` counts them, that together determine the nets `wanted`. The cut contains no
/// net of `affected`, because the fault changes these nets. Returns `None` if the cut has more than `most` bits, or if a net of
/// `affected` is driven by neither a cell nor a constant.
pub(super) fn smallest_cut(
    design: &Design,
    wanted: &BTreeSet<NetId>,
    affected: &BTreeSet<NetId>,
    bits: &impl Fn(NetId) -> u32,
    most: u32,
) -> Option<BTreeSet<NetId>> {
    if affected.iter().any(|net| is_source(design, *net)) {
        return None;
    }
    // The flow goes from the wanted nets back to the sources: freely through affected nets, and through other nets limited by
    // their bits.
    let mut flow: BTreeMap<(Vertex, Vertex), u32> = BTreeMap::new();
    for _ in 0..=most {
        // The vertex from which each vertex was reached; a wanted net has itself.
        let mut came: Vec<Option<Vertex>> = vec![None; 2 * design.nets.len()];
        let mut todo: Vec<Vertex> = wanted.iter().map(|net| (*net, false)).collect();
        for &vertex in &todo {
            came[place(vertex)] = Some(vertex);
        }
        let mut seen = todo.clone();
        let mut end = None;
        while let Some(vertex) = todo.pop() {
            let (net, through) = vertex;
            if through && is_source(design, net) {
                end = Some(vertex);
                break;
            }
            let (near, far) = ((net, false), (net, true));
            let used = flow.get(&(far, near)).copied().unwrap_or(0);
            let mut reached: Vec<Vertex> = Vec::new();
            if through {
                if let Driver::Op(op) = &design.net(net).driver {
                    reached.extend(op.operands().into_iter().map(|operand| (operand, false)));
                }
                if used > 0 {
                    reached.push(near);
                }
            } else {
                let free = affected.contains(&net);
                if free || used < bits(net) {
                    reached.push(far);
                }
                // An amount that already flows may be taken back.
                let (first, last) = ((NetId(0), false), (NetId(u32::MAX), true));
                for ((_, from), amount) in flow.range((near, first)..=(near, last)) {
                    if *amount > 0 {
                        reached.push(*from);
                    }
                }
            }
            for next in reached {
                if came[place(next)].is_none() {
                    came[place(next)] = Some(vertex);
                    todo.push(next);
                    seen.push(next);
                }
            }
        }
        let Some(mut end) = end else {
            // The cut has the nets of which only the first vertex was reached.
            let mut cut = BTreeSet::new();
            for (net, through) in seen {
                if !through && came[place((net, true))].is_none() {
                    cut.insert(net);
                }
            }
            return Some(cut);
        };
        while let Some(from) = came[place(end)] {
            if from == end {
                break;
            }
            match flow.get_mut(&(from, end)) {
                Some(against) if *against > 0 => *against -= 1,
                _ => *flow.entry((end, from)).or_default() += 1,
            }
            end = from;
        }
    }
    None
}

fn is_source(design: &Design, net: NetId) -> bool {
    !matches!(design.net(net).driver, Driver::Op(_) | Driver::Constant(_))
}

/// Returns a vertex's index: a net has `false` at an even index and `true` at the odd index after it.
fn place((net, through): Vertex) -> usize {
    2 * net.index() + usize::from(through)
}

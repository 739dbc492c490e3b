//! Finds the fewest bits that determine some nets: a minimum cut. For example, a sum of 5 bits is a smaller cut than
//! its two operands of 4 bits.

use std::collections::{BTreeMap, BTreeSet};

use glint_rtl::netlist::{Design, Driver, NetId};

/// Vertices of the flow: each net is divided in two, and the flow into it goes through its bits.
type Vertex = (NetId, bool);

/// Returns the nets with the fewest bits together that determine `wanted`. The cut cannot have a net in `affected`.
/// Returns `None` if they have more than `most` bits, or if a net of `affected` is no cell.
pub(super) fn smallest_cut(
    design: &Design,
    wanted: &BTreeSet<NetId>,
    affected: &BTreeSet<NetId>,
    bits: &impl Fn(NetId) -> u32,
    most: u32,
) -> Option<BTreeSet<NetId>> {
    let operands = |net: NetId| match &design.net(net).driver {
        Driver::Op(op) => op.operands(),
        _ => Vec::new(),
    };
    let source =
        |net: NetId| !matches!(design.net(net).driver, Driver::Op(_) | Driver::Constant(_));
    if affected.iter().any(|net| source(*net)) {
        return None;
    }
    // The flow goes back from the wanted nets: freely through affected nets, and through others limited by their
    // bits. The amounts are by where they flow to first.
    let mut flow: BTreeMap<(Vertex, Vertex), u32> = BTreeMap::new();
    let at = |(net, through): Vertex| 2 * net.index() + usize::from(through);
    for _ in 0..=most {
        // Whence each vertex was reached; itself where the way begins.
        let mut came: Vec<Option<Vertex>> = vec![None; 2 * design.nets.len()];
        let mut todo: Vec<Vertex> = wanted.iter().map(|net| (*net, false)).collect();
        todo.iter().for_each(|&vertex| came[at(vertex)] = Some(vertex));
        let mut seen = todo.clone();
        let mut end = None;
        while let Some(vertex) = todo.pop() {
            let (net, through) = vertex;
            if through && source(net) {
                end = Some(vertex);
                break;
            }
            let mut visit = |next: Vertex, room: bool| {
                if room && came[at(next)].is_none() {
                    came[at(next)] = Some(vertex);
                    todo.push(next);
                    seen.push(next);
                }
            };
            let used = |from, to| flow.get(&(to, from)).copied().unwrap_or(0);
            let (near, far) = ((net, false), (net, true));
            if through {
                operands(net).into_iter().for_each(|operand| visit((operand, false), true));
                visit(near, used(near, far) > 0);
            } else {
                let free = affected.contains(&net);
                visit(far, free || used(near, far) < bits(net));
                // Back along the flow that is already there.
                let (first, last) = ((NetId(0), false), (NetId(u32::MAX), true));
                let here = flow.range((near, first)..=(near, last));
                here.for_each(|((_, from), amount)| visit(*from, *amount > 0));
            }
        }
        let Some(mut end) = end else {
            // The cut is the nets that were seen on this side only.
            let cut = seen
                .into_iter()
                .filter(|&(net, through)| !through && came[at((net, true))].is_none());
            return Some(cut.map(|(net, _)| net).collect());
        };
        while let Some(from) = came[at(end)].filter(|from| *from != end) {
            match flow.get_mut(&(from, end)).filter(|against| **against > 0) {
                Some(against) => *against -= 1,
                None => *flow.entry((end, from)).or_default() += 1,
            }
            end = from;
        }
    }
    None
}

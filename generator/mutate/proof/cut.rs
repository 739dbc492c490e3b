//! The fewest bits that determine some nets.

use std::collections::{BTreeMap, BTreeSet};

use crate::hdl::netlist::{Design, Driver, NetId};

/// Vertices of the flow: each net is divided, and what flows into it goes through its bits.
type Vertex = (NetId, bool);

/// The nets with the fewest bits together that determine `wanted`, and of which none is in
/// `affected`. `None` if they have more than `most` bits, or a net of `affected` is no cell.
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
    // From what is wanted back: through affected nets freely, through others by their bits.
    let mut flow: BTreeMap<(Vertex, Vertex), u32> = BTreeMap::new();
    let mut total = 0;
    loop {
        let mut came: BTreeMap<Vertex, Vertex> = BTreeMap::new();
        let mut todo: Vec<Vertex> = wanted.iter().map(|net| (*net, false)).collect();
        let mut seen: BTreeSet<Vertex> = todo.iter().copied().collect();
        let mut end = None;
        while let Some(vertex) = todo.pop() {
            let (net, through) = vertex;
            if through && source(net) {
                end = Some(vertex);
                break;
            }
            let mut visit = |next: Vertex, room: bool| {
                if room && seen.insert(next) {
                    came.insert(next, vertex);
                    todo.push(next);
                }
            };
            let used = |from, to| flow.get(&(from, to)).copied().unwrap_or(0);
            let (near, far) = ((net, false), (net, true));
            if through {
                operands(net).into_iter().for_each(|operand| visit((operand, false), true));
                visit(near, used(near, far) > 0);
            } else {
                let free = affected.contains(&net);
                visit(far, free || used(near, far) < bits(net));
                // Back along what flows here already.
                let back: Vec<Vertex> = flow
                    .iter()
                    .filter(|((_, to), amount)| *to == near && **amount > 0)
                    .map(|((from, _), _)| *from)
                    .collect();
                back.into_iter().for_each(|from| visit(from, true));
            }
        }
        let Some(end) = end else {
            // What was seen on this side only is the cut.
            let cut = seen
                .iter()
                .filter(|(net, through)| !through && !seen.contains(&(*net, true)))
                .map(|(net, _)| *net);
            return Some(cut.collect());
        };
        total += 1;
        if total > most {
            return None;
        }
        let mut at = end;
        while let Some(&from) = came.get(&at) {
            let against = flow.get(&(at, from)).copied().unwrap_or(0);
            if against > 0 {
                flow.insert((at, from), against - 1);
            } else {
                *flow.entry((from, at)).or_default() += 1;
            }
            at = from;
        }
    }
}

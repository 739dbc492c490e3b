//! Assigns products to multipliers, so that one multiplier serves several products of a pipeline, each in its own slot.
//!
//! A pipeline that accepts a point every k clocks counts slots from 0 to k − 1. A point is in stage s while the slot is s modulo
//! k. A product in a known stage therefore needs a multiplier in one slot of k, and products of different slots can share a
//! multiplier. Muxes in front of the multiplier select the factors for its operand registers, and a register behind the
//! multiplier takes the product.

use std::cmp::Reverse;

use super::graph::{Cell, Graph, NodeId, NodeOp};
use glint_base::target::{FAMILIES, Timing};

/// Products that can share multipliers, each in its own slot.
#[derive(Clone, Debug)]
pub struct ProductGroup {
    /// The products, in the order of the computation.
    pub products: Vec<NodeId>,
    /// The number of multipliers, less than the number of products.
    pub units: usize,
    /// Whether the multipliers take signed factors.
    signed: bool,
}

/// A multiplier that several products share.
#[derive(Clone, Debug)]
pub struct MultiplierUnit {
    /// The widths of the two factors, in bits.
    pub widths: [u32; 2],
    pub signed: bool,
    /// For each slot, the product that the multiplier computes, and its factors in the order of the multiplier's operands.
    pub serves: Vec<Option<(NodeId, [NodeId; 2])>>,
}

fn factors(graph: &Graph, id: NodeId) -> Option<[NodeId; 2]> {
    match graph.node(id).cell {
        Cell::Op(NodeOp::Mul(a, b)) => Some([a, b]),
        _ => None,
    }
}

/// Returns the products for which synthesis uses multipliers of the target. Narrow products become look-up tables, for example 5
/// by 5 bits on iCE40. The generic target counts all products.
pub fn products(graph: &Graph, target: &Timing, live: &[NodeId]) -> Vec<NodeId> {
    let least = match FAMILIES.iter().find(|family| family.name() == target.name) {
        Some(family) => family.estimate.least_product,
        None => 0,
    };
    let mut products = Vec::new();
    for &id in live {
        if graph.width(id) >= least && factors(graph, id).is_some() {
            products.push(id);
        }
    }
    products
}

/// Groups the products that can share multipliers. A group that would save no multiplier is left out, so that an interval of 1
/// has no groups. Unsigned products join the signed ones if the multiplier has a bit to spare and this saves multipliers. For
/// example, six products with an interval of 4 need two multipliers.
pub fn kinds(
    graph: &Graph,
    target: &Timing,
    live: &[NodeId],
    interval: usize,
) -> Vec<ProductGroup> {
    // Two groupings: by sign, and with unsigned products among the signed ones if their factors leave a bit for a sign.
    let (mut signed, mut unsigned) = (Vec::new(), Vec::new());
    let (mut with_room, mut without_room) = (Vec::new(), Vec::new());
    for id in products(graph, target, live) {
        let is_signed = graph.node(id).format.signed;
        match is_signed {
            true => signed.push(id),
            false => unsigned.push(id),
        }
        match is_signed || has_room(graph, target, id) {
            true => with_room.push(id),
            false => without_room.push(id),
        }
    }
    let apart = group(signed, unsigned, interval);
    let joined = group(with_room, without_room, interval);
    let count = |groups: &[ProductGroup; 2]| groups[0].units + groups[1].units;
    let mut kinds = if count(&joined) < count(&apart) { joined } else { apart }.to_vec();
    kinds.retain(|kind| kind.units < kind.products.len());
    kinds
}

/// Returns whether the multiplier's operands leave a bit for a sign in both factors.
fn has_room(graph: &Graph, target: &Timing, product: NodeId) -> bool {
    let mut widths =
        factors(graph, product).unwrap_or([product; 2]).map(|factor| graph.width(factor));
    widths.sort_unstable();
    widths[1] < target.multiplier.0 && widths[0] < target.multiplier.1
}

/// Makes a group for signed and a group for unsigned multipliers; `interval` products share a multiplier.
fn group(signed: Vec<NodeId>, unsigned: Vec<NodeId>, interval: usize) -> [ProductGroup; 2] {
    [(signed, true), (unsigned, false)].map(|(products, signed)| {
        let units = products.len().div_ceil(interval);
        ProductGroup { products, units, signed }
    })
}

/// Assigns the products of `kind` to multipliers, the widest first. `stage` has the stage of each node. Among the multipliers
/// that are free in its slot, a product takes the one whose muxes and registers grow the least.
pub fn units(
    graph: &Graph,
    target: &Timing,
    kind: &ProductGroup,
    stage: &[usize],
    interval: usize,
) -> Vec<MultiplierUnit> {
    // A signed multiplier takes an unsigned factor with a zero above it.
    let width = |id: NodeId| {
        let format = graph.node(id).format;
        format.width() + u32::from(kind.signed && !format.signed)
    };
    let mut units =
        vec![
            MultiplierUnit { widths: [1; 2], signed: kind.signed, serves: vec![None; interval] };
            kind.units
        ];
    let mut products = kind.products.clone();
    products.sort_by_key(|id| Reverse(graph.width(*id)));
    for id in products {
        let Some([a, b]) = factors(graph, id) else { continue };
        let slot = stage[id.index()] % interval;
        let mut best: Option<(u32, usize, [u32; 2], [NodeId; 2])> = None;
        for (at, unit) in units.iter().enumerate() {
            if unit.serves[slot].is_some() {
                continue;
            }
            for order in [[a, b], [b, a]] {
                let widths = [0, 1].map(|side| unit.widths[side].max(width(order[side])));
                let mut cost = 0;
                for side in 0..2 {
                    let mut served = unit.serves.iter().flatten();
                    if !served.any(|(_, known)| known[side] == order[side]) {
                        cost += width(order[side]);
                    }
                    cost += (widths[side] - unit.widths[side]) * interval as u32;
                }
                let fits = widths[0].max(widths[1]) <= target.multiplier.0
                    && widths[0].min(widths[1]) <= target.multiplier.1;
                if !fits {
                    cost = u32::MAX;
                }
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, at, widths, order));
                }
            }
        }
        if let Some((_, at, widths, order)) = best {
            units[at].widths = widths;
            units[at].serves[slot] = Some((id, order));
        }
    }
    units
}

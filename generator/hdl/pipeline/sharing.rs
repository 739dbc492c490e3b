//! Assigns products to multipliers that serve several of them, each in a slot of its own.
//!
//! A pipeline that takes a point every k clocks has a point in stage s while the slot is s modulo k. A product whose stage is
//! known therefore takes a multiplier in one slot of k, and products of different slots can share it: their factors come
//! through muxes into the registers before the multiplier, and every product into the one behind it.

use std::cmp::Reverse;

use super::graph::{Cell, Graph, NodeId, NodeOp};
use glint_base::target::{FAMILIES, Timing};

/// Products that can share multipliers.
#[derive(Clone, Debug)]
pub struct ProductGroup {
    /// The products, in order.
    pub products: Vec<NodeId>,
    /// The multipliers, fewer than products: as few as serve them in all slots.
    pub units: usize,
    /// The multipliers take signed factors.
    signed: bool,
}

/// A multiplier and the products that it serves.
#[derive(Clone, Debug)]
pub struct MultiplierUnit {
    /// The bits of its factors.
    pub widths: [u32; 2],
    /// Whether the factors have signs.
    pub signed: bool,
    /// For each slot, the product that the multiplier computes in it, and the factors of this product in the order of
    /// the multiplier's operands.
    pub serves: Vec<Option<(NodeId, [NodeId; 2])>>,
}

/// Returns the factors of a product.
fn factors(graph: &Graph, id: NodeId) -> Option<[NodeId; 2]> {
    match graph.node(id).cell {
        Cell::Op(NodeOp::Mul(a, b)) => Some([a, b]),
        _ => None,
    }
}

/// Returns the products of a computation that take a multiplier of the target. It leaves out the narrow products that
/// synthesis makes of look-up tables.
pub fn products(graph: &Graph, target: &Timing, live: &[NodeId]) -> Vec<NodeId> {
    let family = FAMILIES.iter().find(|family| family.name() == target.name);
    let least = family.map_or(0, |family| family.estimate.least_product);
    let products = live.iter().copied().filter(|&id| graph.width(id) >= least);
    products.filter(|&id| factors(graph, id).is_some()).collect()
}

/// Returns the products of a computation that share multipliers; empty with an interval of 1. Products without a sign are
/// treated as products with one if the multiplier has a bit to spare and this saves multipliers. For example, six products with
/// an interval of 4 need two multipliers.
pub fn kinds(
    graph: &Graph,
    target: &Timing,
    live: &[NodeId],
    interval: usize,
) -> Vec<ProductGroup> {
    let products = products(graph, target, live);
    let signed = |id: &NodeId| graph.node(*id).format.signed;
    let has_room = |id: &NodeId| {
        let mut widths = factors(graph, *id).unwrap_or([*id; 2]).map(|it| graph.width(it));
        widths.sort_unstable();
        widths[1] < target.multiplier.0 && widths[0] < target.multiplier.1
    };
    let units = |products: usize| products.div_ceil(interval);
    let split = |with_room: bool| -> [Vec<NodeId>; 2] {
        let with_sign = |id: &NodeId| signed(id) || (with_room && has_room(id));
        let (with, without) = products.iter().copied().partition(with_sign);
        [with, without]
    };
    let count = |parts: &[Vec<NodeId>; 2]| parts.iter().map(|it| units(it.len())).sum::<usize>();
    let [apart, joined] = [false, true].map(split);
    let parts = if count(&joined) < count(&apart) { joined } else { apart };
    let kinds = parts.into_iter().zip([true, false]).map(|(products, signed)| {
        let units = units(products.len());
        ProductGroup { products, units, signed }
    });
    kinds.filter(|kind| kind.units < kind.products.len()).collect()
}

/// Returns the units that serve the products of a `kind` in these stages. Among the units that are free in its slot,
/// a product takes the unit whose muxes and registers grow the least.
pub fn units(
    graph: &Graph,
    target: &Timing,
    kind: &ProductGroup,
    stage: &[usize],
    interval: usize,
) -> Vec<MultiplierUnit> {
    // A factor without a sign is one bit wider if the multiplier is signed.
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
        let free = units.iter().enumerate().filter(|(_, unit)| unit.serves[slot].is_none());
        for (at, unit) in free {
            for order in [[a, b], [b, a]] {
                let widths = [0, 1].map(|side| unit.widths[side].max(width(order[side])));
                let inputs = (0..2).map(|side| {
                    let has =
                        unit.serves.iter().flatten().any(|(_, known)| known[side] == order[side]);
                    if has { 0 } else { width(order[side]) }
                });
                let grown: u32 = (0..2).map(|side| widths[side] - unit.widths[side]).sum();
                let cost = inputs.sum::<u32>() + grown * interval as u32;
                let fits = widths.iter().max() <= Some(&target.multiplier.0)
                    && widths.iter().min() <= Some(&target.multiplier.1);
                let cost = if fits { cost } else { u32::MAX };
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

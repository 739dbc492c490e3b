//! Routes a block diagram's wires.
//!
//! A wire runs horizontally through the columns of boxes, and vertically in the gaps between two columns. A wire that leads back
//! to an earlier column goes around the boxes.

use std::collections::HashMap;

use super::graph::DiagramGraph;
use super::place::Placement;
use super::tracks::{Side, Trunk, assign};

/// The distance from one track to the next, in units of the drawing.
const TRACK: f64 = 9.0;

/// The space on each side of the tracks of a gap.
const MARGIN: f64 = 14.0;

/// The distance from a box's border to its first pin.
const EDGE: f64 = 8.0;

/// A lane's width, in which a wire that leads back to an earlier column runs around a box.
pub const LANE: f64 = 10.0;

#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// The vertical position at which the wires around the box begin.
    pub top: f64,
    pub upper: f64,
    pub lower: f64,
    pub width: f64,
}

impl Body {
    pub fn lower(&mut self, by: f64) {
        for edge in [&mut self.top, &mut self.upper, &mut self.lower] {
            *edge += by;
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WireSegment {
    /// A horizontal and a vertical position.
    pub from: (f64, f64),
    pub to: (f64, f64),
}

/// The pieces of all wires that one box drives.
#[derive(Clone, Debug, Default)]
pub struct WireRoute {
    pub pieces: Vec<WireSegment>,
    /// The positions at which three or more pieces meet; the drawing marks them with a dot.
    pub junctions: Vec<(f64, f64)>,
    /// The positions at which the wires end in arrows at boxes.
    pub pins: Vec<(f64, f64)>,
}

pub struct Routes {
    pub left: Vec<f64>,
    /// The wires that each box drives.
    pub nets: Vec<WireRoute>,
    pub width: f64,
    /// The left and the right edge of each column.
    pub columns: Vec<(f64, f64)>,
}

impl Routes {
    /// Returns the vertical position of the highest wire, or `f64::MAX` without wires.
    pub fn top(&self) -> f64 {
        let mut top = f64::MAX;
        for piece in self.nets.iter().flat_map(|net| &net.pieces) {
            top = top.min(piece.from.1).min(piece.to.1);
        }
        top
    }

    /// Returns the vertical position of the lowest wire, or 0 without wires. Positions grow downward.
    pub fn bottom(&self) -> f64 {
        let mut bottom: f64 = 0.0;
        for piece in self.nets.iter().flat_map(|net| &net.pieces) {
            bottom = bottom.max(piece.from.1).max(piece.to.1);
        }
        bottom
    }

    pub fn lower(&mut self, by: f64) {
        for net in &mut self.nets {
            for piece in &mut net.pieces {
                piece.from.1 += by;
                piece.to.1 += by;
            }
            for (_, y) in net.junctions.iter_mut().chain(&mut net.pins) {
                *y += by;
            }
        }
    }
}

/// Returns for each box the nets with wires that run around it, because they lead back to an earlier column. A net is the index
/// of the box that drives it, and takes one [`LANE`]. For example, a wire from box 5 back to box 2 gives both boxes a lane for
/// the net 5.
pub fn lanes(graph: &DiagramGraph, back: &[bool]) -> Vec<Vec<usize>> {
    let mut lanes = vec![Vec::new(); graph.boxes.len()];
    for (wire, leads_back) in graph.wires.iter().zip(back) {
        if !leads_back {
            continue;
        }
        for at in [wire.from, wire.to] {
            if !lanes[at].contains(&wire.from) {
                lanes[at].push(wire.from);
            }
        }
    }
    lanes
}

/// Routes the wires between a placement's boxes. `bodies` are the positions of the boxes, and [`lanes`] returns `lanes`.
pub fn routes(
    graph: &DiagramGraph,
    placement: &Placement,
    bodies: &[Body],
    lanes: &[Vec<usize>],
) -> Routes {
    let mut router = Router {
        graph,
        placement,
        bodies,
        lanes,
        gaps: vec![Vec::new(); placement.columns + 1],
        crossings: Vec::new(),
        passes: HashMap::new(),
    };
    // The longest wire of a net is first, so the shorter wires of the net can follow its way.
    let mut order: Vec<usize> = (0..graph.wires.len()).collect();
    order.sort_by_key(|&wire| std::cmp::Reverse(placement.passes[wire].len()));
    let pins = router.pins(&order);
    for &wire in &order {
        router.wire(wire, pins[wire]);
    }
    router.finish(&pins)
}

struct Router<'a> {
    graph: &'a DiagramGraph,
    placement: &'a Placement,
    bodies: &'a [Body],
    lanes: &'a [Vec<usize>],
    /// Gap number k is left of column k.
    gaps: Vec<Vec<Trunk>>,
    /// The net, the column and the vertical position of each crossing of a column.
    crossings: Vec<(usize, usize, f64)>,
    /// The vertical position in a column, for each net, column, and whether the wire leads back.
    passes: HashMap<(usize, usize, bool), f64>,
}

impl Router<'_> {
    /// Returns the y coordinate of a box's output: in the middle of the box and its lanes, where the layout begins the wires.
    fn out(&self, at: usize) -> f64 {
        let body = &self.bodies[at];
        self.placement.middle[at].clamp(body.upper + EDGE, body.lower - EDGE)
    }

    /// Returns the vertical position of the lane of the box `net` around the box `at`.
    fn lane(&self, at: usize, net: usize) -> f64 {
        let lane = self.lanes[at].iter().position(|&other| other == net);
        self.bodies[at].top + LANE * (lane.unwrap_or(0) as f64 + 0.5)
    }

    /// Returns the columns that a wire passes, with its vertical positions, in the wire's direction.
    fn between(&mut self, wire: usize) -> Vec<(usize, f64)> {
        let (net, back) = (self.graph.wires[wire].from, self.placement.back[wire]);
        let mut between = Vec::new();
        for &(column, wanted) in &self.placement.passes[wire] {
            // All wires of a net pass a column at the same position, which its first wire sets.
            let y = *self.passes.entry((net, column, back)).or_insert(wanted);
            between.push((column, y));
        }
        between
    }

    /// Returns the y coordinate at which each wire enters its box. A box's pins are in the order in which its wires arrive, from
    /// above.
    fn pins(&mut self, order: &[usize]) -> Vec<f64> {
        let mut coming: Vec<Vec<(f64, usize)>> = vec![Vec::new(); self.graph.boxes.len()];
        for &at in order {
            let wire = self.graph.wires[at];
            let y = match (self.placement.back[at], self.between(at).last()) {
                (true, _) => self.lane(wire.to, wire.from),
                (false, Some(&(_, y))) => y,
                (false, None) => self.out(wire.from),
            };
            coming[wire.to].push((y, at));
        }
        let mut pins = vec![0.0; self.graph.wires.len()];
        for (body, mut coming) in self.bodies.iter().zip(coming) {
            coming.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (first, last) = (body.upper + EDGE, body.lower - EDGE);
            if let [(y, wire)] = coming[..] {
                pins[wire] = y.clamp(first, last);
                continue;
            }
            let step = (last - first) / (coming.len().max(2) - 1) as f64;
            for (at, (_, wire)) in coming.into_iter().enumerate() {
                pins[wire] = first + step * at as f64;
            }
        }
        pins
    }

    /// Routes the wire with the index `at`, which enters its box at the vertical position `pin`.
    fn wire(&mut self, at: usize, pin: f64) {
        let wire = self.graph.wires[at];
        let net = wire.from;
        let (from, to) = (self.placement.column[wire.from], self.placement.column[wire.to]);
        let between = self.between(at);
        let mut y = self.out(net);
        if !self.placement.back[at] {
            for &(column, pass) in &between {
                self.hop(net, column, (y, Side::Left), (pass, Side::Right));
                self.crossings.push((net, column, pass));
                y = pass;
            }
            self.hop(net, to, (y, Side::Left), (pin, Side::Right));
            return;
        }
        // The wire goes out to the right, runs over its own box in a lane, and leads back to the left.
        let (over, into) = (self.lane(wire.from, net), self.lane(wire.to, net));
        self.hop(net, from + 1, (y, Side::Left), (over, Side::Left));
        self.crossings.push((net, from, over));
        y = over;
        for &(column, pass) in &between {
            self.hop(net, column + 1, (y, Side::Right), (pass, Side::Left));
            self.crossings.push((net, column, pass));
            y = pass;
        }
        if wire.from != wire.to {
            self.hop(net, to + 1, (y, Side::Right), (into, Side::Left));
            self.crossings.push((net, to, into));
            y = into;
        }
        self.hop(net, to, (y, Side::Right), (pin, Side::Right));
    }

    /// Adds the way of a net through a gap. If the net already enters the gap at `entry`, the way becomes one more exit of its
    /// trunk.
    fn hop(&mut self, net: usize, gap: usize, entry: (f64, Side), exit: (f64, Side)) {
        let trunks = &mut self.gaps[gap];
        let found = trunks.iter_mut().find(|it| it.net == net && it.entry == entry);
        match found {
            Some(trunk) if trunk.exits.contains(&exit) => {}
            Some(trunk) => trunk.exits.push(exit),
            None => trunks.push(Trunk { net, entry, exits: vec![exit], track: 0 }),
        }
    }

    /// Assigns tracks to all gaps, and gives columns and boxes their horizontal positions. `pins` has the vertical position at
    /// which each wire enters its box.
    fn finish(mut self, pins: &[f64]) -> Routes {
        let columns = self.placement.columns;
        let tracks: Vec<usize> = self.gaps.iter_mut().map(|gap| assign(gap)).collect();
        let mut widest = vec![0.0_f64; columns];
        for (body, &column) in self.bodies.iter().zip(&self.placement.column) {
            widest[column] = widest[column].max(body.width);
        }
        // The left and the right border of each gap. A column is between one gap and the next.
        let mut borders: Vec<(f64, f64)> = Vec::new();
        let mut x = 0.0;
        for (gap, &tracks) in tracks.iter().enumerate() {
            let outside = (gap == 0 || gap == columns) && tracks == 0;
            let wide =
                if outside { 0.0 } else { 2.0 * MARGIN + TRACK * tracks.saturating_sub(1) as f64 };
            borders.push((x, x + wide));
            x += wide + if gap < columns { widest[gap] } else { 0.0 };
        }
        let mut left: Vec<f64> = Vec::new();
        for (body, &column) in self.bodies.iter().zip(&self.placement.column) {
            let (from, to) = (borders[column].1, borders[column + 1].0);
            left.push(from + (to - from - body.width) / 2.0);
        }
        let mut nets = vec![WireRoute::default(); self.bodies.len()];
        for (gap, trunks) in self.gaps.iter().enumerate() {
            for trunk in trunks {
                nets[trunk.net].trunk(trunk, borders[gap]);
            }
        }
        for &(net, column, y) in &self.crossings {
            nets[net].piece((borders[column].1, y), (borders[column + 1].0, y));
        }
        for (wire, &pin) in self.graph.wires.iter().zip(pins) {
            let (from, to) = (wire.from, wire.to);
            let (start, y) = (left[from] + self.bodies[from].width, self.out(from));
            let (column, net) = (self.placement.column[from], &mut nets[from]);
            net.piece((start, y), (borders[column + 1].0, y));
            net.piece((borders[self.placement.column[to]].1, pin), (left[to], pin));
            net.pins.push((left[to], pin));
        }
        let columns = borders.windows(2).map(|gaps| (gaps[0].1, gaps[1].0)).collect();
        Routes { left, nets, width: x, columns }
    }
}

impl WireRoute {
    fn piece(&mut self, from: (f64, f64), to: (f64, f64)) {
        let piece = WireSegment { from, to };
        if from != to && !self.pieces.contains(&piece) {
            self.pieces.push(piece);
        }
    }

    fn trunk(&mut self, trunk: &Trunk, (left, right): (f64, f64)) {
        if trunk.is_straight() {
            self.piece((left, trunk.entry.0), (right, trunk.entry.0));
            return;
        }
        let x = left + MARGIN + TRACK * trunk.track as f64;
        let (low, high) = trunk.reach();
        self.piece((x, low), (x, high));
        for (y, side) in trunk.taps() {
            match side {
                Side::Left => self.piece((left, y), (x, y)),
                Side::Right => self.piece((x, y), (right, y)),
            }
            let inside = low < y && y < high;
            let taps = trunk.taps().filter(|(other, _)| (other - y).abs() < 0.5);
            // The wires that meet at this point are its taps, and the trunk to one side or both.
            if taps.count() + 1 + usize::from(inside) >= 3 {
                self.junctions.push((x, y));
            }
        }
    }
}

//! Places the boxes of a block diagram in columns from left to right, by the layered layout of the `dagre` library.

use dagre::graph::{Graph as Layered, GraphOptions};
use dagre::{EdgeLabel, LayoutOptions, NodeLabel, RankDir, Ranker, layout};

use super::graph::{BoxForm, DiagramGraph, DiagramWire};
use crate::pages::account::blocks::BlockKind;

/// Between boxes of a column.
const BOXES: f64 = 12.0;

/// Between wires that pass a column.
const WIRES: f64 = 8.0;

/// The weight of a wire at a port when columns are chosen.
const PORT: i32 = 4;

/// The weight of the rule that outputs are at the end. Inputs are placed where they are taken, so that no wire to a
/// late one has to pass by everything else.
const LAST: i32 = 20;

/// The end of the diagram, to which the outputs of the datapath are tied.
const END: &str = "outputs";

/// The place of everything, from above. Columns are numbered from the left.
pub struct Placement {
    /// The column of each box.
    pub column: Vec<usize>,
    /// The middle of the place of each box.
    pub middle: Vec<f64>,
    /// How many columns there are.
    pub columns: usize,
    /// Whether each wire leads back to the left.
    pub back: Vec<bool>,
    /// The places at which each wire passes the columns between its ends, in the wire's own direction.
    pub passes: Vec<Vec<(usize, f64)>>,
}

impl Placement {
    /// Puts boxes of these `heights` into columns; `back` marks the wires that lead back, as [`back`] does. Among
    /// four layouts, it takes the one with the least height, which is the width of the page.
    pub fn new(graph: &DiagramGraph, heights: &[f64], back: &[bool]) -> Self {
        let rankers = [Ranker::NetworkSimplex, Ranker::LongestPath];
        let variants = rankers.into_iter().flat_map(|it| [(it, false), (it, true)]);
        let placements =
            variants.map(|(ranker, last)| Self::variant(graph, heights, back, ranker, last));
        let narrowest = placements.min_by(|a, b| a.height(heights).total_cmp(&b.height(heights)));
        narrowest.expect("there are four")
    }

    /// Returns the height from the top of the highest box to the bottom of the lowest.
    fn height(&self, heights: &[f64]) -> f64 {
        let boxes = || self.middle.iter().zip(heights);
        let top = boxes().map(|(middle, height)| middle - height / 2.0).fold(f64::MAX, f64::min);
        boxes().map(|(middle, height)| middle + height / 2.0).fold(0.0, f64::max) - top
    }

    /// Makes a layout by one way to rank boxes. With `handshake`, the outputs of the handshake are at the end;
    /// otherwise they are placed where there is room.
    fn variant(
        graph: &DiagramGraph,
        heights: &[f64],
        back: &[bool],
        ranker: Ranker,
        handshake: bool,
    ) -> Self {
        let mut layered: Layered<NodeLabel, EdgeLabel> =
            Layered::with_options(GraphOptions { multigraph: true, ..GraphOptions::default() });
        let node = |height| NodeLabel { width: 1.0, height, ..NodeLabel::default() };
        layered.set_node(END, Some(node(1.0)));
        for (at, &height) in heights.iter().enumerate() {
            layered.set_node(at.to_string(), Some(node(height)));
            let edge = EdgeLabel { weight: LAST, ..EdgeLabel::default() };
            if graph.boxes[at].form == BoxForm::Output
                && (handshake || !driven_by_control(graph, at))
            {
                layered.set_edge(at.to_string(), END.to_owned(), Some(edge), None);
            }
        }
        stages(graph, &mut layered);
        let is_port = |at: usize| matches!(graph.boxes[at].form, BoxForm::Input | BoxForm::Output);
        let ends = |wire: usize| {
            let (from, to) = (graph.wires[wire].from, graph.wires[wire].to);
            let (from, to) = if back[wire] { (to, from) } else { (from, to) };
            // Several wires between two boxes go side by side.
            let same = |other: &DiagramWire| *other == graph.wires[wire];
            let first = graph.wires.iter().position(same).unwrap_or(wire);
            (from.to_string(), to.to_string(), first.to_string())
        };
        for (at, wire) in graph.wires.iter().enumerate() {
            // A wire from a box to itself goes around the box.
            if wire.from == wire.to {
                continue;
            }
            let (from, to, name) = ends(at);
            let edge = EdgeLabel {
                weight: if is_port(wire.from) || is_port(wire.to) { PORT } else { 1 },
                ..EdgeLabel::default()
            };
            layered.set_edge(from, to, Some(edge), Some(&name));
        }
        let options = LayoutOptions {
            rankdir: RankDir::LR,
            nodesep: BOXES,
            edgesep: WIRES,
            ranker,
            ..LayoutOptions::default()
        };
        layout(&mut layered, Some(options));

        let at = |node: usize| {
            let found = layered.node(&node.to_string());
            found.and_then(|found| Some((found.x?, found.y?))).unwrap_or_default()
        };
        let places: Vec<(f64, f64)> = (0..heights.len()).map(at).collect();
        let mut xs: Vec<f64> = places.iter().map(|place| place.0.round()).collect();
        xs.sort_unstable_by(f64::total_cmp);
        xs.dedup();
        let column = |x: f64| xs.iter().position(|&column| (column - x).abs() < 1.5);
        let passes = (0..graph.wires.len()).map(|wire| {
            let (from, to, name) = ends(wire);
            let edge = layered.edge(&from, &to, Some(&name));
            let points = edge.map_or(&[][..], |edge| &edge.points);
            // The first and the last are on the borders of the boxes.
            let between = points.get(1..points.len().saturating_sub(1)).unwrap_or_default();
            let mut passes: Vec<(usize, f64)> =
                between.iter().filter_map(|point| Some((column(point.x)?, point.y))).collect();
            if back[wire] {
                passes.reverse();
            }
            passes
        });
        Self {
            column: places.iter().map(|place| column(place.0).unwrap_or(0)).collect(),
            middle: places.iter().map(|place| place.1).collect(),
            columns: xs.len(),
            passes: passes.collect(),
            back: back.to_vec(),
        }
    }
}

/// Ties the boxes of each stage between two nodes that are not drawn, so that a column is in one stage.
fn stages(graph: &DiagramGraph, layered: &mut Layered<NodeLabel, EdgeLabel>) {
    if graph.stages == 0 {
        return;
    }
    let border = |stage: usize| format!("stage {stage}");
    for stage in 0..=graph.stages {
        let node = NodeLabel { width: 1.0, height: 1.0, ..NodeLabel::default() };
        layered.set_node(border(stage), Some(node));
    }
    let mut tie = |from: String, to: String| {
        let edge = EdgeLabel { weight: 0, ..EdgeLabel::default() };
        layered.set_edge(from, to, Some(edge), Some("tie"));
    };
    for (at, one) in graph.boxes.iter().enumerate() {
        let (from, to) = match (one.form, one.stage) {
            (BoxForm::Input, _) => (None, Some(0)),
            (_, Some(stage)) => (Some(stage), Some(stage + 1)),
            (_, None) => (Some(graph.stages), None),
        };
        from.into_iter().for_each(|stage| tie(border(stage), at.to_string()));
        to.into_iter().for_each(|stage| tie(at.to_string(), border(stage)));
    }
}

/// Returns whether an output is the control unit's.
fn driven_by_control(graph: &DiagramGraph, output: usize) -> bool {
    let mut drivers = graph.wires.iter().filter(|wire| wire.to == output);
    drivers.any(|wire| graph.boxes[wire.from].form == BoxForm::Control)
}

/// Marks the wires that lead back. In each loop, it is the wire into the mux that chooses among the most inputs, if the
/// loop has one. For example, in an accumulator it is the wire from the register to the mux in front of the adder.
pub fn back(graph: &DiagramGraph) -> Vec<bool> {
    let weight = |at: usize| match graph.boxes[at].form {
        BoxForm::Block(BlockKind::Mux(inputs)) if !graph.boxes[at].control.is_empty() => 2 + inputs,
        BoxForm::Block(BlockKind::Mux(_)) => 2,
        BoxForm::Block(BlockKind::Register) => 1,
        _ => 0,
    };
    let mut order: Vec<usize> = (0..graph.wires.len()).collect();
    order.sort_by_key(|&wire| std::cmp::Reverse(weight(graph.wires[wire].to)));
    let mut back = vec![false; graph.wires.len()];
    for wire in order {
        back[wire] = reaches(graph, &back, graph.wires[wire].to, graph.wires[wire].from);
    }
    back
}

/// Returns whether there is a way from one box to another that does not lead back.
fn reaches(graph: &DiagramGraph, back: &[bool], from: usize, to: usize) -> bool {
    let mut seen = vec![false; graph.boxes.len()];
    let mut pending = vec![from];
    while let Some(at) = pending.pop() {
        if at == to {
            return true;
        }
        if !std::mem::replace(&mut seen[at], true) {
            let wires = graph.wires.iter().zip(back);
            let onward = wires.filter(|(wire, back)| wire.from == at && !**back);
            pending.extend(onward.map(|(wire, _)| wire.to));
        }
    }
    false
}

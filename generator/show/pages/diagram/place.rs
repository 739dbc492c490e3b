//! Places the boxes of a block diagram in columns from left to right, with the layered layout algorithm of the `dagre`
//! library.
//!
//! The module computes four layouts and takes the lowest one. Wires that lead back, as in a loop of the datapath, are
//! reversed for the algorithm.

use dagre::graph::{Graph as Layered, GraphOptions};
use dagre::{EdgeLabel, LayoutOptions, NodeLabel, RankDir, Ranker, layout};

use super::graph::{BoxForm, DiagramGraph, DiagramWire};
use crate::pages::account::blocks::BlockKind;

/// The distance between two boxes of a column.
const BOXES: f64 = 12.0;

/// The distance between two wires that pass a column.
const WIRES: f64 = 8.0;

/// A wire's weight at a port. The layout keeps wires with a larger weight shorter.
const PORT: i32 = 4;

/// The weight of the edges that pull outputs to the diagram's end.
const LAST: i32 = 20;

/// The node at the diagram's end, which pulls the outputs. It is not drawn.
const END: &str = "outputs";

/// The positions of boxes and wires. Columns are numbered from the left.
pub struct Placement {
    pub column: Vec<usize>,
    /// The vertical position of each box's middle.
    pub middle: Vec<f64>,
    pub columns: usize,
    /// Whether each wire leads back to an earlier column.
    pub back: Vec<bool>,
    /// The columns that each wire passes between its ends, with its vertical position in each, in the wire's direction.
    pub passes: Vec<Vec<(usize, f64)>>,
}

impl Placement {
    /// Places the boxes. `heights` are the heights of the boxes, and `back` marks the wires that lead back ([`back`]). The lowest
    /// of four layouts is taken, because the turned diagram then has the smallest width.
    pub fn new(graph: &DiagramGraph, heights: &[f64], back: &[bool]) -> Self {
        let variants = [
            (Ranker::NetworkSimplex, false),
            (Ranker::NetworkSimplex, true),
            (Ranker::LongestPath, false),
            (Ranker::LongestPath, true),
        ];
        let placements =
            variants.map(|(ranker, last)| Self::variant(graph, heights, back, ranker, last));
        let narrowest =
            placements.into_iter().min_by(|a, b| a.height(heights).total_cmp(&b.height(heights)));
        narrowest.expect("there are four")
    }

    fn height(&self, heights: &[f64]) -> f64 {
        let (mut top, mut bottom) = (f64::MAX, 0.0_f64);
        for (middle, height) in self.middle.iter().zip(heights) {
            top = top.min(middle - height / 2.0);
            bottom = bottom.max(middle + height / 2.0);
        }
        bottom - top
    }

    /// Computes one layout. `ranker` is the algorithm that chooses columns. With `handshake`, the handshake's outputs are also at
    /// the end; otherwise the layout chooses their places.
    fn variant(
        graph: &DiagramGraph,
        heights: &[f64],
        back: &[bool],
        ranker: Ranker,
        handshake: bool,
    ) -> Self {
        let mut layered: Layered<NodeLabel, EdgeLabel> =
            Layered::with_options(GraphOptions { multigraph: true, ..GraphOptions::default() });
        layered.set_node(END, Some(node(1.0)));
        for (at, &height) in heights.iter().enumerate() {
            layered.set_node(at.to_string(), Some(node(height)));
            if graph.boxes[at].form == BoxForm::Output
                && (handshake || !driven_by_control(graph, at))
            {
                layered.set_edge(at.to_string(), END.to_owned(), Some(edge(LAST)), None);
            }
        }
        stages(graph, &mut layered);
        for (at, wire) in graph.wires.iter().enumerate() {
            // A wire from a box to itself goes around the box.
            if wire.from == wire.to {
                continue;
            }
            let (from, to, name) = edge_names(graph, back, at);
            let weight =
                if is_port(graph, wire.from) || is_port(graph, wire.to) { PORT } else { 1 };
            layered.set_edge(from, to, Some(edge(weight)), Some(&name));
        }
        let options = LayoutOptions {
            rankdir: RankDir::LR,
            nodesep: BOXES,
            edgesep: WIRES,
            ranker,
            ..LayoutOptions::default()
        };
        layout(&mut layered, Some(options));
        Self::read(graph, heights.len(), back, &layered)
    }

    fn read(
        graph: &DiagramGraph,
        boxes: usize,
        back: &[bool],
        layered: &Layered<NodeLabel, EdgeLabel>,
    ) -> Self {
        let mut places: Vec<(f64, f64)> = Vec::new();
        for at in 0..boxes {
            places.push(match layered.node(&at.to_string()) {
                Some(NodeLabel { x: Some(x), y: Some(y), .. }) => (*x, *y),
                _ => (0.0, 0.0),
            });
        }
        let mut columns: Vec<f64> = places.iter().map(|(x, _)| x.round()).collect();
        columns.sort_unstable_by(f64::total_cmp);
        columns.dedup();
        let mut all_passes = Vec::new();
        for wire in 0..graph.wires.len() {
            let (from, to, name) = edge_names(graph, back, wire);
            let mut passes: Vec<(usize, f64)> = Vec::new();
            if let Some(edge) = layered.edge(&from, &to, Some(&name)) {
                // The first and the last point of an edge are on the borders of the boxes.
                let last = edge.points.len().saturating_sub(1);
                for point in edge.points.get(1..last).unwrap_or_default() {
                    if let Some(column) = nearest_column(&columns, point.x) {
                        passes.push((column, point.y));
                    }
                }
            }
            if back[wire] {
                passes.reverse();
            }
            all_passes.push(passes);
        }
        Self {
            column: places.iter().map(|(x, _)| nearest_column(&columns, *x).unwrap_or(0)).collect(),
            middle: places.iter().map(|(_, y)| *y).collect(),
            columns: columns.len(),
            passes: all_passes,
            back: back.to_vec(),
        }
    }
}

fn node(height: f64) -> NodeLabel {
    NodeLabel { width: 1.0, height, ..NodeLabel::default() }
}

fn edge(weight: i32) -> EdgeLabel {
    EdgeLabel { weight, ..EdgeLabel::default() }
}

fn is_port(graph: &DiagramGraph, at: usize) -> bool {
    matches!(graph.boxes[at].form, BoxForm::Input | BoxForm::Output)
}

/// Returns the names of a wire's ends and of its edge in the layout. For a wire that leads back, the ends are swapped.
fn edge_names(graph: &DiagramGraph, back: &[bool], wire: usize) -> (String, String, String) {
    let DiagramWire { from, to } = graph.wires[wire];
    let (start, end) = if back[wire] { (to, from) } else { (from, to) };
    let first = graph.wires.iter().position(|other| *other == graph.wires[wire]).unwrap_or(wire);
    (start.to_string(), end.to_string(), first.to_string())
}

fn nearest_column(columns: &[f64], x: f64) -> Option<usize> {
    columns.iter().position(|&column| (column - x).abs() < 1.5)
}

/// Adds two nodes around each stage, which are not drawn, and edges from them to the stage's boxes. All boxes of a column are
/// then in the same stage.
fn stages(graph: &DiagramGraph, layered: &mut Layered<NodeLabel, EdgeLabel>) {
    if graph.stages == 0 {
        return;
    }
    for stage in 0..=graph.stages {
        layered.set_node(stage_border(stage), Some(node(1.0)));
    }
    for (at, one) in graph.boxes.iter().enumerate() {
        let (from, to) = match (one.form, one.stage) {
            (BoxForm::Input, _) => (None, Some(0)),
            (_, Some(stage)) => (Some(stage), Some(stage + 1)),
            (_, None) => (Some(graph.stages), None),
        };
        if let Some(stage) = from {
            layered.set_edge(stage_border(stage), at.to_string(), Some(edge(0)), Some("tie"));
        }
        if let Some(stage) = to {
            layered.set_edge(at.to_string(), stage_border(stage), Some(edge(0)), Some("tie"));
        }
    }
}

fn stage_border(stage: usize) -> String {
    format!("stage {stage}")
}

fn driven_by_control(graph: &DiagramGraph, output: usize) -> bool {
    let mut drivers = graph.wires.iter().filter(|wire| wire.to == output);
    drivers.any(|wire| graph.boxes[wire.from].form == BoxForm::Control)
}

/// Returns for each wire whether it leads back to an earlier column. Every loop has such a wire. If a loop has a mux, the wire
/// ends at the mux with the most inputs. For example, in an accumulator it is the wire from the register to the mux in front of
/// the adder.
pub fn back(graph: &DiagramGraph) -> Vec<bool> {
    let mut order: Vec<usize> = (0..graph.wires.len()).collect();
    order.sort_by_key(|&wire| std::cmp::Reverse(back_weight(graph, graph.wires[wire].to)));
    let mut back = vec![false; graph.wires.len()];
    for wire in order {
        back[wire] = reaches(graph, &back, graph.wires[wire].to, graph.wires[wire].from);
    }
    back
}

/// Returns how suitable a box is as the end of a wire that leads back.
fn back_weight(graph: &DiagramGraph, at: usize) -> usize {
    match graph.boxes[at].form {
        BoxForm::Block(BlockKind::Mux(inputs)) if !graph.boxes[at].control.is_empty() => 2 + inputs,
        BoxForm::Block(BlockKind::Mux(_)) => 2,
        BoxForm::Block(BlockKind::Register) => 1,
        _ => 0,
    }
}

/// Returns whether a path leads from the box `from` to the box `to`, without wires that lead back.
fn reaches(graph: &DiagramGraph, back: &[bool], from: usize, to: usize) -> bool {
    let mut seen = vec![false; graph.boxes.len()];
    let mut pending = vec![from];
    while let Some(at) = pending.pop() {
        if at == to {
            return true;
        }
        if !std::mem::replace(&mut seen[at], true) {
            for (wire, leads_back) in graph.wires.iter().zip(back) {
                if wire.from == at && !leads_back {
                    pending.push(wire.to);
                }
            }
        }
    }
    false
}

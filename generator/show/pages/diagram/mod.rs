//! Draws the block diagram of a core as SVG, with the blocks in columns from the inputs to the outputs.
//!
//! `place` assigns the blocks to columns from left to right, and `route` draws the wires. The finished diagram is turned by 90°,
//! so it reads from top to bottom. A datapath has more columns than blocks in one column, so the turned diagram fits a page. For
//! a pipeline, each stage has a band, and a mark on a wire shows a register between two stages.

mod graph;
mod place;
mod route;
mod tracks;

use anyhow::Result;

use crate::pages::account::blocks::BlockKind;
use crate::pages::drawing::{Drawing, Item, text_width};
use glint_rtl::netlist::{Design, Pipeline, Stage};
use graph::{BoxForm, DiagramBox, DiagramGraph};
use place::Placement;
use route::{Body, LANE, Routes, WireRoute, WireSegment};

/// The height of a line of text in a box, in units of the drawing.
const LINE: i32 = 14;

/// The space above, and below, the text in a box.
const PADDING: i32 = 6;

/// The length of the longest caption on one line, in characters. A longer caption has a line for each of its parts, which ` · `
/// separates.
const LONG: usize = 17;

/// The smallest distance between two pins of a box.
const PIN: f64 = 9.0;

/// The length of the arrow of the control lines beside a box.
const STUB: f64 = 14.0;

/// The space on each side of the text in a box.
const MARGIN: i32 = 10;

/// The height of the triangular tip at the lower end of the shape that is drawn for a port.
const NECK: i32 = 8;

/// The width of the empty border around the drawing.
const BORDER: i32 = 12;

/// The width of the notes beside a stage.
const ASIDE: i32 = 140;

/// The distance from a stage's boxes to the registers at its end.
const REGISTERS: f64 = 7.0;

pub fn drawing(design: &Design) -> Drawing {
    let graph = DiagramGraph::new(design);
    let back = place::back(&graph);
    let lanes = route::lanes(&graph, &back);
    let mut sizes: Vec<Sizes> = Vec::new();
    for (at, lanes_of_box) in lanes.iter().enumerate() {
        sizes.push(Sizes::new(&graph, at, lanes_of_box.len()));
    }
    let heights: Vec<f64> = sizes.iter().map(Sizes::all).collect();
    let placement = Placement::new(&graph, &heights, &back);
    let mut bodies: Vec<Body> = Vec::new();
    for (sizes, middle) in sizes.iter().zip(&placement.middle) {
        bodies.push(sizes.body(*middle));
    }
    let mut routes = route::routes(&graph, &placement, &bodies, &lanes);
    // Wires around the topmost box run above it.
    let above = routes.top().min(0.0);
    routes.lower(-above);
    for body in &mut bodies {
        body.lower(-above);
    }
    let mut items = Vec::new();
    let mut page = Page { left: 0, items: &mut items };
    if let Some(pipeline) = &design.pipeline {
        page.left = ASIDE;
        page.stages(pipeline, &graph, &placement, &routes);
    }
    for (at, net) in routes.nets.iter().enumerate() {
        page.net(net, &graph.boxes[at]);
    }
    for (at, one) in graph.boxes.iter().enumerate() {
        page.block(one, routes.left[at], &bodies[at]);
    }
    let left = page.left;
    let (mut blocks, mut inputs, mut outputs) = (0, 0, 0);
    for one in &graph.boxes {
        match one.form {
            BoxForm::Block(BlockKind::Constant) => {}
            BoxForm::Block(_) => blocks += 1,
            BoxForm::Input => inputs += 1,
            BoxForm::Output => outputs += 1,
            _ => {}
        }
    }
    let between = match &design.pipeline {
        None => format!("{blocks} blocks and the control unit"),
        Some(pipeline) => format!("{} stages with {blocks} blocks", pipeline.stages.len()),
    };
    Drawing {
        id: "block-diagram".to_owned(),
        title: format!("Blocks of {}", design.name),
        description: format!(
            "{between} between {inputs} inputs at the top and {outputs} outputs at the bottom. A table below says the same in words."
        ),
        width: left + coordinate(bottom(&bodies, &routes)) + BORDER,
        height: coordinate(routes.width) + BORDER,
        items,
    }
}

/// Returns the block diagram as an SVG file. Fails if the template cannot be printed.
pub fn svg(design: &Design) -> Result<String> {
    drawing(design).file()
}

/// The size of a box in the layout. The page shows the layout turned, so a height in the layout is a width on the page.
struct Sizes {
    lanes: f64,
    stub: f64,
    height: f64,
    width: f64,
}

impl Sizes {
    fn new(graph: &DiagramGraph, at: usize, lanes: usize) -> Self {
        let one = &graph.boxes[at];
        let pins = graph.wires.iter().filter(|wire| wire.to == at).count();
        if one.form == BoxForm::Empty {
            return Self { lanes: 0.0, stub: 0.0, height: 1.0, width: f64::from(2 * LINE) };
        }
        let lines = lines(one);
        let widest = lines.iter().map(|(_, text)| text_width(text)).max();
        let neck = if is_port(one) { NECK } else { 0 };
        Self {
            lanes: LANE * lanes as f64,
            stub: if one.control.is_empty() { 0.0 } else { STUB },
            height: f64::from(widest.unwrap_or(0) + 2 * MARGIN).max(PIN * (pins + 1) as f64),
            width: f64::from(LINE * lines.len() as i32 + 2 * PADDING + neck),
        }
    }

    /// Returns the height of the box with the lanes and the control arrow beside it.
    fn all(&self) -> f64 {
        self.lanes + self.stub + self.height
    }

    /// Returns the box's position. `middle` is the middle of its whole height.
    fn body(&self, middle: f64) -> Body {
        let top = (middle - self.all() / 2.0).round();
        let upper = top + self.lanes + self.stub;
        Body { top, upper, lower: upper + self.height, width: self.width }
    }
}

fn is_port(one: &DiagramBox) -> bool {
    matches!(one.form, BoxForm::Input | BoxForm::Output)
}

/// Returns the lines of text of a box, each with its class. The control lines come last. For example, `15 difference`, `adder ·
/// u0.8` and `30`.
fn lines(one: &DiagramBox) -> Vec<(&'static str, String)> {
    let head = match one.number {
        Some(number) => format!("{number} {}", one.name),
        None => one.name.clone(),
    };
    let class = if is_port(one) { "tick" } else { "tick name" };
    let mut lines = vec![(class, head)];
    let mut small_lines = one.aliases.clone();
    match one.caption.chars().count() {
        0 => {}
        1..=LONG => small_lines.push(one.caption.clone()),
        _ => small_lines.extend(one.caption.split(" · ").map(str::to_owned)),
    }
    for line in small_lines {
        lines.push(("tick small", line));
    }
    if !one.control.is_empty() {
        lines.push(("control-lines", one.control.clone()));
    }
    lines
}

fn bottom(bodies: &[Body], routes: &Routes) -> f64 {
    bodies.iter().map(|body| body.lower).fold(routes.bottom(), f64::max)
}

fn coordinate(value: f64) -> i32 {
    value.round() as i32 + BORDER
}

/// The area to the right of the notes on stages. It begins at `left`, and its methods append to `items`.
struct Page<'a> {
    left: i32,
    items: &'a mut Vec<Item>,
}

impl Page<'_> {
    /// Converts a point of the layout to the page, which shows the layout turned.
    fn point(&self, (x, y): (f64, f64)) -> String {
        format!("{} {}", self.left + coordinate(y), coordinate(x))
    }

    /// Draws a pipeline's stages. Beside a stage is a note with its delay, slack and register bits. At its end is a line, with a
    /// mark for each wire that a register interrupts.
    fn stages(
        &mut self,
        pipeline: &Pipeline,
        graph: &DiagramGraph,
        place: &Placement,
        routes: &Routes,
    ) {
        // For each stage with boxes, the beginning of its first column and the end of its last column.
        let mut extents: Vec<Option<(f64, f64)>> = vec![None; pipeline.stages.len()];
        for (one, column) in graph.boxes.iter().zip(&place.column) {
            let Some(stage) = one.stage else { continue };
            let Some(extent) = extents.get_mut(stage) else { continue };
            let (from, to) = routes.columns[*column];
            let (least, most) = extent.unwrap_or((f64::MAX, 0.0));
            *extent = Some((from.min(least), to.max(most)));
        }
        let first = match extents.first() {
            Some(Some((from, _))) => *from,
            _ => f64::MAX,
        };
        let mut top = first - 2.0 * REGISTERS;
        for (number, stage) in pipeline.stages.iter().enumerate() {
            // A stage in which only shared multipliers work has no box, and is not drawn.
            let Some((_, end)) = extents[number] else { continue };
            let bottom = end + REGISTERS;
            self.stage(number, stage, [top, bottom], routes);
            top = bottom;
        }
    }

    fn stage(&mut self, number: usize, stage: &Stage, ends: [f64; 2], routes: &Routes) {
        let [top, bottom] = ends.map(coordinate);
        let mut said = vec![
            ("name", format!("stage {number}")),
            ("small", format!("{:.2} ns", stage.logic_ns)),
            ("small", format!("slack {:.2} ns", stage.slack_ns)),
            ("small", format!("{} register bits", stage.register_bits)),
        ];
        if stage.delayed_bits > 0 {
            said.push(("small", format!("{} in delay lines", stage.delayed_bits)));
        }
        self.items.push(Item::Open { class: "stage", title: stage.microinstructions.join("; ") });
        let right = self.left + coordinate(routes.bottom());
        self.items.push(Item::path("grid", format!("M{BORDER} {bottom}H{right}")));
        for (at, (class, line)) in (1..).zip(said) {
            self.items.push(Item::text(class, BORDER, top + 13 * at, line));
        }
        let mut marks = String::new();
        for x in crossings(routes, ends[1]) {
            marks += &format!("M{} {}h8v4h-8Z", self.left + x - 4, bottom - 2);
        }
        self.items.push(Item::path("arrow", marks));
        self.items.push(Item::Close);
    }

    fn net(&mut self, net: &WireRoute, driver: &DiagramBox) {
        if net.pieces.is_empty() {
            return;
        }
        self.items.push(Item::Open { class: "net", title: driver.title.clone() });
        let mut lines = String::new();
        for piece in &net.pieces {
            lines += &format!("M{}L{}", self.point(piece.from), self.point(piece.to));
        }
        self.items.push(Item::path("wire", lines));
        let mut arrows = String::new();
        for &pin in &net.pins {
            arrows += &format!("M{}l-3 -6h6Z", self.point(pin));
        }
        self.items.push(Item::path("arrow", arrows));
        if !net.junctions.is_empty() {
            let mut dots = String::new();
            for &junction in &net.junctions {
                dots += &format!("M{}m-2 0a2 2 0 1 0 4 0a2 2 0 1 0 -4 0Z", self.point(junction));
            }
            self.items.push(Item::path("arrow", dots));
        }
        self.items.push(Item::Close);
    }

    fn block(&mut self, one: &DiagramBox, left: f64, body: &Body) {
        if one.form == BoxForm::Empty {
            return;
        }
        let (x, y) = (self.left + coordinate(body.upper), coordinate(left));
        let (width, height) = ((body.lower - body.upper).round() as i32, body.width.round() as i32);
        let items = &mut *self.items;
        items.push(Item::Open { class: "block", title: one.title.clone() });
        items.push(Item::path(class(one.form), outline(one.form, x, y, width, height)));
        if matches!(one.form, BoxForm::Block(BlockKind::Register | BlockKind::Operand)) {
            // The clock's mark.
            let (right, edge) = (x + width, y + height);
            items.push(Item::path("notch", format!("M{right} {}l-6 -4l6 -4", edge - 3)));
        }
        let mut base = y + PADDING - 3;
        for (class, text) in lines(one) {
            base += LINE;
            if class == "control-lines" {
                let (middle, stub) = (base - 4, STUB as i32);
                items.push(Item::path("control wire", format!("M{} {middle}h{stub}", x - stub)));
                items.push(Item::path("control arrow", format!("M{x} {middle}l-6 -3v6Z")));
            }
            items.push(Item::text(class, x + width / 2, base, text));
        }
        items.push(Item::Close);
    }
}

fn crossings(routes: &Routes, end: f64) -> Vec<i32> {
    let mut places: Vec<i32> = Vec::new();
    for net in &routes.nets {
        for WireSegment { from, to } in &net.pieces {
            if from.1 == to.1 && from.0 < end && end < to.0 {
                places.push(coordinate(from.1));
            }
        }
    }
    places.sort_unstable();
    places.dedup();
    places
}

fn class(form: BoxForm) -> &'static str {
    match form {
        BoxForm::Input | BoxForm::Output => "box port",
        BoxForm::Control => "box control",
        BoxForm::Block(BlockKind::Register | BlockKind::Operand) => "box register",
        BoxForm::Block(BlockKind::Rom | BlockKind::Constant) => "box memory",
        BoxForm::Block(BlockKind::Mux(_)) => "box mux",
        BoxForm::Block(_) | BoxForm::Empty => "box",
    }
}

/// Returns a box's outline. Ports point down the page, in the signal's direction; muxes narrow toward their output.
fn outline(form: BoxForm, x: i32, y: i32, width: i32, height: i32) -> String {
    let (right, bottom, middle) = (x + width, y + height, x + width / 2);
    match form {
        BoxForm::Input | BoxForm::Output => {
            let neck = bottom - NECK;
            format!("M{x} {y}H{right}V{neck}L{middle} {bottom}L{x} {neck}Z")
        }
        BoxForm::Block(BlockKind::Mux(_)) => {
            let (left, right, wide) = (x + 6, right - 6, right);
            format!("M{x} {y}H{wide}L{right} {bottom}H{left}Z")
        }
        _ => format!("M{x} {y}H{right}V{bottom}H{x}Z"),
    }
}

//! The block diagram: the blocks of the netlist, laid out in ranks from the inputs to the outputs.
//!
//! `place` and `route` lay it out from left to right. The page shows it turned, from top to bottom: a datapath has more
//! ranks than blocks in one, so that this is the form that fits a page, on a screen and on paper.

mod graph;
mod place;
mod route;
mod tracks;

use crate::hdl::netlist::Design;
use crate::pages::account::blocks::BlockKind;
use crate::pages::drawing::{Drawing, Item, text_width};
use graph::{BoxForm, Graph, Node};
use place::Placement;
use route::{Body, LANE, Net, Routes};

/// Of the type.
const SIZE: f64 = 11.0;

/// Of a line of text in a box.
const LINE: i32 = 14;

/// Above and below the text in a box.
const PADDING: i32 = 6;

/// A caption that is longer, in characters, takes two lines.
const LONG: usize = 17;

/// The least distance of pins.
const PIN: f64 = 9.0;

/// The arrow of the control lines beside a box.
const STUB: f64 = 14.0;

/// Beside the text in a box.
const MARGIN: i32 = 10;

/// The point of a port.
const NECK: i32 = 8;

/// Around the drawing.
const BORDER: i32 = 12;

/// Draws the blocks of a design.
pub fn drawing(design: &Design) -> Drawing {
    let graph = Graph::new(design);
    let back = place::back(&graph);
    let lanes = route::lanes(&graph, &back);
    let sizes: Vec<Sizes> =
        (0..graph.boxes.len()).map(|at| Sizes::new(&graph, at, lanes[at].len())).collect();
    let heights: Vec<f64> = sizes.iter().map(Sizes::all).collect();
    let placement = Placement::new(&graph, &heights, &back);
    let mut bodies: Vec<Body> =
        sizes.iter().zip(&placement.middle).map(|(sizes, middle)| sizes.body(*middle)).collect();
    let mut routes = route::routes(&graph, &placement, &bodies, &lanes);
    // Wires around the topmost box run above it.
    let above = routes.top().min(0.0);
    routes.lower(-above);
    bodies.iter_mut().for_each(|body| body.lower(-above));
    let mut items = Vec::new();
    for (at, net) in routes.nets.iter().enumerate() {
        draw_net(net, &graph.boxes[at], &mut items);
    }
    for (at, one) in graph.boxes.iter().enumerate() {
        draw_box(one, routes.left[at], &bodies[at], &mut items);
    }
    let count = |wanted: fn(BoxForm) -> bool| {
        let boxes = graph.boxes.iter();
        boxes.filter(|one| wanted(one.form)).count()
    };
    Drawing {
        id: "block-diagram".to_owned(),
        title: format!("Blocks of {}", design.name),
        description: format!(
            "{} blocks and the control unit between {} inputs at the top and {} outputs at the bottom. The table of blocks \
             says what each of them takes.",
            count(|form| matches!(form, BoxForm::Block(_))),
            count(|form| form == BoxForm::Input),
            count(|form| form == BoxForm::Output),
        ),
        width: coordinate(bottom(&bodies, &routes)) + BORDER,
        height: coordinate(routes.width) + BORDER,
        items,
    }
}

/// What a box takes in the layout, which sees the page turned: its height there is the width on the page.
struct Sizes {
    lanes: f64,
    stub: f64,
    height: f64,
    width: f64,
}

impl Sizes {
    fn new(graph: &Graph, at: usize, lanes: usize) -> Self {
        let one = &graph.boxes[at];
        let pins = graph.wires.iter().filter(|wire| wire.to == at).count();
        let lines = lines(one);
        let widest = lines.iter().map(|(_, text)| text_width(text, SIZE)).max();
        let neck = if is_port(one) { NECK } else { 0 };
        Self {
            lanes: LANE * lanes as f64,
            stub: if one.control.is_empty() { 0.0 } else { STUB },
            height: f64::from(widest.unwrap_or(0) + 2 * MARGIN).max(PIN * (pins + 1) as f64),
            width: f64::from(LINE * lines.len() as i32 + 2 * PADDING + neck),
        }
    }

    fn all(&self) -> f64 {
        self.lanes + self.stub + self.height
    }

    fn body(&self, middle: f64) -> Body {
        let top = (middle - self.all() / 2.0).round();
        let upper = top + self.lanes + self.stub;
        Body { top, upper, lower: upper + self.height, width: self.width }
    }
}

fn is_port(one: &Node) -> bool {
    matches!(one.form, BoxForm::Input | BoxForm::Output)
}

/// The text of a box, with the class of each line; the lines that control it are the last.
fn lines(one: &Node) -> Vec<(&'static str, String)> {
    let head = match one.number {
        Some(number) => format!("{number} {}", one.name),
        None => one.name.clone(),
    };
    let class = if is_port(one) { "tick" } else { "tick name" };
    let mut lines = vec![(class, head)];
    match one.caption.split_once(" · ") {
        Some((kind, format)) if one.caption.chars().count() > LONG => {
            lines.extend([kind, format].map(|line| ("tick small", line.to_owned())));
        }
        _ => lines.push(("tick small", one.caption.clone())),
    }
    if !one.control.is_empty() {
        lines.push(("control-lines", one.control.clone()));
    }
    lines
}

fn bottom(bodies: &[Body], routes: &Routes) -> f64 {
    let boxes = bodies.iter().map(|body| body.lower);
    let pieces = routes.nets.iter().flat_map(|net| &net.pieces);
    let wires = pieces.map(|piece| piece.from.1.max(piece.to.1));
    boxes.chain(wires).fold(0.0, f64::max)
}

/// On whole units, with the border.
fn coordinate(value: f64) -> i32 {
    value.round() as i32 + BORDER
}

/// A place of the layout on the page, which shows it turned.
fn point((x, y): (f64, f64)) -> String {
    format!("{} {}", coordinate(y), coordinate(x))
}

fn draw_net(net: &Net, driver: &Node, items: &mut Vec<Item>) {
    if net.pieces.is_empty() {
        return;
    }
    items.push(Item::Open { class: "net", title: driver.title.clone() });
    let pieces = net.pieces.iter();
    let lines = pieces.map(|piece| format!("M{}L{}", point(piece.from), point(piece.to)));
    items.push(Item::path("wire", lines.collect::<String>()));
    let arrows = net.pins.iter().map(|&pin| format!("M{}l-3 -6h6Z", point(pin)));
    items.push(Item::path("arrow", arrows.collect::<String>()));
    if !net.junctions.is_empty() {
        let dots = net.junctions.iter();
        let dots = dots.map(|&at| format!("M{}m-2 0a2 2 0 1 0 4 0a2 2 0 1 0 -4 0Z", point(at)));
        items.push(Item::path("arrow", dots.collect::<String>()));
    }
    items.push(Item::Close);
}

fn draw_box(one: &Node, left: f64, body: &Body, items: &mut Vec<Item>) {
    let (x, y) = (coordinate(body.upper), coordinate(left));
    let (width, height) = ((body.lower - body.upper).round() as i32, body.width.round() as i32);
    items.push(Item::Open { class: "block", title: one.title.clone() });
    items.push(Item::path(class(one.form), outline(one.form, x, y, width, height)));
    if matches!(one.form, BoxForm::Block(BlockKind::Register | BlockKind::Operand)) {
        // The mark of the clock.
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

/// The class of a box, which gives it its colour; its caption says the same.
fn class(form: BoxForm) -> &'static str {
    match form {
        BoxForm::Input | BoxForm::Output => "box port",
        BoxForm::Control => "box control",
        BoxForm::Block(BlockKind::Register | BlockKind::Operand) => "box register",
        BoxForm::Block(BlockKind::Rom | BlockKind::Constant) => "box memory",
        BoxForm::Block(BlockKind::Mux(_)) => "box mux",
        BoxForm::Block(_) => "box",
    }
}

/// Ports point in the direction of the signal, down the page; muxes narrow toward their output.
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

//! The block diagram: the blocks of the netlist, laid out in columns from the inputs to the outputs.

mod graph;
mod place;
mod route;
mod tracks;

use crate::hdl::netlist::Design;
use crate::pages::account::blocks::Kind;
use crate::pages::drawing::{Drawing, Item, text_width};
use graph::{Form, Graph, Node};
use place::Placement;
use route::{Body, LANE, Net, Routes};

/// Of the type.
const SIZE: f64 = 11.0;

/// A box with two lines of text.
const HEIGHT: f64 = 40.0;

/// A box with one.
const LOW: f64 = 24.0;

/// The least distance of pins.
const PIN: f64 = 9.0;

/// What control lines take above a box.
const STUB: f64 = 18.0;

/// Beside the text in a box.
const MARGIN: i32 = 10;

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
    let placement = Placement::new(&graph, &heights, back);
    let bodies: Vec<Body> =
        sizes.iter().zip(&placement.middle).map(|(sizes, middle)| sizes.body(*middle)).collect();
    let routes = route::routes(&graph, &placement, &bodies, &lanes);
    let mut items = Vec::new();
    for (at, net) in routes.nets.iter().enumerate() {
        draw_net(net, &graph.boxes[at], &mut items);
    }
    for (at, one) in graph.boxes.iter().enumerate() {
        draw_box(one, routes.left[at], &bodies[at], &mut items);
    }
    let count = |wanted: fn(Form) -> bool| {
        let boxes = graph.boxes.iter();
        boxes.filter(|one| wanted(one.form)).count()
    };
    Drawing {
        id: "block-diagram".to_owned(),
        title: format!("Blocks of {}", design.name),
        description: format!(
            "{} blocks and the control unit between {} inputs on the left and {} outputs on the right. The table of blocks \
             says what each of them takes.",
            count(|form| matches!(form, Form::Block(_))),
            count(|form| form == Form::Input),
            count(|form| form == Form::Output),
        ),
        width: coordinate(routes.width) + BORDER,
        height: coordinate(bottom(&bodies, &routes)) + BORDER,
        items,
    }
}

/// What a box takes from top to bottom, and from left to right.
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
        let height = match one.form {
            Form::Input | Form::Output => LOW,
            _ => HEIGHT,
        };
        let texts = match one.form {
            Form::Input | Form::Output => vec![head(one) + " " + &one.caption],
            _ => vec![head(one), one.caption.clone(), format!(" {}", one.control)],
        };
        let widest = texts.iter().map(|text| text_width(text, SIZE)).max();
        Self {
            lanes: LANE * lanes as f64,
            stub: if one.control.is_empty() { 0.0 } else { STUB },
            height: height.max(PIN * (pins + 1) as f64),
            width: f64::from(widest.unwrap_or(0) + 2 * MARGIN),
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

/// The first line of a box.
fn head(one: &Node) -> String {
    match one.number {
        Some(number) => format!("{number} {}", one.name),
        None => one.name.clone(),
    }
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

fn point((x, y): (f64, f64)) -> String {
    format!("{} {}", coordinate(x), coordinate(y))
}

fn draw_net(net: &Net, driver: &Node, items: &mut Vec<Item>) {
    if net.pieces.is_empty() {
        return;
    }
    items.push(Item::Open { class: "net", title: driver.title.clone() });
    let pieces = net.pieces.iter();
    let lines = pieces.map(|piece| format!("M{}L{}", point(piece.from), point(piece.to)));
    items.push(Item::path("wire", lines.collect::<String>()));
    let arrows = net.pins.iter().map(|&pin| format!("M{}l-6 -3v6Z", point(pin)));
    items.push(Item::path("arrow", arrows.collect::<String>()));
    if !net.junctions.is_empty() {
        let dots = net.junctions.iter();
        let dots = dots.map(|&at| format!("M{}m-2 0a2 2 0 1 0 4 0a2 2 0 1 0 -4 0Z", point(at)));
        items.push(Item::path("arrow", dots.collect::<String>()));
    }
    items.push(Item::Close);
}

fn draw_box(one: &Node, left: f64, body: &Body, items: &mut Vec<Item>) {
    let (x, y) = (coordinate(left), coordinate(body.upper));
    let (width, height) = (body.width.round() as i32, (body.lower - body.upper).round() as i32);
    items.push(Item::Open { class: "block", title: one.title.clone() });
    items.push(Item::path(class(one.form), outline(one.form, x, y, width, height)));
    if matches!(one.form, Form::Block(Kind::Register | Kind::Operand)) {
        // The mark of the clock.
        let edge = y + height;
        items.push(Item::path("notch", format!("M{} {edge}l4 -6l4 6", x + 4)));
    }
    let middle = x + width / 2;
    let centre = y + height / 2;
    match one.form {
        Form::Input | Form::Output => {
            let text = head(one) + " " + &one.caption;
            items.push(Item::text("tick", middle, centre + 4, text));
        }
        _ => {
            items.push(Item::text("tick name", middle, centre - 3, head(one)));
            items.push(Item::text("tick small", middle, centre + 12, one.caption.clone()));
        }
    }
    if !one.control.is_empty() {
        let x = x + 8;
        items.push(Item::path("wire", format!("M{x} {}v{STUB}", y - STUB as i32)));
        items.push(Item::path("arrow", format!("M{x} {y}l-3 -6h6Z")));
        items.push(Item::text("small", x + 6, y - 7, one.control.clone()));
    }
    items.push(Item::Close);
}

/// The class of a box, which gives it its colour; its caption says the same.
fn class(form: Form) -> &'static str {
    match form {
        Form::Input | Form::Output => "box port",
        Form::Control => "box control",
        Form::Block(Kind::Register | Kind::Operand) => "box register",
        Form::Block(Kind::Rom | Kind::Constant) => "box memory",
        Form::Block(Kind::Mux(_)) => "box mux",
        Form::Block(_) => "box",
    }
}

/// Ports point in the direction of the signal; muxes narrow toward their output.
fn outline(form: Form, x: i32, y: i32, width: i32, height: i32) -> String {
    let (right, bottom, middle) = (x + width, y + height, y + height / 2);
    match form {
        Form::Input | Form::Output => {
            let neck = right - 8;
            format!("M{x} {y}H{neck}L{right} {middle}L{neck} {bottom}H{x}Z")
        }
        Form::Block(Kind::Mux(_)) => {
            let (upper, lower) = (y + 5, bottom - 5);
            format!("M{x} {y}L{right} {upper}V{lower}L{x} {bottom}Z")
        }
        _ => format!("M{x} {y}H{right}V{bottom}H{x}Z"),
    }
}

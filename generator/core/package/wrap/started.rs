//! Gives a pipeline the ports of a sequential core, so that bus registers and instructions start every core in one way.
//!
//! A pipeline gets a module around it: `<name>_single` computes one point at a time, and `<name>_queue` several, whose results wait
//! until software has read them.

use std::borrow::Cow;

use super::connected;
use glint_base::fixed::Format;
use glint_rtl::netlist::{Design, Driver, Net, NetId, Pipeline, Port, Role};
use glint_rtl::verilog::text::{literal, range};

/// The ports that `<name>_queue` has and a sequential core lacks.
pub const FULL: &str = "full";
pub const OFFERING: &str = "offering";
pub const WAITING: &str = "waiting";
pub const TAKE: &str = "take";

/// The internal signals of `<name>_single.v` and of `<name>_queue.v`, without the registers of operands and the wires of results.
const SIGNALS: [&str; 6] =
    ["accepted", "arrives", "core_side_out", "offered", "pipeline", "unused"];

/// The signals that only `<name>_queue.v` has.
const QUEUE_SIGNALS: [&str; 9] =
    [FULL, OFFERING, WAITING, TAKE, "claimed", "head", "results", "tail", "takes"];

/// Returns the design that bus registers or instructions start: a sequential core itself, and for a pipeline the ports of
/// the module around it, as a design without contents. `queue` is the number of results that can wait, or `None` for
/// `<name>_single`.
pub fn started(design: &Design, queue: Option<u32>) -> Cow<'_, Design> {
    if design.pipeline.is_none() {
        return Cow::Borrowed(design);
    }
    let mut around = design.clone();
    around.name = module_name(design, queue);
    around.pipeline = None;
    around.ports.clear();
    for port in &design.ports {
        match port.role {
            Role::Reset => around.ports.push(port.clone()),
            role if role.is_of_table() => around.ports.push(port.clone()),
            Role::Point => {
                let name = format!("{}_write", design.net(port.net).name);
                let strobe = net(&mut around, &name, 1);
                around.ports.push(Port { net: port.net, role: Role::Operand { strobe } });
                around.ports.push(Port { net: strobe, role: Role::Strobe });
            }
            _ => {}
        }
    }
    let mut add = |name: &str, width: u32, role: Role| {
        let net = net(&mut around, name, width);
        around.ports.push(Port { net, role });
    };
    add("start", 1, Role::Start);
    add("valid", 1, Role::Valid);
    add("busy", 1, Role::Busy);
    add("done", 1, Role::Done);
    if let Some(depth) = queue {
        add(FULL, 1, Role::Status);
        add(OFFERING, 1, Role::Status);
        add(WAITING, count_width(depth), Role::Status);
        add(TAKE, 1, Role::Strobe);
    }
    around.ports.extend(design.ports.iter().filter(|port| port.role == Role::Result).cloned());
    Cow::Owned(around)
}

fn module_name(design: &Design, queue: Option<u32>) -> String {
    let suffix = if queue.is_some() { "queue" } else { "single" };
    format!("{}_{suffix}", design.name)
}

/// Returns the number of bits of a count from 0 to `depth`: 4 results need 3 bits.
pub fn count_width(depth: u32) -> u32 {
    depth.ilog2() + 1
}

/// Returns a message about a port of a pipeline that has the name of a signal inside the module around it: an operand `offered`, or
/// an operand `held_x` beside an operand `x`. Returns `None` for a sequential core.
pub fn colliding_port(design: &Design, queue: Option<u32>) -> Option<String> {
    design.pipeline.as_ref()?;
    let mut signals: Vec<String> = SIGNALS.iter().map(|&name| name.to_owned()).collect();
    if queue.is_some() {
        signals.extend(QUEUE_SIGNALS.iter().map(|&name| name.to_owned()));
    }
    for port in &design.ports {
        let name = &design.net(port.net).name;
        match port.role {
            Role::Point => signals.push(format!("held_{name}")),
            Role::Result => signals.push(format!("new_{name}")),
            _ => {}
        }
    }
    let mut names = design.ports.iter().map(|port| design.net(port.net).name.as_str());
    let port = names.find(|name| signals.iter().any(|signal| signal == name))?;
    let module = module_name(design, queue);
    Some(format!("`{port}` is a signal of `{module}.v`, and a port cannot have its name"))
}

fn net(design: &mut Design, name: &str, width: u32) -> NetId {
    let reset = design.nets.iter().find(|net| net.format == Format::BIT && net.name == "rst_n");
    let reset = reset.expect("every core has a reset").clone();
    let format = Format::unsigned(width as i32, 0);
    let name = name.to_owned();
    design.nets.push(Net { name, format, driver: Driver::Undriven, doc: String::new(), ..reset });
    NetId(design.nets.len() as u32 - 1)
}

/// An operand or a result of the pipeline, as the templates of the module around it declare it.
pub struct PipelinePort {
    pub name: String,
    /// The range of bits with a blank behind it, and before it the word `signed` if the port is signed.
    pub range: String,
    pub width: u32,
    /// The bits of a result in a word with all results, as a part-select with its brackets.
    pub bits: String,
}

/// Returns the operands (`Role::Point`) or the results (`Role::Result`) of a pipeline.
pub fn pipeline_ports(design: &Design, role: Role) -> Vec<PipelinePort> {
    let mut ports = Vec::new();
    let mut low = 0;
    for port in design.ports.iter().filter(|port| port.role == role) {
        let net = design.net(port.net);
        let sign = if net.format.signed { "signed " } else { "" };
        let width = net.format.width();
        let bits = range(width);
        let blank = if bits.is_empty() { "" } else { " " };
        ports.push(PipelinePort {
            name: net.name.clone(),
            range: format!("{sign}{bits}{blank}"),
            width,
            bits: format!("[{}:{low}]", low + width - 1),
        });
        low += width;
    }
    ports
}

/// Returns the connections of the pipeline's instance in the module around it.
pub fn pipeline_connections(design: &Design, pipeline: &Pipeline) -> Vec<String> {
    connected(design, "clk", |role, name| match role {
        Role::Reset => Some("rst_n".to_owned()),
        Role::InValid => Some("offered".to_owned()),
        Role::InReady => Some("accepted".to_owned()),
        Role::OutReady => Some("1'b1".to_owned()),
        Role::Valid => Some("arrives".to_owned()),
        Role::Point => Some(format!("held_{name}")),
        Role::Result => Some(format!("new_{name}")),
        Role::SideIn => Some(literal(0, pipeline.side)),
        _ => None,
    })
}

/// Returns the nets inside the module around a pipeline that a proof reads: `offered`, `arrives`, `accepted` if the pipeline has
/// `in_ready`, and a register or a wire of each operand and each result. Each comes with its width in bits.
pub fn observed_nets(design: &Design) -> Vec<(String, u32)> {
    let mut nets = vec![("offered".to_owned(), 1), ("arrives".to_owned(), 1)];
    for port in pipeline_ports(design, Role::Point) {
        nets.push((format!("held_{}", port.name), port.width));
    }
    for port in pipeline_ports(design, Role::Result) {
        nets.push((format!("new_{}", port.name), port.width));
    }
    if has_port(design, Role::InReady) {
        nets.push(("accepted".to_owned(), 1));
    }
    nets
}

pub fn has_port(design: &Design, role: Role) -> bool {
    design.ports.iter().any(|port| port.role == role)
}

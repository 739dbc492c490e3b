//! Generates `<name>_single.v`, which computes one point at a time with a pipeline, and its formal properties.
//!
//! The module has the ports of a core with a microprogram: `start`, `busy`, `done`, a write strobe for each operand, and results that
//! stay until the next computation ends. Bus registers can therefore start a pipeline as they start any other core.

use std::borrow::Cow;

use anyhow::Result;
use glint_base::fill;

use super::{add_proof, connected, seen_inside, stub_ports, table_ports};
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use glint_base::fixed::Format;
use glint_rtl::netlist::{Design, Driver, Net, NetId, Pipeline, Port, Role};
use glint_rtl::verilog::text::{literal, range};

/// Returns the design that bus registers start: a core with a microprogram itself, and for a pipeline the ports of
/// `<name>_single`, as a design without contents.
pub fn started(design: &Design) -> Cow<'_, Design> {
    if design.pipeline.is_none() {
        return Cow::Borrowed(design);
    }
    let mut single = design.clone();
    single.name = format!("{}_single", design.name);
    single.pipeline = None;
    single.ports.clear();
    for port in &design.ports {
        match port.role {
            Role::Reset => single.ports.push(port.clone()),
            role if role.is_of_table() => single.ports.push(port.clone()),
            Role::Point => {
                let name = format!("{}_write", design.net(port.net).name);
                let strobe = bit(&mut single, name);
                single.ports.push(Port { net: port.net, role: Role::Operand { strobe } });
                single.ports.push(Port { net: strobe, role: Role::Strobe });
            }
            _ => {}
        }
    }
    for (name, role) in
        [("start", Role::Start), ("valid", Role::Valid), ("busy", Role::Busy), ("done", Role::Done)]
    {
        let net = bit(&mut single, name.to_owned());
        single.ports.push(Port { net, role });
    }
    single.ports.extend(design.ports.iter().filter(|port| port.role == Role::Result).cloned());
    Cow::Owned(single)
}

/// The signals of `<name>_single.v` besides those of operands and results.
const SIGNALS: [&str; 6] =
    ["accepted", "arrives", "core_side_out", "offered", "pipeline", "unused"];

/// Returns a port of a pipeline that has the name of a signal inside `<name>_single.v`: an operand `offered`, or an operand `held_x` beside
/// an operand `x`. Returns `None` for a core with a microprogram.
pub fn colliding_port(design: &Design) -> Option<&str> {
    design.pipeline.as_ref()?;
    let mut signals: Vec<String> = SIGNALS.iter().map(|&name| name.to_owned()).collect();
    for port in &design.ports {
        let name = &design.net(port.net).name;
        match port.role {
            Role::Point => signals.push(format!("held_{name}")),
            Role::Result => signals.push(format!("new_{name}")),
            _ => {}
        }
    }
    let mut names = design.ports.iter().map(|port| design.net(port.net).name.as_str());
    names.find(|name| signals.iter().any(|signal| signal == name))
}

/// Adds a net of one bit for a port.
fn bit(design: &mut Design, name: String) -> NetId {
    let reset = design.nets.iter().find(|net| net.format == Format::BIT && net.name == "rst_n");
    let reset = reset.expect("every core has a reset").clone();
    design.nets.push(Net { name, driver: Driver::Undriven, doc: String::new(), ..reset });
    NetId(design.nets.len() as u32 - 1)
}

/// An operand or a result of the pipeline.
struct SinglePort {
    name: String,
    /// The range of bits with a blank behind it, and before it the word `signed` if the port is signed.
    range: String,
    width: u32,
}

/// Adds the module around the pipeline of the job, and with test vectors its proof.
///
/// # Errors
/// Fails if a template fails.
pub fn modules(job: &EmitJob, pipeline: &Pipeline, files: &mut OutputFiles) -> Result<()> {
    let design = job.design;
    let ports_of = |role: Role| {
        let mut ports = Vec::new();
        for port in design.ports.iter().filter(|port| port.role == role) {
            let net = design.net(port.net);
            let sign = if net.format.signed { "signed " } else { "" };
            let width = net.format.width();
            let bits = range(width);
            let blank = if bits.is_empty() { "" } else { " " };
            ports.push(SinglePort {
                name: net.name.clone(),
                range: format!("{sign}{bits}{blank}"),
                width,
            });
        }
        ports
    };
    let has = |role: Role| design.ports.iter().any(|port| port.role == role);
    let accepts = has(Role::InReady);
    let connections = connected(design, "clk", |role, name| match role {
        Role::Reset => Some("rst_n".to_owned()),
        Role::InValid => Some("offered".to_owned()),
        Role::InReady => Some("accepted".to_owned()),
        Role::OutReady => Some("1'b1".to_owned()),
        Role::Valid => Some("arrives".to_owned()),
        Role::Point => Some(format!("held_{name}")),
        Role::Result => Some(format!("new_{name}")),
        Role::SideIn => Some(literal(0, pipeline.side)),
        _ => None,
    });
    let single = started(design);
    let verilog = fill!("single.v" {
        name: &'a str = job.name(),
        regenerate: &'a str = job.regenerate(),
        accepts: bool,
        side: bool = has(Role::SideOut),
        side_range: String = range(pipeline.side),
        operands: Vec<SinglePort> = ports_of(Role::Point),
        results: Vec<SinglePort> = ports_of(Role::Result),
        connections: Vec<String>,
        table_ports: Vec<String> = table_ports::declared(design),
    })?;
    files.add_verilog(FileKind::SingleWrapper, vec![single.name.clone()], verilog);
    let mut inside = vec![("offered".to_owned(), 1), ("arrives".to_owned(), 1)];
    inside.extend(
        ports_of(Role::Point).into_iter().map(|it| (format!("held_{}", it.name), it.width)),
    );
    inside.extend(
        ports_of(Role::Result).into_iter().map(|it| (format!("new_{}", it.name), it.width)),
    );
    if accepts {
        inside.push(("accepted".to_owned(), 1));
    }
    let proof = fill!("single_formal.sv" {
        name: &'a str = job.name(),
        accepts: bool,
        operands: Vec<SinglePort> = ports_of(Role::Point),
        results: Vec<SinglePort> = ports_of(Role::Result),
        stub_ports: Vec<String> = stub_ports(design),
        side: bool = has(Role::SideOut),
        inside: Vec<String> = inside.into_iter().map(seen_inside).collect(),
    })?;
    add_proof(job, &single.name, vec![job.name().to_owned()], proof, files)
}

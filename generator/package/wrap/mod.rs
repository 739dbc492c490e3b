//! Wrappers in Verilog between a core and a system, and the properties that are proved of them.

mod bench;
pub(super) mod fields;
mod pipeline;
mod points;
mod registers;
mod stream;
mod words;

use anyhow::Result;
use askama::Template;

use super::map::Map;
use super::surroundings::Bus;
use super::{EmitInputs, render};
use crate::hdl::netlist::{Design, Port, Role};
use crate::hdl::verilog::rows::separated;
use crate::hdl::verilog::text::range;

/// The wrappers that a configuration asks for: pairs of a plain name and its text.
#[derive(Default)]
pub struct Wrappers {
    /// Verilog.
    pub rtl: Vec<(String, String)>,
    /// The properties that are proved of it, for formal tools alone.
    pub formal: Vec<(String, String)>,
    /// Benches and the points for them.
    pub benches: Vec<(String, String)>,
}

/// The wrappers that the configuration asks for; the map is that of the registers.
///
/// # Errors
/// A core that they do not fit.
pub fn wrappers(
    design: &Design,
    inputs: &EmitInputs,
    map: Option<(Bus, &Map)>,
) -> Result<Wrappers> {
    let mut made = Wrappers::default();
    let mut add = |one: Wrappers| {
        made.rtl.extend(one.rtl);
        made.formal.extend(one.formal);
    };
    if inputs.around.stream {
        add(match &design.pipeline {
            Some(pipeline) => pipeline::wrapper(design, pipeline, inputs)?,
            None => stream::wrapper(design, inputs)?,
        });
    }
    if let Some((bus, map)) = map {
        add(registers::wrapper(design, inputs, bus, map)?);
    }
    if let Some(vectors) = &inputs.vectors
        && !made.rtl.is_empty()
    {
        made.benches = bench::benches(design, inputs, map, vectors)?;
    }
    Ok(made)
}

/// The commands of Yosys that make the problem of `<wrapper>_formal.sv`.
#[derive(Template)]
#[template(path = "wrapper_formal.ys")]
struct Script<'a> {
    name: &'a str,
}

fn script(name: &str) -> Result<String> {
    render(&Script { name })
}

/// Returns the connections of the core, the clock first: where `to` says nothing, inputs to 0, and outputs to the wire of
/// [`core_wire`].
fn connected(
    design: &Design,
    clock: &str,
    to: impl Fn(Role, &str) -> Option<String>,
) -> Vec<String> {
    let ports = design.ports.iter().map(|port| {
        let name = design.net(port.net).name.as_str();
        let to = to(port.role, name).unwrap_or_else(|| match port.role.is_input() {
            true => "1'b0".to_owned(),
            false => format!("core_{name}"),
        });
        format!(".{name}({to})")
    });
    separated(std::iter::once(format!(".clk({clock})")).chain(ports).collect())
}

/// The declaration of the wire that an output of the core drives.
fn core_wire(design: &Design, port: &Port) -> String {
    let net = design.net(port.net);
    format!("wire {} core_{};", range(net.format.width()), net.name).replace("  ", " ")
}

/// Results of the module that stands in for the core: anything.
fn stub_free(design: &Design) -> Vec<String> {
    let is_free = |port: &&Port| matches!(port.role, Role::Result | Role::Status);
    let free = design.ports.iter().filter(is_free).flat_map(|port| {
        let net = design.net(port.net);
        let any = format!("(* anyseq *) reg {} any_{};", range(net.format.width()), net.name);
        [any.replace("  ", " "), format!("assign {0} = any_{0};", net.name)]
    });
    free.collect()
}

/// The ports of a module that stands in for the core, in the order of the core's.
fn stub_ports(design: &Design) -> Vec<String> {
    let port = |port: &Port| {
        let net = design.net(port.net);
        let range = range(net.format.width());
        let sign = if net.format.signed { "signed " } else { "" };
        let direction = if port.role.is_input() { "input" } else { "output" };
        format!("{direction} wire {sign}{range} {}", net.name).replace("  ", " ")
    };
    let clock = "input wire clk".to_owned();
    separated(std::iter::once(clock).chain(design.ports.iter().map(port)).collect())
}

/// The declaration of a net inside the module that is proved, with its width.
fn seen_inside((net, width): (String, u32)) -> String {
    format!("(* hierconn *) wire {} \\dut.{net} ;", range(width)).replace("  ", " ")
}

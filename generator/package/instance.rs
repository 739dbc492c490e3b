//! How a device is used from Verilog: wires for its ports, and an instance.

use anyhow::Result;
use askama::Template;

use crate::hdl::netlist::Design;
use crate::hdl::verilog::naming::remark;
use crate::hdl::verilog::rows::{Row, separated};

#[derive(Template)]
#[template(path = "instance.v")]
struct Instance<'a> {
    name: &'a str,
    wires: Vec<String>,
    connections: Vec<String>,
}

/// Declarations of what the ports are connected to, and an instance; the clock is there already.
///
/// # Errors
/// A template that fails to print.
pub fn instance(design: &Design) -> Result<String> {
    let wires: Vec<Row> = design
        .ports
        .iter()
        .map(|port| {
            let net = design.net(port.net);
            let kind = if port.role.is_input() { "reg" } else { "wire" };
            let format = net.format;
            let note = remark(design, port.net);
            Row::port("", kind, format.width(), format.signed, &net.name, &note)
        })
        .collect();
    let names = || {
        let ports = design.ports.iter().map(|port| port.net);
        std::iter::once("clk").chain(ports.map(|net| design.net(net).name.as_str()))
    };
    let width = names().map(str::len).max().unwrap_or(0);
    super::render(&Instance {
        name: &design.name,
        wires: Row::declarations(&wires),
        connections: separated(names().map(|name| format!(".{name:width$} ({name})")).collect()),
    })
}

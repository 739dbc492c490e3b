//! Writes an example of a device's use in Verilog: wires for its ports, and an instance.

use glint_rtl::netlist::Design;
use glint_rtl::verilog::naming::remark;
use glint_rtl::verilog::rows::{Row, separated};

/// Writes declarations of the wires that the ports are connected to, and an instance. The clock must be declared already.
pub fn instance(design: &Design) -> String {
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
    let connections =
        separated(names().map(|name| format!("    .{name:width$} ({name})")).collect());
    let (wires, name) = (Row::declarations(&wires).join("\n"), &design.name);
    format!("{wires}\n{name} u_{name} (\n{}\n);\n", connections.join("\n"))
}

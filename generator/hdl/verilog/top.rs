//! Writes the top Verilog module of a device: an instance of the control unit, an instance of the datapath, and the wires between
//! them.

use super::header::{self, Origin};
use super::interface::Interface;
use super::module::parameters;
use super::naming::Naming;
use super::plan::Plan;
use super::rows::{Row, separated};
use super::writer;
use crate::netlist::Partition;

/// `units` has both modules with their ports.
pub fn module(
    plan: &Plan,
    naming: &Naming,
    units: [(Partition, &Interface); 2],
    origin: &Origin,
) -> String {
    let design = plan.design;
    let mut ports = vec![Row::port("input", "wire", 1, false, "clk", "")];
    for port in &design.ports {
        let direction = if port.role.is_input() { "input" } else { "output" };
        ports.push(Row::net(plan, direction, "wire", port.net));
    }
    let mut between = Vec::new();
    for net in units.iter().flat_map(|(_, interface)| &interface.outputs) {
        if !plan.is_port(*net) {
            between.push(Row::net(plan, "", "wire", *net));
        }
    }
    let declarations = Row::declarations(&between);
    let mut body = writer::section("Signals between control unit and datapath", declarations);
    for (partition, interface) in units {
        body.push(String::new());
        body.extend(instance(plan, naming, partition, interface));
    }
    let roms: Vec<_> = units.iter().flat_map(|(_, interface)| interface.roms.clone()).collect();
    let (header, parameters) = (header::top(design, origin), parameters(naming, &roms));
    writer::module(header, &design.name, &parameters, Row::ports(&ports), body)
}

fn instance(
    plan: &Plan,
    naming: &Naming,
    partition: Partition,
    interface: &Interface,
) -> Vec<String> {
    let mut connections = Vec::new();
    if interface.clocked {
        connections.push(connected("clk"));
    }
    for net in interface.inputs.iter().chain(&interface.outputs) {
        connections.push(connected(&plan.design.net(*net).name));
    }
    let mut parameters = Vec::new();
    if !naming.style.inline {
        for rom in &interface.roms {
            parameters.push(connected(&naming.parameters[rom.index()]));
        }
    }
    writer::instance(
        &naming.module(partition),
        &separated(parameters),
        naming.instance(partition),
        &separated(connections),
    )
}

/// Connects a port or a parameter to its namesake: `.clk(clk)`.
fn connected(name: &str) -> String {
    format!(".{name}({name})")
}

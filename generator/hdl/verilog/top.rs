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

/// Returns the text of the top module.
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
    let between: Vec<_> = units
        .iter()
        .flat_map(|(_, interface)| &interface.outputs)
        .filter(|net| !plan.is_port(**net))
        .map(|net| Row::net(plan, "", "wire", *net))
        .collect();
    let between = Row::declarations(&between);
    let mut body = writer::section("Between the control unit and the datapath", between);
    for (partition, interface) in units {
        body.push(String::new());
        body.extend(instance(plan, naming, partition, interface));
    }
    let roms: Vec<_> = units.iter().flat_map(|(_, interface)| interface.roms.clone()).collect();
    let (header, parameters) = (header::top(design, origin), parameters(naming, &roms));
    writer::module(header, &design.name, &parameters, Row::ports(&ports), body, "")
}

fn instance(
    plan: &Plan,
    naming: &Naming,
    partition: Partition,
    interface: &Interface,
) -> Vec<String> {
    let clock = interface.clocked.then_some("clk");
    let nets = interface.inputs.iter().chain(&interface.outputs);
    let names = clock.into_iter().chain(nets.map(|net| plan.design.net(*net).name.as_str()));
    let connect = |name: &str| format!(".{name}({name})");
    let roms = interface.roms.iter().filter(|_| !naming.style.inline);
    let parameters = roms.map(|rom| connect(&naming.parameters[rom.index()]));
    writer::instance(
        &naming.module(partition),
        &separated(parameters.collect()),
        naming.instance(partition),
        &separated(names.map(connect).collect()),
    )
}

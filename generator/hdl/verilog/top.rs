//! The top module: the two units and the wires between them.

use super::header::{self, Origin};
use super::interface::Interface;
use super::module::parameters;
use super::naming::Naming;
use super::plan::Plan;
use super::rows::{Row, separated};
use super::view::{Instance, Section, Top};
use crate::hdl::netlist::Partition;

/// The top module.
pub fn module(
    plan: &Plan,
    naming: &Naming,
    units: [(Partition, &Interface); 2],
    origin: &Origin,
) -> Top {
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
    let declarations = if between.is_empty() {
        Vec::new()
    } else {
        vec![Section {
            title: "Between the control unit and the datapath",
            lines: Row::declarations(&between),
        }]
    };
    let roms: Vec<_> = units.iter().flat_map(|(_, interface)| interface.roms.clone()).collect();
    Top {
        header: header::top(design, origin),
        name: design.name.clone(),
        parameters: parameters(naming, &roms),
        ports: Row::ports(&ports),
        declarations,
        instances: units
            .iter()
            .map(|(partition, interface)| instance(plan, naming, *partition, interface))
            .collect(),
    }
}

fn instance(plan: &Plan, naming: &Naming, partition: Partition, interface: &Interface) -> Instance {
    let clock = interface.clocked.then_some("clk");
    let nets = interface.inputs.iter().chain(&interface.outputs);
    let names = clock.into_iter().chain(nets.map(|net| plan.design.net(*net).name.as_str()));
    let connect = |name: &str| format!(".{name}({name})");
    Instance {
        module: naming.module(partition),
        name: naming.instance(partition).to_owned(),
        parameters: separated(
            interface
                .roms
                .iter()
                .filter(|_| !naming.style.inline)
                .map(|rom| connect(&naming.parameters[rom.index()]))
                .collect(),
        ),
        connections: separated(names.map(connect).collect()),
    }
}

//! Writes example instances of a core and its wrappers in Verilog, with a wire for each port. Datasheets show them for the
//! user to copy.

use anyhow::Result;

use super::emit_job::EmitJob;
use super::inputs::EmitInputs;
use super::output_files::OutputFiles;
use super::tops::{Face, Top, TopPort, tops};
use glint_rtl::netlist::Design;
use glint_rtl::verilog::naming::{Naming, remark};
use glint_rtl::verilog::rows::{Row, separated};

pub struct InstanceExample {
    pub module: String,
    /// The module in a few words, for example `the core between two AXI4-Streams`.
    pub what: String,
    /// Declarations of the wires for the module's ports, and the instance. The clock must be declared already.
    pub verilog: String,
}

/// Returns an example instance of each module that a system can instantiate, the outermost wrapper first.
///
/// # Errors
/// Fails if the core cannot have a wrapper that the configuration asks for. For example, streams need operands and results,
/// and registers on a bus cannot hold a line of results.
pub fn instances(design: &Design, inputs: &EmitInputs) -> Result<Vec<InstanceExample>> {
    let naming = Naming::new(design);
    let job = EmitJob::new(design, inputs, &naming)?;
    let modules = tops(&job, &OutputFiles::new(job.name()))?;
    // Most systems use the outermost module, so it comes first.
    Ok(modules.into_iter().rev().map(|top| instance(design, top)).collect())
}

fn instance(design: &Design, top: Top) -> InstanceExample {
    let rows = match top.face {
        Face::Core => core_wires(design),
        Face::Stream | Face::Registers(_) | Face::Processor(_) => {
            let ports = top.ports.iter().filter(|port| port.name != top.clock);
            ports.map(wire).collect()
        }
    };
    let wires = Row::declarations(&rows).join("\n");
    let width = top.ports.iter().map(|port| port.name.len()).max().unwrap_or(0);
    let mut connected = Vec::new();
    for port in &top.ports {
        connected.push(format!("    .{0:width$} ({0})", port.name));
    }
    let connections = separated(connected).join("\n");
    let module = top.module;
    let verilog = format!("{wires}\n{module} u_{module} (\n{connections}\n);\n");
    InstanceExample { module, what: top.what, verilog }
}

fn core_wires(design: &Design) -> Vec<Row> {
    let wires = design.ports.iter().map(|port| {
        let net = design.net(port.net);
        let kind = kind_of(port.role.is_input());
        let note = remark(design, port.net);
        Row::port("", kind, net.format.width(), net.format.signed, &net.name, &note)
    });
    wires.collect()
}

fn wire(port: &TopPort) -> Row {
    Row::port("", kind_of(port.input), port.width, false, &port.name, &port.doc)
}

/// A system drives an input of the module from a `reg`, and reads an output by a `wire`.
fn kind_of(is_input: bool) -> &'static str {
    if is_input { "reg" } else { "wire" }
}

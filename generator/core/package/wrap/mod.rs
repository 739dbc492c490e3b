//! Generates Verilog wrappers that connect a core to a system by AXI4-Streams, bus registers or instructions, and their formal
//! properties.

mod bench;
pub(super) mod fields;
mod pipeline;
mod points;
pub(super) mod processor;
mod queue;
mod registers;
mod single;
pub(super) mod started;
mod stream;
pub(super) mod table_ports;
mod words;

use anyhow::Result;
use glint_base::fill;

use super::emit_job::EmitJob;
use super::file_kind::FileKind;
use super::output_files::OutputFiles;
use glint_rtl::netlist::{Design, Port, Role};
use glint_rtl::verilog::rows::separated;
use glint_rtl::verilog::text::range;

/// Adds the wrappers that the configuration asks for, and with test vectors also their benches and proofs.
///
/// # Errors
/// Fails if the core cannot have a wrapper that the configuration asks for. For example, a pipeline without stalls cannot
/// have streams.
pub fn files(job: &EmitJob, files: &mut OutputFiles) -> Result<()> {
    let streams = job.inputs.around.stream;
    if streams {
        match &job.design.pipeline {
            Some(pipeline) => pipeline::modules(job, pipeline, files)?,
            None => stream::modules(job, files)?,
        }
    }
    if let Some((bus, map)) = &job.registers {
        registers::modules(job, bus, map, files)?;
    }
    if let Some((interface, instructions)) = &job.instructions {
        processor::modules(job, interface, instructions, files)?;
    }
    if let Some(pipeline) = &job.design.pipeline {
        if let Some(depth) = job.queue() {
            queue::modules(job, pipeline, depth, files)?;
        }
        if job.instructions.is_some() || job.registers.is_some() && job.queue().is_none() {
            single::modules(job, pipeline, files)?;
        }
    }
    let are_started = job.registers.is_some() || job.instructions.is_some();
    match &job.inputs.vectors {
        Some(vectors) if streams || are_started => bench::files(job, vectors, files),
        _ => Ok(()),
    }
}

struct WrapperProof {
    text: String,
    /// The modules that `text` defines in place of modules that the wrapper instantiates. For example, the proof of `rough_axis` has
    /// a simple module `rough` in place of the core.
    stubs: Vec<String>,
    /// Whether a property reads the words of a memory of the wrapper.
    reads_memory: bool,
}

impl WrapperProof {
    /// Returns properties that read no memory.
    fn new(text: String, stubs: Vec<String>) -> Self {
        Self { text, stubs, reads_memory: false }
    }
}

/// Adds the formal properties of the module `wrapper`, and the Yosys commands that prepare them for a solver. Adds nothing without
/// test vectors.
fn add_proof(
    job: &EmitJob,
    wrapper: &str,
    proof: WrapperProof,
    files: &mut OutputFiles,
) -> Result<()> {
    if job.inputs.vectors.is_some() {
        let script = fill!("wrapper_formal.ys" {
            name: &'a str = wrapper, reads_memory: bool = proof.reads_memory,
        })?;
        let mut modules = vec![format!("{wrapper}_formal")];
        modules.extend(proof.stubs);
        files.add_system_verilog(FileKind::WrapperProof, modules, proof.text);
        files.add(FileKind::WrapperProofScript, format!("{wrapper}_formal.ys"), script);
    }
    Ok(())
}

/// Returns the port connections of the core's instance, the clock first. `to` returns the net for a port. If `to` returns
/// `None`, an input is connected to `1'b0`, and an output to the wire of [`core_wire`]. For example, `.busy(core_busy)`. The
/// write port of a table is connected to nets with the names of its ports.
fn connected(
    design: &Design,
    clock: &str,
    to: impl Fn(Role, &str) -> Option<String>,
) -> Vec<String> {
    let ports = design.ports.iter().map(|port| {
        let name = design.net(port.net).name.as_str();
        let to = to(port.role, name).unwrap_or_else(|| match port.role.is_input() {
            _ if port.role.is_of_table() => name.to_owned(),
            true => "1'b0".to_owned(),
            false => format!("core_{name}"),
        });
        format!(".{name}({to})")
    });
    separated(std::iter::once(format!(".clk({clock})")).chain(ports).collect())
}

/// Returns a declaration such as `wire [7:0] core_red_out;`.
fn core_wire(design: &Design, port: &Port) -> String {
    let net = design.net(port.net);
    format!("wire {} core_{};", range(net.format.width()), net.name).replace("  ", " ")
}

/// A module with the ports and the handshake of a core, which replaces the core in a proof. The results are arbitrary.
pub struct CoreStub {
    pub core: String,
    pub ports: Vec<String>,
    /// The lines that let the solver choose results and status bits.
    pub free: Vec<String>,
    /// The strobes of the operands. A start must raise them all.
    pub strobes: Vec<String>,
}

impl CoreStub {
    fn new(design: &Design) -> Self {
        let mut strobes = Vec::new();
        for port in design.inputs() {
            if let Role::Operand { strobe } = port.role {
                strobes.push(design.net(strobe).name.clone());
            }
        }
        let core = design.name.clone();
        Self { core, ports: stub_ports(design), free: stub_free(design), strobes }
    }

    /// Returns the stub of a queue, whose status bits are not arbitrary.
    fn of_queue(queue: &Design) -> Self {
        let mut results = queue.clone();
        results.ports.retain(|port| port.role != Role::Status);
        Self { free: stub_free(&results), ..Self::new(queue) }
    }
}

/// Returns the part of a stub that lets the solver choose results and status bits in each clock.
fn stub_free(design: &Design) -> Vec<String> {
    let mut lines = Vec::new();
    for port in &design.ports {
        if matches!(port.role, Role::Result | Role::Status | Role::TableReady) {
            let net = design.net(port.net);
            let any = format!("(* anyseq *) reg {} any_{};", range(net.format.width()), net.name);
            lines.push(any.replace("  ", " "));
            lines.push(format!("assign {0} = any_{0};", net.name));
        }
    }
    lines
}

/// Returns the ports of a stub in the order of the core's ports.
fn stub_ports(design: &Design) -> Vec<String> {
    let mut ports = vec!["input wire clk".to_owned()];
    for port in &design.ports {
        let net = design.net(port.net);
        let range = range(net.format.width());
        let sign = if net.format.signed { "signed " } else { "" };
        let direction = if port.role.is_input() { "input" } else { "output" };
        let declaration = format!("{direction} wire {sign}{range} {}", net.name);
        ports.push(declaration.replace("  ", " "));
    }
    separated(ports)
}

/// Returns the declaration with which a proof reads a net inside the instance `dut`: its path, for example `core.run`, and its
/// width in bits.
fn seen_inside((net, width): (String, u32)) -> String {
    format!("(* hierconn *) wire {} \\dut.{net} ;", range(width)).replace("  ", " ")
}

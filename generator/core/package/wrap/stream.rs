//! Generates `<name>_axis.v` for a sequential core, a wrapper between two AXI4-Streams, and the formal properties of
//! this wrapper.

use anyhow::{Context, Result};
use glint_base::fill;

use super::fields::{StreamField, Transfer, sink};
use super::{
    WrapperProof, add_proof, connected, core_wire, seen_inside, stub_free, stub_ports, table_ports,
};
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use glint_rtl::netlist::Role;
use glint_rtl::verilog::rows::separated;
use glint_rtl::verilog::text::literal;

/// The stream of a core that computes all points along a scan line after one `start`. The wrapper buffers the results of a
/// line. `length` is the operand with the number of intervals, at the bits `length_low` to `length_high` of the input
/// transfer.
struct LineStream {
    length: String,
    length_low: u32,
    length_high: u32,
    /// The number of bits of the operand `length`, and of an address of the buffer.
    width: u32,
}

impl LineStream {
    fn high(&self) -> u32 {
        self.width - 1
    }

    /// A count of results has a bit more than an address of the buffer.
    fn zero(&self) -> String {
        literal(0, self.width + 1)
    }

    fn one(&self) -> String {
        literal(1, self.width + 1)
    }

    /// Returns the largest number of points of a line, which is the number of words in the buffer.
    fn places(&self) -> String {
        literal(1 << self.width, self.width + 1)
    }

    fn deepest(&self) -> u64 {
        (1 << self.width) - 1
    }
}

/// Adds the stream wrapper of a sequential core, and its proof. A core of lines also gets a buffer for the results.
///
/// # Errors
/// Fails if the core lacks the handshake of a microprogram, operands or results.
pub fn modules(job: &EmitJob, files: &mut OutputFiles) -> Result<()> {
    let (name, design, regenerate) = (job.name(), job.design, job.regenerate());
    design.handshake()?;
    let (operands, results) = (Transfer::sent(job)?, Transfer::received(job)?);
    let keep = job.inputs.around.keep;
    let (in_high, out_high) = (operands.high(), results.high());
    let user_bits = job.inputs.around.user_bits;
    let overlaps = design.control.overlaps;
    let is_unused = |role: Role| role == Role::Status || role == Role::Done && !overlaps;
    let connections = connected(design, "aclk", |role, name| match role {
        Role::Reset => Some("aresetn".to_owned()),
        Role::Start | Role::Valid | Role::Busy => Some(name.to_owned()),
        Role::Done if overlaps => Some("done".to_owned()),
        Role::Operand { .. } => {
            let field = operands.field(name);
            Some(format!("operands{}", field.map(StreamField::bits).unwrap_or_default()))
        }
        Role::Strobe if operands.fields.iter().any(|field| field.strobe == name) => {
            Some("start".to_owned())
        }
        _ => None,
    });
    let mut unused = Vec::new();
    let mut result_wires = Vec::new();
    for port in design.outputs() {
        if port.role == Role::Result || is_unused(port.role) {
            result_wires.push(core_wire(design, port));
        }
        if is_unused(port.role) {
            unused.push(format!("core_{}", design.net(port.net).name));
        }
    }
    unused.extend(operands.padding("operands"));
    unused.extend(keep.then(|| "s_axis_tkeep".to_owned()));
    let line = line(job, &operands)?;
    let text = fill!("axis.v" {
        name: &'a str,
        regenerate: &'a str,
        user_bits: u32,
        keep: bool,
        operands: &'a [StreamField] = &operands.fields,
        results: &'a [StreamField] = &results.fields,
        signed: bool = results.has_signs(),
        in_high: u32,
        out_high: u32,
        result_wires: Vec<String>,
        packed: Vec<String> = separated(results.packed("core_")),
        connections: Vec<String>,
        table_ports: Vec<String> = table_ports::declared(design),
        // The kind of net that drives the outputs: a register, or a wire from the buffer.
        output: &'a str = if line.is_some() { "wire" } else { "reg " },
        line: Option<&'a LineStream> = line.as_ref(),
        unused: Vec<String> = sink(&unused),
        // Whether the core also accepts `start` in the clock of `done`.
        overlaps: bool,
    })?;
    files.add_verilog(FileKind::StreamWrapper, vec![format!("{name}_axis")], text);
    if let Some(line) = &line {
        let buffer = fill!("axis_buffer.v" {
            name: &'a str, regenerate: &'a str, out_high: u32, user_bits: u32, line: &'a LineStream,
        })?;
        let module = format!("{name}_axis_buffer");
        files.add_verilog(FileKind::StreamWrapper, vec![module], buffer);
    }
    let check =
        |field: &StreamField| format!("dut.core.{} == its_operands{}", field.name, field.bits());
    let text = fill!("axis_formal.sv" {
        name: &'a str,
        in_high: u32,
        out_high: u32,
        keep: bool,
        user_high: u32 = user_bits - 1,
        // The highest bit of results, tlast and tuser together.
        packed_high: u32 = out_high + 1 + user_bits,
        stub_ports: Vec<String> = stub_ports(design),
        stub_free: Vec<String> = stub_free(design),
        stub_packed: Vec<String> = separated(results.packed("dut.core.")),
        stub_checks: Vec<String> = operands.fields.iter().map(check).collect(),
        inside: Vec<String> = inside(&operands, &results, line.as_ref(), user_bits)?,
        strobes: Vec<&'a String> = operands.fields.iter().map(|field| &field.strobe).collect(),
        line: Option<&'a LineStream> = line.as_ref(),
        overlaps: bool,
    })?;
    let mut stubs = vec![name.to_owned()];
    if line.is_some() {
        stubs.push(format!("{name}_axis_buffer"));
    }
    add_proof(job, &format!("{name}_axis"), WrapperProof::new(text, stubs), files)
}

/// Returns the declarations of the nets inside the wrapper that the proof reads, by which Yosys finds them. `user` is the
/// number of bits of `tuser`.
fn inside(
    operands: &Transfer,
    results: &Transfer,
    line: Option<&LineStream>,
    user: u32,
) -> Result<Vec<String>> {
    let (in_bits, out_bits) = (operands.bits, results.bits);
    let mut nets: Vec<(String, u32)> = [
        ("start", 1),
        ("valid", 1),
        ("waiting", 1),
        ("operands", in_bits),
        ("operands_user", user),
        ("user", user),
        ("core.computing", 1),
        ("core.run", 1),
    ]
    .map(|(net, width)| (net.to_owned(), width))
    .into();
    let own = match line {
        Some(LineStream { width, .. }) => vec![
            ("core.to_come", width + 1),
            ("read", 1),
            ("read_at", width + 1),
            ("write_at", width + 1),
            ("next_line", width + 1),
            ("buffer.watched", *width),
            ("buffer.watched_word", out_bits + 1 + user),
        ],
        None => vec![
            ("operands_last", 1),
            ("last", 1),
            ("held", 1),
            ("held_last", 1),
            ("held_user", user),
            ("held_results", out_bits),
        ],
    };
    nets.extend(own.into_iter().map(|(net, width)| (net.to_owned(), width)));
    let ports = operands.fields.iter().chain(&results.fields);
    nets.extend(ports.map(|field| (format!("core.{}", field.name), field.width)));
    Ok(nets.into_iter().map(seen_inside).collect())
}

/// Returns the data for a core of lines, or `None` if the core computes single points. Fails if the operand with the length of
/// a line is not among the operands.
fn line(job: &EmitJob, operands: &Transfer) -> Result<Option<LineStream>> {
    let length = job.inputs.accuracy.as_ref().and_then(|accuracy| accuracy.length.as_ref());
    let Some(length) = length else {
        return Ok(None);
    };
    let field = operands
        .field(length)
        .with_context(|| format!("the length of the line, `{length}`, is not an operand"))?;
    Ok(Some(LineStream {
        length: field.name.clone(),
        length_low: field.low,
        length_high: field.high(),
        width: field.width,
    }))
}

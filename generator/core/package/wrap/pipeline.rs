//! Generates `<name>_axis.v` for a pipeline, a wrapper between two AXI4-Streams, and the formal properties of this wrapper.

use anyhow::{Result, ensure};
use glint_base::fill;

use super::fields::{StreamField, Transfer, sink};
use super::{WrapperProof, add_proof, connected, seen_inside, stub_ports, table_ports};
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use glint_rtl::netlist::{Pipeline, Role};
use glint_rtl::verilog::rows::separated;
use glint_rtl::verilog::text::literal;

/// The lowest and the highest bit of a stage's tlast and tuser, in the wrapper's register or memory with these bits of all
/// stages.
struct SideBits {
    low: u32,
    high: u32,
}

/// The position of a result in the concatenation of all results without padding.
struct ResultBits<'a> {
    name: &'a str,
    low: u32,
    width: u32,
}

/// Adds the wrapper and its proof. Fails if the pipeline has no stall (`pipeline.stall` = "none"), no operands or no results.
pub fn modules(job: &EmitJob, pipeline: &Pipeline, files: &mut OutputFiles) -> Result<()> {
    let (name, design) = (job.name(), job.design);
    ensure!(
        pipeline.stall,
        "interface.stream needs a pipeline that can stall, and `{name}` cannot; set pipeline.stall = \"ready\""
    );
    let (operands, results) = (Transfer::sent(job)?, Transfer::received(job)?);
    let keep = job.inputs.around.keep;
    let connections = connected(design, "aclk", |role, name| match role {
        Role::Reset => Some("aresetn".to_owned()),
        Role::InValid => Some("s_axis_tvalid".to_owned()),
        Role::InReady => Some("s_axis_tready".to_owned()),
        Role::OutReady => Some("ready".to_owned()),
        Role::Valid => Some("valid".to_owned()),
        Role::Point => {
            let field = operands.field(name);
            Some(format!("s_axis_tdata{}", field.map(StreamField::bits).unwrap_or_default()))
        }
        Role::SideIn => Some(literal(0, pipeline.side)),
        _ => None,
    });
    let mut unused = operands.padding("s_axis_tdata");
    unused.extend(keep.then(|| "s_axis_tkeep".to_owned()));
    if pipeline.side > 0 {
        unused.push("core_side_out".to_owned());
    }
    let (stages, user_bits) = (pipeline.stages.len(), job.inputs.around.user_bits);
    // If the core has delay lines in memory, another delay line in memory holds tlast and tuser.
    let words = stages.saturating_sub(1);
    let in_memory = words > 1 && !design.delay_lines().is_empty();
    let memory = in_memory.then(|| usize::BITS - (words - 1).leading_zeros());
    let (in_high, out_high) = (operands.high(), results.high());
    let text = fill!("axis_pipeline.v" {
        name: &'a str,
        regenerate: &'a str = job.regenerate(),
        user_bits: u32,
        keep: bool,
        operands: &'a [StreamField] = &operands.fields,
        results: &'a [StreamField] = &results.fields,
        signed: bool = results.has_signs(),
        in_high: u32,
        out_high: u32,
        stages: usize,
        // The number of address bits of the memory for tlast and tuser, if there is one.
        memory: Option<u32>,
        interval: usize = pipeline.interval,
        // The signal that is 1 if the points in the core move at the next edge.
        moves: &'a str = if pipeline.interval > 1 { "moves" } else { "s_axis_tready" },
        // The number of bits of the core's own side channel, which the wrapper does not use.
        side: u32 = pipeline.side,
        packed: Vec<String> = separated(results.packed("core_")),
        connections: Vec<String>,
        table_ports: Vec<String> = table_ports::declared(design),
        unused: Vec<String> = sink(&unused),
    })?;
    files.add_verilog(FileKind::StreamWrapper, vec![format!("{name}_axis")], text);

    let side = user_bits + 1;
    let mut raw_bits = 0;
    let mut raw = Vec::new();
    for field in &results.fields {
        raw.push(ResultBits { name: &field.name, low: raw_bits, width: field.width });
        raw_bits += field.width;
    }
    let side_net = if in_memory { "side.words" } else { "side" };
    let mut nets = vec![
        ("held".to_owned(), 1),
        ("held_results".to_owned(), out_high + 1),
        ("held_side".to_owned(), side),
        (side_net.to_owned(), stages as u32 * side),
        ("results_side".to_owned(), side),
        ("core.points".to_owned(), stages as u32),
    ];
    let handshake = ["rst_n", "in_valid", "in_ready", "out_valid", "out_ready"];
    nets.extend(handshake.map(|port| (format!("core.{port}"), 1)));
    let ports = operands.fields.iter().chain(&results.fields);
    nets.extend(ports.map(|field| (format!("core.{}", field.name), field.width)));
    let check =
        |field: &StreamField| format!("dut.core.{} == s_axis_tdata{}", field.name, field.bits());
    let text = fill!("axis_pipeline_formal.sv" {
        name: &'a str,
        in_high: u32,
        out_high: u32,
        user_bits: u32,
        keep: bool,
        stub_ports: Vec<String> = stub_ports(design),
        raw: Vec<ResultBits<'a>>,
        raw_high: u32 = raw_bits - 1,
        packed: Vec<String> = separated(results.packed("dut.core.")),
        checks: Vec<String> = operands.fields.iter().map(check).collect(),
        inside: Vec<String> = nets.into_iter().map(seen_inside).collect(),
        stages: usize,
        memory: Option<u32>,
        interval: usize = pipeline.interval,
        slot_high: u32 = (pipeline.interval - 1).checked_ilog2().unwrap_or(0),
        side: &'a str = side_net,
        sides: Vec<SideBits> = (0..stages as u32)
            .map(|stage| SideBits { low: stage * side, high: stage * side + user_bits })
            .collect(),
    })?;
    let mut stubs = vec![name.to_owned()];
    if memory.is_some() {
        stubs.push(format!("{name}_delay"));
    }
    add_proof(job, &format!("{name}_axis"), WrapperProof::new(text, stubs), files)
}

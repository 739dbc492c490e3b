//! `<name>_axis.v` of a pipeline: the core between two AXI4-Streams, and what is proved of it.

use anyhow::{Result, ensure};
use askama::Template;

use super::fields::{Field, bits, operands, packed, padding, results, sink};
use super::{Wrappers, connected, script, seen_inside, stub_ports};
use crate::hdl::netlist::{Design, Pipeline, Role};
use crate::hdl::verilog::rows::separated;
use crate::hdl::verilog::text::literal;
use crate::package::{EmitInputs, render};

#[derive(Template)]
#[template(path = "axis_pipeline.v")]
struct Wrapper<'a> {
    name: &'a str,
    regenerate: &'a str,
    user_bits: u32,
    operands: &'a [Field],
    results: &'a [Field],
    signed: bool,
    in_high: u32,
    out_high: u32,
    stages: usize,
    /// Bits of the own side channel of the core, which is not used.
    side: u32,
    packed: Vec<String>,
    connections: Vec<String>,
    unused: Vec<String>,
}

/// The lowest and the highest bit of tlast and tuser of a stage's point among those of all stages.
struct Side {
    low: u32,
    high: u32,
}

/// A result among the bits of all, without those that fill bytes.
struct Raw<'a> {
    name: &'a str,
    low: u32,
    width: u32,
}

#[derive(Template)]
#[template(path = "axis_pipeline_formal.sv")]
struct Formal<'a> {
    name: &'a str,
    in_high: u32,
    out_high: u32,
    user_bits: u32,
    stub_ports: Vec<String>,
    raw: Vec<Raw<'a>>,
    raw_high: u32,
    packed: Vec<String>,
    checks: Vec<String>,
    /// Declarations of what the proof sees of the inside.
    inside: Vec<String>,
    stages: usize,
    sides: Vec<Side>,
}

/// The wrapper, and what is proved of it.
///
/// # Errors
/// A pipeline that cannot be held back; one without operands or results.
pub fn wrapper(design: &Design, pipeline: &Pipeline, inputs: &EmitInputs) -> Result<Wrappers> {
    let name = design.name.as_str();
    ensure!(
        pipeline.stall,
        "`{name}` cannot be held back, which interface.stream needs; set pipeline.stall = \"ready\""
    );
    let (operands, results) = (operands(design), results(design));
    let connections = connected(design, "aclk", |role, name| match role {
        Role::Reset => Some("aresetn".to_owned()),
        Role::InValid => Some("s_axis_tvalid".to_owned()),
        Role::InReady => Some("s_axis_tready".to_owned()),
        Role::OutReady => Some("ready".to_owned()),
        Role::Valid => Some("valid".to_owned()),
        Role::Point => {
            let field = operands.iter().find(|field| field.name == name);
            Some(format!("s_axis_tdata{}", field.map(Field::bits).unwrap_or_default()))
        }
        Role::SideIn => Some(literal(0, pipeline.side)),
        _ => None,
    });
    let mut unused = padding(&operands, "s_axis_tdata");
    if pipeline.side > 0 {
        unused.push("core_side_out".to_owned());
    }
    let view = Wrapper {
        name,
        regenerate: &inputs.config,
        user_bits: inputs.around.user_bits,
        signed: results.iter().any(|field| field.signed && field.padded() > field.width),
        in_high: bits(&operands)? - 1,
        out_high: bits(&results)? - 1,
        stages: pipeline.stages.len(),
        side: pipeline.side,
        packed: separated(packed(&results, "core_")),
        connections,
        unused: sink(&unused),
        operands: &operands,
        results: &results,
    };
    let rtl = vec![(format!("{name}_axis.v"), render(&view)?)];
    let formal = formal(design, pipeline, inputs, (&operands, &results))?;
    Ok(Wrappers { rtl, formal, ..Wrappers::default() })
}

fn formal(
    design: &Design,
    pipeline: &Pipeline,
    inputs: &EmitInputs,
    (operands, results): (&[Field], &[Field]),
) -> Result<Vec<(String, String)>> {
    let name = design.name.as_str();
    let stages = pipeline.stages.len();
    let user = inputs.around.user_bits;
    let side = user + 1;
    let mut raw_bits = 0;
    let mut raw = Vec::new();
    for field in results {
        raw.push(Raw { name: &field.name, low: raw_bits, width: field.width });
        raw_bits += field.width;
    }
    let mut nets = vec![
        ("held".to_owned(), 1),
        ("held_results".to_owned(), bits(results)?),
        ("held_side".to_owned(), side),
        ("side".to_owned(), stages as u32 * side),
        ("results_side".to_owned(), side),
        ("core.points".to_owned(), stages as u32),
    ];
    let handshake = ["rst_n", "in_valid", "in_ready", "out_valid", "out_ready"];
    nets.extend(handshake.map(|port| (format!("core.{port}"), 1)));
    let ports = operands.iter().chain(results);
    nets.extend(ports.map(|field| (format!("core.{}", field.name), field.width)));
    let check = |field: &Field| format!("dut.core.{} == s_axis_tdata{}", field.name, field.bits());
    let view = Formal {
        name,
        in_high: bits(operands)? - 1,
        out_high: bits(results)? - 1,
        user_bits: user,
        stub_ports: stub_ports(design),
        raw,
        raw_high: raw_bits - 1,
        packed: separated(packed(results, "dut.core.")),
        checks: operands.iter().map(check).collect(),
        inside: nets.into_iter().map(seen_inside).collect(),
        stages,
        sides: (0..stages as u32)
            .map(|stage| Side { low: stage * side, high: stage * side + user })
            .collect(),
    };
    Ok(vec![
        (format!("{name}_axis_formal.sv"), render(&view)?),
        (format!("{name}_axis_formal.ys"), script(&format!("{name}_axis"))?),
    ])
}

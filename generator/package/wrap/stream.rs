//! `<name>_axis.v`: the core between two AXI4-Streams, and what is proved of it.

use anyhow::{Context, Result};
use askama::Template;

use super::fields::{Field, bits, operands, packed, padding, results, sink};
use super::{Wrappers, connected, core_wire, script, seen_inside, stub_free, stub_ports};
use crate::hdl::netlist::{Design, Role};
use crate::hdl::verilog::rows::separated;
use crate::hdl::verilog::text::literal;
use crate::package::{EmitInputs, render};

/// The line of a core that walks lines: the operand that says how long one is, and the buffer.
struct Line {
    length: String,
    length_low: u32,
    length_high: u32,
    /// Bits of the length.
    width: u32,
}

impl Line {
    /// The highest bit of a place in the buffer.
    fn high(&self) -> u32 {
        self.width - 1
    }

    /// 0 as a count, which has a bit more than an address of the buffer.
    fn zero(&self) -> String {
        literal(0, self.width + 1)
    }

    fn one(&self) -> String {
        literal(1, self.width + 1)
    }

    /// As many points as a line can have, and as the buffer has places.
    fn places(&self) -> String {
        literal(1 << self.width, self.width + 1)
    }

    fn deepest(&self) -> u64 {
        (1 << self.width) - 1
    }
}

/// All that the templates print.
#[derive(Template)]
#[template(path = "axis.v")]
struct Wrapper<'a> {
    name: &'a str,
    regenerate: &'a str,
    user_bits: u32,
    operands: Vec<Field>,
    results: Vec<Field>,
    signed: bool,
    in_high: u32,
    out_high: u32,
    result_wires: Vec<String>,
    packed: Vec<String>,
    connections: Vec<String>,
    line: Option<Line>,
    unused: Vec<String>,
    /// The core hears `start` in the clock of `done` too.
    overlaps: bool,
    /// The declaration of the outputs: `reg `, or `wire` of the buffer.
    output: &'static str,
}

#[derive(Template)]
#[template(path = "axis_buffer.v")]
struct Buffer<'a> {
    name: &'a str,
    regenerate: &'a str,
    out_high: u32,
    user_bits: u32,
    line: Line,
}

#[derive(Template)]
#[template(path = "axis_formal.sv")]
struct Formal<'a> {
    name: &'a str,
    in_high: u32,
    out_high: u32,
    user_high: u32,
    /// The highest bit of results, tlast and tuser together.
    packed_high: u32,
    stub_ports: Vec<String>,
    stub_free: Vec<String>,
    stub_packed: Vec<String>,
    stub_checks: Vec<String>,
    strobes: Vec<String>,
    /// Declarations of what the proof sees of the inside.
    inside: Vec<String>,
    line: Option<Line>,
    /// The core hears `start` in the clock of `done` too.
    overlaps: bool,
}

/// The wrapper, of a core that walks lines its buffer too, and what is proved of them.
///
/// # Errors
/// A core without the handshake of a microprogram, or without operands or results.
pub fn wrapper(design: &Design, inputs: &EmitInputs) -> Result<Wrappers> {
    design.handshake()?;
    let (rtl, formal) = (modules(design, inputs)?, formal(design, inputs)?);
    Ok(Wrappers { rtl, formal, ..Wrappers::default() })
}

fn modules(design: &Design, inputs: &EmitInputs) -> Result<Vec<(String, String)>> {
    let name = design.name.as_str();
    let (operands, results) = (operands(design), results(design));
    let overlaps = design.control.overlaps;
    let is_unused = |role: Role| role == Role::Status || role == Role::Done && !overlaps;
    let connections = connected(design, "aclk", |role, name| match role {
        Role::Reset => Some("aresetn".to_owned()),
        Role::Start | Role::Valid | Role::Busy => Some(name.to_owned()),
        Role::Done if overlaps => Some("done".to_owned()),
        Role::Operand { .. } => {
            let field = operands.iter().find(|field| field.name == name);
            Some(format!("operands{}", field.map(Field::bits).unwrap_or_default()))
        }
        Role::Strobe if operands.iter().any(|field| field.strobe == name) => {
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
    unused.extend(padding(&operands, "operands"));
    let signed = results.iter().any(|field| field.signed && field.padded() > field.width);
    let packed = packed(&results, "core_");
    let buffered = line(inputs, &operands)?;
    let wrapper = Wrapper {
        name: &design.name,
        regenerate: &inputs.config,
        user_bits: inputs.around.user_bits,
        in_high: bits(&operands)? - 1,
        out_high: bits(&results)? - 1,
        signed,
        result_wires,
        packed: separated(packed),
        connections,
        output: if buffered.is_some() { "wire" } else { "reg " },
        line: line(inputs, &operands)?,
        unused: sink(&unused),
        overlaps,
        operands,
        results,
    };
    let (regenerate, user_bits, out_high) =
        (wrapper.regenerate, wrapper.user_bits, wrapper.out_high);
    let mut files = vec![(format!("{name}_axis.v"), render(&wrapper)?)];
    if let Some(line) = buffered {
        let buffer = Buffer { name, regenerate, out_high, user_bits, line };
        files.push((format!("{name}_axis_buffer.v"), render(&buffer)?));
    }
    Ok(files)
}

/// Returns the properties that are proved of the wrapper.
fn formal(design: &Design, inputs: &EmitInputs) -> Result<Vec<(String, String)>> {
    let name = design.name.as_str();
    let (operands, results) = (operands(design), results(design));
    let line = line(inputs, &operands)?;
    let user_high = inputs.around.user_bits - 1;
    let out_high = bits(&results)? - 1;
    let stub_checks = operands
        .iter()
        .map(|field| format!("dut.core.{} == its_operands{}", field.name, field.bits()));
    let inside = inside(&operands, &results, line.as_ref(), user_high + 1)?;
    let formal = Formal {
        name,
        in_high: bits(&operands)? - 1,
        out_high,
        user_high,
        packed_high: out_high + 1 + user_high + 1,
        stub_ports: stub_ports(design),
        stub_free: stub_free(design),
        stub_packed: separated(packed(&results, "dut.core.")),
        stub_checks: stub_checks.collect(),
        inside,
        strobes: operands.iter().map(|field| field.strobe.clone()).collect(),
        line,
        overlaps: design.control.overlaps,
    };
    Ok(vec![
        (format!("{name}_axis_formal.sv"), render(&formal)?),
        (format!("{name}_axis_formal.ys"), script(&format!("{name}_axis"))?),
    ])
}

/// Yosys finds nets below the top by their path, if a declaration says how wide they are.
fn inside(
    operands: &[Field],
    results: &[Field],
    line: Option<&Line>,
    user: u32,
) -> Result<Vec<String>> {
    let (in_bits, out_bits) = (bits(operands)?, bits(results)?);
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
        Some(Line { width, .. }) => vec![
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
    let ports = operands.iter().chain(results);
    nets.extend(ports.map(|field| (format!("core.{}", field.name), field.width)));
    Ok(nets.into_iter().map(seen_inside).collect())
}

fn line(inputs: &EmitInputs, operands: &[Field]) -> Result<Option<Line>> {
    let length = inputs.accuracy.as_ref().and_then(|accuracy| accuracy.length.as_ref());
    let Some(length) = length else {
        return Ok(None);
    };
    let field = operands.iter().find(|field| field.name == *length);
    let field = field.with_context(|| format!("`{length}` is no operand"))?;
    Ok(Some(Line {
        length: field.name.clone(),
        length_low: field.low,
        length_high: field.high(),
        width: field.width,
    }))
}

//! The model in C: header, functions, and an example in Python.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use askama::Template;

use super::graph::{Graph, Node, State};
use super::print::{Line, Printer, comment, field, literal, pattern_type, read_name, taken};
use super::unroll::{Stepped, stepped, straight};
use crate::base::fixed::{Format, mask};
use crate::hdl::netlist::{Design, NetId, Port, RegId, Role, RomId};
use crate::hdl::verilog::text::{Names, ascii, constant_name, statement};
use crate::package::{EmitInputs, Unfit, WorkedExample, render};

/// An operand or a result in C.
#[derive(Clone)]
pub struct Field {
    /// As a structure has it.
    pub name: String,
    /// The upper-case name with the module's before it.
    constant: String,
    /// The type of the raw integer.
    pub kind: &'static str,
    /// Of the port.
    pub format: Format,
    doc: String,
}

#[derive(Template)]
#[template(path = "model.h")]
struct Header<'a> {
    name: &'a str,
    guard: String,
    title: String,
    formula: String,
    regenerate: &'a str,
    /// Of a pipeline, the upper-case name of its latency, and the clocks.
    latency: Option<(String, usize)>,
    operands: Vec<Field>,
    results: Vec<Field>,
    line: bool,
}

#[derive(Template)]
#[template(path = "model.c")]
struct Source<'a> {
    name: &'a str,
    title: String,
    regenerate: &'a str,
    tables: Vec<String>,
    body: Vec<String>,
    line: bool,
}

#[derive(Template)]
#[template(path = "model.py")]
struct Example<'a> {
    name: &'a str,
    regenerate: &'a str,
    operands: Vec<Field>,
    results: Vec<Field>,
    values: Vec<String>,
    line: bool,
}

impl Field {
    /// Of a port.
    pub fn new(design: &Design, port: &Port) -> Self {
        let net = design.net(port.net);
        Self {
            name: field(&net.name),
            constant: format!("{}_{}", constant_name(&design.name), constant_name(&net.name)),
            kind: match (net.format.signed, net.format.width() <= 32) {
                (false, true) => "uint32_t",
                (false, false) => "uint64_t",
                (true, true) => "int32_t",
                (true, false) => "int64_t",
            },
            format: net.format,
            doc: ascii(&match net.doc.as_str() {
                "" => net.format.to_string(),
                doc => format!("{}: {doc}", net.format),
            })
            .replace("*/", "* /"),
        }
    }

    /// The smallest raw integer as C writes it.
    fn least(&self) -> String {
        let (least, suffix) = (self.format.min_raw(), self.suffix());
        match (self.format.signed, self.format.width()) {
            // The literal without its sign would not fit the type.
            (true, 32 | 64) => format!("(-{}{suffix} - 1)", -(least + 1)),
            (true, _) => format!("(-{}{suffix})", -least),
            (false, _) => format!("{least}{suffix}"),
        }
    }

    /// The largest.
    fn most(&self) -> String {
        format!("{}{}", self.format.max_raw(), self.suffix())
    }

    fn suffix(&self) -> &'static str {
        match (self.format.signed, self.format.width() <= 32) {
            (false, true) => "u",
            (true, true) => "",
            (false, false) => "ull",
            (true, false) => "ll",
        }
    }

    /// The weight of the lowest bit's inverse, as a C double: 2^F exactly.
    pub fn scale(&self) -> String {
        format!("{:?}", crate::base::fixed::exp2(self.format.frac))
    }

    /// The lowest bit, as a C double: 2^-F exactly.
    fn unit(&self) -> String {
        format!("{:?}", crate::base::fixed::exp2(-self.format.frac))
    }

    /// The limits as doubles.
    fn limits(&self) -> (String, String) {
        let (low, high) = self.format.range();
        (format!("{:?}", low as f64), format!("{:?}", high as f64))
    }

    /// The field of a structure in ctypes.
    fn ctype(&self) -> String {
        format!("c_{}", self.kind.trim_end_matches("_t"))
    }

    /// The field of a structure in NumPy.
    fn dtype(&self) -> &'static str {
        match self.kind {
            "uint32_t" => "u4",
            "int32_t" => "i4",
            "uint64_t" => "u8",
            _ => "i8",
        }
    }
}

/// The files of `software/<name>/`, pairs of a plain name and contents. The design has the microprogram; `latency` is that
/// of the pipeline in its place.
///
/// # Errors
/// A core of which no function can be made: one that waits for `start` in the middle, has a loop without a bound, or
/// whose results depend on what it did before.
pub fn files(
    design: &Design,
    inputs: &EmitInputs,
    latency: Option<usize>,
) -> Result<Vec<(String, String)>> {
    let name = design.name.as_str();
    let line = inputs.accuracy.as_ref().is_some_and(|accuracy| accuracy.length.is_some());
    let about = &design.about;
    let operands = || {
        design
            .inputs()
            .filter(|port| matches!(port.role, Role::Operand { .. }))
            .map(|port| Field::new(design, port))
            .collect::<Vec<_>>()
    };
    let results = || result_ports(design).map(|port| Field::new(design, port)).collect::<Vec<_>>();
    let names = table_names(design);
    let (body, read) = if line { of_line(design, &names) } else { of_point(design, &names) }
        .map_err(|error| {
            let message = format!("`{name}` has no model in C: {error:#}");
            Unfit::new("package.software", message, "remove it")
        })?;
    let regenerate = inputs.config.as_str();
    let header = Header {
        name,
        guard: format!("{}_MODEL_H", constant_name(name)),
        title: ascii(&about.title).replace("*/", "* /"),
        formula: ascii(&about.formula).replace("*/", "* /"),
        regenerate,
        latency: latency.map(|clocks| (format!("{}_LATENCY", constant_name(name)), clocks)),
        operands: operands(),
        results: results(),
        line,
    };
    let source = Source {
        name,
        title: ascii(&about.title).replace("*/", "* /"),
        regenerate,
        tables: tables(design, &names, &read),
        body,
        line,
    };
    let mut files = vec![
        (format!("{name}_model.h"), render(&header)?),
        (format!("{name}_model.c"), render(&source)?),
    ];
    if let Some(example) = &inputs.example {
        let example = Example {
            name,
            regenerate,
            operands: operands(),
            results: results(),
            values: example_values(design, example),
            line,
        };
        files.push((format!("{name}_model.py"), render(&example)?));
    }
    Ok(files)
}

/// The worked example's raw operands in the order of the ports, which need not be its own.
fn example_values(design: &Design, example: &WorkedExample) -> Vec<String> {
    let named = |port: &Port| {
        let name = &design.net(port.net).name;
        let quantity = example.operands.iter().find(|quantity| quantity.name == *name);
        quantity.map_or_else(|| "0".to_owned(), |quantity| quantity.raw.to_string())
    };
    let ports = design.inputs().filter(|port| matches!(port.role, Role::Operand { .. }));
    ports.map(named).collect()
}

fn result_ports(design: &Design) -> impl Iterator<Item = &Port> {
    design.outputs().filter(|port| port.role == Role::Result)
}

/// The body of the function of one point, and the ROMs that it reads.
fn of_point(design: &Design, tables: &[String]) -> Result<(Vec<String>, Vec<RomId>)> {
    let straight = straight(design)?;
    let mut names = taken();
    let (printer, lines) = Printer::new(
        &straight.graph,
        design,
        tables,
        BTreeMap::new(),
        &mut names,
        &straight.results,
    );
    let mut body = sections(1, &lines, &straight.sections);
    body.push(String::new());
    for (port, value) in result_ports(design).zip(&straight.results) {
        let text = assigned(design, port, &printer.text(*value));
        body.extend(statement(4, &format!("results.{text}")));
    }
    let read = roms(&straight.graph, &straight.results);
    Ok((body, read))
}

/// The body of the function of a line, and the ROMs that it reads.
fn of_line(design: &Design, tables: &[String]) -> Result<(Vec<String>, Vec<RomId>)> {
    let Stepped { first, initial, each, clock, next } = stepped(design)?;
    let port = |role: Role| {
        let port = design.port(|of| of == role).map(|port| clock[port.net.index()]);
        port.with_context(|| format!("it has no output {role:?}"))
    };
    let (valid, done) = (port(Role::Valid)?, port(Role::Done)?);
    let results: Vec<(&Port, NetId)> =
        result_ports(design).map(|port| (port, clock[port.net.index()])).collect();

    // Registers and reads that the results of some clock depend on.
    let mut wanted: Vec<NetId> = results.iter().map(|(_, value)| *value).collect();
    wanted.extend([valid, done]);
    let (mut registers, mut reads) = (Vec::new(), Vec::new());
    loop {
        let needed = each.needed(&wanted);
        let before = registers.len() + reads.len();
        for (value, _) in each.values.iter().zip(needed).filter(|(_, needed)| *needed) {
            match value.node {
                Node::State(id) if !registers.contains(&id) => {
                    registers.push(id);
                    wanted.push(next.registers[id.index()]);
                }
                Node::Read(id) if !reads.contains(&id) => {
                    reads.push(id);
                    wanted.push(next.reads[id.index()]);
                }
                _ => {}
            }
        }
        if registers.len() + reads.len() == before {
            break;
        }
    }
    registers.sort_unstable();
    reads.sort_unstable();

    let mut names = taken();
    let states: BTreeMap<RegId, String> = registers
        .iter()
        .map(|id| (*id, names.fresh(&design.net(design.register(*id).q).name)))
        .collect();
    for id in &reads {
        names.fresh(&read_name(design, id.index()));
    }
    let starts: Vec<NetId> = registers.iter().map(|id| initial.registers[id.index()]).collect();
    let (printer, lines) =
        Printer::new(&first, design, tables, BTreeMap::new(), &mut names, &starts);
    let mut body = vec![format!("    {}", comment("the clock that takes start"))];
    body.extend(lines.iter().flat_map(|line| statement(4, &line.text)));
    for (id, start) in registers.iter().zip(&starts) {
        let kind = pattern_type(first.width(*start));
        let text = format!("{kind} {} = {};", states[id], printer.text(*start));
        body.extend(statement(4, &text));
    }
    for id in &reads {
        let rom = design.rom(*id);
        let width = design.width(rom.data);
        let name = read_name(design, id.index());
        body.push(format!("    {} {name} = {};", pattern_type(width), literal(0, width)));
    }
    body.push("    size_t count = 0;".to_owned());
    body.push("    for (;;) {".to_owned());
    let (printer, lines) = Printer::new(&each, design, tables, states.clone(), &mut names, &wanted);
    body.extend(lines.iter().flat_map(|line| statement(8, &line.text)));
    body.push(format!("        if ({} != 0u) {{", printer.text(valid)));
    body.push("            if (count < capacity) {".to_owned());
    for (port, value) in &results {
        let text = assigned(design, port, &printer.text(*value));
        body.extend(statement(16, &format!("points[count].{text}")));
    }
    body.push("            }".to_owned());
    body.push("            ++count;".to_owned());
    body.push("        }".to_owned());
    body.push(format!("        if ({} != 0u) {{", printer.text(done)));
    body.push("            return count;".to_owned());
    body.push("        }".to_owned());
    body.extend(clocked(design, &printer, &registers, &reads, &states, &next, &mut names));
    body.push("    }".to_owned());
    let mut read = roms(&each, &wanted);
    read.extend(roms(&first, &starts));
    Ok((body, read))
}

/// All registers take their new values at once.
fn clocked(
    design: &Design,
    printer: &Printer,
    registers: &[RegId],
    reads: &[RomId],
    states: &BTreeMap<RegId, String>,
    next: &State,
    names: &mut Names,
) -> Vec<String> {
    let registers = registers.iter().map(|id| {
        let width = design.width(design.register(*id).q);
        (states[id].clone(), next.registers[id.index()], width)
    });
    let reads = reads.iter().map(|id| {
        let width = design.width(design.rom(*id).data);
        (read_name(design, id.index()), next.reads[id.index()], width)
    });
    let mut lines = vec![format!("        {}", comment("the rising edge"))];
    let mut moves = Vec::new();
    for (name, value, width) in registers.chain(reads) {
        let mut text = printer.text(value);
        if text == name {
            continue;
        }
        // What is computed from the state has to be computed before any of it changes.
        if !printer.is_settled(value) {
            let next = names.fresh(&format!("next_{name}"));
            let kind = pattern_type(width);
            lines.extend(statement(8, &format!("const {kind} {next} = {text};")));
            text = next;
        }
        moves.push(format!("        {name} = {text};"));
    }
    lines.extend(moves);
    lines
}

/// Statements under the headings of their sections.
fn sections(depth: usize, lines: &[Line], headings: &[String]) -> Vec<String> {
    let indent = 4 * depth;
    let mut body = Vec::new();
    let mut section = None;
    for line in lines {
        if section != Some(line.section) {
            section = Some(line.section);
            body.push(format!("{}{}", " ".repeat(indent), comment(&headings[line.section])));
        }
        body.extend(statement(indent, &line.text));
    }
    body
}

/// `red_out = …;` from a bit pattern.
fn assigned(design: &Design, port: &Port, pattern: &str) -> String {
    let net = design.net(port.net);
    let kind = Field::new(design, port).kind;
    let width = net.format.width();
    let value = match net.format.signed {
        false => pattern.to_owned(),
        true if width == 32 || width == 64 => format!("({kind})({pattern})"),
        true => {
            let sign = literal(1 << (width - 1), width);
            format!("({kind})(({pattern}) ^ {sign}) - ({kind}){sign}")
        }
    };
    format!("{} = {value};", field(&net.name))
}

fn roms(graph: &Graph, wanted: &[NetId]) -> Vec<RomId> {
    let needed = graph.needed(wanted);
    let values = graph.values.iter().zip(needed).filter(|(_, needed)| *needed);
    values
        .filter_map(|(value, _)| match value.node {
            Node::Rom(rom, _) => Some(rom),
            _ => None,
        })
        .collect()
}

/// The array of each ROM.
fn table_names(design: &Design) -> Vec<String> {
    let mut names = Names::new(design.nets.iter().map(|net| net.name.as_str()));
    design.roms.iter().map(|rom| names.fresh(&format!("{}_table", rom.name))).collect()
}

/// The arrays of the ROMs that are read.
fn tables(design: &Design, names: &[String], read: &[RomId]) -> Vec<String> {
    let mut lines = Vec::new();
    for (at, rom) in design.roms.iter().enumerate() {
        if !read.contains(&RomId(at as u32)) {
            continue;
        }
        let width = design.width(rom.data);
        let kind = match width {
            ..=8 => "uint8_t",
            9..=16 => "uint16_t",
            17..=32 => "uint32_t",
            _ => "uint64_t",
        };
        let what = rom.doc.join(" ");
        lines.push(comment(&format!("ROM {}: {what}", rom.name)));
        lines.push(format!("static const {kind} {}[{}] = {{", names[at], rom.words.len()));
        let words: Vec<String> = rom
            .words
            .iter()
            .map(|word| format!("{},", literal(word & mask(width), width)))
            .collect();
        lines.extend(
            statement(4, &words.join(" "))
                .into_iter()
                .map(|line| format!("    {}", line.trim_start())),
        );
        lines.push("};".to_owned());
        lines.push(String::new());
    }
    lines
}

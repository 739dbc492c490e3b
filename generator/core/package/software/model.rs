//! Generates the bit-exact model of a core in C: a header, the functions, and an example in Python that calls them.
//!
//! A function computes the raw results of one point, or of a line of points, from raw operands. The module `print` prints this
//! function from the unrolled microprogram, or for a line from one clock of the core. A core that waits for a second `start`
//! within a computation has no model.

use glint_base::fill;
use std::collections::BTreeMap;

use anyhow::{Context, Result};

use super::print::{CStatement, Printer, comment, field, literal, pattern_type, taken};
use crate::observation::WorkedExample;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use glint_base::config_error::ConfigError;
use glint_base::fixed::{Format, mask};
use glint_rtl::netlist::{Design, NetId, Port, Role, RomId};
use glint_rtl::pipeline::{
    Cell, Cycle, DispatchedResults, Graph, NodeId, StateValues, Unrolled, any_cycle,
    unroll_in_powers,
};
use glint_rtl::verilog::text::{Names, ascii, constant_name, statement};

/// An operand or a result as a member of a C structure.
#[derive(Clone)]
pub struct CField {
    pub name: String,
    /// The prefix of the port's constants in C: `ROUGH_COS_GAMMA`.
    constant: String,
    /// The C type of the raw integer.
    pub kind: &'static str,
    pub format: Format,
    pub doc: String,
}

impl CField {
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

    fn least(&self) -> String {
        let (least, suffix) = (self.format.min_raw(), self.suffix());
        match (self.format.signed, self.format.width()) {
            // The literal without its sign would not fit the type.
            (true, 32 | 64) => format!("(-{}{suffix} - 1)", -(least + 1)),
            (true, _) => format!("(-{}{suffix})", -least),
            (false, _) => format!("{least}{suffix}"),
        }
    }

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

    /// Returns 2^F for F fraction bits as a C double, exactly: `u1.20` gives `1048576.0`.
    pub fn scale(&self) -> String {
        format!("{:?}", glint_base::fixed::exp2(self.format.frac))
    }

    fn fraction_bits(&self) -> String {
        c_integer(self.format.frac)
    }

    /// Returns 2^−F for F fraction bits as a C double, exactly.
    fn unit(&self) -> String {
        format!("{:?}", glint_base::fixed::exp2(-self.format.frac))
    }

    /// Returns the smallest and the largest raw integer as C doubles.
    fn limits(&self) -> (String, String) {
        let (low, high) = self.format.range();
        (format!("{:?}", low as f64), format!("{:?}", high as f64))
    }

    fn ctype(&self) -> String {
        format!("c_{}", self.kind.trim_end_matches("_t"))
    }

    fn dtype(&self) -> &'static str {
        match self.kind {
            "uint32_t" => "u4",
            "int32_t" => "i4",
            "uint64_t" => "u8",
            _ => "i8",
        }
    }
}

/// Adds a header, the functions, and an example in Python if there is a worked example. Returns the ROMs whose words the model
/// contains. The model comes from the sequential netlist and its microprogram, also for a pipeline.
///
/// # Errors
/// Fails if the core cannot become a C function. A core that computes single points must not wait for a second `start`, have
/// a loop without a bound, or have results that depend on an earlier computation.
pub fn files(job: &EmitJob, files: &mut OutputFiles) -> Result<Vec<RomId>> {
    let (name, inputs, line) = (job.name(), job.inputs, job.is_line());
    let design = inputs.sequential.as_ref().unwrap_or(job.design);
    let about = &design.about;
    let mut operands = Vec::new();
    for port in design.inputs() {
        if matches!(port.role, Role::Operand { .. }) {
            operands.push(CField::new(design, port));
        }
    }
    let results: Vec<CField> = result_ports(design).map(|port| CField::new(design, port)).collect();
    let names = table_names(design);
    let (body, read) = if line { of_line(design, &names) } else { of_point(design, &names) }
        .map_err(|error| {
            let message = format!("no model in C can be written for `{name}`: {error:#}");
            ConfigError::new("package.software", message, "remove package.software")
        })?;
    let regenerate = job.regenerate();
    let [title, formula] =
        [&about.title, &about.formula].map(|text| ascii(text).replace("*/", "* /"));
    let mut functions = Vec::new();
    for function in &design.functions {
        let doc = ascii(&function.doc).replace("*/", "* /");
        functions.push((format!("{}_{}", constant_name(name), function.constant()), doc));
    }
    let latency = job.design.pipeline.as_ref().map(|pipeline| pipeline.stages.len());
    let header = fill!("model.h" {
        name: &'a str,
        guard: String = format!("{}_MODEL_H", constant_name(name)),
        title: &'a str = &title,
        formula: String,
        regenerate: &'a str,
        // Only for a pipeline: the upper-case name of its latency, and the clocks.
        latency: Option<(String, usize)> =
            latency.map(|clocks| (format!("{}_LATENCY", constant_name(name)), clocks)),
        // In the order of the opcodes, each with the name of its constant and its formulas.
        functions: &'a [(String, String)] = &functions,
        operands: &'a [CField] = &operands,
        results: &'a [CField] = &results,
        line: bool,
    })?;
    let source = fill!("model.c" {
        name: &'a str,
        title: &'a str = &title,
        regenerate: &'a str,
        tables: Vec<String> = tables(design, &names, &read),
        body: Vec<String>,
        line: bool,
    })?;
    files.add(FileKind::Software, format!("{name}_model.h"), header);
    files.add(FileKind::Software, format!("{name}_model.c"), source);
    if let Some(example) = &inputs.example {
        let python = fill!("model.py" {
            name: &'a str,
            regenerate: &'a str,
            operands: &'a [CField] = &operands,
            results: &'a [CField] = &results,
            values: Vec<String> = example_values(design, example),
            line: bool,
        })?;
        files.add(FileKind::Software, format!("{name}_model.py"), python);
    }
    Ok(read)
}

/// Returns the raw operands in the order of the ports, which may differ from the order in the example.
fn example_values(design: &Design, example: &WorkedExample) -> Vec<String> {
    let mut values = Vec::new();
    for port in design.inputs() {
        if matches!(port.role, Role::Operand { .. }) {
            let name = &design.net(port.net).name;
            let quantity = example.operands.iter().find(|quantity| quantity.name == *name);
            values.push(quantity.map_or(0, |quantity| quantity.raw).to_string());
        }
    }
    values
}

fn result_ports(design: &Design) -> impl Iterator<Item = &Port> {
    design.outputs().filter(|port| port.role == Role::Result)
}

/// Returns the lines of the C function that computes one point, and the ROMs that it reads. `tables` has the names of the C
/// arrays with the ROMs' words. Fails if the microprogram cannot be unrolled.
fn of_point(design: &Design, tables: &[String]) -> Result<(Vec<String>, Vec<RomId>)> {
    let unrolled = unroll_in_powers(design)?;
    let mut body = match &unrolled.dispatched {
        Some(dispatched) => switch(design, &unrolled, tables, dispatched),
        None => computation(design, &unrolled, tables, (4, &unrolled.results)),
    };
    if !body.iter().any(|line| line.contains("operands.")) {
        // A constant reads no operand, and a compiler would warn of the unused parameter.
        body.insert(0, "    (void)operands;".to_owned());
    }
    let wanted: Vec<NodeId> =
        results_of(design, &unrolled.results).map(|(_, value)| value).collect();
    Ok((body, roms(&unrolled.graph, &wanted)))
}

/// Returns the C statements that compute the nodes `results` of some ports and assign them, behind `indent` blanks.
fn computation(
    design: &Design,
    unrolled: &Unrolled,
    tables: &[String],
    (indent, results): (usize, &[(NetId, NodeId)]),
) -> Vec<String> {
    let results: Vec<(&Port, NodeId)> = results_of(design, results).collect();
    let wanted: Vec<NodeId> = results.iter().map(|(_, value)| *value).collect();
    let mut printer = Printer::new(design, unrolled, tables, BTreeMap::new());
    let margin = " ".repeat(indent);
    let mut body = Vec::new();
    let mut step = None;
    for CStatement { step: of, text } in printer.lines(&mut taken(), &wanted) {
        if step.replace(of) != Some(of) {
            let step = &unrolled.steps[of];
            let turn =
                if step.visit == 0 { String::new() } else { format!(", turn {}", step.visit + 1) };
            let name = &design.control.microprogram[step.address].name;
            body.push(format!("{margin}{}", comment(&format!("{}: {name}{turn}", step.address))));
        }
        body.extend(statement(indent, &text));
    }
    if !body.is_empty() {
        body.push(String::new());
    }
    for (port, value) in results {
        let text = assigned(design, port, &printer.text(value));
        body.extend(statement(indent, &format!("results.{text}")));
    }
    body
}

/// Returns a C statement `switch` that computes the results for each value of the operand by which the microprogram dispatches.
fn switch(
    design: &Design,
    unrolled: &Unrolled,
    tables: &[String],
    dispatched: &DispatchedResults,
) -> Vec<String> {
    let mut printer = Printer::new(design, unrolled, tables, BTreeMap::new());
    let mut body = Vec::new();
    for line in printer.lines(&mut taken(), &[dispatched.selector]) {
        body.extend(statement(4, &line.text));
    }
    body.push(format!("    switch ({}) {{", printer.text(dispatched.selector)));
    let mut values: Vec<usize> = Vec::new();
    for (value, results) in dispatched.of_values.iter().enumerate() {
        values.push(value);
        let following = dispatched.of_values.get(value + 1);
        if following == Some(results) {
            continue;
        }
        for value in values.drain(..) {
            let name = design.functions.get(value).map(|function| comment(&function.name));
            let label = match following {
                Some(_) => format!("    case {value}u:"),
                // With a default, every path assigns the results.
                None => "    default:".to_owned(),
            };
            body.push(format!("{label} {}", name.unwrap_or_default()).trim_end().to_owned());
            if following.is_none() {
                break;
            }
        }
        body.push("    {".to_owned());
        body.extend(computation(design, unrolled, tables, (8, results)));
        body.extend(["        break;".to_owned(), "    }".to_owned()]);
    }
    body.push("    }".to_owned());
    body
}

/// Returns the result ports, each with its node in the list `results` of nets and nodes.
fn results_of<'a>(
    design: &'a Design,
    results: &'a [(NetId, NodeId)],
) -> impl Iterator<Item = (&'a Port, NodeId)> {
    result_ports(design).filter_map(|port| {
        let (_, value) = results.iter().find(|(net, _)| *net == port.net)?;
        Some((port, *value))
    })
}

/// Returns the lines of the C function that computes a line of points, and the ROMs that it reads. The function executes the
/// core clock by clock until `done` is 1.
fn of_line(design: &Design, tables: &[String]) -> Result<(Vec<String>, Vec<RomId>)> {
    let Cycle { unrolled, held } = any_cycle(design);
    let graph = &unrolled.graph;
    let port = |role: Role| {
        let port = design
            .port(|of| of == role)
            .with_context(|| format!("the design has no output {role:?}"))?;
        let value = unrolled.results.iter().find(|(net, _)| *net == port.net);
        value.map(|it| it.1).context("an output has no value")
    };
    let (valid, done) = (port(Role::Valid)?, port(Role::Done)?);
    let results: Vec<(&Port, NodeId)> = results_of(design, &unrolled.results).collect();

    // The registers and memories on which the results, `valid` and `done` of any clock depend.
    let mut wanted: Vec<NodeId> = results.iter().map(|(_, value)| *value).collect();
    wanted.extend([valid, done]);
    let mut kept: Vec<StateValues> = Vec::new();
    loop {
        let needed = graph.cone(wanted.iter().copied());
        let mut now = held.clone();
        now.retain(|it| {
            let is_state = matches!(graph.node(it.before).cell, Cell::Unknown(_));
            is_state && needed.binary_search(&it.before).is_ok()
        });
        if now.len() == kept.len() {
            break;
        }
        wanted.extend(now.iter().map(|it| it.after));
        kept = now;
    }

    let mut names = taken();
    let mut states: BTreeMap<NodeId, String> = BTreeMap::new();
    for it in &kept {
        states.insert(it.before, names.fresh(&design.net(it.net).name));
    }
    let starts: Vec<NodeId> = kept.iter().map(|it| it.first).collect();
    let mut printer = Printer::new(design, &unrolled, tables, BTreeMap::new());
    let mut body = vec![format!("    {}", comment("the clock that takes start"))];
    let lines = printer.lines(&mut names, &starts);
    body.extend(lines.iter().flat_map(|line| statement(4, &line.text)));
    for it in &kept {
        let kind = pattern_type(graph.width(it.before));
        let text = format!("{kind} {} = {};", states[&it.before], printer.text(it.first));
        body.extend(statement(4, &text));
    }
    body.extend(["    size_t count = 0;", "    for (;;) {"].map(str::to_owned));
    let mut printer = Printer::new(design, &unrolled, tables, states.clone());
    let lines = printer.lines(&mut names, &wanted);
    body.extend(lines.iter().flat_map(|line| statement(8, &line.text)));
    body.push(format!("        if ({} != 0u) {{", printer.text(valid)));
    body.push("            if (count < capacity) {".to_owned());
    for (port, value) in &results {
        let text = assigned(design, port, &printer.text(*value));
        body.extend(statement(16, &format!("points[count].{text}")));
    }
    body.extend(["            }", "            ++count;", "        }"].map(str::to_owned));
    body.push(format!("        if ({} != 0u) {{", printer.text(done)));
    body.extend(["            return count;", "        }"].map(str::to_owned));
    body.extend(clocked(graph, &printer, &kept, &states, &mut names));
    body.push("    }".to_owned());
    let mut read = roms(graph, &wanted);
    read.extend(roms(graph, &starts));
    Ok((body, read))
}

/// Returns the C statements of a rising edge: the variables `states` of the registers and memories in `kept` take their new
/// values.
fn clocked(
    graph: &Graph,
    printer: &Printer,
    kept: &[StateValues],
    states: &BTreeMap<NodeId, String>,
    names: &mut Names,
) -> Vec<String> {
    let mut lines = vec![format!("        {}", comment("the rising edge"))];
    let mut moves = Vec::new();
    for it in kept {
        let name = &states[&it.before];
        let mut text = printer.text(it.after);
        if text == *name {
            continue;
        }
        // A value that depends on the state must be computed before any part of the state changes.
        if !printer.is_settled(it.after) {
            let next = names.fresh(&format!("next_{name}"));
            let kind = pattern_type(graph.width(it.before));
            lines.extend(statement(8, &format!("const {kind} {next} = {text};")));
            text = next;
        }
        moves.push(format!("        {name} = {text};"));
    }
    lines.extend(moves);
    lines
}

/// Returns the C statement that converts `pattern`, the bit pattern of a result, to a number, and assigns it to the result's
/// member. For example, `red_out = pattern;`.
fn assigned(design: &Design, port: &Port, pattern: &str) -> String {
    let net = design.net(port.net);
    let kind = CField::new(design, port).kind;
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

/// Returns the ROMs that the values `wanted` read. A ROM that is read several times occurs several times.
fn roms(graph: &Graph, wanted: &[NodeId]) -> Vec<RomId> {
    let mut roms = Vec::new();
    for id in graph.cone(wanted.iter().copied()) {
        if let Cell::Read { rom, .. } = graph.node(id).cell {
            roms.push(rom);
        }
    }
    roms
}

/// Returns the name of each ROM's C array, in the order of the design's ROMs.
pub fn table_names(design: &Design) -> Vec<String> {
    let mut names = Names::new(design.nets.iter().map(|net| net.name.as_str()));
    design.roms.iter().map(|rom| names.fresh(&format!("{}_table", rom.name))).collect()
}

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

/// Returns a C expression that keeps its value inside any other expression: a negative integer is in parentheses.
pub(super) fn c_integer(value: i32) -> String {
    if value < 0 { format!("({value})") } else { value.to_string() }
}

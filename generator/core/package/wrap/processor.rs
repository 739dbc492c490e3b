//! Generates `<name>_cfu.v` or `<name>_pcpi.v`, by which a processor computes a result with one instruction, and the formal
//! properties of this module.

use anyhow::Result;

use super::fields::sink;
use super::started::started;
use super::{CoreStub, WrapperProof, add_proof, connected, core_wire, seen_inside, table_ports};
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::instructions::{InstructionOperand, Instructions, OPCODE_BITS};
use crate::package::output_files::OutputFiles;
use crate::package::processor::ProcessorInterface;
use glint_rtl::netlist::{OPCODE, Role};
use glint_rtl::verilog::text::{comment, literal, statement};

/// The variables of a module's templates.
pub struct ProcessorModule {
    pub name: String,
    pub regenerate: String,
    /// The module of the core: the core itself, or `<name>_single` around a pipeline.
    pub core: String,
    /// The lines of a comment that lists the instructions.
    pub table: Vec<String>,
    pub result_wires: Vec<String>,
    pub connections: Vec<String>,
    /// The declarations of the ports that write the core's table.
    pub table_ports: Vec<String>,
    /// The declaration of a wire that says whether there is an instruction with the function id `taken`.
    pub known: Vec<String>,
    pub answers: Vec<ResultAnswer>,
    pub unused: Vec<String>,
}

/// A result as the answer to an instruction.
pub struct ResultAnswer {
    /// The upper bits of the function id, as a literal.
    pub number: String,
    /// The Verilog expression of 32 bits.
    pub word: String,
}

/// The variables of a proof's templates.
pub struct ProcessorProof {
    pub name: String,
    /// The module in place of the core.
    pub stub: CoreStub,
    /// The declaration of a wire that says whether there is an instruction with the function id `asked`.
    pub known: Vec<String>,
    pub answers: Vec<ResultAnswer>,
    /// The operands of the core, each with the bits of the instruction that it must get.
    pub operands: Vec<(String, String)>,
    pub inside: Vec<String>,
}

/// Adds the module for the job's processor, and with test vectors its proof.
///
/// # Errors
/// Fails if a template fails.
pub fn modules(
    job: &EmitJob,
    processor: &ProcessorInterface,
    instructions: &Instructions,
    files: &mut OutputFiles,
) -> Result<()> {
    let module = format!("{}_{}", job.name(), processor.key);
    let text = (processor.module)(&processor_module(job, instructions))?;
    files.add_verilog(FileKind::ProcessorWrapper, vec![module.clone()], text);
    let proof = (processor.proof)(&processor_proof(job, instructions))?;
    let core = started(job.design, None).name.clone();
    add_proof(job, &module, WrapperProof::new(proof, vec![core]), files)
}

fn processor_module(job: &EmitJob, instructions: &Instructions) -> ProcessorModule {
    let started = started(job.design, None);
    let design = started.as_ref();
    let opcode = instructions.opcode.as_ref();
    let is_written = |strobe: &str| {
        let is_opcode = opcode.is_some_and(|(opcode, _)| opcode == strobe);
        is_opcode || instructions.operands.iter().any(|operand| operand.strobe == strobe)
    };
    let connections = connected(design, "clk", |role, name| match role {
        Role::Reset => Some("rst_n".to_owned()),
        Role::Start | Role::Valid | Role::Busy => Some(name.to_owned()),
        Role::Strobe if is_written(name) => Some("start".to_owned()),
        Role::Operand { .. } => Some(source(instructions, name, "asked")),
        _ => None,
    });
    let mut unused = vec!["word_0".to_owned(), "word_1".to_owned()];
    let mut result_wires = Vec::new();
    for port in design.outputs() {
        if matches!(port.role, Role::Valid | Role::Busy | Role::TableReady) {
            continue;
        }
        result_wires.push(core_wire(design, port));
        if port.role != Role::Result {
            unused.push(format!("core_{}", design.net(port.net).name));
        }
    }
    ProcessorModule {
        name: job.name().to_owned(),
        regenerate: job.regenerate().to_owned(),
        core: design.name.clone(),
        table: table(instructions),
        result_wires,
        connections,
        table_ports: table_ports::declared(design),
        known: known(instructions),
        answers: answers(instructions, "core_"),
        unused: sink(&unused),
    }
}

fn processor_proof(job: &EmitJob, instructions: &Instructions) -> ProcessorProof {
    let started = started(job.design, None);
    let design = started.as_ref();
    let mut operands = Vec::new();
    let mut inside: Vec<(String, u32)> =
        ["computing", "start", "core.run", "core.ends", "core.rst_n"]
            .map(|net| (net.to_owned(), 1))
            .to_vec();
    for port in &design.ports {
        let net = design.net(port.net);
        let path = format!("core.{}", net.name);
        match port.role {
            Role::Operand { .. } => {
                operands.push((net.name.clone(), source(instructions, &net.name, "offered")));
                inside.push((path, net.format.width()));
            }
            Role::Result => inside.push((path, net.format.width())),
            _ => {}
        }
    }
    ProcessorProof {
        name: job.name().to_owned(),
        stub: CoreStub::new(design),
        known: known_one_by_one(instructions),
        answers: answers(instructions, "dut.core."),
        operands,
        inside: inside.into_iter().map(seen_inside).collect(),
    }
}

/// Returns the bits that the operand `name` of the core gets. An opcode is a part of the function id in the net `id`, and another
/// operand a part of a source register.
fn source(instructions: &Instructions, name: &str, id: &str) -> String {
    if let (OPCODE, Some((_, bits))) = (name, &instructions.opcode) {
        return format!("{id}[{}:0]", bits - 1);
    }
    let operand = instructions.operands.iter().find(|operand| operand.port == name);
    let operand = operand.expect("every operand has its bits");
    format!("word_{}{}", operand.word, bits_from(operand.low, operand.format.width()))
}

/// Returns the part-select of `width` bits from bit `low` on. All 32 bits of a word give an empty text.
fn bits_from(low: u32, width: u32) -> String {
    match width {
        32 => String::new(),
        1 => format!("[{low}]"),
        _ => format!("[{}:{low}]", low + width - 1),
    }
}

/// Returns the declaration of the wire `known`. The instructions that return the first result usually have all opcodes up to the last,
/// so that one comparison is enough for them.
fn known(instructions: &Instructions) -> Vec<String> {
    let mut firsts = 0;
    while instructions.list.iter().any(|it| it.id == firsts && it.id < 1 << OPCODE_BITS) {
        firsts += 1;
    }
    let mut terms = Vec::new();
    if firsts == 1 << OPCODE_BITS {
        terms.push("(taken[9:4] == 6'd0)".to_owned());
    } else if firsts > 1 {
        terms.push(format!("(taken[9:4] == 6'd0) & (taken[3:0] < 4'd{firsts})"));
    }
    let has_comparison = !terms.is_empty();
    for it in &instructions.list {
        if !has_comparison || it.id >= firsts {
            terms.push(format!("(taken == {})", literal(it.id.into(), 10)));
        }
    }
    statement(4, &format!("wire known = {};", terms.join(" | ")))
}

/// Returns the declaration of a wire `known` for the proof, which compares `asked` with each function id.
fn known_one_by_one(instructions: &Instructions) -> Vec<String> {
    let ids = instructions.list.iter();
    let terms: Vec<String> =
        ids.map(|it| format!("asked == {}", literal(it.id.into(), 10))).collect();
    statement(4, &format!("wire known = {};", terms.join(" || ")))
}

/// Returns the function ids with commas between them, at most eight on a line.
pub(super) fn ids(instructions: &Instructions) -> Vec<String> {
    let mut lines = Vec::new();
    for ids in instructions.list.chunks(8) {
        let ids: Vec<String> = ids.iter().map(|it| literal(it.id.into(), 10)).collect();
        lines.push(format!("{},", ids.join(", ")));
    }
    if let Some(last) = lines.last_mut() {
        last.pop();
    }
    lines
}

/// Returns each result as a word of 32 bits, extended by its sign or zeros. `prefix` is put before the name of its port.
fn answers(instructions: &Instructions, prefix: &str) -> Vec<ResultAnswer> {
    let mut answers = Vec::new();
    for (number, result) in (0..).zip(&instructions.results) {
        let net = format!("{prefix}{}", result.port);
        let width = result.format.width();
        let word = match (32 - width, result.format.signed) {
            (0, _) => net,
            (more, true) if width == 1 => format!("{{{{{more}{{{net}}}}}, {net}}}"),
            (more, true) => format!("{{{{{more}{{{net}[{}]}}}}, {net}}}", width - 1),
            (more, false) => format!("{{{}, {net}}}", literal(0, more)),
        };
        answers.push(ResultAnswer { number: literal(number, 10 - OPCODE_BITS), word });
    }
    answers
}

/// Returns the lines of a comment: for each instruction funct7 and funct3, the function, its operands and its result.
fn table(instructions: &Instructions) -> Vec<String> {
    let mut lines = vec!["//  funct7  funct3".to_owned()];
    for it in &instructions.list {
        let operands: Vec<String> =
            it.operands.iter().map(|operand| placement(instructions, operand)).collect();
        let of = if it.function.is_empty() { String::new() } else { format!("{} ", it.function) };
        let text = format!("{of}{}, {} of {}", it.result, it.format, operands.join(", "));
        let head = format!("//  {:>6}  {:>6}  ", it.funct7(), it.funct3());
        for (at, line) in comment(18, &text).into_iter().enumerate() {
            let words = line.trim_start().trim_start_matches("// ");
            let margin = format!("//{}", " ".repeat(head.len() - 2));
            lines.push(format!("{}{words}", if at == 0 { &head } else { &margin }));
        }
    }
    lines
}

/// Returns the operand's name, its bits in the source registers and its format, for example `x = word_0[15:0] in s0.15`.
fn placement(instructions: &Instructions, operand: &InstructionOperand) -> String {
    let bits = &instructions.operands[operand.place];
    let place = bits_from(bits.low, operand.format.width());
    format!("{} = word_{}{place} in {}", operand.name, bits.word, operand.format)
}

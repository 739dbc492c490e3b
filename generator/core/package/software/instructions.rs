//! Generates `<name>_instructions.h`, a function in C for each instruction that computes with the core.

use anyhow::Result;
use glint_base::fill;

use super::print::taken;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::instructions::{CoreInstruction, InstructionOperand, Instructions};
use crate::package::output_files::OutputFiles;
use glint_base::fixed::Format;
use glint_rtl::verilog::text::{ascii, constant_name};

struct InstructionFunction {
    name: String,
    /// The lines of the comment above the function.
    doc: Vec<String>,
    kind: &'static str,
    parameters: String,
    funct3: u32,
    funct7: u32,
    /// The names and the C expressions of the source registers.
    words: [(String, String); 2],
    /// The name of the variable with the answer.
    answer: String,
    /// The C expression of the result in terms of the answer.
    result: String,
}

/// Adds the header. The header needs a compiler with the inline assembly of GCC.
///
/// # Errors
/// Fails if the template fails.
pub fn file(job: &EmitJob, instructions: &Instructions, files: &mut OutputFiles) -> Result<()> {
    let name = job.name();
    let mut functions = Vec::new();
    for instruction in &instructions.list {
        functions.push(function(name, instructions, instruction));
    }
    let prefix = constant_name(name);
    let header = fill!("instructions.h" {
        name: &'a str,
        title: String = plain(&job.design.about.title),
        regenerate: &'a str = job.regenerate(),
        prefix: &'a str = &prefix,
        functions: &'a [InstructionFunction] = &functions,
    })?;
    files.add(FileKind::Software, format!("{name}_instructions.h"), header);
    Ok(())
}

/// Returns `text` for a comment in C.
fn plain(text: &str) -> String {
    ascii(text).replace("*/", "* /")
}

fn function(core: &str, all: &Instructions, instruction: &CoreInstruction) -> InstructionFunction {
    let mut names = taken();
    let mut operands = Vec::new();
    let mut parameters = Vec::new();
    let mut doc = Vec::new();
    if !instruction.doc.is_empty() {
        doc.push(plain(&instruction.doc));
    }
    for operand in &instruction.operands {
        let name = names.fresh(&operand.name);
        parameters.push(format!("{} {name}", kind(operand.format)));
        doc.push(plain(&format!("{name}: {}", operand.format)));
        operands.push((name, operand));
    }
    let words = [0, 1]
        .map(|word| (names.fresh(&format!("word_{word}")), source_word(all, &operands, word)));
    let answer = names.fresh("answer");
    doc.push(plain(&format!("returns {}: {}", instruction.result, instruction.format)));
    if parameters.is_empty() {
        parameters.push("void".to_owned());
    }
    InstructionFunction {
        name: format!("{core}_{}", instruction.name()),
        doc,
        kind: kind(instruction.format),
        parameters: parameters.join(", "),
        funct3: instruction.funct3(),
        funct7: instruction.funct7(),
        words,
        result: result(instruction, &answer),
        answer,
    }
}

fn kind(format: Format) -> &'static str {
    if format.signed { "int32_t" } else { "uint32_t" }
}

/// Returns the C expression of source register `word`. Only an operand below another operand is cut to its bits, because the
/// core ignores the bits above the operands.
fn source_word(
    all: &Instructions,
    operands: &[(String, &InstructionOperand)],
    word: u32,
) -> String {
    let mut placed = Vec::new();
    for (name, operand) in operands {
        let bits = &all.operands[operand.place];
        if bits.word == word {
            placed.push((name, operand, bits.low));
        }
    }
    let mut parts = Vec::new();
    for (number, (name, operand, low)) in placed.iter().enumerate() {
        let mut text = match operand.format.signed {
            true => format!("(uint32_t){name}"),
            false => (*name).clone(),
        };
        if number + 1 < placed.len() {
            text = format!("({text} & {:#x}u)", operand.format.bits(-1));
        }
        parts.push(if *low == 0 { text } else { format!("({text} << {low})") });
    }
    if parts.is_empty() { "0u".to_owned() } else { parts.join(" | ") }
}

/// Returns the result in terms of the variable `answer`.
fn result(instruction: &CoreInstruction, answer: &str) -> String {
    let width = instruction.format.width();
    match (instruction.format.signed, instruction.is_extended || width == 32) {
        (false, _) => answer.to_owned(),
        (true, true) => format!("(int32_t){answer}"),
        (true, false) => format!("(int32_t)({answer} << {0}) >> {0}", 32 - width),
    }
}

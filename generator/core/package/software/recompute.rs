//! Writes a C program that computes the results of a core with its C model for every combination of operands, and compares them
//! with the formulas.
//!
//! The program evaluates the formulas with the multiple-precision library MPFR, so that its verdict does not depend on Glint's
//! own arithmetic. A formula of one operand is evaluated with MPFR at every operand. For the device `expression`, the program
//! first evaluates in double precision, and uses MPFR only if rounding errors leave the verdict open. [`check`] refuses all
//! other contracts, results that wrap, and more than 2^32 combinations.

use std::sync::Arc;

use anyhow::Result;

use super::model::{CField, table_names};
use crate::observation::ContractFacts;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use glint_base::config_error::ConfigError;
use glint_base::fill;
use glint_base::fixed::exp2;
use glint_base::interval;
use glint_formula::{CArithmetic, Comparison, Expression, parse};
use glint_rtl::netlist::{Design, RomId};
use glint_rtl::verilog::naming::Naming;
use glint_rtl::verilog::text::{ascii, statement};

/// The number of intervals with MPFR limits that the program reserves for each part of a formula, such as a sum.
const VALUES: usize = 8;

/// The largest number of combinations of operands that a program computes.
pub const MOST_COMBINATIONS: u128 = 1 << 32;

/// The contract of a core, as far as a program can recompute it.
enum RecomputedContract<'f> {
    /// A formula of one operand, which is promised for the whole domain.
    Function(RecomputedFormula<'f>),
    /// Formulas of several operands, each with the comparison under which its error is promised.
    Expression(&'f [Option<Comparison>]),
}

/// The parts of a contract that the program needs: one operand with its domain, one result, and its formula.
struct RecomputedFormula<'f> {
    operand: &'f str,
    domain: (i64, i64),
    result: &'f str,
    formula: &'f str,
}

impl<'f> RecomputedContract<'f> {
    fn new(name: &str, facts: &'f ContractFacts) -> Result<Self, ConfigError> {
        let check_wraps = || match facts.wraps {
            true => Err(recomputation_error(
                name,
                "a result wraps around, and the program cannot compute such results",
            )),
            false => Ok(()),
        };
        if let Some(conditions) = &facts.conditions {
            let combinations =
                interval::combinations(facts.domain.iter().map(|(_, limits)| *limits));
            if combinations > MOST_COMBINATIONS {
                let why = format!(
                    "the operands have {combinations} combinations, more than the limit of 2^32, which a \
                     program computes in minutes"
                );
                return Err(recomputation_error(name, &why));
            }
            check_wraps()?;
            return Ok(Self::Expression(conditions));
        }
        match (&facts.domain[..], &facts.outputs[..], &facts.f[..]) {
            ([(operand, domain)], [(result, None)], [formula]) => {
                check_wraps()?;
                let domain = *domain;
                Ok(Self::Function(RecomputedFormula { operand, domain, result, formula }))
            }
            _ => Err(recomputation_error(
                name,
                "the contract is not a list of formulas with bounds, as for the devices `function` and \
                 `expression`",
            )),
        }
    }
}

/// `why` says why no program recomputes the core `name`.
fn recomputation_error(name: &str, why: &str) -> ConfigError {
    let message = format!("no program can recompute `{name}`: {why}");
    ConfigError::new("package.recomputation", message, "remove package.recomputation")
}

/// Fails if a result wraps, or if the operands of an expression have more than 2^32 combinations. Fails if the contract is
/// neither one formula of one operand nor the formulas of an expression.
pub fn check(name: &str, facts: &ContractFacts) -> Result<(), ConfigError> {
    RecomputedContract::new(name, facts).map(drop)
}

/// Adds the program. `read` are the ROMs that the C model reads.
///
/// # Errors
/// Fails if [`check`] refuses the contract, or if the core has no contract.
pub fn file(job: &EmitJob, read: &[RomId], files: &mut OutputFiles) -> Result<()> {
    let (name, inputs) = (job.name(), job.inputs);
    let design = inputs.sequential.as_ref().unwrap_or(job.design);
    let facts = inputs
        .accuracy
        .as_ref()
        .ok_or_else(|| recomputation_error(name, "the core has no contract"))?;
    let memories = CheckedMemories::new(design, read, files);
    let program = match RecomputedContract::new(name, facts)? {
        RecomputedContract::Function(formula) => {
            function_program(job, design, facts.bounds[0], formula, memories)?
        }
        RecomputedContract::Expression(conditions) => {
            expression_program(job, design, facts, conditions, memories)?
        }
    };
    files.add(FileKind::Recomputation, format!("{name}_recompute.c"), program);
    Ok(())
}

/// The memory files that the program compares with the tables of the C model.
struct CheckedMemories {
    /// The memory file, the name of the table, and the number of words.
    files: Vec<(String, String, usize)>,
    /// The program prints this sentence if there are no memory files to compare.
    why_none: &'static str,
}

impl CheckedMemories {
    fn new(design: &Design, read: &[RomId], written: &OutputFiles) -> Self {
        let (naming, tables) = (Naming::new(design), table_names(design));
        let paths = written.local_paths(&[FileKind::Memory]);
        let mut files = Vec::new();
        for id in read {
            let file = naming.files[id.index()].clone();
            if paths.contains(&file) {
                files.push((file, tables[id.index()].clone(), design.rom(*id).words.len()));
            }
        }
        let why_none = match read.is_empty() {
            true => "the core reads no table.",
            false => {
                "the words of the tables are in the Verilog itself, which this program does not read."
            }
        };
        Self { files, why_none }
    }
}

fn field(name: &str, design: &Design, port: &str) -> Result<CField, ConfigError> {
    let mut ports = design.ports.iter();
    let found = ports.find(|found| design.net(found.net).name == port);
    found.map(|found| CField::new(design, found)).ok_or_else(|| {
        recomputation_error(
            name,
            "the contract has an operand or a result that is no port of the core",
        )
    })
}

/// Returns the number of nodes of a formula's tree: `x * x + 1` has five.
fn part_count(formula: &Expression) -> usize {
    formula.size() as usize
}

/// Removes `*/`, which would end a C comment.
fn in_comment(text: &str) -> String {
    ascii(text).replace("*/", "* /")
}

fn function_program(
    job: &EmitJob,
    design: &Design,
    bound: f64,
    recomputed: RecomputedFormula<'_>,
    memories: CheckedMemories,
) -> Result<String> {
    let RecomputedFormula { operand, domain: (first, last), result, formula: text } = recomputed;
    let name = job.name();
    let formula = parse(text)?;
    let (operand, result) = (field(name, design, operand)?, field(name, design, result)?);
    fill!("recompute.c" {
        name: &'a str,
        title: String = in_comment(&design.about.title),
        regenerate: &'a str = job.regenerate(),
        text: &'a str,
        formula: Vec<String> = statement(4, &format!("return {};", formula.c(CArithmetic::Limits))),
        values: usize = VALUES * (part_count(&formula) + 1),
        memories: Vec<(String, String, usize)> = memories.files,
        without_memories: &'a str = memories.why_none,
        operand_exponent: i32 = -operand.format.frac,
        operand: String = operand.name,
        result_exponent: i32 = -result.format.frac,
        result: String = result.name,
        first: i64,
        last: i64,
        bound: String = format!("{bound:?}"),
    })
}

struct ProgramOperand {
    field: CField,
    first: i64,
    last: i64,
    /// The weight of the last bit is 2^`exponent`.
    exponent: i32,
    /// The same weight as a C double.
    unit: String,
}

struct ProgramResult {
    field: CField,
    exponent: i32,
    unit: String,
    /// The proved bound in units of the last place, as a C double.
    bound: String,
    formula: ProgramFormula,
    /// The comparison under which the error is promised.
    condition: Option<ProgramFormula>,
}

/// The bodies of the C functions that evaluate a formula or a comparison.
struct ProgramFormula {
    /// The formula for a comment.
    text: String,
    /// The lines of the function that uses MPFR.
    limits: Vec<String>,
    /// The lines of the function that uses doubles.
    near: Vec<String>,
}

impl ProgramFormula {
    fn new(text: &str, limits: &str, near: &str) -> Self {
        Self { text: in_comment(text), limits: c_return(limits), near: c_return(near) }
    }
}

fn c_return(value: &str) -> Vec<String> {
    let mut lines = Vec::new();
    if !value.contains("x[") {
        // A compiler would warn of the unused parameter.
        lines.push("    (void)x;".to_owned());
    }
    lines.extend(statement(4, &format!("return {value};")));
    lines
}

/// Renames the operands to `x[0]`, `x[1]` and so on, in the order of the contract's domain.
fn with_numbered_operands(formula: &Expression, facts: &ContractFacts) -> Expression {
    formula.with_operands(&|name| {
        let number = facts.domain.iter().position(|(operand, _)| operand == name)?;
        Some(Arc::new(Expression::operand(&format!("x[{number}]"))))
    })
}

fn expression_program(
    job: &EmitJob,
    design: &Design,
    facts: &ContractFacts,
    conditions: &[Option<Comparison>],
    memories: CheckedMemories,
) -> Result<String> {
    let name = job.name();
    let mut operands = Vec::new();
    let mut operand_list = Vec::new();
    for (number, (operand, (first, last))) in facts.domain.iter().enumerate() {
        let field = field(name, design, operand)?;
        let exponent = -field.format.frac;
        let unit = format!("{:?}", exp2(exponent));
        operands.push(ProgramOperand { field, first: *first, last: *last, exponent, unit });
        operand_list.push(format!("x[{number}] for {operand}"));
    }
    let mut results = Vec::new();
    let mut most_parts = 0;
    for (number, (output, _)) in facts.outputs.iter().enumerate() {
        let field = field(name, design, output)?;
        let exponent = -field.format.frac;
        let text = &facts.f[number];
        let formula = with_numbered_operands(&parse(text)?, facts);
        let mut parts = part_count(&formula);
        let mut condition = None;
        if let Some(stated) = &conditions[number] {
            let [left, right] = [&stated.left, &stated.right]
                .map(|side| Arc::new(with_numbered_operands(side, facts)));
            parts += part_count(&left) + part_count(&right) + 1;
            let comparison = Comparison { left, right, or_equal: stated.or_equal };
            let [limits, near] =
                [CArithmetic::Limits, CArithmetic::Near].map(|it| comparison.c(it));
            condition = Some(ProgramFormula::new(&stated.python(), &limits, &near));
        }
        most_parts = most_parts.max(parts);
        let [limits, near] = [CArithmetic::Limits, CArithmetic::Near].map(|it| formula.c(it));
        results.push(ProgramResult {
            field,
            exponent,
            unit: format!("{:?}", exp2(exponent)),
            bound: format!("{:?}", facts.bounds[number]),
            formula: ProgramFormula::new(&format!("{output} = {text}"), &limits, &near),
            condition,
        });
    }
    let memory_argument = match memories.files.is_empty() {
        true => String::new(),
        false => format!(" ../../rtl_out/{name}"),
    };
    fill!("recompute_expression.c" {
        name: &'a str,
        title: String = in_comment(&design.about.title),
        regenerate: &'a str = job.regenerate(),
        memory_argument: String,
        memories: Vec<(String, String, usize)> = memories.files,
        without_memories: &'a str = memories.why_none,
        values: usize = VALUES * (most_parts + 1) + operands.len(),
        operands: Vec<ProgramOperand>,
        operand_list: String = operand_list.join(", "),
        results: Vec<ProgramResult>,
    })
}

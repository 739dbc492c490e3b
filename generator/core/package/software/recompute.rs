//! Writes a C program that computes the result for every value of a core's only operand, and compares it with the formula.
//!
//! The program evaluates the formula with the multiple-precision library MPFR. It is therefore evidence for the error bound that
//! does not depend on Glint's own arithmetic.

use anyhow::Result;

use super::model::{CField, table_names};
use crate::observation::ContractFacts;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use glint_base::fill;
use glint_base::key_error::KeyError;
use glint_formula::parse;
use glint_rtl::netlist::RomId;
use glint_rtl::verilog::naming::Naming;
use glint_rtl::verilog::text::{ascii, statement};

/// The most values that the program may make for a part of a formula.
const VALUES: usize = 8;

/// The parts of a contract that the program needs: one operand with its domain, one result, and its formula.
struct RecomputedFormula<'f> {
    operand: &'f str,
    domain: (i64, i64),
    result: &'f str,
    formula: &'f str,
}

impl<'f> RecomputedFormula<'f> {
    fn new(name: &str, facts: &'f ContractFacts) -> Result<Self, KeyError> {
        match (&facts.domain[..], &facts.outputs[..], &facts.f[..]) {
            ([(operand, domain)], [(result, None)], [formula]) => {
                Ok(Self { operand, domain: *domain, result, formula })
            }
            _ => Err(recomputation_error(
                name,
                "its contract is no formula of one operand, with a bound",
            )),
        }
    }
}

/// Returns the error of the key that asks for the program.
fn recomputation_error(name: &str, why: &str) -> KeyError {
    let message = format!("nothing recomputes `{name}`: {why}");
    KeyError::new("package.recomputation", message, "remove it")
}

/// Checks that the program can be written for a core.
///
/// # Errors
/// Fails if the core has several operands or results, or if its contract states no formula.
pub fn check(name: &str, facts: &ContractFacts) -> Result<(), KeyError> {
    RecomputedFormula::new(name, facts).map(drop)
}

/// Adds the C program that recomputes all results to `files`. `read` are the ROMs that the C model reads.
///
/// # Errors
/// Fails as [`check`] does.
pub fn file(job: &EmitJob, read: &[RomId], files: &mut OutputFiles) -> Result<()> {
    let (name, inputs) = (job.name(), job.inputs);
    let design = inputs.sequential.as_ref().unwrap_or(job.design);
    let facts =
        inputs.accuracy.as_ref().ok_or_else(|| recomputation_error(name, "it has no contract"))?;
    let RecomputedFormula { operand, domain: (first, last), result, formula: text } =
        RecomputedFormula::new(name, facts)?;
    let formula = parse(text)?;
    let mut parts = 0;
    formula.walk(&mut |_| parts += 1);
    let field = |name: &str| {
        let mut ports = design.ports.iter();
        let port = ports.find(|port| design.net(port.net).name == name);
        port.map(|port| CField::new(design, port))
            .ok_or_else(|| recomputation_error(name, "its contract names no port"))
    };
    let (operand, result) = (field(operand)?, field(result)?);
    let (naming, tables) = (Naming::new(design), table_names(design));
    let written = files.local_paths(&[FileKind::Memory]);
    let mut memories = Vec::new();
    for id in read {
        let (file, table) = (naming.files[id.index()].clone(), tables[id.index()].clone());
        if written.contains(&file) {
            memories.push((file, table, design.rom(*id).words.len()));
        }
    }
    let program = fill!("recompute.c" {
        name: &'a str,
        title: String = ascii(&design.about.title).replace("*/", "* /"),
        regenerate: &'a str = job.regenerate(),
        text: &'a str,
        formula: Vec<String> = statement(4, &format!("return {};", formula.c())),
        values: usize = VALUES * (parts + 1),
        memories: Vec<(String, String, usize)>,
        without_memories: &'a str = match read.is_empty() {
            true => "the core reads no table.",
            false => "the words of the tables are in the Verilog itself, which this program does not read.",
        },
        operand_exponent: i32 = -operand.format.frac,
        operand: String = operand.name,
        result_exponent: i32 = -result.format.frac,
        result: String = result.name,
        first: i64,
        last: i64,
        bound: String = format!("{:?}", facts.bound),
    })?;
    files.add(FileKind::Recomputation, format!("{name}_recompute.c"), program);
    Ok(())
}

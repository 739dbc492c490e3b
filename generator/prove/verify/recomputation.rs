//! Checks the error bound with a generated C program. The program computes the result of the core's C model for every combination
//! of operands, and compares the result with the exact value of the formula. It evaluates the formula with MPFR and the C
//! library, so the verdict does not depend on Glint's own arithmetic.
//!
//! For the device `function`, the program uses MPFR at every operand. For `expression`, the program evaluates in doubles first.
//! It uses MPFR only if the rounding errors of the doubles leave the verdict open.
//!
//! Without `--full`, `glint verify` skips this check for an `expression` with more than 2^24 combinations of operands, and for a
//! `function` with more than 2^20 operands.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};

use super::outside::directory_of;
use super::{Check, CheckSubject, CheckVerdict, Finding};
use glint_base::config_error::ConfigError;
use glint_base::input;
use glint_base::interval;
use glint_base::program::Program;
use glint_base::text::grouped;
use glint_core::package::{FileKind, OutputFile};
use glint_golden::Operand;
use glint_tools::Tool;

/// The largest number of operands of a `function` without `--full`. MPFR computes the result of each.
const MOST_OPERANDS: u128 = 1 << 20;

/// The largest number of combinations of an `expression` without `--full`. Doubles decide most of them.
const MOST_COMBINATIONS: u128 = 1 << 24;

/// The exit code of the program if it finds no error, but cannot decide about some combinations.
const SOME_UNDECIDED: i32 = 3;

pub const RECOMPUTATION: Check = Check {
    id: "recomputation",
    title: "Every combination of operands recomputed with MPFR",
    question: "Does a program outside Glint find no error above the bound, with the formula in MPFR and the \
               emitted memories?",
    reads: "the memory files, the model in C, and the program that `package.recomputation` writes",
    tools: &["cc"],
    steps: |_| 1,
    run: |subject, tools, _| {
        let files = match subject.core.recomputation() {
            Ok(files) => files,
            Err(error) => {
                let ConfigError { message, .. } = error.downcast()?;
                let why = format!("The program cannot be written: {message}.");
                return Ok(Finding::without(CheckVerdict::NotApplicable, why));
            }
        };
        if let Some(left_out) = left_out(subject) {
            return Ok(left_out);
        }
        let dir = directory_of(&files)?;
        let programs = files.of(&[FileKind::Recomputation]);
        let program = programs.first().context("no program that recomputes every operand")?;
        let compiler = ProgramCompiler { tool: &tools[0], dir: dir.path(), subject };
        if !compiler.has_mpfr()? {
            let why = "MPFR is not installed for the C compiler: install it, for example the package \
                       libmpfr-dev";
            return Ok(Finding::without(CheckVerdict::NotRun, why));
        }
        compiler.compile_program(&program.path)?;
        run(subject, program, dir.path())
    },
};

/// Returns the finding [`CheckVerdict::LeftOut`] if the operands have too many combinations for a check without `--full`.
fn left_out(subject: &CheckSubject<'_>) -> Option<Finding> {
    let contract = &subject.core.contract;
    let most = if contract.conditions().is_some() { MOST_COMBINATIONS } else { MOST_OPERANDS };
    let count = interval::combinations(contract.operands().iter().map(|operand| operand.domain));
    if subject.effort.full || count <= most {
        return None;
    }
    let why = format!(
        "{} combinations of operands take minutes or more: `--full` computes them within the limit of `--time-limit`.",
        grouped(count as u64)
    );
    let complete_with = format!("{Program} verify {} --full", input::label(subject.path));
    Some(Finding {
        complete_with: Some(complete_with),
        ..Finding::without(CheckVerdict::LeftOut, why)
    })
}

/// The C compiler, in a directory with the program and the files that it includes.
struct ProgramCompiler<'a> {
    tool: &'a Tool,
    dir: &'a Path,
    subject: &'a CheckSubject<'a>,
}

impl ProgramCompiler<'_> {
    /// Returns whether the compiler accepts the file `source`, and the compiler's output.
    fn compile(&self, source: &str) -> Result<(bool, String)> {
        let arguments = ["-std=c99", "-O2", "-o", "recompute", source, "-lmpfr", "-lgmp", "-lm"];
        let run = self.tool.run(arguments, self.dir, self.subject.effort.time_limit)?;
        Ok((run.status.success(), run.output))
    }

    /// Returns whether MPFR is installed: the compiler can compile a program that includes it.
    fn has_mpfr(&self) -> Result<bool> {
        let probe = "#include <mpfr.h>\nint main(void) { return 0; }\n";
        fs::write(self.dir.join("probe.c"), probe)
            .context("cannot write a program for the C compiler")?;
        Ok(self.compile("probe.c")?.0)
    }

    fn compile_program(&self, source: &str) -> Result<()> {
        let (is_accepted, output) = self.compile(source)?;
        ensure!(is_accepted, "`{source}`: {}", output.trim());
        Ok(())
    }
}

fn run(subject: &CheckSubject<'_>, program: &OutputFile, dir: &Path) -> Result<Finding> {
    let recompute = Tool::find_in("recompute", dir.as_os_str())?;
    // A program that has no memory to check takes no argument.
    let mut arguments = Vec::new();
    if program.contents.contains("check_memories(argv") {
        let name = &subject.core.config().name;
        arguments.push(format!("{}/{name}", FileKind::Memory.folder()));
    }
    let run = recompute.run(arguments, dir, subject.effort.time_limit)?;
    let lines: Vec<&str> = run.output.lines().filter(|line| !is_about_memories(line)).collect();
    let said = lines.join("; ");
    if run.status.code() == Some(SOME_UNDECIDED) {
        let why = format!("{said}: MPFR cannot decide on which side of a jump these results are.");
        return Ok(Finding::without(CheckVerdict::Unconfirmed, &why));
    }
    let failures = if run.status.success() { Vec::new() } else { vec![said.clone()] };
    let domain = domain(subject.core.contract.operands());
    Ok(Finding::new(CheckVerdict::Proved, domain, format!("{said}.")).failures(failures).open(
        "The model in C is made of the netlist, which other checks compare with the Verilog.",
    ))
}

fn is_about_memories(line: &str) -> bool {
    line.starts_with("no memory is checked")
}

/// Returns the domain as text, such as `every operand: x = 0 to 255`.
fn domain(operands: &[Operand]) -> String {
    let mut ranges = Vec::new();
    for operand in operands {
        let (first, last) = operand.domain;
        ranges.push(format!("{} = {first} to {last}", operand.name));
    }
    let what = if operands.len() == 1 { "operand" } else { "combination of operands" };
    format!("every {what}: {}", ranges.join(", "))
}

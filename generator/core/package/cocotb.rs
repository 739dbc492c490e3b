//! Generates the test bench of a core in Python, for cocotb, and the Python driver that the benches of all configurations share.
//!
//! For example, the bench of `rough` is `test_rough.py`.

use anyhow::Result;
use glint_base::fill;

use super::emit_job::EmitJob;
use super::file_kind::FileKind;
use super::output_file::OutputFile;
use super::output_files::OutputFiles;
use super::seal::{Seal, sealed};
use crate::observation::{ContractFacts, Quantity, WorkedExample};

/// The driver's tests for a sequential core. The first test needs the formula as a Python expression.
const SEQUENTIAL: [&str; 5] = [
    "formula_holds_at_random_points",
    "computations_are_exact",
    "held_start_repeats",
    "reset_ends_a_computation",
    "writes_and_starts_while_busy_are_ignored",
];

/// The test that replaces the last test of [`SEQUENTIAL`] if the operands have buffers.
const BUFFERED: &str = "writes_while_busy_are_for_the_next_computation";

/// The driver's tests for a pipeline. The first test needs the formula as a Python expression.
const PIPELINE: [&str; 4] = [
    "random_points_follow_the_formula",
    "points_are_exact",
    "bubbles_and_stalls_change_nothing",
    "reset_drops_every_point",
];

pub fn file(
    job: &EmitJob,
    example: &WorkedExample,
    accuracy: &ContractFacts,
    files: &mut OutputFiles,
) -> Result<()> {
    let (name, design) = (job.name(), job.design);
    let pipeline = design.pipeline.is_some();
    let all = if pipeline { &PIPELINE[..] } else { &SEQUENTIAL[..] };
    let mut tests = all[usize::from(accuracy.f.is_empty())..].to_vec();
    if design.control.overlaps {
        tests.pop();
        tests.push(BUFFERED);
    }
    tests.sort_unstable();
    let text = fill!("test.py" {
        name: &'a str,
        operands: Vec<String> = lines(&example.operands, |name, raw| format!("{name}={raw},")),
        outputs: Vec<String> = lines(&example.outputs, |name, raw| format!("\"{name}\": {raw},")),
        tests: Vec<&'static str>,
        pipeline: bool,
        shown: &'a str = if pipeline { "shown" } else { "shown.results[0]" },
    })?;
    files.add(FileKind::CocotbBench, format!("test_{name}.py"), text);
    Ok(())
}

/// Returns one line for each number, with the value in a Python comment if the value differs from the raw integer.
fn lines(quantities: &[Quantity], code: fn(&str, i128) -> String) -> Vec<String> {
    let mut lines = Vec::new();
    for quantity in quantities {
        let mut line = code(&quantity.name, quantity.raw);
        if quantity.value != quantity.raw as f64 {
            line += &format!("  # {}", quantity.value);
        }
        lines.push(line);
    }
    lines
}

/// Returns the Python driver that the cocotb benches of all configurations share. The driver's last line has a digest of its
/// text.
pub fn driver() -> OutputFile {
    let text = fill!("glint_cocotb.py" {}).expect("a template without fields");
    let kind = FileKind::CocotbDriver;
    let path = format!("{}/glint_cocotb.py", kind.folder());
    OutputFile::new(kind, path, sealed(text, Seal::Hash))
}

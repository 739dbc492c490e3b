//! The bench in Python, for cocotb, and the driver that those of all configurations share.

use anyhow::Result;
use askama::Template;

use super::seal::{Seal, sealed};
use super::{Accuracy, OutputFile, Quantity, WorkedExample};
use crate::hdl::netlist::Design;

#[derive(Template)]
#[template(path = "test.py")]
struct Bench<'a> {
    name: &'a str,
    operands: Vec<String>,
    outputs: Vec<String>,
    has_formula: bool,
}

/// The bench of a design, as name and text.
///
/// # Errors
/// A template that fails.
pub fn bench(
    design: &Design,
    example: &WorkedExample,
    accuracy: &Accuracy,
) -> Result<(String, String)> {
    let bench = Bench {
        name: &design.name,
        operands: lines(&example.operands, |name, raw| format!("{name}={raw},")),
        outputs: lines(&example.outputs, |name, raw| format!("\"{name}\": {raw},")),
        has_formula: !accuracy.f.is_empty(),
    };
    Ok((format!("test_{}.py", design.name), super::render(&bench)?))
}

/// A line a number; where it has a fraction, with what the integer stands for.
fn lines(quantities: &[Quantity], code: fn(&str, i128) -> String) -> Vec<String> {
    let line = |quantity: &Quantity| {
        let code = code(&quantity.name, quantity.raw);
        match quantity.value == quantity.raw as f64 {
            true => code,
            false => format!("{code}  # {}", quantity.value),
        }
    };
    quantities.iter().map(line).collect()
}

/// The driver, with a last line that vouches for those above.
pub fn driver() -> OutputFile {
    let text = include_str!("../../templates/glint_cocotb.py");
    OutputFile {
        path: "testbench/glint_cocotb.py".to_owned(),
        contents: sealed(text.to_owned(), Seal::Python),
    }
}

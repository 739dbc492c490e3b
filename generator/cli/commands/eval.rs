//! `glint eval`: computes one point, or the points of a CSV file: golden registers, outputs and the formula in f64.

mod batch;
mod operands;

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use serde::Serialize;
use serde_json::{Value, json};

use super::{Loaded, load_one};
use crate::failure::Failure;
use crate::{OutputOptions, say, tables, wrong_usage};
use glint_base::fixed::Format;
use glint_core::cosim::Driven;
use glint_core::registry::Registry;
use glint_golden::{self as golden, Contract, Model, Operand};

/// Compute one point: golden registers, outputs and the formula in f64
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint eval my_core.toml cos_gamma=0.99 exponent=20 red=255
  glint eval my_core.toml cos_gamma=#1038090     a raw integer, as the port takes it
  glint eval my_core.toml --batch points.csv     a row of results for each row of operands
  glint setup my_core.toml --batch lines.csv | glint eval my_core.toml --batch -
  glint eval my_core.toml --typical --json       a point at which results show, for scripts")]
pub struct Arguments {
    /// A configuration
    config: PathBuf,
    /// Operands: `cos_gamma=0.99` is a value, `cos_gamma=#1038090` a raw integer. An operand that is not
    /// given is 0, or the value nearest to 0 in its domain
    #[arg(value_name = "OPERAND=VALUE")]
    operands: Vec<String>,
    /// Compute many points: a CSV file with the names of operands in its first row, or - for standard input. The
    /// results are CSV, or with --json a list; of a line, a row for each point. Operands on the command line hold for all
    /// rows
    #[arg(long, value_name = "FILE.csv")]
    batch: Option<PathBuf>,
    /// Give the operands that are not given values at which results show: a colour the largest, an angle at which the
    /// highlight is half as bright
    #[arg(long, conflicts_with = "batch")]
    typical: bool,
}

/// More clocks than any device takes.
const LIMIT: u64 = 1 << 16;

/// Runs `glint eval`: one point, or as many as a CSV file has.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let one = load_one(registry, &registry.schemas(), &arguments.config)?;
    let given = operands::given(one.core.contract.operands(), &arguments.operands)
        .map_err(Failure::WrongUsage)?;
    match &arguments.batch {
        Some(path) if *path == arguments.config => {
            wrong_usage!("configuration and --batch are one file")
        }
        Some(path) => batch::batch(output, &one, &given, path),
        None => point(output, &one, &given, arguments.typical),
    }
}

/// Returns the operands that are outside the domain for which the contract is stated, in words. For example, `exponent
/// = 300 is not in 1 to 255`.
fn outside(operands: &[Operand], raw: &[i64]) -> Vec<String> {
    let outside = operands.iter().zip(raw).filter_map(|(operand, raw)| {
        let (low, high) = operand.domain;
        let value = |raw: i64| operand.format.to_f64(i128::from(raw));
        (!(low..=high).contains(raw)).then(|| {
            format!(
                "{} = {} is not in {} to {}",
                operand.name,
                value(*raw),
                value(low),
                value(high)
            )
        })
    });
    outside.collect()
}

/// Returns one point, with every signal of the golden model.
fn point(
    output: OutputOptions,
    one: &Loaded,
    given: &[Option<i64>],
    typical: bool,
) -> Result<bool> {
    let contract = one.core.contract.as_ref();
    let operands = contract.operands();
    let (raw, missing) = match typical {
        true => (operands::typical(contract, given), Vec::new()),
        false => (operands::completed(contract, given), operands::missing(contract, given)),
    };
    let model = one.core.device.golden(&one.core.config);
    let mut signals = signals(model, operands, &raw)?;
    let outside = outside(operands, &raw);
    let results = results(contract, &raw);
    // The golden model of a pipeline is the model of its sequential core. Formats are the formats of the core's nets.
    // The list cannot have signals that only the core has.
    let pipeline = one.core.design.pipeline.as_ref();
    let sequential = pipeline.map(|_| one.core.device.sequential(&one.core.config)).transpose()?;
    if let Some(pipeline) = pipeline {
        signals.retain(|(name, _)| {
            let mut registers = pipeline.checkpoints.iter().map(|it| &it.register);
            registers.any(|it| it == name) || one.core.design.find(name).is_some()
        });
    }
    let design = sequential.as_ref().unwrap_or(&one.core.design);
    let signals: Vec<SignalValue> = signals
        .into_iter()
        .map(|(name, bits)| match design.find(&name).map(|id| design.net(id).format) {
            Some(format) => SignalValue::new(name, format, format.raw(bits)),
            None => {
                SignalValue { name, format: String::new(), raw: bits.into(), value: bits as f64 }
            }
        })
        .collect();
    let operands = operands.iter().zip(&raw);
    let operands: Vec<SignalValue> = operands
        .map(|(it, &raw)| SignalValue::new(it.name.clone(), it.format, raw.into()))
        .collect();
    if output.json {
        tables::print_json(&json!({
            "config": one.path,
            "operands": operands,
            "not_given": missing,
            "inside_the_domain": outside.is_empty(),
            "signals": signals,
            "formula": as_json(&results),
        }));
        return Ok(true);
    }
    if !missing.is_empty() {
        say!("Operands that were not given: {}.", missing.join(", "));
    }
    if !outside.is_empty() {
        say!("Outside the domain for which the contract is stated: {}.", outside.join("; "));
    }
    print_values("operand", operands);
    print_values("golden, when valid", signals);
    let rows = results.into_iter().map(|it| {
        vec![it.name, it.value.to_string(), format!("{:.9}", it.exact), format!("{:.3}", it.error)]
    });
    tables::print("result | value: | formula in f64: | error in last places:", rows);
    Ok(true)
}

/// The results of a point, beside the formula: f of a highlight, and each output.
struct ResultComparison {
    name: String,
    value: f64,
    exact: f64,
    /// The error in last places of the result. At a jump of the formula, it is measured from the nearer side. For
    /// example, an output of 200 for a formula of 200.3 has the error 0.3, in an output without fraction bits.
    error: f64,
}

/// The name of f among the results.
const F: &str = "f";

fn results(contract: &dyn Contract, raw: &[i64]) -> Vec<ResultComparison> {
    let of = |name: &str, format: Format, raw: i64, exact: [f64; 2]| ResultComparison {
        name: name.to_owned(),
        value: format.to_f64(i128::from(raw)),
        exact: exact[0],
        error: golden::nearer(raw as f64, exact.map(|it| it / format.to_f64(1))),
    };
    let f = contract.highlight().map(|it| {
        let point = it.point(&raw[..it.control()], 0);
        of(F, it.f_format(), it.f(&point), [it.reference(&point); 2])
    });
    let (mut bits, mut exact) = (Vec::new(), Vec::new());
    contract.results(raw, 0, &mut bits);
    contract.exact(raw, 0, &mut exact);
    let outputs = contract.outputs().iter().zip(bits).zip(exact);
    let outputs = outputs.map(|((it, raw), exact)| of(&it.name, it.format, raw, exact));
    f.into_iter().chain(outputs).collect()
}

fn as_json(results: &[ResultComparison]) -> Value {
    let (f, outputs): (Vec<&ResultComparison>, Vec<_>) =
        results.iter().partition(|it| it.name == F);
    let exact: Vec<f64> = outputs.iter().map(|it| it.exact).collect();
    let errors: Vec<f64> = outputs.iter().map(|it| it.error).collect();
    match f.first() {
        Some(f) => {
            json!({ "f": f.exact, "f_error": f.error, "outputs": exact, "errors": errors })
        }
        None => json!({ "outputs": exact, "errors": errors }),
    }
}

/// A number of a device.
#[derive(Serialize)]
struct SignalValue {
    name: String,
    raw: i128,
    value: f64,
    /// Nothing of a signal that is no net.
    format: String,
}

impl SignalValue {
    fn new(name: String, format: Format, raw: i128) -> Self {
        Self { name, raw, value: format.to_f64(raw), format: format.to_string() }
    }
}

fn print_values(what: &str, values: Vec<SignalValue>) {
    let row = |it: SignalValue| vec![it.name, it.format, it.raw.to_string(), it.value.to_string()];
    tables::print(&format!("{what} | format | raw: | value:"), values.into_iter().map(row));
}

/// Returns all signals in the clock in which `valid` is high.
fn signals(model: Box<dyn Model>, operands: &[Operand], raw: &[i64]) -> Result<Vec<(String, u64)>> {
    let mut model = Driven::new(model, operands.iter().map(|operand| operand.name.as_str()))?;
    let pairs = operands.iter().zip(raw);
    model.start(pairs.map(|(operand, &raw)| operand.format.bits(i128::from(raw))));
    for _ in 0..LIMIT {
        if model.is_valid() {
            return Ok(model.names().iter().cloned().zip(model.values().iter().copied()).collect());
        }
        model.clock();
    }
    bail!("the device does not raise `valid` within {LIMIT} clocks")
}

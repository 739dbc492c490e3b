//! `eval`.

mod batch;
mod operands;

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::Args;
use serde_json::{Value, json};

use super::{Loaded, load_one};
use crate::base::fixed::Format;
use crate::cli::failure::WrongUsage;
use crate::cli::tables::Column;
use crate::cli::{Output, say, tables, wrong_usage};
use crate::golden::{self, Contract, Model, Operand};
use crate::registry::Registry;

/// Compute one point: golden registers, outputs and the formula in f64
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint eval my_core.toml cos_gamma=0.99 exponent=20 red=255
  glint eval my_core.toml cos_gamma=#1038090     a raw integer, as the port takes it
  glint eval my_core.toml --batch points.csv     a row of results for each row of operands
  glint setup my_core.toml --batch lines.csv | glint eval my_core.toml --batch -
  glint eval my_core.toml --json                 a typical point, for scripts")]
pub struct Arguments {
    /// A configuration
    config: PathBuf,
    /// Operands: `cos_gamma=0.99` is a value, `cos_gamma=#1038090` a raw integer. An operand that is not
    /// given has a value at which results show, a colour the largest
    #[arg(value_name = "OPERAND=VALUE")]
    operands: Vec<String>,
    /// Compute many points: a CSV file with the names of operands in its first row, or - for standard input. The
    /// results are CSV, or with --json a list; of a line, a row for each point. Operands on the command line hold for all
    /// rows
    #[arg(long, value_name = "FILE.csv")]
    batch: Option<PathBuf>,
}

/// More clocks than any device takes.
const LIMIT: u64 = 1 << 16;

/// `glint eval`: one point, or as many as a CSV file has.
pub fn run(registry: &Registry, output: Output, arguments: &Arguments) -> Result<bool> {
    let one = load_one(registry, &registry.schemas(), &arguments.config)?;
    let given =
        operands::given(one.core.contract.operands(), &arguments.operands).map_err(WrongUsage)?;
    match &arguments.batch {
        Some(path) if *path == arguments.config => {
            wrong_usage!("configuration and --batch are one file")
        }
        Some(path) => batch::batch(output, &one, &given, path),
        None => point(output, &one, &given),
    }
}

/// The formula at raw operands: f of a highlight, and each output, of result number `index`.
fn formula(contract: &dyn Contract, raw: &[i64], index: u64) -> (Option<f64>, Vec<f64>) {
    let f = contract.highlight().map(|it| it.reference(&it.point(&raw[..it.control()], index)));
    let mut exact = Vec::new();
    contract.exact(raw, index, &mut exact);
    (f, exact.into_iter().map(|[value, _]| value).collect())
}

/// The operands that are outside the domain for which the contract is stated, in words.
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

/// One point, with every signal of the golden model.
fn point(output: Output, one: &Loaded, given: &[Option<i64>]) -> Result<bool> {
    let contract = one.core.contract.as_ref();
    let operands = contract.operands();
    let raw = operands::completed(contract, given);
    let mut model = one.core.device.golden(&one.core.config);
    let mut signals = signals(model.as_mut(), operands, &raw)?;
    let outside = outside(operands, &raw);
    let results = results(contract, &raw);
    // The golden model of a pipeline is that of its sequential core: formats are those of its nets, and of the rest of it
    // nothing is in the pipeline.
    let pipeline = one.core.design.pipeline.as_ref();
    let sequential = pipeline.map(|_| one.core.device.sequential(&one.core.config)).transpose()?;
    if let Some(pipeline) = pipeline {
        signals.retain(|(name, _)| {
            let mut registers = pipeline.checkpoints.iter().map(|it| &it.register);
            registers.any(|it| it == name) || one.core.design.find(name).is_some()
        });
    }
    let design = sequential.as_ref().unwrap_or(&one.core.design);
    let value_of = |name: &str, bits: u64| {
        let net = design.find(name).map(|id| design.net(id));
        net.map_or((i128::from(bits), bits as f64, String::new()), |net| {
            let raw = net.format.raw(bits);
            (raw, net.format.to_f64(raw), net.format.to_string())
        })
    };
    if output.json {
        let signals: Vec<Value> = signals
            .iter()
            .map(|(name, bits)| {
                let (raw, value, format) = value_of(name, *bits);
                json!({ "name": name, "raw": raw as i64, "value": value, "format": format })
            })
            .collect();
        let operands: Vec<Value> = operands
            .iter()
            .zip(&raw)
            .map(|(operand, &raw)| {
                let value = operand.format.to_f64(i128::from(raw));
                json!({ "name": operand.name, "raw": raw, "value": value, "format": operand.format.to_string() })
            })
            .collect();
        tables::print_json(&json!({
            "config": one.path,
            "operands": operands,
            "inside_the_domain": outside.is_empty(),
            "signals": signals,
            "formula": as_json(&results),
        }));
        return Ok(true);
    }
    if !outside.is_empty() {
        say!("Outside the domain for which the contract is stated: {}.", outside.join("; "));
    }
    let rows = operands.iter().zip(&raw).map(|(operand, &raw)| {
        vec![
            operand.name.clone(),
            operand.format.to_string(),
            raw.to_string(),
            operand.format.to_f64(i128::from(raw)).to_string(),
        ]
    });
    print_values("operand", rows);
    let rows = signals.iter().map(|(name, bits)| {
        let (raw, value, format) = value_of(name, *bits);
        vec![name.clone(), format, raw.to_string(), value.to_string()]
    });
    print_values("golden, when valid", rows);
    let columns = [
        Column::words("result"),
        Column::numbers("value"),
        Column::numbers("formula in f64"),
        Column::numbers("error in last places"),
    ];
    let rows = results.into_iter().map(|it| {
        vec![it.name, it.value.to_string(), format!("{:.9}", it.exact), format!("{:.3}", it.error)]
    });
    tables::print(&columns, rows);
    Ok(true)
}

/// The results of a point, beside the formula: f of a highlight, and each output.
struct Computed {
    name: String,
    value: f64,
    exact: f64,
    /// In last places of the result, from the nearer side where the formula jumps.
    error: f64,
}

/// The name of f among the results.
const F: &str = "f";

fn results(contract: &dyn Contract, raw: &[i64]) -> Vec<Computed> {
    let of = |name: &str, format: Format, raw: i64, exact: [f64; 2]| Computed {
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

fn as_json(results: &[Computed]) -> Value {
    let (f, outputs): (Vec<&Computed>, Vec<_>) = results.iter().partition(|it| it.name == F);
    let exact: Vec<f64> = outputs.iter().map(|it| it.exact).collect();
    let errors: Vec<f64> = outputs.iter().map(|it| it.error).collect();
    match f.first() {
        Some(f) => {
            json!({ "f": f.exact, "f_error": f.error, "outputs": exact, "errors": errors })
        }
        None => json!({ "outputs": exact, "errors": errors }),
    }
}

fn print_values(what: &str, rows: impl Iterator<Item = Vec<String>>) {
    let columns = [
        Column::words(what),
        Column::words("format"),
        Column::numbers("raw"),
        Column::numbers("value"),
    ];
    tables::print(&columns, rows);
}

/// Writes the operands, starts, and returns all signals in the clock in which `valid` is high.
fn signals(model: &mut dyn Model, operands: &[Operand], raw: &[i64]) -> Result<Vec<(String, u64)>> {
    let mut inputs = vec![0; model.inputs().len()];
    let names = model.inputs().to_vec();
    let set = |inputs: &mut Vec<u64>, name: &str, bits: u64| {
        if let Some(at) = names.iter().position(|other| other == name) {
            inputs[at] = bits;
        }
    };
    model.clock(&inputs);
    set(&mut inputs, "rst_n", 1);
    for (operand, &raw) in operands.iter().zip(raw) {
        set(&mut inputs, &operand.name, operand.format.bits(i128::from(raw)));
        set(&mut inputs, &format!("{}_write", operand.name), 1);
    }
    set(&mut inputs, "start", 1);
    model.clock(&inputs);
    inputs.fill(0);
    set(&mut inputs, "rst_n", 1);
    let valid = model
        .signals()
        .iter()
        .position(|name| name == "valid")
        .context("the golden model does not predict `valid`")?;
    for _ in 0..LIMIT {
        if model.values()[valid] == 1 {
            let values = model.values().to_vec();
            return Ok(model.signals().iter().cloned().zip(values).collect());
        }
        model.clock(&inputs);
    }
    bail!("the device does not raise `valid` within {LIMIT} clocks")
}

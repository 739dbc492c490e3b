//! `glint eval`: computes one point, or the points of a CSV file, with the golden model, and compares the outputs with the
//! formula in f64.

mod batch;
mod function;
mod operands;

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use serde::Serialize;
use serde_json::{Value, json};

use self::batch::BatchSubject;
use self::function::NamedFunction;
use super::{Loaded, load_one};
use crate::failure::Failure;
use crate::report::CommandReport;
use crate::{OutputOptions, say, tables, wrong_usage};
use glint_base::fixed::Format;
use glint_core::cosim::Driven;
use glint_core::registry::Registry;
use glint_golden::{self as golden, ANY_VALUE, Contract, Model, Operand};

/// Compute one point: registers and outputs of the golden model, and the formula in f64
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint eval my_core.toml cos_gamma=0.99 exponent=20 red=255
  glint eval my_core.toml cos_gamma=#1038090     a raw integer, as the port takes it
  glint eval sfu.toml opcode=log2 x=2            a function of a unit, by its own names and formats
  glint eval softmax4.toml v=0.5,0,0,-1          the numbers of a list; `v[0]=0.5` gives one of them
  glint eval my_core.toml --batch points.csv     a row of results for each row of operands
  glint eval sfu.toml opcode=log2 --batch x.csv  the same for a function of a unit
  glint setup my_core.toml --batch lines.csv | glint eval my_core.toml --batch -
  glint eval my_core.toml --typical --json       a point with a visible highlight, for scripts")]
pub struct Arguments {
    /// A configuration file
    config: PathBuf,
    /// Operands: `cos_gamma=0.99` is a value, `cos_gamma=#1038090` a raw integer. An operand that is not
    /// given is 0, or the value nearest to 0 in its domain
    #[arg(value_name = "OPERAND=VALUE")]
    operands: Vec<String>,
    /// Compute many points: read operands from a CSV file, or from standard input if the file is -. The first row has the
    /// names of the operands. The results are printed as CSV, or with --json as a list; a line gives one row for each of its
    /// points. Operands on the command line apply to all rows
    #[arg(long, value_name = "FILE.csv")]
    batch: Option<PathBuf>,
    /// Choose values for the operands that you do not give, so that the highlight is visible: for a colour the largest
    /// value, for an angle the value at which the highlight has half its brightness
    #[arg(long, conflicts_with = "batch")]
    typical: bool,
}

/// The number of clocks after which a computation counts as without result.
const LIMIT: u64 = 1 << 16;

/// Computes the points and reports them.
///
/// # Errors
///
/// Fails if the configuration has problems, if an operand is unknown or has no valid value, or if the CSV file cannot be read.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let one = load_one(registry, &arguments.config)?;
    let function =
        function::named_function(&one.core, &arguments.operands).map_err(Failure::WrongUsage)?;
    let at_ports = function.as_ref().map(NamedFunction::settings);
    let settings = at_ports.as_ref().unwrap_or(&arguments.operands);
    let given =
        operands::given(one.core.contract.operands(), settings).map_err(Failure::WrongUsage)?;
    match &arguments.batch {
        Some(path) if *path == arguments.config => {
            wrong_usage!(
                "the configuration and --batch name the same file: give --batch another file"
            )
        }
        Some(path) => {
            let of_core = || {
                let contract = one.core.contract.as_ref();
                let results = contract.outputs().iter().map(|it| it.name.clone()).collect();
                BatchSubject { contract, given: &given, results }
            };
            let subject = function.as_ref().map_or_else(of_core, NamedFunction::batch_subject);
            batch::batch(output, &one, &subject, path)
        }
        None => point(output, &one, function.as_ref(), &given, arguments.typical),
    }
}

/// Returns a phrase for each operand outside the contract's domain, such as `exponent = 300 is not between 1 and 255`. An operand
/// that the device limits to its domain is never outside.
fn outside(operands: &[Operand], raw: &[i64]) -> Vec<String> {
    let mut outside = Vec::new();
    for (operand, &raw) in operands.iter().zip(raw) {
        let (low, high) = operand.domain;
        if !operand.clamped && !(low..=high).contains(&raw) {
            let [value, from, to] =
                [raw, low, high].map(|raw| operand.format.to_f64(i128::from(raw)));
            outside.push(format!("{} = {value} is not between {from} and {to}", operand.name));
        }
    }
    outside
}

/// Reports one point with every signal of the golden model. `given` has the raw operands that the user gave, in the contract's
/// order. If the user named a `function` of a unit, its operands and results are also reported in its own formats.
fn point(
    output: OutputOptions,
    one: &Loaded,
    function: Option<&NamedFunction>,
    given: &[Option<i64>],
    typical: bool,
) -> Result<bool> {
    let contract = one.core.contract.as_ref();
    let operands = contract.operands();
    let (raw, missing) = match typical {
        true => (operands::typical(contract, given), Vec::new()),
        false => (operands::completed(contract, given), operands::missing(contract, given)),
    };
    let signals = signal_values(one, operands, &raw)?;
    let outside = outside(operands, &raw);
    let results = results(contract, &raw);
    let mut operand_values: Vec<SignalValue> = Vec::new();
    for (operand, &raw) in operands.iter().zip(&raw) {
        operand_values.push(SignalValue::new(operand.name.clone(), operand.format, raw.into()));
    }
    let of_function = function.map(|function| (function.operands(), function.results()));
    output.report(&EvaluatedPoint {
        one,
        of_function,
        operands: operand_values,
        missing,
        outside,
        signals,
        results,
    })?;
    Ok(true)
}

struct EvaluatedPoint<'a> {
    one: &'a Loaded,
    /// The operands and results of the function that the user named, in its own formats.
    of_function: Option<(Vec<SignalValue>, Vec<ResultComparison>)>,
    operands: Vec<SignalValue>,
    /// The operands that the user did not give, with the values that the command chose.
    missing: Vec<String>,
    outside: Vec<String>,
    signals: Vec<SignalValue>,
    results: Vec<ResultComparison>,
}

impl CommandReport for EvaluatedPoint<'_> {
    fn json(&self) -> Result<Value> {
        let mut point = json!({
            "config": self.one.path,
            "operands": self.operands,
            "not_given": self.missing,
            "inside_the_domain": self.outside.is_empty(),
            "signals": self.signals,
            "formula": as_json(&self.results),
        });
        if let Some((operands, results)) = &self.of_function {
            let mut values = serde_json::Map::new();
            for result in results {
                values.insert(result.name.clone(), json!(result.value));
            }
            let formula = as_json(results);
            point["function"] =
                json!({ "operands": operands, "results": values, "formula": formula });
        }
        Ok(point)
    }

    fn print(&self) -> Result<()> {
        if !self.missing.is_empty() {
            say!("Operands that were not given: {}.", self.missing.join(", "));
        }
        if !self.outside.is_empty() {
            let outside = self.outside.join("; ");
            say!("Outside the domain for which the contract is stated: {outside}.");
        }
        print_values("operand", &self.operands);
        print_values("golden, when valid", &self.signals);
        print_results(&self.results);
        if let Some((operands, results)) = &self.of_function {
            print_values("operand of the function", operands);
            print_results(results);
        }
        Ok(())
    }
}

fn print_results(results: &[ResultComparison]) {
    let mut rows = Vec::new();
    for result in results {
        rows.push(vec![
            result.label(),
            result.value.to_string(),
            result.exact.map_or("no value".to_owned(), |exact| format!("{exact:.9}")),
            result.error.map_or("outside where".to_owned(), |error| format!("{error:.3}")),
        ]);
    }
    tables::print("result | value: | formula in f64: | error in last places:", rows);
}

/// Returns the signals of the golden model in the first result's clock. The golden model of a pipeline is the model of its
/// sequential core; the result has only its checkpoints and the signals that the pipeline also has. The formats come from the
/// sequential core's nets.
fn signal_values(one: &Loaded, operands: &[Operand], raw: &[i64]) -> Result<Vec<SignalValue>> {
    let core = &one.core;
    let mut signals = signals(core.opened.golden(), operands, raw)?;
    let sequential = match &core.design.pipeline {
        Some(_) => Some(core.opened.sequential()?),
        None => None,
    };
    if let Some(pipeline) = &core.design.pipeline {
        signals.retain(|(name, _)| {
            pipeline.checkpoints.iter().any(|checkpoint| checkpoint.register == *name)
                || core.design.find(name).is_some()
        });
    }
    let design = sequential.as_ref().unwrap_or(&core.design);
    let mut values = Vec::new();
    for (name, bits) in signals {
        values.push(match design.find(&name) {
            Some(net) => {
                let format = design.net(net).format;
                SignalValue::new(name, format, format.raw(bits))
            }
            None => {
                SignalValue { name, format: String::new(), raw: bits.into(), value: bits as f64 }
            }
        });
    }
    Ok(values)
}

/// A result of a point (an output, or `f` of a highlight) with the value of the formula.
struct ResultComparison {
    name: String,
    /// The number of fraction bits, which decides the unit of the error.
    fraction: i32,
    value: f64,
    exact: Option<f64>,
    /// The absolute error in units of the result's last bit, or `None` if the contract promises nothing for these operands. At
    /// a jump of the formula, the error is measured from the nearer side.
    error: Option<f64>,
}

/// The name of the reflectance `f` among the results.
const F: &str = "f";

fn results(contract: &dyn Contract, raw: &[i64]) -> Vec<ResultComparison> {
    let mut results = Vec::new();
    if let Some(highlight) = contract.highlight() {
        let point = highlight.point(&raw[..highlight.control()], 0);
        let (f, exact) = (highlight.f(&point), highlight.reference(&point));
        results.push(ResultComparison::new(F, highlight.f_format(), f, [exact; 2], exact));
    }
    let (mut bits, mut exact, mut values) = (Vec::new(), Vec::new(), Vec::new());
    contract.results(raw, 0, &mut bits);
    contract.exact(raw, 0, &mut exact);
    contract.formula_values(raw, 0, &mut values);
    let outputs = contract.outputs().iter().zip(bits);
    for ((output, raw), (exact, value)) in outputs.zip(exact.into_iter().zip(values)) {
        results.push(ResultComparison::new(&output.name, output.format, raw, exact, value));
    }
    results
}

impl ResultComparison {
    /// Compares `raw` with `exact`, the formula's values on the two sides of a jump, or [`ANY_VALUE`] if nothing is promised.
    /// Without a jump, the two values are equal. `value` is the formula's value, or NaN.
    fn new(name: &str, format: Format, raw: i64, exact: [f64; 2], value: f64) -> Self {
        let unit = format.to_f64(1);
        let error = golden::nearer(raw as f64, exact.map(|side| side / unit));
        Self {
            name: name.to_owned(),
            fraction: format.frac,
            value: format.to_f64(i128::from(raw)),
            exact: (!value.is_nan()).then_some(value),
            error: (exact != ANY_VALUE).then_some(error),
        }
    }

    /// Returns the name of the result in the table. `f` is no output, so its name states the unit of its error.
    fn label(&self) -> String {
        match self.name.as_str() {
            F => format!("f (last place 2^{})", -self.fraction),
            name => name.to_owned(),
        }
    }
}

fn as_json(results: &[ResultComparison]) -> Value {
    let mut f = None;
    let (mut exact, mut errors) = (Vec::new(), Vec::new());
    for result in results {
        if result.name == F {
            f = f.or(Some(result));
        } else {
            exact.push(result.exact);
            errors.push(result.error);
        }
    }
    match f {
        Some(f) => {
            json!({ "f": f.exact, "f_error": f.error, "outputs": exact, "errors": errors })
        }
        None => json!({ "outputs": exact, "errors": errors }),
    }
}

#[derive(Serialize)]
struct SignalValue {
    name: String,
    raw: i128,
    value: f64,
    /// The format; empty for a signal that is no net of the design.
    format: String,
}

impl SignalValue {
    fn new(name: String, format: Format, raw: i128) -> Self {
        Self { name, raw, value: format.to_f64(raw), format: format.to_string() }
    }
}

fn print_values(what: &str, values: &[SignalValue]) {
    let mut rows = Vec::new();
    for SignalValue { name, raw, value, format } in values {
        rows.push(vec![name.clone(), format.clone(), raw.to_string(), value.to_string()]);
    }
    tables::print(&format!("{what} | format | raw: | value:"), rows);
}

/// Returns the names and bit patterns of all signals of a model in the first clock in which `valid` is high. `raw` has the raw
/// operands, in the order of `operands`.
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
    bail!("the golden model does not set `valid` within {LIMIT} clocks")
}

//! A program outside Glint's workspace, with three devices: the device of `examples/fresnel`, the catalogue's `function`, and
//! `root`, which has `function` as a part. `tests/tools/foreign.rs` makes a crate of it.

#[allow(dead_code)]
#[path = "fresnel/main.rs"]
mod fresnel;

use std::process::ExitCode;
use std::sync::Arc;

use glint::config::{Config, Schema, Value};
use glint::devices::function::describe as rsqrt;
use glint::dsl::{About, Designer};
use glint::fixed::{Format, Overflow, Rounding, exp2};
use glint::golden::device::{self, Formula};
use glint::golden::frame::{Frame, State};
use glint::golden::narrow::Narrow;
use glint::golden::{self, Contract, Model, Term};
use glint::keys::function::{self, FunctionPlan};
use glint::registry::{Device, DeviceParts, PartsResult, Registry};

/// The format of the result, u1.14.
const RESULT: Format = Format::unsigned(1, 14);

/// Returns the part: 1/√x from 1 to 2.
fn part() -> Config {
    let values = [("formula", Value::Text("1/sqrt(x)".into())), ("from", Value::Text("1".into()))];
    let mut values: Vec<_> = values.into();
    values.push(("to", Value::Text("2".into())));
    let values = values.into_iter().map(|(key, value)| (format!("function.{key}"), value));
    Config::from_values(&function::schema(), "rsqrt", values.collect()).expect("sound keys")
}

/// The parts of the device `root`, with the plan of its inverse root.
struct RootParts {
    inverse: FunctionPlan,
}

impl RootParts {
    fn device(&self) -> device::Device {
        let polynomials = &self.inverse.polynomials;
        let (first, last) = polynomials.domain;
        let model = golden::function::model(&part(), &self.inverse);
        let mut frame = Frame::default();
        let x = frame.operand("x", polynomials.operand);
        let inverse = frame.part("rsqrt", &*model, [("x", move |s: &State| s[x])]).out("result_out");
        let places = polynomials.operand.frac + polynomials.result.frac;
        let rounded = Narrow::new(places as u32, RESULT, Rounding::Nearest);
        frame.output("root_out", RESULT, move |s| rounded.apply(s[x] * s[inverse]));
        frame.dataflow().domain("x", first, last)
    }
}

impl DeviceParts for RootParts {
    /// √x = x·(1/√x).
    fn describe(&self, d: &Designer, _: &Config) {
        d.about(About {
            device: "root".into(),
            title: "The square root".into(),
            formula: "sqrt(x)".into(),
            source: "x * (1 / sqrt(x))".into(),
            notes: Vec::new(),
        });
        let x = d.operand("x", self.inverse.polynomials.operand).q();
        let describe = |d: &Designer| rsqrt(d, &part(), &self.inverse);
        let inverse = d.instance("rsqrt", describe, &[("x", x)]).out("result_out");
        let product = d.mul("product", x, inverse);
        let rounded = d.narrow("r", product, RESULT, Rounding::Nearest, Overflow::Saturate);
        d.output("root_out", rounded);
        d.dataflow();
    }

    fn model(&self, _: &Config) -> Box<dyn Model> {
        self.device().model()
    }

    fn contract(&self, _: &Config) -> Box<dyn Contract> {
        let part = golden::function::contract(&part(), &self.inverse);
        let error = part.bounds().governing().units * exp2(-part.outputs()[0].format.frac);
        self.device().contract(Root { error })
    }
}

/// Plans the inverse root once, for the description, the golden model and the contract.
fn parts(_: &Config) -> PartsResult {
    Ok(Arc::new(RootParts { inverse: function::plan(&part())? }))
}

/// The square root, and the largest error of the inverse root.
struct Root {
    error: f64,
}

impl Formula for Root {
    fn exact(&self, x: &[f64]) -> Vec<f64> {
        vec![x[0].sqrt()]
    }

    /// Returns the part's error grows by x, which is at most 2.
    fn terms(&self, _output: usize) -> Vec<Term> {
        let units = 2.0 * self.error * exp2(RESULT.frac);
        let rounding = Term { key: "root", what: "rounding of the result", units: 0.5 };
        vec![Term { key: "root", what: "the inverse root", units }, rounding]
    }
}

const ROOT: Device = Device {
    name: "root",
    summary: "sqrt(x), of the inverse root",
    schema: || Schema { device: "root", keys: Vec::new(), check: |_, _| {} },
    parts,
    proved: false,
};

fn main() -> ExitCode {
    let catalogue = Registry::catalogue();
    let function = *catalogue.device("function").expect("a device of the catalogue");
    glint::cli::run(&Registry::empty().with(fresnel::FRESNEL).with(function).with(ROOT))
}

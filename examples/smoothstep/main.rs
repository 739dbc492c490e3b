//! Defines a device whose author has proved no bound on its error: smoothstep, 3·x² − 2·x³.
//!
//! An accuracy contract states how far an output may be from its formula. If nobody has worked that out, the author leaves out
//! `terms`, and `certify` searches for a bound. The command translates the netlist and the microprogram to real numbers with
//! roundings, and Gappa proves how far the results are from the formula.
//!
//! ```sh
//! cargo run --release --example smoothstep -- new smoothstep > s.toml
//! cargo run --release --example smoothstep -- certify s.toml
//! ```
//!
//! If Gappa finds a bound, the printed bound is proved, and the author may state it as a `Term`. Without a stated bound, the
//! commands that compare errors with the bound say that no bound is stated, and `strict = true` refuses the configuration.

use std::process::ExitCode;
use std::sync::Arc;

use glint::config::{Config, Key, Schema};
use glint::dsl::{About, Designer, end, step, valid};
use glint::fixed::{Format, Overflow, Rounding};
use glint::golden::device::{self, Formula};
use glint::golden::frame::{Frame, idle, step as execute};
use glint::golden::narrow::Narrow;
use glint::golden::{Contract, Model};
use glint::registry::{Device, KeyParts, Registry};

glint::keys! {
    struct Keys {
        fraction: u32 = Key::integer("x.fraction", 12, 4..=20, "Fraction bits of x, u1.F."),
        kept: u32 = Key::integer("output.fraction", 12, 4..=20,
            "Fraction bits of the output, u1.C; x^2 has four more."),
    }
}

fn schema() -> Schema {
    Schema { device: "smoothstep", keys: Keys::keys(), check: |_, _| {} }
}

fn bits(config: &Config) -> (i32, i32) {
    let keys = Keys::of(config);
    (keys.fraction as i32, keys.kept as i32)
}

/// Fraction bits that the square has beyond those of the output.
const GUARD: i32 = 4;

/// The square is cut, and its product with 3 − 2·x rounded.
fn describe(d: &Designer, config: &Config) {
    let (fraction, kept) = bits(config);
    let result = Format::unsigned(1, kept);
    d.about(About {
        device: "smoothstep".into(),
        title: "A smooth step from 0 to 1".into(),
        formula: "3*x^2 - 2*x^3".into(),
        source: "RenderMan Interface Specification 3.1, 1989".into(),
        notes: vec!["x beyond 1 is taken for 1.".into()],
    });
    let x = d.operand_clamped("x", Format::unsigned(1, fraction), 0.0, 1.0).q();
    let wide = Format::unsigned(1, kept + GUARD);
    let square = d.register("square", wide).doc("x^2");
    let smooth = d.register("smooth", result).doc("x^2 * (3 - 2*x)");
    let product = d.mul("x_square", x, x);
    square.takes(d.narrow("square_cut", product, wide, Rounding::Truncate, Overflow::Saturate));
    let three = d.constant("three", 3.0, Format::unsigned(2, fraction));
    let slope = d.sub("slope", three, x.shift_left(1)).doc("3 - 2*x");
    let product = d.mul("product", square.q(), slope);
    smooth.takes(d.narrow("rounded", product, result, Rounding::Nearest, Overflow::Saturate));
    d.output("smooth_out", smooth.q());
    d.microprogram([
        step("idle", []),
        step("square", [square.load()]),
        step("smooth", [smooth.load()]),
        step("result", [valid(), end()]),
    ]);
}

/// Returns the golden model: registers, and what each microinstruction does to them.
fn device(config: &Config) -> device::Device {
    let (fraction, kept) = bits(config);
    let [wide, result] = [kept + GUARD, kept].map(|fraction| Format::unsigned(1, fraction));
    let cut = Narrow::new(2 * fraction as u32, wide, Rounding::Truncate);
    let rounded = Narrow::new((fraction + wide.frac) as u32, result, Rounding::Nearest);
    let mut frame = Frame::default();
    let x = frame.clamped("x", Format::unsigned(1, fraction), 0, 1 << fraction);
    let square = frame.register("square", wide);
    let smooth = frame.register("smooth", result);
    frame.shows("smooth_out", smooth);
    frame.device([
        idle(),
        execute(move |s| s[square] = cut.apply(s[x] * s[x])),
        execute(move |s| s[smooth] = rounded.apply(s[square] * ((3 << fraction) - 2 * s[x]))),
        idle().valid().end(),
    ])
}

fn model(config: &Config) -> Box<dyn Model> {
    device(config).model()
}

fn contract(config: &Config) -> Box<dyn Contract> {
    device(config).contract(Curve)
}

/// The formula, without `terms`.
struct Curve;

impl Formula for Curve {
    fn exact(&self, x: &[f64]) -> Vec<f64> {
        let x = x[0].min(1.0);
        vec![x * x * (3.0 - 2.0 * x)]
    }

    fn expressions(&self) -> Vec<String> {
        vec!["x ** 2 * (3 - 2 * x)".to_owned()]
    }
}

/// The device.
pub const SMOOTHSTEP: Device = Device {
    name: "smoothstep",
    summary: "3*x^2 - 2*x^3, a smooth step from 0 to 1",
    schema,
    parts: |_| Ok(Arc::new(KeyParts { describe, model, contract })),
    proved: false,
};

fn main() -> ExitCode {
    glint::cli::run(&Registry::empty().with(SMOOTHSTEP))
}

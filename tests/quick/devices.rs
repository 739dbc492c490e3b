//! Tests the devices `dot-product`, `normaliser` and `shading`, whose contracts are no highlights, against formulas that are
//! written out in this file.
//!
//! It also tests devices that Glint must refuse, for example a device that never shows its result.

use std::ops::ControlFlow;
use std::sync::Arc;

use glint::config::{Config, Schema};
use glint::core::Core;
use glint::cosim::exhaustive::{Clocks, Peak, Places, Proof, Shard, ShardState};
use glint::cosim::{Random, search, trial};
use glint::dsl::{Designer, end, step, valid};
use glint::fixed::Format;
use glint::golden::device::{self, Formula};
use glint::golden::frame::{Frame, idle, step as execute};
use glint::golden::{Bound, Bounds, Contract, Operand, Term};
use glint::registry::{Device, KeyParts, PartsResult};
use glint::verify::CheckVerdict;

use crate::common::Sure;
use crate::common::cores::{assert_agrees, default, device, random, with_keys};
use crate::common::tools::{EFFORT, finding};

const NAMES: [&str; 3] = ["dot-product", "normaliser", "shading"];

/// Returns the raw results and the error of each in last places, by the formula given.
fn errors(contract: &dyn Contract, operands: &[i64], formula: impl Fn(&[f64]) -> Vec<f64>) -> f64 {
    let mut raw = Vec::new();
    contract.results(operands, 0, &mut raw);
    let values = contract.operands().iter().zip(operands);
    let values: Vec<f64> = values.map(|(it, &raw)| it.format.to_f64(raw.into())).collect();
    let outputs = contract.outputs().iter().zip(&raw).zip(formula(&values));
    outputs
        .map(|((output, &raw), exact)| (raw as f64 - exact / output.format.to_f64(1)).abs())
        .fold(0.0, f64::max)
}

fn dot(v: &[f64]) -> Vec<f64> {
    let n = unit(&v[..3]);
    vec![(n[0] * v[3] + n[1] * v[4] + n[2] * v[5]).clamp(0.0, 1.0)]
}

/// By the default, W of power 16.
fn shading(v: &[f64]) -> Vec<f64> {
    let [facing, cosine] = [3, 6].map(|at| dot(&[&v[..3], &v[at..at + 3]].concat())[0]);
    let base = (v[9] / 16.0 * (cosine - 1.0) + 1.0).max(0.0);
    let f = if cosine > 0.0 { base.powi(16) } else { 0.0 };
    (10..13).map(|at| (v[at] + v[at + 3] * facing + v[at + 6] * f).min(255.0)).collect()
}

/// A highlight by its keys, and its formula of cosine and exponent.
type OfHighlight = (&'static str, fn(f64, f64) -> f64);

const HIGHLIGHTS: [OfHighlight; 5] = [
    ("highlight = \"cosine-power\"\npower = 4", |c, n| {
        if c > 0.0 { (n / 4.0 * (c - 1.0) + 1.0).max(0.0).powi(4) } else { 0.0 }
    }),
    ("highlight = \"blinn\"", |c, n| c.powf(n)),
    ("highlight = \"schlick\"", |c, n| c / (n - n * c + c)),
    (
        "highlight = \"gauss\"",
        |c, n| {
            if c > 0.0 { (-n * c.acos().powi(2) / 2.0).exp() } else { 0.0 }
        },
    ),
    ("highlight = \"function\"\n[function]\nformula = \"x^3 + 0.25\"", |c, _| c.powi(3) + 0.25),
];

/// Colours of several lights, from both sides, against formulas that are written out here.
#[test]
fn lights_add_up_on_both_sides() {
    for ((keys, f), (lights, two_sided)) in
        HIGHLIGHTS.into_iter().flat_map(|it| [(1, true), (3, false)].map(|of| (it, of)))
    {
        let text = format!("lights = {lights}\ntwo_sided = {two_sided}\n{keys}\n");
        let core = with_keys(device("shading"), &text).sure_of(&text);
        let contract = core.contract.as_ref();
        let has_exponent = !keys.contains("function");
        let formula = |v: &[f64]| {
            let normal = unit(&v[..3]);
            let cosine = |other: &[f64]| {
                let sum: f64 = normal.iter().zip(other).map(|(a, b)| a * b).sum();
                (if two_sided { sum.abs() } else { sum }).clamp(0.0, 1.0)
            };
            let vectors = &v[3..3 + 6 * lights];
            let n = v[3 + 6 * lights];
            let material = &v[3 + 6 * lights + usize::from(has_exponent)..];
            let facing: f64 = vectors.chunks(6).map(|it| cosine(&it[..3])).sum();
            let shine: f64 = vectors.chunks(6).map(|it| f(cosine(&it[3..]), n)).sum();
            let colour =
                |at: usize| material[at] + material[3 + at] * facing + material[6 + at] * shine;
            (0..3).map(|at| colour(at).min(255.0)).collect()
        };
        let mut random = Random::new(7);
        let mut part = || (random.bits() >> 11) as f64 / (1u64 << 53) as f64;
        let points = (0..20_000).filter_map(|_| contract.hint(&mut part));
        let worst = points.map(|it| errors(contract, &it, formula)).fold(0.0, f64::max);
        let bound = contract.bounds().governing().units;
        assert!(worst <= bound + 1e-9 && worst > 0.49, "{text}: {worst}, {bound}");
        assert_agrees(&core, 300, 1, &text);
    }
}

fn unit(v: &[f64]) -> Vec<f64> {
    let length = v.iter().map(|it| it * it).sum::<f64>().sqrt();
    v.iter().map(|it| if length == 0.0 { 0.0 } else { it / length }).collect()
}

#[test]
fn schemas_are_sound_and_defaults_are_proven() {
    for device in NAMES.map(device) {
        assert_eq!((device.schema)().mistakes(), Vec::<String>::new());
        let core = default(device);
        assert!(core.contract.highlight().is_none());
        let bound = core.contract.bounds();
        assert!(bound.governing_units() < 1.0, "{}: {bound:?}", device.name);
    }
}

#[test]
fn random_configurations_agree_on_every_clock() {
    for device in NAMES.map(device) {
        for seed in 0..if device.name == "shading" { 6 } else { 24 } {
            let (what, core) = random(device, seed);
            assert_agrees(&core, 300, seed, &what);
        }
    }
}

/// All vectors of a grid and of a fine corner, against the formulas written out here.
#[test]
fn the_bounds_hold() {
    for device in NAMES.map(device) {
        let formula = match device.name {
            "dot-product" => dot,
            "normaliser" => unit,
            _ => shading,
        };
        let core = default(device);
        let contract = core.contract.as_ref();
        let bound = contract.bounds().governing().units;
        let mut worst: f64 = 0.0;
        let mut random = Random::new(1);
        for _ in 0..200_000 {
            let drawn = |operand: &Operand| {
                // Its magnitude by octaves.
                let (low, high) = operand.domain;
                (random.within(low, high) >> random.below(8)).clamp(low, high)
            };
            let operands: Vec<i64> = contract.operands().iter().map(drawn).collect();
            worst = worst.max(errors(contract, &operands, formula));
        }
        assert!(worst <= bound + 1e-9, "{}: {worst} > {bound}", device.name);
        assert!(worst > bound / 2.0, "{}: {worst} is far below {bound}", device.name);
    }
}

/// Every vector of a narrow normaliser at every clock, and its contract for every sum of squares.
#[test]
fn a_narrow_normaliser_is_proved() {
    let keys = "[vector]\nfraction = 2\n[table]\naddress = 3\n[inverse]\nfraction = 6\n[output]\nfraction = 2\n";
    let core = with_keys(device("normaliser"), keys).sure();
    let contract = core.contract.as_ref();
    let job = core.job().expect("model and design fit");
    let mut state = ShardState::new("", Shard::WHOLE);
    let whole = job.run(&mut state, &|_| (), &mut |_| ControlFlow::Continue(())).expect("it runs");
    assert!(whole.is_continue());
    assert_eq!(state.clocks.differs, None);
    // 12·16 sums of squares, of which 0 has no direction; 3 operands of 4 bits.
    assert_eq!(job.words(), "192 evaluations of the outputs");
    assert_eq!(job.clocks.as_ref().map(Clocks::count), Some(4096));
    let proof = Proof::new(contract, state.f.peak, state.colours.peak);
    assert_eq!(
        (proof.verdict(contract, &contract.sweep()), &proof.failures[..]),
        ("proved", &[][..])
    );
    let said = proof.words("");
    assert!(said.starts_with("the error of an output is at most 0."), "{said}");
}

/// The worked example shows something, and hints lie within the domain.
#[test]
fn examples_come_from_hints() {
    for device in NAMES.map(device) {
        let core = default(device);
        let example = trial::example(&core.design, core.contract.as_ref()).expect("an example");
        for output in &example.outputs {
            let magnitude = output.value.abs();
            let most = if device.name == "shading" { 255.0 } else { 1.0 };
            assert!(magnitude > 0.0 && magnitude < most, "{}: {output:?}", device.name);
        }
        for (operand, quantity) in core.contract.operands().iter().zip(&example.operands) {
            let (low, high) = operand.domain;
            assert!((low..=high).contains(&(quantity.raw as i64)), "{}: {quantity:?}", device.name);
        }
    }
}

#[test]
fn vectors_by_hand() {
    let core = default(device("normaliser"));
    let mut raw = Vec::new();
    // (0.6, 0, −0.8) has length 1; in 2^-14: 9830.4 and −13107.2. The zero vector stays.
    for (operands, expected) in [
        ([9830, 0, -13107], [9830, 0, -13107]),
        ([3, 0, -4], [9830, 0, -13107]),
        ([0, 1, 0], [0, 16384, 0]),
        ([0, 0, 0], [0, 0, 0]),
    ] {
        raw.clear();
        core.contract.results(&operands, 0, &mut raw);
        assert_eq!(raw, expected, "{operands:?}");
    }
    let core = default(device("dot-product"));
    for (operands, expected) in [
        // (3, 0, 4)/5·(1, 0, 0) = 0.6, of any length, in 2^-14 9830.4; the other way round it is 0; beyond 1 it is 1.
        ([3, 0, 4, 16384, 0, 0], 9830),
        ([12288, 0, 16384, 16384, 0, 0], 9830),
        ([-8192, 8192, 0, 16384, 0, 0], 0),
        ([0, 0, 0, 16384, 0, 0], 0),
        ([16384, 16384, 0, 16384, 16384, 0], 16384),
    ] {
        raw.clear();
        core.contract.results(&operands, 0, &mut raw);
        assert_eq!(raw, [expected], "{operands:?}");
    }
}

fn without_keys(device: &'static str) -> Schema {
    Schema { device, keys: vec![], check: |_, _| {} }
}

/// A sum of two points, this and the one before.
struct Sum;

impl Formula for Sum {
    fn exact(&self, x: &[f64]) -> Vec<f64> {
        vec![x[0]]
    }
}

fn sum_model(shows: bool) -> device::Device {
    let mut frame = Frame::default();
    let x = frame.operand("x", Format::unsigned(8, 0));
    let before = frame.register("earlier", Format::unsigned(8, 0));
    let sum = frame.register("sum", Format::unsigned(9, 0));
    frame.shows("sum_out", sum);
    let add = execute(move |s| {
        s[sum] = s[before] + s[x];
        s[before] = s[x];
    });
    let result = if shows { idle().valid() } else { idle() };
    frame.device([idle(), add, result.end()])
}

/// Describes a device that adds its operand to the operand of the computation before.
fn describe_sum(d: &Designer, _: &Config) {
    let x = d.operand("x", Format::unsigned(8, 0)).q();
    let before = d.register("earlier", Format::unsigned(8, 0));
    let sum = d.register("sum", Format::unsigned(9, 0));
    sum.takes(d.add("both", before.q(), x));
    before.takes(x);
    d.output("sum_out", sum.q());
    let add = step("add", [sum.load(), before.load()]);
    d.microprogram([step("idle", []), add, step("result", [valid(), end()])]);
}

/// Every command builds the core first.
#[test]
fn results_that_depend_on_the_past_and_results_that_never_come_are_refused() {
    let sum = Device {
        name: "sum",
        summary: "",
        schema: || without_keys("sum"),
        parts: |_| {
            Ok(Arc::new(KeyParts {
                describe: describe_sum,
                model: |_| sum_model(true).model(),
                contract: |_| sum_model(true).contract(Sum),
            }))
        },
        proved: false,
    };
    let silent = Device {
        parts: |_| {
            Ok(Arc::new(KeyParts {
                describe: describe_sum,
                model: |_| sum_model(true).model(),
                contract: |_| sum_model(false).contract(Sum),
            }))
        },
        ..sum
    };
    for (device, expected) in [
        (
            sum,
            "`sum_out` depends on the value that `earlier` had before the computation; load `earlier`",
        ),
        (silent, "shows no result within"),
    ] {
        let config = Config::defaults(&(device.schema)(), "sum");
        let Err(error) = Core::new(device, config) else { panic!("{expected}: accepted") };
        let text = format!("{error:#}");
        assert!(text.contains(expected), "{text}");
    }
}

/// A formula that has this value from x = 5 on, and the operand below.
struct Missing(f64);

impl Formula for Missing {
    fn exact(&self, x: &[f64]) -> Vec<f64> {
        vec![if x[0] < 5.0 { x[0] } else { self.0 }]
    }

    fn terms(&self, _output: usize) -> Vec<Term> {
        vec![Term { key: "width", what: "nothing", units: 0.0 }]
    }
}

/// A formula with more values than there are outputs.
struct Two;

impl Formula for Two {
    fn exact(&self, x: &[f64]) -> Vec<f64> {
        vec![x[0]; 2]
    }
}

fn copying() -> device::Device {
    let mut frame = Frame::default();
    let x = frame.operand("x", Format::unsigned(4, 0));
    let copy = frame.register("copy", Format::unsigned(4, 0));
    frame.shows("copy_out", copy);
    frame.device([idle(), execute(move |s| s[copy] = s[x]), idle().valid().end()])
}

/// Returns the parts of a device that copies its operand, with this contract.
fn copying_parts(contract: fn(&Config) -> Box<dyn Contract>) -> PartsResult {
    fn describe(d: &Designer, _: &Config) {
        let x = d.operand("x", Format::unsigned(4, 0)).q();
        let copy = d.register("copy", Format::unsigned(4, 0));
        copy.takes(x);
        d.output("copy_out", copy.q());
        let load = step("load", [copy.load()]);
        d.microprogram([step("idle", []), load, step("result", [valid(), end()])]);
    }
    Ok(Arc::new(KeyParts { describe, model: |_| copying().model(), contract }))
}

/// No comparison of an error takes a reference that is no finite number for one that is met.
#[test]
fn a_reference_without_a_value_is_a_failure_everywhere() {
    let of_nan = Device {
        name: "copy",
        summary: "",
        schema: || without_keys("copy"),
        parts: |_| copying_parts(|_| copying().contract(Missing(f64::NAN))),
        proved: true,
    };
    let infinite = Device {
        parts: |_| copying_parts(|_| copying().contract(Missing(f64::INFINITY))),
        ..of_nan
    };
    let config = || Config::defaults(&(of_nan.schema)(), "copy");
    for device in [of_nan, infinite] {
        let core = Core::new(device, config()).expect("a device");
        let contract = core.contract.as_ref();
        assert_eq!(contract.largest_error(&[3]), 0.0);
        assert_eq!(contract.largest_error(&[5]), f64::INFINITY);

        let outcome = core.lockstep(1).and_then(|it| it.run(500, &|_| ())).expect("a run");
        for bound in [
            contract.bounds(),
            Bounds::alike(f64::INFINITY, &Bound::of(Vec::new()), contract.outputs()),
        ] {
            let failures = outcome.failures(&bound).concat();
            let expected =
                "the formula has no finite value for `copy_out` at the raw operands x = ";
            assert!(failures.starts_with(expected), "{failures}");
        }

        let places = Places::of_f(contract);
        let peak = places.check(0..places.blocks(), &|_| ());
        let proof = Proof::new(contract, peak, Peak::NONE);
        assert_eq!(proof.failures, ["the formula has no finite value at the raw operands x = 5"]);
        assert_eq!(proof.verdict(contract, places.sweep()), "FAILS");
        // JSON has no infinite number.
        let kept = serde_json::to_string(&peak).expect("JSON");
        assert_eq!(serde_json::from_str::<Peak>(&kept).expect("a peak"), peak);

        let worst = search::worst(contract, 4, 1, &|| ()).expect("starts");
        assert_eq!((worst.units, worst.operands[0] >= 5), (f64::INFINITY, true));

        for id in ["lockstep", "contract"] {
            assert_eq!(finding(&core, id, EFFORT).verdict, CheckVerdict::Failed, "{id}");
        }
    }
    let two = Device { parts: |_| copying_parts(|_| copying().contract(Two)), ..of_nan };
    let error = Core::new(two, config()).err().expect("a value too many");
    assert!(format!("{error:#}").contains("2 values for 1 outputs"), "{error:#}");
    // A bound that is no number limits nothing.
    let term = |units| Term { key: "width", what: "it", units };
    assert!(!Bound::of(vec![term(1.0), term(f64::NAN)]).is_stated());
}

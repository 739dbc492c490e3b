//! Compares the golden model with the simulation for every combination of operands, in the narrow configurations of
//! `configs/reduced`, and tests the report of a difference. The devices `dot-product`, `normaliser` and `shading` have no
//! narrow configuration.
//!
//! A default run takes a quarter of the combinations (`tests/kinds.toml`).

use std::collections::BTreeSet;
use std::env;
use std::ffi::OsString;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::Arc;

use crate::common::cores::{configuration, configuration_with, device};
use crate::common::files::{paths, read};
use crate::common::sample::sampled;
use glint::config::Config;
use glint::core::Core;
use glint::cosim::exhaustive::{Clocks, Difference, Job, MOST_BITS, Proof, Shard, ShardState};
use glint::devices;
use glint::golden::{self, Model};
use glint::registry::{Device, KeyParts, Registry};
use serde_json::Value;

const NARROW: &str = "configs/reduced/quadratic.toml";

/// Makes a pipeline of it.
const PIPELINED: &str = "architecture = \"pipelined\"\n";

/// Operands, with what they must be for a model to err.
type Aim = &'static [(&'static str, u64)];

/// All operands of `quadratic`: one combination, and one whose cosine no other is clamped to.
const ONE: Aim = &[("exponent", 13), ("cos_gamma", 200), ("red", 2), ("green", 1), ("blue", 3)];

/// 64 combinations: those of all colours.
const SOME: Aim = &[("exponent", 13), ("cos_gamma", 200)];

/// A golden model that is wrong in the lowest bit of `red_out` for the operands that it aims at.
struct Wrong {
    inner: Box<dyn Model>,
    /// The registers of operands among the values, and what they must hold.
    aim: Vec<(usize, u64)>,
    valid: usize,
    red: usize,
    values: Vec<u64>,
}

impl Wrong {
    fn new(inner: Box<dyn Model>, aim: Aim) -> Self {
        let signals = inner.signals();
        let at = |name: &str| {
            let at = signals.iter().position(|signal| signal == name);
            at.unwrap_or_else(|| panic!("no {name}"))
        };
        Self {
            aim: aim.iter().map(|(name, bits)| (at(&format!("{name}_reg")), *bits)).collect(),
            valid: at("valid"),
            red: at("red_out"),
            values: inner.values().to_vec(),
            inner,
        }
    }
}

impl Clone for Wrong {
    fn clone(&self) -> Self {
        Self {
            inner: self.inner.boxed_clone(),
            aim: self.aim.clone(),
            values: self.values.clone(),
            ..*self
        }
    }
}

impl Model for Wrong {
    fn inputs(&self) -> &[String] {
        self.inner.inputs()
    }
    fn signals(&self) -> &[String] {
        self.inner.signals()
    }
    fn clock(&mut self, inputs: &[u64]) {
        self.inner.clock(inputs);
        self.values.copy_from_slice(self.inner.values());
        let aimed = |&(at, bits): &(usize, u64)| self.values[at] == bits;
        if self.values[self.valid] == 1 && self.aim.iter().all(aimed) {
            self.values[self.red] ^= 1;
        }
    }
    fn values(&self) -> &[u64] {
        &self.values
    }
}

/// Returns the job of a configuration whose model is wrong.
fn job(core: &Core, aim: Aim) -> Job<'_> {
    let model = Wrong::new(core.opened.golden(), aim);
    let contract = core.contract.as_ref();
    let clocks = Clocks::new(&core.design, Box::new(model), contract).expect("they fit");
    Job::new(contract).with(clocks)
}

/// Returns a shard, broken off and resumed after every look.
fn done(job: &Job<'_>, shard: Shard) -> ShardState {
    let mut state = ShardState::new("digest", shard);
    while job.remaining(&state) > 0 {
        let text = serde_json::to_string(&state).expect("a state");
        state = serde_json::from_str(&text).expect("a state");
        let _ = job
            .run(&mut state, &|_| (), &mut |_| ControlFlow::Break(()))
            .expect("it can be simulated");
    }
    state
}

/// Returns a job without a break.
fn whole(job: &Job<'_>) -> ShardState {
    part(job, Shard::WHOLE)
}

/// Runs a shard without a break.
fn part(job: &Job<'_>, shard: Shard) -> ShardState {
    let mut state = ShardState::new("digest", shard);
    let end = job.run(&mut state, &|_| (), &mut |_| ControlFlow::Continue(()));
    assert_eq!(end.expect("it can be simulated"), ControlFlow::Continue(()));
    state
}

/// In how many parts combinations are gone through.
const PARTS: u64 = 4;

/// Returns the parts that a run takes.
fn parts(kind: &str) -> Vec<Shard> {
    sampled(kind, (1..=PARTS).map(|number| Shard { number, of: PARTS }))
}

#[test]
fn every_combination_of_every_device_agrees() {
    let parts = parts("combinations");
    let mut devices = BTreeSet::new();
    for path in paths("configs/reduced", ".toml") {
        let core = configuration(&path);
        let job = core.job().expect("they fit");
        let clocks = job.clocks.as_ref().expect("combinations");
        let bits: u32 =
            (core.contract.operands().iter()).map(|operand| operand.format.width()).sum();
        assert!(bits <= MOST_BITS && clocks.bits() == bits, "{path}: {bits}");
        assert_eq!(clocks.count(), 1 << bits, "{path}");
        for shard in &parts {
            let state = part(&job, *shard);
            let difference = state.clocks.differs.map(|place| clocks.difference(place));
            assert!(difference.is_none(), "{path}: {difference:?}");
            let proof = Proof::new(core.contract.as_ref(), state.f.peak, state.colours.peak);
            assert!(proof.failures.is_empty(), "{path}: {:?}", proof.failures);
        }
        devices.insert(core.device().name);
    }
    let catalogue = Registry::catalogue();
    let mut all: BTreeSet<&str> = catalogue.devices().iter().map(|device| device.name).collect();
    all.insert("expression");
    assert_eq!(devices, all);
}

/// Pipelines too; the stages are those of the narrow configuration.
#[test]
fn every_combination_of_every_pipeline_agrees() {
    let parts = parts("combinations of pipelines");
    let mut pipelines = 0;
    for path in paths("configs/reduced", ".toml") {
        let sequential = configuration(&path);
        if sequential.contract.length().is_some() {
            continue;
        }
        let core = configuration_with(&path, PIPELINED);
        assert!(core.design.pipeline.is_some(), "{path}");
        let clocks = core.clocks().expect("they fit");
        assert_eq!(clocks.count(), sequential.clocks().expect("they fit").count(), "{path}");
        let mine = |block: &u64| parts.iter().any(|it| block % it.of + 1 == it.number);
        let blocks = (0..clocks.blocks()).filter(mine).collect();
        let differs = clocks.check(blocks, &|_| ()).expect("it can be simulated");
        let difference = differs.map(|place| clocks.difference(place));
        assert!(difference.is_none(), "{path}: {difference:?}");
        pipelines += 1;
    }
    assert_eq!(pipelines, 10);
}

/// Returns the combination of which a model errs, in a pipeline: found, had again, and no other.
/// The one combination that differs; no other does.
fn the_one(core: &Core) -> Difference {
    let job = job(core, ONE);
    let clocks = job.clocks.as_ref().expect("combinations");
    let place = whole(&job).clocks.differs.expect("it differs");
    let found = clocks.difference(place).expect("it can be had again");
    for (name, bits) in ONE {
        let operand = found.operands.iter().find(|(operand, _)| operand == name);
        assert_eq!(operand.map(|(_, bits)| bits), Some(bits), "{found:?}");
    }
    assert_eq!((found.place, found.mismatch.signal.as_str()), (place, "red_out"));
    let block = place / (clocks.count() / clocks.blocks());
    let others = (0..clocks.blocks()).filter(|&other| other != block);
    assert_eq!(clocks.check(others.collect(), &|_| ()).expect("checked"), None);
    assert!(clocks.difference(place + 1).is_err());
    found
}

#[test]
fn a_fault_that_one_combination_of_a_pipeline_shows_is_found() {
    let core = configuration_with(NARROW, PIPELINED);
    // It shows when the point is at the end.
    let latency = core.design.pipeline.as_ref().expect("a pipeline").stages.len();
    assert_eq!(the_one(&core).clock, latency as u64 - 1);
}

#[test]
fn a_fault_that_one_combination_shows_is_found() {
    let found = the_one(&configuration(NARROW));
    assert_eq!(found.mismatch.golden ^ found.mismatch.simulated, 1);
    // Microinstruction 3 is the result's. It begins with the edge that ends 2, three clocks after that of `start`.
    assert!(found.mismatch.during.starts_with("microinstruction `intensity"), "{found:?}");
    assert_eq!(found.clock, 3);
}

#[test]
fn the_first_difference_is_the_same_however_the_work_is_divided() {
    let core = configuration(NARROW);
    let job = job(&core, SOME);
    let clocks = job.clocks.as_ref().expect("combinations");
    let whole = whole(&job);
    let first = whole.clocks.differs;
    let alone = (0..clocks.blocks()).filter_map(|block| {
        let found = clocks.check(vec![block], &|_| ());
        found.expect("checked")
    });
    assert!(first.is_some());
    assert_eq!(alone.min(), first);
    assert_eq!(done(&job, Shard::WHOLE), whole);
    for of in [2, 3, 500] {
        let shards = (1..=of).map(|number| done(&job, Shard { number, of }));
        let shards: Vec<ShardState> = shards.collect();
        let names: Vec<String> = (1..=of).map(|number| number.to_string()).collect();
        assert_eq!(job.merge(&shards, &names).expect("merged"), whole);
    }
}

/// `quadratic` with a model that is wrong for some combinations.
fn wrong_device() -> Device {
    fn model(config: &Config) -> Box<dyn Model> {
        Box::new(Wrong::new(golden::quadratic::model(config), &[("exponent", 13)]))
    }
    Device {
        parts: |_| {
            Ok(Arc::new(KeyParts {
                describe: devices::quadratic::describe,
                model,
                contract: golden::quadratic::contract,
            }))
        },
        ..device("quadratic")
    }
}

/// Says to the test below that it is the command line of the wrong device, which it starts.
const ARGUMENTS: &str = "GLINT_ARGUMENTS";

/// The command line of the wrong device.
fn program(arguments: &str) {
    let arguments = arguments.split(' ').map(OsString::from);
    let registry = Registry::empty().with(wrong_device());
    let code = glint::cli::run_from(&registry, arguments);
    assert_ne!(format!("{code:?}"), format!("{:?}", std::process::ExitCode::SUCCESS));
}

/// Runs the wrong device's command line, and returns its output.
fn wrong(directory: &Path, arguments: &str) -> String {
    let program = env::current_exe().expect("this program");
    let mut command = Command::new(program);
    let test = "combinations::a_difference_leaves_all_that_it_takes_to_have_it_again";
    command.args(["--exact", test, "--nocapture"]);
    command.env(ARGUMENTS, arguments);
    let Output { status, stdout, stderr } =
        command.current_dir(directory).output().expect("it runs");
    let text = String::from_utf8(stdout).expect("UTF-8");
    let errors = String::from_utf8_lossy(&stderr);
    assert!(status.success(), "{arguments}: {text}{errors}");
    text
}

/// Returns the JSON among what the test program prints.
fn json(text: &str) -> Value {
    let (from, to) = (text.find('{'), text.rfind('}'));
    let text = &text[from.expect("JSON")..=to.expect("JSON")];
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

#[test]
fn a_difference_leaves_all_that_it_takes_to_have_it_again() {
    if let Ok(arguments) = env::var(ARGUMENTS) {
        return program(&arguments);
    }
    let place = tempfile::tempdir().expect("a directory");
    let narrow = fs::read(NARROW).expect("a configuration");
    fs::write(place.path().join("core.toml"), narrow).expect("written");

    let run = json(&wrong(place.path(), "glint cosim core.toml --json --seed 3"));
    let one = &run["configurations"][0]["mismatch"];
    let text = |value: &Value, key: &str| value[key].as_str().expect(key).to_owned();
    let bits = |value: &Value, key| {
        let text = text(value, key);
        u64::from_str_radix(text.strip_prefix("0x").expect("hexadecimal"), 16).expect("a number")
    };
    assert_eq!((run["ok"].as_bool(), text(one, "signal").as_str()), (Some(false), "red_out"));
    assert_eq!(bits(one, "golden") ^ bits(one, "simulated"), 1);
    assert!(text(one, "during").starts_with("microinstruction `intensity"), "{one}");
    let vcd = read(place.path().join(text(one, "vcd")));
    assert!(vcd.contains("red_out"), "{vcd}");
    // The command that it names finds the same, alone.
    let again = text(one, "reproduce").replace("FILE", "all.vcd");
    let (seed, clock) = (one["seed"].as_u64(), one["clock"].as_u64());
    let said = wrong(place.path(), &again);
    let wanted = format!(
        "seed {}, after clock {}, microinstruction `intensity",
        seed.expect("a seed"),
        clock.expect("a clock")
    );
    assert!(said.contains(&wanted), "{said}");
    assert!(place.path().join("all.vcd").exists());

    let run = json(&wrong(place.path(), "glint cosim core.toml --json --exhaustive"));
    let found = &run["configurations"][0];
    let one = &found["clocks"]["mismatch"];
    assert_eq!((&found["holds"], &one["seed"]), (&Value::Bool(false), &Value::Null));
    assert_eq!(one["operands"]["exponent"], "0xd");
    assert_eq!(
        (text(one, "signal").as_str(), one["clock_of_computation"].as_u64()),
        ("red_out", Some(3))
    );
    assert_eq!(bits(one, "golden") ^ bits(one, "simulated"), 1);
    let said = wrong(place.path(), &text(one, "reproduce"));
    assert!(said.contains(&format!("combination {} (exponent=0xd ", one["combination"])), "{said}");
    assert!(said.contains("`quadratic_reduced_mismatch.vcd` shows clocks "), "{said}");
}

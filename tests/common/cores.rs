//! Loads configurations for tests, builds their cores, and emits their files.

use std::fs;
use std::path::Path;

use glint::config::{self, Config, Value};
use glint::core::Core;
use glint::cosim::batch::{Engine, Golden, Points, RustHdl};
use glint::cosim::{Outcome, trial};
use glint::keys::presets;
use glint::package::{Computation, FileKind, OutputFile, OutputFiles, driver};
use glint::registry::{Device, OpenedConfig, Registry};
use tempfile::TempDir;

use super::Sure;
use super::files::{paths, put, read};

/// Pairs of a plain file name and contents.
pub type Files = Vec<(String, String)>;

/// Returns the configurations in `configs/` and `configs/studies/` that have a microprogram, by path, sorted.
///
/// # Panics
/// There are none, or one of them is wrong.
pub fn configurations() -> Vec<(String, Core)> {
    let sequential = |(_, core): &(String, Core)| core.design.pipeline.is_none();
    all_configurations().into_iter().filter(sequential).collect()
}

/// Returns those that are pipelines, by path, sorted.
///
/// # Panics
/// One of them is wrong, or there are others than are known.
pub fn pipelines() -> Vec<(String, Core)> {
    let pipelined = |(_, core): &(String, Core)| core.design.pipeline.is_some();
    let found: Vec<_> = all_configurations().into_iter().filter(pipelined).collect();
    assert_eq!(found.len(), 13, "pipelines");
    found
}

/// Returns the configurations in `configs/` and `configs/studies/`, pipelines too, by path, sorted.
///
/// # Panics
/// There are none, or one of them is wrong.
pub fn all_configurations() -> Vec<(String, Core)> {
    let mut all = ["configs", "configs/studies"].map(|it| paths(it, ".toml")).concat();
    all.sort();
    let with_unit = |path: String| {
        let core = configuration(&path);
        (path, core)
    };
    all.into_iter().map(with_unit).collect()
}

/// Returns the configuration of that path.
///
/// # Panics
/// It is wrong.
pub fn configuration(path: &str) -> Core {
    let (opened, _) = Registry::shipped().read(Path::new(path)).sure();
    Core::build(opened).sure_of(path)
}

/// Returns the device of that name.
///
/// # Panics
/// There is none.
pub fn device(name: &str) -> Device {
    *Registry::shipped().device(name).unwrap_or_else(|| panic!("no device {name}"))
}

/// Returns the core of a device with its defaults.
///
/// # Panics
/// There is none.
pub fn default(device: Device) -> Core {
    Core::new(device, device.defaults()).sure()
}

/// Returns the configuration of that path with more TOML: a table, whose keys join those that the file has of it.
///
/// # Panics
/// It is wrong.
pub fn configuration_with(path: &str, more: &str) -> Core {
    let text = read(path);
    let text = match more.trim_start().split_once("]\n") {
        Some((heading, keys)) if text.contains(&format!("\n{heading}]\n")) => {
            let heading = format!("\n{heading}]\n");
            text.replacen(&heading, &format!("{heading}{keys}"), 1)
        }
        _ => format!("{text}{more}"),
    };
    parsed(path, &text)
}

/// Returns the configuration of that path with other TOML in place of its tables `package` and `interface`, which stand last.
///
/// # Panics
/// It is wrong.
pub fn configuration_between(path: &str, interface: &str) -> Core {
    let text = read(path);
    let own = text.split("\n[interface]\n").next().unwrap_or_default();
    let own = own.split("\n[package]\n").next().unwrap_or_default();
    parsed(path, &format!("{own}\n[interface]\n{interface}"))
}

/// Returns the configuration that a text states, by the name of its file.
///
/// # Panics
/// It is wrong.
pub fn parsed(path: &str, text: &str) -> Core {
    let (opened, _) = Registry::shipped().parse(path, text).sure();
    Core::build(opened).sure_of(path)
}

/// Returns the core of a preset, such as `sincos`, with this name and with the value `architecture`, such as `pipelined`.
///
/// # Panics
/// There is no such preset, or it has no such core.
pub fn preset(name: &str, architecture: &str) -> Core {
    let preset = presets::find(name).unwrap_or_else(|| panic!("no preset `{name}`"));
    let device = device(preset.device);
    let mut config = Config::defaults(&(device.schema)(), name);
    for (key, value) in preset.values {
        config.set(&key, value);
    }
    config.set("architecture", Value::Text(architecture.to_owned()));
    Core::new(device, config).sure_of(name)
}

/// Returns the core of a device, of the catalogue or changed, by its defaults and more keys, as TOML.
///
/// # Errors
/// It has no such core.
///
/// # Panics
/// The keys are wrong.
pub fn with_keys(device: Device, more: &str) -> anyhow::Result<Core> {
    let text = format!("device = \"{}\"\n{more}", device.name);
    let config = config::parse("core.toml", &text, &[(device.schema)()]);
    Core::new(device, config.sure())
}

/// Returns the computations that are listed of a core.
///
/// # Panics
/// Golden model and simulation differ.
pub fn computations(core: &Core) -> Vec<Computation> {
    let listed = trial::computations(&core.design, core.contract.as_ref());
    listed.expect("computations that agree with the golden model")
}

/// Returns what comes of golden model and simulation, side by side.
///
/// # Panics
/// The design cannot be simulated.
pub fn run(core: &Core, points: u64, seed: u64, what: &str) -> Outcome {
    core.lockstep(seed).and_then(|it| it.run(points, &|_| ())).sure_of(what)
}

/// # Panics
/// Golden model and simulation differ, or an error is beyond the bound.
pub fn assert_agrees(core: &Core, points: u64, seed: u64, what: &str) {
    let outcome = run(core, points, seed, what);
    assert!(outcome.mismatch.is_none(), "{what}: {:?}", outcome.mismatch);
    assert_eq!(outcome.points, points, "{what}");
    assert!(outcome.worst.is_some(), "{what}: no error was measured");
    let failures = outcome.failures(&core.contract.bounds());
    assert!(failures.is_empty(), "{what}: {failures:?}");
}

/// Returns a valid configuration drawn at random, as TOML for messages, and its unit.
///
/// # Panics
/// The description does not make a design of it.
pub fn random(device: Device, seed: u64) -> (String, Core) {
    let opened = sample(device, seed);
    let toml = opened.config.to_toml(&(device.schema)());
    let toml = format!("{}, seed {seed}\n{toml}", device.name);
    let core = Core::build(opened).unwrap_or_else(|error| panic!("{error:?}\n{toml}"));
    (toml, core)
}

/// Returns a configuration that is drawn at random and that the device can have.
///
/// # Panics
/// The ranges of the schema allow too few such configurations.
pub fn sample(device: Device, seed: u64) -> OpenedConfig {
    let refusal = |config: &Config| device.open(config.clone()).err();
    let config = config::sample(&(device.schema)(), seed, &refusal);
    device.open(config).sure()
}

/// The files of a configuration whose bench runs over so many points.
pub struct Emitted {
    /// Everything, as it would be written.
    pub files: OutputFiles,
    /// The name of the top module.
    pub name: String,
}

impl Emitted {
    /// # Panics
    /// Golden model and built-in simulator differ, or the design cannot be written.
    pub fn new(core: &Core, points: u64, seed: u64) -> Self {
        let name = core.config().name.clone();
        let files = core
            .vectors(points, seed)
            .and_then(|vectors| core.files(&format!("configs/{name}.toml"), vectors))
            .sure_of(&name);
        Self { files, name }
    }

    /// Returns the module that tests the device.
    pub fn bench(&self) -> String {
        format!("{}_tb", self.name)
    }

    /// Verilog and memories of the device, without its bench.
    pub fn rtl(&self) -> Files {
        self.files.sources(FileKind::DESIGN_SOURCES)
    }

    /// Returns the files for a family of FPGAs, its own in place of portable ones.
    pub fn rtl_for(&self, family: &str) -> Files {
        self.files.sources_for(FileKind::DESIGN_SOURCES, family)
    }

    /// Verilog and memories of the device and of its bench.
    pub fn simulated(&self) -> Files {
        self.files.sources(FileKind::SIMULATED)
    }

    /// Returns all files and the driver of the benches in Python in a directory, each where it would be written.
    pub fn tree(&self) -> TempDir {
        let dir = tempfile::tempdir().expect("a directory");
        for file in self.files.iter().chain([&driver()]) {
            put(dir.path().join(&file.path), &file.contents);
        }
        dir
    }

    /// Returns the files of one folder beside each other in a directory. For example, the folder `rtl_out`.
    pub fn beside(&self, folder: &str) -> TempDir {
        side_by_side(self.files.iter().filter(|file| file.kind.folder() == folder))
    }

    /// Returns the files of all folders beside each other in a directory.
    pub fn all_beside(&self) -> TempDir {
        side_by_side(self.files.iter())
    }
}

/// Writes files beside each other into a directory. A form of a file for one target has the name of the form for all targets,
/// and is left out.
fn side_by_side<'a>(files: impl Iterator<Item = &'a OutputFile>) -> TempDir {
    let dir = tempfile::tempdir().expect("a directory");
    for file in files {
        if file.target.is_none() {
            fs::write(dir.path().join(file.name()), &file.contents).expect("written");
        }
    }
    dir
}

/// Writes files into a directory.
///
/// # Panics
/// It cannot be done.
pub fn write(directory: &Path, files: &Files) {
    for (name, contents) in files {
        fs::write(directory.join(name), contents).sure_of(name);
    }
}

/// Returns every combination of raw operands in the formats of their ports.
fn all_points(core: &Core) -> Points {
    let operands = core.contract.operands();
    let mut combinations: Vec<Vec<i64>> = vec![Vec::new()];
    for operand in operands {
        let (low, high) = operand.format.range();
        let mut longer = Vec::new();
        for combination in &combinations {
            for raw in low..=high {
                longer.push([&combination[..], &[raw as i64]].concat());
            }
        }
        combinations = longer;
    }
    let mut points = Points::new(operands.len());
    for combination in combinations {
        points.push(combination, 1);
    }
    points
}

/// Checks that the simulation gives the results that the contract states, for every combination of raw operands in the formats of
/// their ports, also outside the domains.
///
/// # Panics
/// A result differs, or the core cannot be simulated.
pub fn assert_results_as_stated(core: &Core, what: &str) {
    let points = all_points(core);
    let stated = Golden(&*core.contract).compute(&points).expect("results");
    let mut simulator = RustHdl::new(&core.design, &*core.contract).expect("a simulator");
    let simulated = simulator.compute(&points).expect("a simulation");
    let outputs = core.contract.outputs().len();
    for at in 0..points.len() {
        let results = at * outputs..(at + 1) * outputs;
        let operands = points.operands(at);
        assert_eq!(simulated[results.clone()], stated[results], "{operands:?}: {what}");
    }
}

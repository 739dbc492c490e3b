//! [`Core`]: a configuration of a device with its design and its contract, and everything that is made of them: Verilog
//! and other files, digests, timing, bench vectors, and the jobs of co-simulation and proof.

use std::path::Path;

use anyhow::{Context, Result};

use crate::cosim::exhaustive::{Backing, Clocks, Job, Places};
use crate::cosim::{Lockstep, directed, trial};
use crate::package::{
    self, ContractFacts, EmitInputs, LineClocks, OutputFile, Surroundings, Timing, Vectors,
    WorkedExample,
};
use crate::registry::Device;
use glint_base::input;
use glint_base::program::Program;
use glint_config::{Config, Key};
use glint_golden::{Contract, Sweep};
use glint_rtl::netlist::Design;

/// Results that the main job and `cosim` check of each configuration, unless told otherwise: the default
/// test.
pub const TEST_POINTS: u64 = 100_000;

/// The seed of the default test.
pub const TEST_SEED: u64 = 1;

/// Computations at random at the beginning of the shipped bench, with all that the handshake allows; of lines so
/// many times [`BENCH_LINE`] results.
const BENCH_POINTS: u64 = 64;

/// The results of a line there, at most.
const BENCH_LINE: i64 = 6;

/// Points of the shipped bench of a pipeline, which takes one a clock.
const PIPELINE_POINTS: u64 = 2000;

/// The seed of the stimulus of benches.
pub const BENCH_SEED: u64 = 1;

/// A configuration with everything that is made of it.
pub struct Core {
    /// The device.
    pub device: Device,
    /// Its configuration.
    pub config: Config,
    /// The design that the description makes of it.
    pub design: Design,
    /// The accuracy contract.
    pub contract: Box<dyn Contract>,
}

impl Core {
    /// Builds and checks the design.
    ///
    /// # Errors
    /// The mistakes of the description; results that depend on earlier ones, or that the contract's model never shows;
    /// constraints with a clock that the pipeline is not made for; a style of ROMs that there are not; a program that recomputes a
    /// contract without a formula of one operand.
    pub fn new(device: Device, config: Config) -> Result<Self> {
        let design = device
            .design(&config)
            .with_context(|| format!("the description of `{}` is wrong", device.name))?;
        if let Some(pipeline) = &design.pipeline {
            package::check_clock(&config, pipeline)?;
        }
        package::check_rom_style(&config, &design)?;
        device.check_golden(&config)?;
        let contract = (device.contract)(&config);
        device.check_contract(&config, &design, contract.as_ref())?;
        let asked = Surroundings::new(&config, design.pipeline.as_ref());
        if asked.software && asked.recomputation {
            package::check_recomputation(&design.name, &ContractFacts::new(contract.as_ref()))?;
        }
        Ok(Self { device, config, design, contract })
    }

    /// Tells this configuration, and version of Glint, from others: SHA-256 in hexadecimal.
    pub fn digest(&self) -> String {
        let text = self.config.to_toml(&(self.device.schema)());
        package::digest(format!("{}\n{text}", env!("CARGO_PKG_VERSION")).as_bytes())
    }

    /// Tells what a proof of the accuracy contract depends on from others: the device, and its own keys that are not at
    /// their defaults. A key that comes later, at its default, leaves the digest as it is. SHA-256 in hexadecimal.
    pub fn contract_digest(&self) -> String {
        self.digest_of((self.device.schema)().keys.iter())
    }

    /// Returns the evidence for the contract's bound; `proofs` is the directory of records.
    ///
    /// # Errors
    /// A record that cannot be read.
    pub fn backing(&self, proofs: &Path) -> Result<Backing> {
        if self.device.proved {
            return Ok(Backing::Catalogue);
        }
        Backing::of_records(proofs, &self.contract_digest(), self.contract.as_ref())
    }

    /// Tells this core, whatever its name, from others: as [`Core::contract_digest`], with the architecture. What stands around
    /// the core and beside it makes no other core.
    pub fn core_digest(&self) -> String {
        let schema = (self.device.schema)();
        let around = |key: &&Key| ["interface", "package"].contains(&key.table_and_leaf().0);
        self.digest_of(schema.all_keys().filter(|key| !around(key)))
    }

    fn digest_of<'k>(&self, keys: impl Iterator<Item = &'k Key>) -> String {
        let schema = (self.device.schema)();
        let mut text = format!("device = {}\n", self.device.name);
        for key in keys {
            let value = self.config.value(key.name);
            if *value != key.default && self.config.applies(&schema, key.name) {
                text += &format!("{} = {}\n", key.name, value.toml());
            }
        }
        package::digest(text.as_bytes())
    }

    /// Tells what a proof of this configuration goes through and computes from others: the configuration, the sweep, the
    /// sources of everything that takes part, and what a spread of places gives, which also notices a
    /// golden model outside this crate that was changed. The same on every machine.
    pub fn fingerprint(&self, sweep: &Sweep) -> String {
        let contract = self.contract.as_ref();
        let places = [Places::of_sweep(contract, sweep.clone()), Places::of_colours(contract)];
        let seen: Vec<String> = places
            .iter()
            .map(|places| places.glimpse().iter().map(|error| format!("{error:e} ")).collect())
            .collect();
        let axes = format!("{:?}", sweep.axes);
        let sources = env!("GLINT_SOURCES").to_owned();
        let text = [self.digest(), sources, axes, seen.concat()].join("\n");
        package::digest(text.as_bytes())
    }

    /// Pairs the golden model with the built-in simulator, for runs whose stimuli are drawn from `seed`.
    ///
    /// # Errors
    /// Model and design do not name the same signals.
    pub fn lockstep(&self, seed: u64) -> Result<Lockstep<'_>> {
        self.lockstep_of(&self.design, seed)
    }

    /// Pairs the golden model with another design of its ports and registers: a mutant, say.
    ///
    /// # Errors
    /// Model and design do not name the same signals.
    pub fn lockstep_of<'a>(&'a self, design: &'a Design, seed: u64) -> Result<Lockstep<'a>> {
        let model = self.device.golden(&self.config);
        Lockstep::new(design, model, self.contract.as_ref(), seed)
    }

    /// Returns the exhaustive check: the proof of the contract and, where they are not too many, every
    /// combination of operands clock by clock.
    ///
    /// # Errors
    /// Model and design do not name the same signals.
    pub fn job(&self) -> Result<Job<'_>> {
        self.job_of(self.contract.sweep())
    }

    /// Returns the job by a sweep with other values than those of the contract.
    ///
    /// # Errors
    /// Model and design do not name the same signals.
    pub fn job_of(&self, sweep: Sweep) -> Result<Job<'_>> {
        Ok(Job::of_sweep(self.contract.as_ref(), sweep).with(self.clocks()?))
    }

    /// Returns every combination of operands, golden model against built-in simulator.
    ///
    /// # Errors
    /// Model and design do not name the same signals.
    pub fn clocks(&self) -> Result<Clocks<'_>> {
        let model = self.device.golden(&self.config);
        Clocks::new(&self.design, model, self.contract.as_ref())
    }

    /// Returns the clocks between the events of the handshake, as [`trial::timing`] measures them.
    ///
    /// # Errors
    /// A device that does not end.
    pub fn timing(&self) -> Result<Timing> {
        trial::timing(&self.design, self.contract.as_ref())
    }

    /// Returns one computation with all its numbers.
    ///
    /// # Errors
    /// A device that does not end.
    pub fn example(&self) -> Result<WorkedExample> {
        trial::example(&self.design, self.contract.as_ref())
    }

    /// Returns the clocks of a line in terms of its length, where the device walks lines.
    ///
    /// # Errors
    /// A device that does not end.
    pub fn line(&self) -> Result<Option<LineClocks>> {
        trial::line(&self.design, self.contract.as_ref())
    }

    /// Returns stimulus and expected outputs for a bench; the golden model and the built-in simulator agree on them.
    ///
    /// # Errors
    /// They do not agree.
    pub fn vectors(&self, points: u64, seed: u64) -> Result<Vectors> {
        self.lockstep(seed)?.record(points, &[])
    }

    /// Returns stimulus and expected outputs of the shipped bench: some computations at random, which show the
    /// handshake, and directed ones, which show the datapath and its tables.
    ///
    /// # Errors
    /// As of [`Core::vectors`].
    pub fn shipped_vectors(&self) -> Result<Vectors> {
        self.shipped_vectors_of(&directed::Known::default())
    }

    /// Returns what [`Core::shipped_vectors`] returns, but takes directed computations that are in `known` already from
    /// there, and adds new ones to it.
    ///
    /// # Errors
    /// As of [`Core::vectors`].
    pub fn shipped_vectors_of(&self, known: &directed::Known) -> Result<Vectors> {
        let contract = self.contract.as_ref();
        // A pipeline has the datapath of the microprogram that it was made of.
        let sequential = self.microprogram(true)?;
        let datapath = sequential.as_ref().unwrap_or(&self.design);
        let directed = known.computations(datapath, contract, &self.contract_digest())?;
        let vectors = if sequential.is_some() {
            self.lockstep(BENCH_SEED)?.record(PIPELINE_POINTS, &directed.operands)
        } else {
            let lockstep = self.lockstep(BENCH_SEED)?.with_lines_of(BENCH_LINE);
            let results = if self.contract.length().is_some() { BENCH_LINE as u64 } else { 1 };
            lockstep.record(BENCH_POINTS * results, &directed.operands)
        };
        Ok(Vectors { word_stride: directed.word_stride, ..vectors? })
    }

    /// Returns the program that recomputes every operand, the model that it includes, and the memories.
    ///
    /// # Errors
    /// A contract that is no formula of one operand.
    pub fn recomputation(&self) -> Result<Vec<OutputFile>> {
        let asked = Surroundings { software: true, recomputation: true, ..Surroundings::default() };
        let inputs = EmitInputs {
            accuracy: Some(ContractFacts::new(self.contract.as_ref())),
            around: asked,
            sequential: self.microprogram(true)?,
            ..EmitInputs::default()
        };
        package::emit(&self.design, &inputs)
    }

    /// Returns of a pipeline the design with the microprogram, if it is wanted.
    fn microprogram(&self, is_wanted: bool) -> Result<Option<Design>> {
        let wanted = is_wanted && self.design.pipeline.is_some();
        Ok(wanted.then(|| self.device.sequential(&self.config)).transpose()?)
    }

    /// Returns every file of the configuration, which the command line knows as `config`, a path; without vectors there are no benches.
    ///
    /// # Errors
    /// Golden model and simulation do not agree, or the design cannot be written as Verilog.
    pub fn files(
        &self,
        config: &str,
        vectors: impl Into<Option<Vectors>>,
    ) -> Result<Vec<OutputFile>> {
        let around = Surroundings::new(&self.config, self.design.pipeline.as_ref());
        let sequential = self.microprogram(around.software)?;
        let inputs = EmitInputs {
            regenerate: format!("{Program} generate {}", input::label(config)),
            configuration: self.digest(),
            timing: self.timing()?,
            example: Some(self.example()?),
            accuracy: Some(ContractFacts::new(self.contract.as_ref())),
            computations: trial::computations(&self.design, self.contract.as_ref())?,
            vectors: vectors.into(),
            around,
            sequential,
        };
        package::emit(&self.design, &inputs)
    }

    /// Returns Verilog and ROM contents alone, pairs of a plain name and contents: what synthesis needs.
    ///
    /// # Errors
    /// The design cannot be written as Verilog.
    pub fn verilog(&self) -> Result<Vec<(String, String)>> {
        self.verilog_for("")
    }

    /// Returns the Verilog for a target, by name, with its own files.
    ///
    /// # Errors
    /// The design cannot be written as Verilog.
    pub fn verilog_for(&self, target: &str) -> Result<Vec<(String, String)>> {
        let around = Surroundings {
            style: Surroundings::new(&self.config, None).style,
            ..Surroundings::default()
        };
        let files = package::emit(&self.design, &EmitInputs { around, ..EmitInputs::default() })?;
        Ok(package::sources_for(files, target))
    }
}

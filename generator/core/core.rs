//! Defines [`Core`]: a configuration of a device, with the netlist and the accuracy contract that Glint builds from it.
//!
//! From these, the methods of [`Core`] make Verilog and other files, digests, timing, bench vectors, and the jobs of
//! co-simulation and exhaustive checks. For example, [`Core::files`] returns every emitted file of the configuration.

use std::path::Path;

use anyhow::Result;

use crate::cosim::exhaustive::{Backing, Clocks, Job, Places};
use crate::cosim::{Lockstep, directed, trial};
use crate::package::{
    self, ContractFacts, EmitInputs, FileKind, HandshakeTiming, InstanceExample, LineClocks,
    OutputFiles, Surroundings, TableImage, Vectors, WorkedExample,
};
use crate::registry::{DesignError, Device, OpenedConfig};
use glint_base::input;
use glint_base::program::Program;
use glint_config::{Config, Key};
use glint_golden::{Contract, Sweep};
use glint_rtl::netlist::Design;

/// The number of results that the default test of a configuration checks. An option of `glint cosim` changes this number.
pub const TEST_POINTS: u64 = 100_000;

pub const TEST_SEED: u64 = 1;

/// The number of random computations at the beginning of a sequential core's emitted bench. The computations use the whole
/// handshake, such as writes while the core is busy. A device with lines computes random lines until they have `BENCH_POINTS` ·
/// [`BENCH_LINE`] results.
const BENCH_POINTS: u64 = 64;

/// The largest number of results of a random line in the emitted bench.
const BENCH_LINE: i64 = 6;

/// The number of random points at the beginning of the emitted bench of a pipeline.
const PIPELINE_POINTS: u64 = 2000;

/// The seed of the random inputs of emitted test benches.
pub const BENCH_SEED: u64 = 1;

/// A configured device: its configuration, netlist and accuracy contract.
pub struct Core {
    pub opened: OpenedConfig,
    /// The netlist, as the device's description builds it.
    pub design: Design,
    /// Operands, formula and error bound.
    pub contract: Box<dyn Contract>,
}

impl Core {
    /// Builds the netlist of a configuration, and checks the netlist and the contract.
    ///
    /// # Errors
    /// Fails in these cases:
    /// - The description has mistakes.
    /// - The pipeline cannot be made.
    /// - A result depends on an earlier computation, the golden model never shows a result, or the formula gives a wrong number
    ///   of values.
    /// - The constraints ask for a faster clock than the pipeline was scheduled for.
    /// - The configuration writes ROMs as functions, and the table of the core can be written.
    /// - The configuration sets `package.rom_style`, and no ROM of the core can have such an attribute.
    /// - The configuration asks for a program that recomputes results, and the contract does not allow one; see
    ///   [`Core::recomputation`].
    /// - The golden model cannot model the output registers or the operand buffers.
    pub fn new(device: Device, config: Config) -> Result<Self> {
        Self::build(device.open(config)?)
    }

    /// Builds the core of a configuration that is already open.
    ///
    /// # Errors
    /// Fails if the netlist cannot be built, or if a check of [`Core::new`] finds a mistake.
    pub fn build(opened: OpenedConfig) -> Result<Self> {
        let design = opened.design();
        Self::of_design(opened, design)
    }

    /// Builds the core of a configuration that states no clock frequency. If the pipeline cannot reach the default frequency,
    /// the core gets the fastest clock that the pipeline can reach.
    ///
    /// Fails if the netlist cannot be built, or if a check of [`Core::new`] finds a mistake.
    pub fn build_with_free_clock(mut opened: OpenedConfig) -> Result<Self> {
        let design = opened.design_with_free_clock();
        Self::of_design(opened, design)
    }

    fn of_design(opened: OpenedConfig, design: Result<Design, DesignError>) -> Result<Self> {
        let OpenedConfig { device, config, .. } = &opened;
        let mut design = match design {
            Ok(design) => design,
            Err(DesignError::Key(error)) => return Err(error.into()),
            Err(DesignError::Description(mistakes)) => {
                let context = format!("the description of `{}` has mistakes", device.name);
                return Err(anyhow::Error::new(mistakes).context(context));
            }
        };
        if let Some(pipeline) = &design.pipeline {
            package::check_clock(config, pipeline)?;
        }
        package::check_rom_style(config, &design)?;
        package::check_written_memories(config, &design)?;
        opened.check_golden()?;
        let contract = opened.contract();
        opened.check_contract(&design, contract.as_ref())?;
        if !device.proved && contract.bounds().are_stated() {
            // The descriptions of the catalogue state their bounds themselves, or refer to their pages.
            let note = format!(
                "The author of the device states that the error of an output is at most {} units of its last place.",
                contract.bounds().words()
            );
            design.about.notes.push(note.into());
        }
        let asked = Surroundings::new(config, design.pipeline.as_ref());
        if asked.software && asked.recomputation {
            package::check_recomputation(&design.name, &ContractFacts::new(contract.as_ref()))?;
        }
        Ok(Self { opened, design, contract })
    }

    pub fn device(&self) -> &Device {
        &self.opened.device
    }

    pub fn config(&self) -> &Config {
        &self.opened.config
    }

    /// Returns a digest of the configuration and of Glint's version: SHA-256 of version and TOML text, in hexadecimal.
    pub fn digest(&self) -> String {
        let text = self.config().to_toml(&(self.device().schema)());
        package::digest(format!("{}\n{text}", env!("CARGO_PKG_VERSION")).as_bytes())
    }

    /// Returns a digest that identifies the contract in a record of a proof: SHA-256 in hexadecimal. The digest covers the
    /// name of the device, and its own keys that apply and are not at their defaults. A record therefore stays valid if keys
    /// that all devices share change, or if the device later gets another key.
    pub fn contract_digest(&self) -> String {
        self.digest_of((self.device().schema)().keys.iter())
    }

    /// Returns the evidence for the contract's bound, from the records in the directory `proofs`. A device whose bound is
    /// proved in the catalogue needs no record.
    ///
    /// # Errors
    /// Fails if a record cannot be read, or does not fit the contract.
    pub fn backing(&self, proofs: &Path) -> Result<Backing> {
        if self.device().proved {
            return Ok(Backing::Catalogue);
        }
        Backing::of_records(proofs, &self.contract_digest(), self.contract.as_ref())
    }

    /// Returns a digest that identifies this core, whatever its name: SHA-256 in hexadecimal. The digest covers the keys of
    /// [`Core::contract_digest`] and the shared keys, such as the architecture. The digest leaves out the tables `interface`
    /// and `package`, which concern only wrappers and packages around the core.
    pub fn core_digest(&self) -> String {
        let schema = (self.device().schema)();
        self.digest_of(schema.all_keys().filter(|key| {
            let (table, _) = key.table_and_leaf();
            !["interface", "package"].contains(&table)
        }))
    }

    fn digest_of<'k>(&self, keys: impl Iterator<Item = &'k Key>) -> String {
        let schema = (self.device().schema)();
        let mut text = format!("device = {}\n", self.device().name);
        for key in keys {
            let value = self.config().value(key.name);
            if *value != key.default && self.config().applies(&schema, key.name) {
                text += &format!("{} = {}\n", key.name, value.toml());
            }
        }
        package::digest(text.as_bytes())
    }

    /// Returns a digest that an exhaustive check must have to be resumed or merged: SHA-256 in hexadecimal. The digest covers
    /// the configuration, the sweep, the sources of the code that takes part, and the errors at some operand combinations. The
    /// errors reveal a changed golden model in another crate. The digest is the same on every machine.
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

    /// Returns a co-simulation of the golden model and the netlist, whose random inputs are drawn from `seed`.
    ///
    /// # Errors
    /// Fails if golden model, design and contract do not have the same signals, operands and outputs.
    pub fn lockstep(&self, seed: u64) -> Result<Lockstep<'_>> {
        self.lockstep_of(&self.design, seed)
    }

    /// Returns a co-simulation of the golden model with the netlist `design`, for example a mutant. `design` must have the
    /// ports and registers of the core's own netlist.
    ///
    /// # Errors
    /// Fails if golden model, `design` and contract have different signals.
    pub fn lockstep_of<'a>(&'a self, design: &'a Design, seed: u64) -> Result<Lockstep<'a>> {
        let model = self.opened.golden();
        Lockstep::new(design, model, self.contract.as_ref(), seed)
    }

    /// Returns the exhaustive check of this core. The check tests the error bound and, if the operands have at most 26 bits in
    /// total, compares model and hardware clock by clock.
    ///
    /// # Errors
    /// Fails if golden model, design and contract have different signals.
    pub fn job(&self) -> Result<Job<'_>> {
        self.job_of(self.contract.sweep())
    }

    /// Returns the exhaustive check for the operand values in `sweep`, in place of the contract's own sweep.
    ///
    /// # Errors
    /// Fails if golden model, design and contract have different signals.
    pub fn job_of(&self, sweep: Sweep) -> Result<Job<'_>> {
        Ok(Job::of_sweep(self.contract.as_ref(), sweep).with(self.clocks()?))
    }

    /// Returns the clock-by-clock comparison of model and hardware alone. The comparison is empty if the operands have more
    /// than 26 bits.
    ///
    /// # Errors
    /// Fails if golden model, design and contract have different signals.
    pub fn clocks(&self) -> Result<Clocks<'_>> {
        let model = self.opened.golden();
        Clocks::new(&self.design, model, self.contract.as_ref())
    }

    /// Measures the numbers of clocks between the events of the handshake, such as `start` and `valid`. A number that depends
    /// on the operands is `None`.
    ///
    /// # Errors
    /// Fails if a simulated computation does not finish within 65 536 clocks, or never raises `valid`.
    pub fn timing(&self) -> Result<HandshakeTiming> {
        trial::timing(&self.design, self.contract.as_ref())
    }

    /// Returns one computation with the values of all operands and outputs, for pages that show an example.
    ///
    /// # Errors
    /// Fails if a simulated computation does not finish, or never raises `valid`.
    pub fn example(&self) -> Result<WorkedExample> {
        trial::example(&self.design, self.contract.as_ref())
    }

    /// Returns the clock numbers of a line as linear functions of its length. Returns `None` for a device of single points, or
    /// if the numbers are no linear functions.
    ///
    /// # Errors
    /// Fails if a simulated computation does not finish, or never raises `valid`.
    pub fn line(&self) -> Result<Option<LineClocks>> {
        trial::line(&self.design, self.contract.as_ref())
    }

    /// Returns the inputs and the expected outputs of every clock of a test bench, for random computations with `points`
    /// results in all. The golden model and the simulated netlist agree on the outputs.
    ///
    /// # Errors
    /// Fails if golden model, design and contract have different signals, or if golden model and simulation differ.
    pub fn vectors(&self, points: u64, seed: u64) -> Result<Vectors> {
        self.lockstep(seed)?.record(points, &[])
    }

    /// Returns the vectors of the emitted test bench: first random computations, which use the whole handshake, then
    /// computations that the module `directed` chooses, because they detect faults in the datapath and its ROMs.
    ///
    /// # Errors
    /// Fails if golden model and simulation differ, or if a computation does not end.
    pub fn shipped_vectors(&self) -> Result<Vectors> {
        self.shipped_vectors_of(&directed::ComputationCache::default())
    }

    /// Does the same as [`Core::shipped_vectors`], but takes the chosen computations from the cache `known` if it has them.
    /// The search for these computations takes most of the time.
    ///
    /// # Errors
    /// Fails if golden model and simulation differ, or if a computation does not end.
    pub fn shipped_vectors_of(&self, known: &directed::ComputationCache) -> Result<Vectors> {
        let contract = self.contract.as_ref();
        // A pipeline has the same datapath as the microprogram from which it was made.
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

    /// Returns a C program that recomputes the results of every combination of operands. The program includes the C model and
    /// the contents of the ROMs.
    ///
    /// # Errors
    /// Fails if the contract is neither a formula of one operand nor a list of formulas with conditions. Fails if the operands of
    /// such a list have more than 2^32 combinations, if a result wraps, or if the core has no C model.
    pub fn recomputation(&self) -> Result<OutputFiles> {
        let asked = Surroundings { software: true, recomputation: true, ..Surroundings::default() };
        let inputs = EmitInputs {
            accuracy: Some(ContractFacts::new(self.contract.as_ref())),
            around: asked,
            sequential: self.microprogram(true)?,
            ..EmitInputs::default()
        };
        package::emit(&self.design, &inputs)
    }

    /// Returns the sequential design from which the core was made, if the core is a pipeline and `is_wanted` is true.
    fn microprogram(&self, is_wanted: bool) -> Result<Option<Design>> {
        let wanted = is_wanted && self.design.pipeline.is_some();
        Ok(wanted.then(|| self.opened.sequential()).transpose()?)
    }

    /// Returns every emitted file. The heads of the files print `config`, the path of the configuration file, in a command.
    /// Without `vectors` there are no test benches and no formal proofs.
    ///
    /// # Errors
    /// Fails if golden model and simulation differ, if a computation does not end, or if a file or wrapper that the
    /// configuration asks for does not fit the core.
    pub fn files(&self, config: &str, vectors: impl Into<Option<Vectors>>) -> Result<OutputFiles> {
        let around = Surroundings::new(self.config(), self.design.pipeline.as_ref());
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
            images: self.images()?,
        };
        package::emit(&self.design, &inputs)
    }

    /// Returns the words of the writable table for each further function that the configuration states.
    ///
    /// # Errors
    /// Fails if the netlist of an image cannot be built.
    pub fn images(&self) -> Result<Vec<TableImage>> {
        let mut images = Vec::new();
        for (image, opened) in self.opened.images()? {
            images.push(Self::build(opened)?.table_image(&image.name, &image.formula));
        }
        Ok(images)
    }

    /// Returns the words of the writable table of this core as the image `name`, for a function with the text `formula`.
    pub fn table_image(&self, name: &str, formula: &str) -> TableImage {
        let contract = self.opened.written_contract();
        TableImage {
            name: name.to_owned(),
            formula: formula.to_owned(),
            bound: contract.bounds().governing().units,
            words: package::words_of(&self.design),
        }
    }

    /// Returns an example of a Verilog instance for each module that a system can instantiate, the outermost wrapper first.
    ///
    /// # Errors
    /// Fails if a wrapper that the configuration asks for does not fit the core.
    pub fn instances(&self) -> Result<Vec<InstanceExample>> {
        let inputs = EmitInputs {
            accuracy: Some(ContractFacts::new(self.contract.as_ref())),
            around: Surroundings::new(self.config(), self.design.pipeline.as_ref()),
            ..EmitInputs::default()
        };
        package::instances(&self.design, &inputs)
    }

    /// Returns only the Verilog of the core and the contents of its ROMs, which synthesis needs. If a file has a special form
    /// for an FPGA family, the list has the portable form and the special form.
    ///
    /// # Errors
    /// Fails if the design cannot be written as Verilog.
    pub fn core_files(&self) -> Result<OutputFiles> {
        let around = Surroundings {
            style: Surroundings::new(self.config(), None).style,
            ..Surroundings::default()
        };
        package::emit_core(&self.design, &EmitInputs { around, ..EmitInputs::default() })
    }

    /// Returns the files of [`Core::core_files`] in the portable form, as pairs of a file name and contents.
    ///
    /// # Errors
    /// Fails if the design cannot be written as Verilog.
    pub fn verilog(&self) -> Result<Vec<(String, String)>> {
        self.verilog_for("")
    }

    /// Returns the files of [`Core::core_files`] for the FPGA family `target`, as pairs of a file name and contents. A file
    /// with a special form for this family replaces the portable one.
    ///
    /// # Errors
    /// Fails if the design cannot be written as Verilog.
    pub fn verilog_for(&self, target: &str) -> Result<Vec<(String, String)>> {
        Ok(self.core_files()?.sources_for(FileKind::CORE_SOURCES, target))
    }
}

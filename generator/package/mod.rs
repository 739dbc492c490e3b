//! From a checked [`Design`] to files: Verilog, ROM contents, manifest, FuseSoC cores, test bench, and
//! the page for people.
//!
//! Names and expressions become strings first (`plan`, `expression`), views collect them, and
//! the templates in `templates/` print views and decide nothing. Emission is pure: it returns files
//! and writes none, and the same design gives the same bytes.

mod bench;
mod cocotb;
pub(crate) mod facts;
pub(crate) mod formal;
mod fusesoc;
mod instance;
mod manifest;
mod memory;
mod points;
pub(crate) mod seal;
mod software;
mod surroundings;
mod window;

use anyhow::{Result, ensure};
use askama::Template;
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::golden::Contract;
use crate::hdl;
use crate::hdl::netlist::{Design, RomId, Unit};
use crate::hdl::verilog::interface::Interface;
use crate::hdl::verilog::naming::Naming;
use crate::hdl::verilog::plan::Plan;
use crate::hdl::verilog::{module, top};

pub use cocotb::driver;
pub use instance::instance;
pub use points::{POINTS_FILE, PointsBench, RESULTS_FILE, points_bench};
pub use seal::{Seal, is_sealed, sealed, sealed_json};
pub use surroundings::Surroundings;
pub use window::{WINDOW_FILE, window};

/// A file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFile {
    /// Relative to the output directory, with `/`: `rtl_out/<name>/<name>.v`.
    pub path: String,
    /// The whole text, ending with a newline.
    pub contents: String,
}

impl OutputFile {
    /// The last part of the path.
    pub fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or(&self.path)
    }
}

/// What simulators and synthesisers read of some files: Verilog and memories, each with its plain name.
pub fn sources(files: Vec<OutputFile>) -> Vec<(String, String)> {
    let needed = |name: &str| name.ends_with(".v") || name.ends_with(".mem");
    files
        .into_iter()
        .filter(|file| needed(file.name()))
        .map(|file| (file.name().to_owned(), file.contents))
        .collect()
}

/// What the files say beyond the design.
#[derive(Clone, Debug, Default)]
pub struct EmitInputs {
    /// The configuration as the command line names it, `configs/<name>.toml`.
    pub config: String,
    /// Clocks, for header and manifest.
    pub timing: Timing,
    /// One computation with all its numbers, for the manifest.
    pub example: Option<WorkedExample>,
    /// What the results are to be, for the manifest.
    pub accuracy: Option<Accuracy>,
    /// Computations with all that they show, for the manifest.
    pub computations: Vec<Computation>,
    /// Stimulus and expected outputs; without them there is no bench.
    pub vectors: Option<Vectors>,
    /// What is put around the core.
    pub around: Surroundings,
}

/// Clocks between the events of the handshake; `None` where they depend on the data.
///
/// The clock in which `start` is taken is number 0.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Timing {
    /// The number of the first clock in which `valid` is high.
    pub start_to_valid: Option<u32>,
    /// Clocks from a result to the next of the same computation, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valid_to_valid: Option<u32>,
    /// The number of the clock in which `done` is high.
    pub start_to_done: Option<u32>,
    /// Where that depends on the data, the number of the latest clock in which `done` can be high, if the
    /// microprogram has a bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_to_done_at_most: Option<u32>,
    /// The number of the first clock in which the next `start` is taken.
    pub start_to_start: Option<u32>,
}

impl Timing {
    /// Clocks from a point to the next without a pause: of a line once it is under way, where a computation
    /// has several results; of computations back to back elsewhere. `None` where they depend on the data.
    pub fn clocks_per_point(&self) -> Option<u32> {
        self.valid_to_valid.or(self.start_to_start)
    }
}

/// A computation with all its numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorkedExample {
    /// In the order of the operand ports.
    pub operands: Vec<Quantity>,
    /// In the order of the result ports.
    pub outputs: Vec<Quantity>,
}

/// What a device promises of its results, as far as a program can use it.
#[derive(Clone, Debug, PartialEq)]
pub struct Accuracy {
    /// The operands with the smallest and the largest raw value for which it promises anything.
    pub domain: Vec<(String, (i64, i64))>,
    /// The result outputs, each with the operand by which it multiplies f.
    pub outputs: Vec<(String, String)>,
    /// The operand that says how many results there are beyond the first, where one does.
    pub length: Option<String>,
    /// The values that are right for f, as expressions of Python.
    pub f: Vec<String>,
    /// The largest error of an output, in its units.
    pub bound: f64,
}

impl Accuracy {
    /// What a contract says.
    pub fn new(contract: &dyn Contract) -> Self {
        let operands = contract.operands();
        let colours = operands.iter().filter(|operand| operand.colour);
        let domain = operands.iter();
        Self {
            domain: domain.map(|operand| (operand.name.clone(), operand.domain)).collect(),
            outputs: contract
                .outputs()
                .iter()
                .zip(colours)
                .map(|(output, colour)| (output.clone(), colour.name.clone()))
                .collect(),
            length: contract.length().map(str::to_owned),
            f: contract.expressions(),
            bound: contract.bound().units,
        }
    }
}

/// A computation as its handshake shows it. The clock in which `start` is taken is number 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Computation {
    /// Raw, in the order of [`Accuracy::domain`].
    pub operands: Vec<i64>,
    /// What is on the outputs whenever `valid` is high.
    pub results: Vec<Shown>,
    /// The clock in which `done` is high.
    pub done: u32,
}

impl Computation {
    /// Whether the last result comes with `done`.
    pub fn ends_with_result(&self) -> bool {
        let last = self.results.last();
        last.is_some_and(|result| result.clock == self.done)
    }
}

/// A result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    /// The clock in which `valid` is high.
    pub clock: u32,
    /// Raw, in the order of [`Accuracy::outputs`].
    pub outputs: Vec<i64>,
}

/// A number on a port.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// The port.
    pub name: String,
    /// The integer that its bits denote.
    pub raw: i128,
    /// `raw · 2^-F`.
    pub value: f64,
}

/// Stimulus and expected outputs, clock by clock.
///
/// The inputs of a clock are applied on the falling edge that begins it; its outputs are those just
/// before the rising edge in its middle, with these inputs applied.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Vectors {
    /// For each clock the bit patterns of all input ports but `clk`, in port order.
    pub inputs: Vec<Vec<u64>>,
    /// For each clock the bit patterns of all output ports, in port order.
    pub expected: Vec<Vec<u64>>,
    /// The first clock from which results and status are compared. Handshake outputs are compared from the
    /// first clock after one with reset.
    pub known_from: usize,
}

/// Every file of a design.
///
/// # Errors
/// The mistakes that [`Design::verify_structure`] finds; a net named `clk`; vectors that do not fit the ports.
pub fn emit(design: &Design, inputs: &EmitInputs) -> Result<Vec<OutputFile>> {
    ensure!(design.find("clk").is_none(), "`clk` is the clock; no other net can have that name");
    let plan = Plan::new(design)?;
    let naming = Naming::new(design);
    let name = &design.name;
    let rtl = match &design.pipeline {
        Some(pipeline) => {
            let module = hdl::verilog::pipeline::module(&plan, &naming, pipeline, inputs);
            vec![(format!("{name}.v"), render(&module)?)]
        }
        None => units(&plan, &naming, inputs)?,
    };
    let mut memories = Vec::new();
    for (at, file) in naming.files.iter().enumerate() {
        let id = RomId(at as u32);
        if !naming.second.contains(&id) {
            memories.push((file.clone(), memory::contents(design, id)?));
        }
    }
    let mut testbench = Vec::new();
    if let Some(vectors) = &inputs.vectors {
        testbench = bench::files(design, &naming, vectors)?;
        let names = names_of(&testbench);
        testbench.push((format!("{name}_tb.core"), fusesoc::bench(name, &names[0], &names[1..])?));
        // The properties and the bench in Python are of the handshake of a microprogram.
        let sequential = design.pipeline.is_none();
        let sources = formal::Sources { rtl: &names_of(&rtl), memories: &names_of(&memories) };
        if sequential {
            let formal = formal::files(design, &naming, inputs, sources)?;
            testbench.splice(0..0, formal);
        }
        if let (true, Some(example), Some(accuracy)) =
            (sequential, &inputs.example, &inputs.accuracy)
        {
            testbench.insert(0, cocotb::bench(design, example, accuracy)?);
        }
    }

    let software =
        if inputs.around.software { software::files(design, inputs)? } else { Vec::new() };

    let (rtl_names, memory_names) = (names_of(&rtl), names_of(&memories));
    let mut cores = vec![format!("{name}.core")];
    let mut bench_names = names_of(&testbench);
    cores.extend(bench_names.pop());
    let files = manifest::Files {
        rtl: &rtl_names,
        memories: &memory_names,
        cores: &cores,
        testbench: &bench_names,
        software: &names_of(&software),
    };
    let has_bench = !testbench.is_empty();
    let core = fusesoc::device(name, &design.about.title, &rtl_names, &memory_names, has_bench)?;
    let mut all: Vec<OutputFile> = rtl
        .into_iter()
        .chain(memories)
        .chain([(format!("{name}.core"), core)])
        .map(|(file, contents)| OutputFile { path: format!("rtl_out/{name}/{file}"), contents })
        .collect();
    for (folder, files) in [("testbench", testbench), ("software", software)] {
        all.extend(files.into_iter().map(|(file, contents)| OutputFile {
            path: format!("{folder}/{name}/{file}"),
            contents,
        }));
    }
    // The manifest vouches for every other file.
    let contents = manifest::contents(design, inputs, &naming, &files, &all)?;
    all.push(OutputFile { path: format!("rtl_out/{name}/{name}.json"), contents });
    Ok(all)
}

/// The top module, the control unit and the datapath.
fn units(plan: &Plan, naming: &Naming, inputs: &EmitInputs) -> Result<Vec<(String, String)>> {
    let control = Interface::new(plan, Unit::Control);
    let datapath = Interface::new(plan, Unit::Datapath);
    let units = [(Unit::Control, &control), (Unit::Datapath, &datapath)];
    let top = render(&top::module(plan, naming, units, inputs))?;
    let mut rtl = vec![(format!("{}.v", plan.design.name), top)];
    for (unit, interface) in units {
        let module = module::Builder::new(plan, naming, interface, unit).module(inputs);
        rtl.push((format!("{}.v", naming.module(unit)), render(&module)?));
    }
    Ok(rtl)
}

/// The digest of a file, as the manifest holds it: SHA-256 in hexadecimal.
pub fn digest(contents: &[u8]) -> String {
    Sha256::digest(contents).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn names_of(files: &[(String, String)]) -> Vec<String> {
    files.iter().map(|(name, _)| name.clone()).collect()
}

/// A template's text. Askama drops the newline that ends a template.
pub(crate) fn render(template: &impl Template) -> Result<String> {
    let mut text = template.render()?;
    if !text.ends_with('\n') {
        text.push('\n');
    }
    Ok(text)
}

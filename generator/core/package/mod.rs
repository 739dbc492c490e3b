//! Generates the files of a checked [`Design`]: Verilog, ROM contents, manifest, FuseSoC cores, benches, formal
//! wrappers, bus wrappers and the model in C.
//!
//! Names and expressions become strings first (`hdl::verilog`), views collect them, and the templates in
//! `templates/` print views and decide nothing. Emission is pure: it returns files
//! and writes none, and the same design gives the same bytes.

/// A structure of a bench's own names, none of which a port has.
macro_rules! fresh_names {
    ($all:ident { $($name:ident),* }) => {
        struct $all {
            $($name: String,)*
        }

        impl $all {
            fn new(names: &mut Names) -> Self {
                Self { $($name: names.fresh(stringify!($name)),)* }
            }
        }
    };
}

mod artifact;
mod bench;
mod bus;
mod cocotb;
pub mod facts;
mod formal;
mod formal_pipeline;
mod fusesoc;
mod instance;
mod languages;
mod manifest;
mod map;
pub mod module_names;
mod multiplier;
mod points;
pub mod seal;
mod software;
mod surroundings;
mod tops;
mod unfit;
mod vendor;
mod wrap;

use anyhow::{Result, ensure};
use sha2::{Digest, Sha256};

use artifact::{Artifacts, Job, Kind};
use glint_rtl::netlist::Design;
use glint_rtl::verilog;
use glint_rtl::verilog::header::Origin;
use glint_rtl::verilog::naming::Naming;
use glint_rtl::verilog::plan::Plan;

pub use crate::observation::{
    Computation, ContractFacts, LineClocks, Linear, Quantity, Shown, Vectors, WorkedExample,
};
pub use cocotb::driver;
pub use glint_rtl::netlist::Timing;
pub use instance::instance;
pub use points::{POINTS_FILE, PointsBench, RESULTS_FILE};
pub use seal::{Seal, is_sealed, sealed, sealed_json};
pub use surroundings::{Surroundings, check_clock, check_rom_style};
pub use unfit::Unfit;

/// Returns the bench that computes a list of points, each in less than `limit` clocks: of a pipeline, or of a design with a
/// microprogram.
///
/// # Errors
/// A design without its handshake, or without operands or results.
pub fn points_bench(design: &Design, limit: u32) -> Result<PointsBench> {
    match design.pipeline {
        Some(_) => points::pipeline::points_bench(design, limit),
        None => points::points_bench(design, limit),
    }
}

/// A file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFile {
    /// Relative to the output directory, with `/`: `rtl_out/<name>/<name>.v`.
    pub path: String,
    /// The whole text, ending with a newline.
    pub contents: String,
}

impl OutputFile {
    /// Returns the last part of the path.
    pub fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or(&self.path)
    }

    /// Returns the target that the file is for, of one that stands in its directory: `rtl_out/<name>/<target>/…`.
    fn target(&self) -> Option<&str> {
        match self.path.split('/').collect::<Vec<_>>()[..] {
            [_, _, target, _] => Some(target),
            _ => None,
        }
    }
}

/// Returns the files that simulators and synthesisers read, Verilog and memories, each with its plain name.
pub fn sources(files: Vec<OutputFile>) -> Vec<(String, String)> {
    sources_for(files, "")
}

/// Returns the files for a target, whose own take the place of portable ones of the same name.
pub fn sources_for(files: Vec<OutputFile>, target: &str) -> Vec<(String, String)> {
    let needed = |file: &OutputFile| [".v", ".mem"].iter().any(|it| file.name().ends_with(it));
    let (primitives, portable): (Vec<_>, Vec<_>) =
        files.into_iter().filter(needed).partition(|file| file.target().is_some());
    let own =
        |name: &str| primitives.iter().find(|it| it.target() == Some(target) && it.name() == name);
    portable
        .into_iter()
        .map(|file| {
            let name = file.name().to_owned();
            let contents = own(&name).map_or(file.contents, |own| own.contents.clone());
            (name, contents)
        })
        .collect()
}

/// The inputs of the files beyond the design.
#[derive(Clone, Debug, Default)]
pub struct EmitInputs {
    /// The command that makes the files again, with the configuration by its [`glint_base::input::label`].
    pub regenerate: String,
    /// Tells the configuration from others: SHA-256 in hexadecimal.
    pub configuration: String,
    /// Clocks, for header and manifest.
    pub timing: Timing,
    /// One computation with all its numbers, for the manifest.
    pub example: Option<WorkedExample>,
    /// The contract of the results, for the manifest.
    pub accuracy: Option<ContractFacts>,
    /// Computations with all that they show, for the manifest.
    pub computations: Vec<Computation>,
    /// Stimulus and expected outputs; without them there is no bench.
    pub vectors: Option<Vectors>,
    /// The surroundings of the core.
    pub around: Surroundings,
    /// The design with the microprogram from which a pipeline is made: the model in C is made of it.
    pub sequential: Option<Design>,
}

impl EmitInputs {
    fn origin(&self) -> Origin<'_> {
        Origin { regenerate: &self.regenerate, timing: &self.timing }
    }
}

/// Returns every file of a design.
///
/// # Errors
/// The mistakes that [`Design::verify_structure`] finds; a net named `clk`; vectors that do not fit the ports.
pub fn emit(design: &Design, inputs: &EmitInputs) -> Result<Vec<OutputFile>> {
    ensure!(design.find("clk").is_none(), "`clk` is the clock; no other net can have that name");
    let plan = Plan::new(design)?;
    let naming = Naming::new(design).styled(inputs.around.style);
    let registers = match inputs.around.registers {
        Some(bus) => Some((bus, map::Map::new(design, inputs)?)),
        None => None,
    };
    let job = Job { design, inputs, naming: &naming, registers };
    let mut files = Artifacts::default();
    for (file, module) in verilog::modules(&plan, &naming, &inputs.origin()) {
        files.add(Kind::Rtl, file, module);
    }
    multiplier::files(&job, &mut files)?;
    for (file, contents) in verilog::memories(design, &naming)? {
        files.add(Kind::Memory, file, contents);
    }
    if let (Some(_), Some(example), Some(accuracy)) =
        (&inputs.vectors, &inputs.example, &inputs.accuracy)
    {
        cocotb::file(&job, example, accuracy, &mut files)?;
    }
    if let Some(vectors) = &inputs.vectors {
        bench::files(&job, vectors, &mut files)?;
        match &design.pipeline {
            None => formal::files(&job, &mut files)?,
            Some(pipeline) => formal_pipeline::files(&job, pipeline, &mut files)?,
        }
    }
    wrap::files(&job, &mut files)?;
    let tops = tops::tops(&job, &files)?;
    vendor::files(&job, &tops, &mut files)?;
    languages::files(&job, &tops, &mut files)?;
    software::files(&job, &tops, &mut files)?;
    fusesoc::files(&job, &mut files)?;
    let names = manifest::Names::new(&files);
    let mut files = files.files(&design.name);
    module_names::check(&files)?;
    // The manifest vouches for every other file.
    let contents = manifest::contents(&job, &names, &files)?;
    files.push(OutputFile { path: format!("rtl_out/{0}/{0}.json", design.name), contents });
    Ok(files)
}

/// Returns the digest of a file, as the manifest holds it: SHA-256 in hexadecimal.
pub fn digest(contents: &[u8]) -> String {
    Sha256::digest(contents).iter().map(|byte| format!("{byte:02x}")).collect()
}

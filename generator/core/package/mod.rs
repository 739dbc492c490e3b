//! Generates the files of a checked [`Design`]: Verilog, ROM contents, manifest, FuseSoC cores, benches, formal
//! wrappers, bus wrappers and the model in C.
//!
//! Names and expressions become strings first (`hdl::verilog`), views collect them, and the templates in
//! `templates/` print views and decide nothing. Emission is pure: it returns files
//! and writes none, and the same design gives the same bytes.

/// Declares a structure of a bench's own names. No name is the name of a port.
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
mod inputs;
mod instance;
mod languages;
mod manifest;
mod map;
pub mod module_names;
mod multiplier;
mod output_file;
mod points;
pub mod seal;
mod software;
mod surroundings;
mod tops;
mod vendor;
mod wrap;

use anyhow::{Result, ensure};

use artifact::{ArtifactKind, Artifacts, EmitJob};
use glint_rtl::netlist::Design;
use glint_rtl::verilog;
use glint_rtl::verilog::naming::Naming;
use glint_rtl::verilog::plan::Plan;

pub use crate::observation::{
    Computation, ContractFacts, LineClocks, Linear, Quantity, TimedResult, Vectors, WorkedExample,
};
pub use cocotb::driver;
pub use glint_rtl::netlist::HandshakeTiming;
pub use inputs::EmitInputs;
pub use instance::{InstanceExample, instances};
pub use output_file::{OutputFile, digest, sources, sources_for};
pub use points::{POINTS_FILE, PointsBench, RESULTS_FILE};
pub use seal::{Seal, is_sealed, sealed, sealed_json};
pub use software::check_recomputation;
pub use surroundings::{Surroundings, check_clock, check_rom_style};

/// Returns the bench that computes a list of points, for a pipeline or for a design with a microprogram. Each point must take
/// less than `limit` clocks.
///
/// # Errors
/// Fails if the design lacks its handshake, operands or results.
pub fn points_bench(design: &Design, limit: u32) -> Result<PointsBench> {
    match design.pipeline {
        Some(_) => points::pipeline::points_bench(design, limit),
        None => points::points_bench(design, limit),
    }
}

/// Returns every file of a design.
///
/// # Errors
/// Fails if [`Design::verify_structure`] finds mistakes, if a net is named `clk`, or if vectors do not fit the ports.
pub fn emit(design: &Design, inputs: &EmitInputs) -> Result<Vec<OutputFile>> {
    ensure!(design.find("clk").is_none(), "`clk` is the clock; no other net can have that name");
    let plan = Plan::new(design)?;
    let naming = Naming::new(design).styled(inputs.around.style);
    let registers = match inputs.around.registers {
        Some(bus) => Some((bus, map::Map::new(design, inputs)?)),
        None => None,
    };
    let job = EmitJob { design, inputs, naming: &naming, registers };
    let mut files = Artifacts::default();
    for (file, module) in verilog::modules(&plan, &naming, &inputs.origin()) {
        files.add(ArtifactKind::Rtl, file, module);
    }
    multiplier::files(&job, &mut files)?;
    for (file, contents) in verilog::memories(design, &naming)? {
        files.add(ArtifactKind::Memory, file, contents);
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
    let names = manifest::FileNames::new(&files);
    let mut files = files.files(&design.name);
    module_names::check(&files)?;
    // The manifest has the digests of all other files.
    let contents = manifest::contents(&job, &names, &files)?;
    files.push(OutputFile { path: format!("rtl_out/{0}/{0}.json", design.name), contents });
    Ok(files)
}

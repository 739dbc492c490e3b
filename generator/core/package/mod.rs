//! Generates the files of a [`Design`] that a configuration asks for, such as Verilog, ROM contents, manifest, FuseSoC cores,
//! test benches, formal wrappers, bus wrappers and the model in C.
//!
//! `hdl::verilog` turns names and expressions of the netlist into strings. Each module here collects such strings in a view, a
//! plain struct, and a template in `templates/` prints the view. Emission returns the files and writes nothing to disk, and
//! the same design always gives the same bytes.

/// Declares a struct with names for the variables of a test bench. The struct's function `new` chooses names that no port has.
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

mod bench;
mod bus;
mod cocotb;
mod emit_job;
pub mod facts;
mod file_kind;
mod formal;
mod formal_pipeline;
mod fusesoc;
mod inputs;
mod instance;
mod instructions;
mod languages;
mod manifest;
mod map;
pub mod module_names;
mod multiplier;
mod output_file;
mod output_files;
mod points;
mod processor;
pub mod seal;
mod software;
mod surroundings;
mod table_image;
mod tops;
mod vendor;
mod wrap;

use anyhow::{Result, ensure};

use emit_job::EmitJob;
use glint_rtl::netlist::Design;
use glint_rtl::verilog;
use glint_rtl::verilog::naming::Naming;
use glint_rtl::verilog::plan::Plan;

pub use crate::observation::{
    Computation, ContractFacts, LineClocks, Linear, Quantity, TimedResult, Vectors, WorkedExample,
};
pub use cocotb::driver;
pub use file_kind::FileKind;
pub use glint_rtl::netlist::HandshakeTiming;
pub use inputs::EmitInputs;
pub use instance::{InstanceExample, instances};
pub use output_file::{OutputFile, digest};
pub use output_files::OutputFiles;
pub use points::{POINTS_FILE, PointsBench, RESULTS_FILE};
pub use seal::{Seal, is_sealed, sealed, sealed_json, sealed_object};
pub use software::{check_recomputation, image_file, image_header};
pub use surroundings::{Surroundings, check_clock, check_rom_style, check_written_memories};
pub use table_image::{TableImage, TableLayout, words_of};

/// Returns a Verilog test bench that computes the points of a file. The simulation ends with `FAIL` if a
/// computation takes `limit` clocks or more. For a pipeline, `limit` counts the clocks from the last point to the last result.
///
/// # Errors
/// Fails if the design lacks a port of its handshake, or if a template fails.
pub fn points_bench(design: &Design, limit: u32) -> Result<PointsBench> {
    match design.pipeline {
        Some(_) => points::pipeline::points_bench(design, limit),
        None => points::points_bench(design, limit),
    }
}

/// Returns only the Verilog of a core and the files with the contents of its ROMs.
///
/// # Errors
/// Fails if [`Design::verify_structure`] finds mistakes, if a net is named `clk`, or if the name of a module is used for
/// anything else.
pub fn emit_core(design: &Design, inputs: &EmitInputs) -> Result<OutputFiles> {
    let naming = Naming::new(design).styled(inputs.around.style);
    let job = EmitJob { design, inputs, naming: &naming, registers: None, instructions: None };
    let files = core_files(&job)?;
    module_names::check(files.as_slice())?;
    Ok(files)
}

/// Returns the Verilog and the ROM contents of a core. The names of modules are not checked yet.
fn core_files(job: &EmitJob) -> Result<OutputFiles> {
    let EmitJob { design, inputs, naming, .. } = *job;
    ensure!(
        design.find("clk").is_none(),
        "`clk` is the name of the clock, and no other net can have this name"
    );
    let plan = Plan::new(design)?;
    let mut files = OutputFiles::new(&design.name);
    for file in verilog::modules(&plan, naming, &inputs.origin()) {
        files.add_verilog(FileKind::CoreVerilog, file.modules, file.text);
    }
    multiplier::files(job, &mut files)?;
    for (file, contents) in verilog::memories(design, naming)? {
        files.add(FileKind::Memory, file, contents);
    }
    Ok(files)
}

/// Returns all files of a core that the configuration asks for.
///
/// # Errors
/// Fails if [`Design::verify_structure`] finds mistakes, if a net is named `clk`, or if vectors do not fit the ports. Fails if
/// the core cannot have a wrapper or a model, or if the name of a module is used for anything else.
pub fn emit(design: &Design, inputs: &EmitInputs) -> Result<OutputFiles> {
    let naming = Naming::new(design).styled(inputs.around.style);
    let job = EmitJob::new(design, inputs, &naming)?;
    let mut files = core_files(&job)?;
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
    fusesoc::files(&job, &tops, &mut files)?;
    module_names::check(files.as_slice())?;
    // The manifest has the digests of all other files.
    let contents = manifest::contents(&job, &files)?;
    files.add(FileKind::Manifest, format!("{}.json", design.name), contents);
    Ok(files)
}

//! From a checked [`Design`] to files: Verilog, ROM contents, manifest, FuseSoC cores, benches,
//! formal wrappers, bus wrappers and the model in C.
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

mod bench;
mod cocotb;
pub(crate) mod facts;
pub(crate) mod formal;
mod formal_pipeline;
mod fusesoc;
mod instance;
mod manifest;
mod map;
mod memory;
pub mod module_names;
mod multiplier;
mod points;
pub(crate) mod seal;
mod software;
mod surroundings;
mod tops;
mod unfit;
mod vendor;
mod window;
mod wrap;

use anyhow::{Result, ensure};
use askama::Template;
use sha2::{Digest, Sha256};

use crate::hdl::netlist::{Design, Partition, RomId};
use crate::hdl::verilog::header::Origin;
use crate::hdl::verilog::interface::Interface;
use crate::hdl::verilog::naming::Naming;
use crate::hdl::verilog::plan::Plan;
use crate::hdl::verilog::{module, pipeline, top};

pub use crate::observation::{
    Computation, ContractFacts, LineClocks, Linear, Quantity, Shown, Timing, Vectors, WorkedExample,
};
pub use cocotb::driver;
pub use instance::instance;
pub use points::{POINTS_FILE, PointsBench, RESULTS_FILE};
pub use seal::{Seal, is_sealed, sealed, sealed_json};
pub use surroundings::{Surroundings, check_clock, check_rom_style};
pub use unfit::Unfit;
pub use window::{WINDOW_FILE, window};

/// The bench that computes a list of points, each in less than `limit` clocks: of a pipeline, or of a design with a
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
    /// The last part of the path.
    pub fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or(&self.path)
    }

    /// The target that the file is for, of one that stands in its directory: `rtl_out/<name>/<target>/…`.
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
    /// The configuration by its [`crate::base::input::label`].
    pub config: String,
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
        Origin { config: &self.config, timing: &self.timing }
    }
}

/// Every file of a design.
///
/// # Errors
/// The mistakes that [`Design::verify_structure`] finds; a net named `clk`; vectors that do not fit the ports.
pub fn emit(design: &Design, inputs: &EmitInputs) -> Result<Vec<OutputFile>> {
    ensure!(design.find("clk").is_none(), "`clk` is the clock; no other net can have that name");
    let plan = Plan::new(design)?;
    let naming = Naming::new(design).styled(inputs.around.style);
    let name = &design.name;
    let mut rtl = match &design.pipeline {
        Some(pipeline) => {
            let module = pipeline::module(&plan, &naming, pipeline, &inputs.origin());
            vec![(format!("{name}.v"), render(&module)?)]
        }
        None => units(&plan, &naming, inputs)?,
    };
    let mut primitives = Vec::new();
    if let Some(multiplier) = multiplier::multiplier(design, &naming, inputs)? {
        rtl.push(multiplier.portable);
        primitives = multiplier.primitives;
    }
    let mut memories = Vec::new();
    for (at, file) in naming.files.iter().enumerate() {
        let id = RomId(at as u32);
        if !naming.style.inline && !naming.second.contains(&id) {
            memories.push((file.clone(), memory::contents(design, id)?));
        }
    }
    let map = match inputs.around.registers {
        Some(bus) => Some((bus, map::Map::new(design, inputs)?)),
        None => None,
    };
    let registers = map.as_ref().map(|(bus, map)| (*bus, map));
    let wrap::Wrappers { rtl: wrappers, formal, benches } =
        wrap::wrappers(design, inputs, registers)?;
    let mut testbench = Vec::new();
    if let Some(vectors) = &inputs.vectors {
        testbench = bench::files(design, &naming, vectors)?;
        let (python, benches): (Vec<_>, Vec<_>) =
            benches.into_iter().partition(|(file, _)| file.ends_with(".py"));
        testbench.extend(benches);
        let names = names_of(&testbench);
        testbench.push((
            format!("{name}_tb.core"),
            fusesoc::bench(design, inputs, &names[0], &names[1..])?,
        ));
        let sources = formal::Sources { rtl: &names_of(&rtl), memories: &names_of(&memories) };
        testbench.splice(
            0..0,
            match &design.pipeline {
                None => formal::files(design, &naming, inputs, sources)?,
                Some(pipeline) => formal_pipeline::files(design, pipeline, sources)?,
            },
        );
        testbench.splice(0..0, formal);
        if let (Some(example), Some(accuracy)) = (&inputs.example, &inputs.accuracy) {
            testbench.insert(0, cocotb::bench(design, example, accuracy)?);
            testbench.splice(1..1, python);
        }
    }

    let (rtl_names, memory_names) = (names_of(&rtl), names_of(&memories));
    let wrapper_names = names_of(&wrappers);
    let tops = tops::tops(design, inputs, registers, &rtl_names, &wrapper_names)?;
    let map = map.as_ref();
    let vendor::Vendor { constraints, scripts } =
        vendor::files(design, inputs, &tops, map.map(|(_, map)| map), &memory_names)?;
    let mut software = if inputs.around.software {
        let latency = design.pipeline.as_ref().map(|pipeline| pipeline.stages.len());
        let sequential = inputs.sequential.as_ref().unwrap_or(design);
        let mut files = software::files(sequential, inputs, latency)?;
        files.extend(software::of_lines(sequential, inputs)?);
        files
    } else {
        Vec::new()
    };
    if let Some((bus, map)) = map {
        software.extend(software::of_registers(design, inputs, *bus, map)?);
    }
    if inputs.around.litex {
        software.push(software::of_litex(design, inputs, &tops)?);
    }

    let mut cores = vec![format!("{name}.core")];
    let mut bench_names = names_of(&testbench);
    cores.extend(bench_names.pop());
    let primitive_names = names_of(&primitives);
    let sources = fusesoc::Sources {
        rtl: &rtl_names,
        primitives: &primitive_names,
        wrappers: &wrapper_names,
        memories: &memory_names,
    };
    let files = manifest::Files {
        sources,
        cores: &cores,
        testbench: &bench_names,
        software: &names_of(&software),
        constraints: &names_of(&constraints),
        scripts: &names_of(&scripts),
        map: map.map(|(_, map)| map),
    };
    let wrapper_bench = |file: &String| {
        let bench = file.strip_prefix(name)?.strip_prefix('_')?.strip_suffix("_tb.v")?;
        Some(bench.to_owned())
    };
    let wrapper_benches: Vec<String> = bench_names.iter().filter_map(wrapper_bench).collect();
    let benches = (!testbench.is_empty()).then_some(&wrapper_benches[..]);
    let core = fusesoc::device(design, inputs, sources, benches)?;
    let mut all: Vec<OutputFile> = rtl
        .into_iter()
        .chain(primitives)
        .chain(wrappers)
        .chain(memories)
        .chain([(format!("{name}.core"), core)])
        .chain(constraints)
        .chain(scripts)
        .map(|(file, contents)| OutputFile { path: format!("rtl_out/{name}/{file}"), contents })
        .collect();
    for (folder, files) in [("testbench", testbench), ("software", software)] {
        all.extend(files.into_iter().map(|(file, contents)| OutputFile {
            path: format!("{folder}/{name}/{file}"),
            contents,
        }));
    }
    module_names::check(&all)?;
    // The manifest vouches for every other file.
    let contents = manifest::contents(design, inputs, &naming, &files, &all)?;
    all.push(OutputFile { path: format!("rtl_out/{name}/{name}.json"), contents });
    Ok(all)
}

/// The top module, the control unit and the datapath.
fn units(plan: &Plan, naming: &Naming, inputs: &EmitInputs) -> Result<Vec<(String, String)>> {
    let control = Interface::new(plan, Partition::Control);
    let datapath = Interface::new(plan, Partition::Datapath);
    let units = [(Partition::Control, &control), (Partition::Datapath, &datapath)];
    let origin = inputs.origin();
    let top = render(&top::module(plan, naming, units, &origin))?;
    let mut rtl = vec![(format!("{}.v", plan.design.name), top)];
    for (partition, interface) in units {
        let module = module::Builder::new(plan, naming, interface, partition).module(&origin);
        rtl.push((format!("{}.v", naming.module(partition)), render(&module)?));
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

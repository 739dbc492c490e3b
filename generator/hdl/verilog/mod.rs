//! Writes a design as Verilog modules, and the contents of its ROMs as memory files.
//!
//! Names and expressions become strings first (`plan`, `expression`). `writer` then makes modules of these lines.

pub mod bits;
pub mod delays;
pub mod expression;
pub mod header;
pub mod interface;
pub mod invariants;
pub mod memory;
pub mod module;
pub mod naming;
pub mod pipeline;
pub mod plan;
pub mod rows;
pub mod text;
pub mod top;
pub mod words;
pub mod writer;

use anyhow::Result;

use crate::netlist::{Design, HandshakeTiming, Partition, RomId};
use header::Origin;
use interface::Interface;
use naming::Naming;
use plan::Plan;

/// Returns the files of a design by their names: modules, then the contents of ROMs as `$readmemh` reads them.
///
/// # Errors
/// Fails with the mistakes that [`Design::verify_structure`] finds, or if [`memories`] fails.
pub fn files(design: &Design) -> Result<Vec<(String, String)>> {
    let (plan, naming) = (Plan::new(design)?, Naming::new(design));
    let origin = Origin { regenerate: "", timing: &HandshakeTiming::default() };
    let mut files = Vec::new();
    for file in modules(&plan, &naming, &origin) {
        files.push((format!("{}.v", file.modules[0]), file.text));
    }
    files.extend(memories(design, &naming)?);
    Ok(files)
}

/// The text of a file in Verilog, with the names of the modules that it defines.
pub struct ModuleFile {
    /// The names of the modules, the main one first.
    pub modules: Vec<String>,
    /// The whole text.
    pub text: String,
}

/// Returns the files of the modules, the top module first. A pipeline is one module, in one file with its delay line. Other
/// designs have the top module, the control unit and the datapath, each in a file of its own.
pub fn modules(plan: &Plan, naming: &Naming, origin: &Origin) -> Vec<ModuleFile> {
    if let Some(pipeline) = &plan.design.pipeline {
        let mut modules = vec![plan.design.name.clone()];
        if !plan.delays.is_empty() {
            modules.push(naming.delay());
        }
        return vec![ModuleFile {
            modules,
            text: pipeline::module(plan, naming, pipeline, origin),
        }];
    }
    let control = Interface::new(plan, Partition::Control);
    let datapath = Interface::new(plan, Partition::Datapath);
    let units = [(Partition::Control, &control), (Partition::Datapath, &datapath)];
    let top = top::module(plan, naming, units, origin);
    let mut files = vec![ModuleFile { modules: vec![plan.design.name.clone()], text: top }];
    for (partition, interface) in units {
        let text = module::Builder::new(plan, naming, interface, partition).module(origin);
        files.push(ModuleFile { modules: vec![naming.module(partition)], text });
    }
    files
}

/// Returns the contents of the ROMs that have files of their own, by the names of these files.
///
/// # Errors
/// Fails if the words of the control ROM are not exactly as wide as all fields, or if a word is wider than its ROM.
pub fn memories(design: &Design, naming: &Naming) -> Result<Vec<(String, String)>> {
    let apart = |id: &RomId| !naming.style.inline && !naming.second.contains(id);
    let roms = naming.files.iter().enumerate().map(|(at, file)| (RomId(at as u32), file));
    let roms = roms.filter(|(id, _)| apart(id));
    roms.map(|(id, file)| Ok((file.clone(), memory::contents(design, id)?))).collect()
}

//! Writes a design as Verilog modules, and the contents of its ROMs as memory files.
//!
//! `plan` decides which nets the Verilog declares, `expression` writes the right-hand sides, and `writer` forms modules from
//! these lines.

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

/// Returns the files for a design as pairs of file name and text. The files are the Verilog modules (`.v`), and the contents of
/// ROMs (`.mem`) for `$readmemh` and `$readmemb`.
///
/// # Errors
/// Fails with the mistakes of [`Design::verify_structure`], or if the words of the control ROM are not as wide as all fields
/// together.
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

/// The text of one Verilog file.
pub struct ModuleFile {
    /// The names of the modules that the file defines, the main one first.
    pub modules: Vec<String>,
    pub text: String,
}

/// Returns the Verilog files of a design, the top module first. A pipeline has one file for its module, and another one for delay
/// lines. Other designs have the top module, the control unit and the datapath.
pub fn modules(plan: &Plan, naming: &Naming, origin: &Origin) -> Vec<ModuleFile> {
    if let Some(pipeline) = &plan.design.pipeline {
        let name = &plan.design.name;
        let text = pipeline::module(plan, naming, pipeline, origin);
        let mut files = vec![ModuleFile { modules: vec![name.clone()], text }];
        if !plan.delays.is_empty() {
            let text = pipeline::delay_module(name, naming, origin);
            files.push(ModuleFile { modules: vec![naming.delay()], text });
        }
        return files;
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

/// Returns the contents of the memories with a write port, as pairs of the memory's name and the text of its memory file. Fails
/// if a word is wider than its memory.
pub fn writable_memories(design: &Design) -> Result<Vec<(String, String)>> {
    let mut memories = Vec::new();
    for (id, rom) in (0..).map(RomId).zip(&design.roms) {
        if rom.write.is_some() && rom.shares.is_none() {
            memories.push((rom.name.clone(), memory::contents(design, id)?));
        }
    }
    Ok(memories)
}

/// Returns the memory files for the ROMs of a design as pairs of file name and text; none if the style of `naming` puts the
/// words into the Verilog. The second read port of a memory has no file of its own. Fails for the reasons that
/// [`memory::contents`] lists.
pub fn memories(design: &Design, naming: &Naming) -> Result<Vec<(String, String)>> {
    let mut memories = Vec::new();
    for (id, file) in (0..).map(RomId).zip(&naming.files) {
        if !naming.style.inline && !naming.second.contains(&id) {
            memories.push((file.clone(), memory::contents(design, id)?));
        }
    }
    Ok(memories)
}

//! Asks a synthesis tool how many cells a core takes on each FPGA family that Glint compares: LUTs, DSP blocks and block RAMs.
//! The cells are counted before placement.

use anyhow::{Context, Result};
use rayon::prelude::*;
use serde::Serialize;

use glint_base::target::{COMPARED, Family, Usage};
use glint_core::core::Core;

/// A synthesis tool that counts the cells of a core.
pub trait Synthesis: Sync {
    /// Returns the version of the tool, for people: for example, `Yosys 0.23`.
    ///
    /// # Errors
    /// Fails if the tool does not say its version.
    fn version(&self) -> Result<String>;

    /// Counts the cells of the module `top` on an FPGA family. `files` are the Verilog and memory files: pairs of a file name
    /// without directory, and the contents.
    ///
    /// # Errors
    /// Fails if the tool fails or takes too long.
    fn usage(&self, files: &[(String, String)], top: &str, family: &Family) -> Result<Usage>;
}

/// The number of cells that a core takes on an FPGA family, before placement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FamilyUsage {
    pub family: &'static str,
    pub luts: u64,
    pub dsps: u64,
    pub block_rams: u64,
}

/// Returns the cells on each of the FPGA families [`COMPARED`], in their order. The function calls `done` after each family,
/// so that a caller can show progress.
///
/// # Errors
/// Fails if synthesis fails.
pub fn usage(
    core: &Core,
    synthesis: &dyn Synthesis,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<FamilyUsage>> {
    let (files, top) = (core.verilog()?, &core.config().name);
    let families = COMPARED.par_iter().map(|family| {
        let usage = synthesis.usage(&files, top, family);
        done();
        let usage = usage.with_context(|| format!("{top} for {}", family.title))?;
        let Usage { luts, dsps, block_rams, .. } = usage;
        Ok(FamilyUsage { family: family.title, luts, dsps, block_rams })
    });
    families.collect()
}

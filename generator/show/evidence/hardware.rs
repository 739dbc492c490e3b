//! Asks a synthesis tool how many cells a core takes before placement: LUTs, DSP blocks and block RAMs, on each FPGA family that
//! Glint compares.

use anyhow::{Context, Result};
use rayon::prelude::*;
use serde::Serialize;

use glint_base::target::{COMPARED, Family, Usage};
use glint_core::core::Core;

/// A synthesis tool that counts a core's cells.
pub trait Synthesis: Sync {
    /// Returns the tool's version as a page shows it, for example `Yosys 0.23`.
    ///
    /// # Errors
    ///
    /// Fails if the tool does not state its version.
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

/// Returns the cells on each of the FPGA families [`COMPARED`], in their order. Calls `done` after each family.
///
/// # Errors
///
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

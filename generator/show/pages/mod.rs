//! Makes the pages about a core that people read: its documentation page in Markdown, and its datasheet in HTML.

pub mod account;
pub mod datasheet;
pub mod diagram;
pub mod drawing;
pub mod figure;
pub mod formula;
mod markdown;
pub mod markup;
pub mod plots;
pub mod stages;

pub use account::PageInputs;
pub use markdown::page;

use std::path::Path;

use anyhow::Result;

use crate::evidence::advice;
use glint_base::input;
use glint_core::core::Core;

/// Returns the documentation page of `core` in Markdown. `config` is the configuration file's path, as the user gave it. The page
/// cites the records in the directory `proofs` as evidence for the error bound.
///
/// # Errors
/// Fails if a simulated computation does not finish within 65 536 clocks, or never raises `valid`. Fails if a record cannot be
/// read, or does not fit the contract.
pub fn of(core: &Core, config: &str, proofs: &Path) -> Result<String> {
    let line = core.line()?;
    let inputs = PageInputs {
        path: &input::label(config),
        config: core.config(),
        schema: &(core.device().schema)(),
        contract: core.contract.as_ref(),
        backing: &core.backing(proofs)?,
        advice: advice::of(core),
        timing: &core.timing()?,
        example: &core.example()?,
        line: line.as_ref(),
    };
    page(&core.design, &inputs)
}

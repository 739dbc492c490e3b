//! Pages for people: the page of a device, its datasheet, the report.

pub mod account;
pub mod datasheet;
pub mod diagram;
pub mod drawing;
pub mod figure;
mod formula;
mod markdown;
mod markup;
pub mod plots;
pub mod report;
pub mod stages;

pub use account::PageInputs;
pub use markdown::page;

use std::path::Path;

use anyhow::Result;

use crate::base::input;
use crate::core::Core;

impl Core {
    /// The page of the configuration, which the command line knows as `config`, a path; `proofs` is the directory of records.
    ///
    /// # Errors
    /// A device that does not end; a record that cannot be read.
    pub fn page(&self, config: &str, proofs: &Path) -> Result<String> {
        let line = self.line()?;
        let inputs = PageInputs {
            path: &input::label(config),
            config: &self.config,
            schema: &(self.device.schema)(),
            contract: self.contract.as_ref(),
            backing: &self.backing(proofs)?,
            advice: self.advice(),
            timing: &self.timing()?,
            example: &self.example()?,
            line: line.as_ref(),
        };
        page(&self.design, &inputs)
    }
}

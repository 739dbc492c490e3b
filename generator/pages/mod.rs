//! Pages for people: the page of a device, its datasheet, the report.

pub mod account;
pub mod datasheet;
pub mod drawing;
pub mod figure;
mod markdown;
pub mod plots;
pub mod report;

use anyhow::Result;

use crate::core::Unit;

pub use account::PageInputs;
pub use markdown::page;

impl Unit {
    /// The page of the configuration, which the command line knows as `config`.
    ///
    /// # Errors
    /// A device that does not end.
    pub fn page(&self, config: &str) -> Result<String> {
        let inputs = PageInputs {
            path: config,
            config: &self.config,
            schema: &(self.device.schema)(),
            contract: self.contract.as_ref(),
            timing: &self.timing()?,
            example: &self.example()?,
        };
        markdown::page(&self.design, &inputs)
    }
}

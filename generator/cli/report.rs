//! Prints the answers of commands: as JSON for scripts, or as text for people.
//!
//! A command returns its answer as a [`CommandReport`], which supports JSON and text. [`OutputOptions::report`] prints the form
//! that the user wants. A command that behaves differently for scripts asks [`OutputOptions::is_for_people`]. For example, `glint
//! tune` refuses `--csv` together with `--json`.

use anyhow::Result;
use serde_json::{Value, json};

use crate::{OutputOptions, tables};

/// The answer of a command, or one part of it.
pub trait CommandReport {
    /// Returns the answer for scripts. Fails if a part of the answer cannot be computed or written.
    fn json(&self) -> Result<Value>;

    /// Prints the answer for people. Fails if a part of the answer cannot be computed or written.
    fn print(&self) -> Result<()>;
}

impl OutputOptions {
    /// Prints a report: as JSON with `--json`, and otherwise as text.
    ///
    /// # Errors
    ///
    /// Fails if a part of the report cannot be computed or written.
    pub fn report(self, report: &impl CommandReport) -> Result<()> {
        if self.json {
            tables::print_json(&report.json()?);
            Ok(())
        } else {
            report.print()
        }
    }

    /// Returns whether people read the answer. Only people get, for example, an estimate of a long check's duration.
    pub fn is_for_people(self) -> bool {
        !self.json
    }

    pub fn list(self) -> ReportList {
        ReportList { output: self, reports: Vec::new() }
    }
}

/// Reports of the same kind, for example one for each configuration. As text, each report is printed when it is added. As
/// JSON, all reports are printed together at the end.
pub struct ReportList {
    output: OutputOptions,
    reports: Vec<Value>,
}

impl ReportList {
    /// Adds a report. Fails if a part of it cannot be computed or written.
    pub fn add(&mut self, report: &impl CommandReport) -> Result<()> {
        if self.output.json {
            self.reports.push(report.json()?);
            Ok(())
        } else {
            report.print()
        }
    }

    /// Ends the list and returns `holds`, which must say whether everything that the command checked holds. With `--json`, prints
    /// an object with the keys `ok`, which is `holds`, and `configurations`, the list of reports.
    pub fn conclude(self, holds: bool) -> Result<bool> {
        self.finish(|reports| Ok(json!({ "ok": holds, "configurations": reports })))?;
        Ok(holds)
    }

    /// Ends the list. With `--json`, prints the value that `answer` makes from the list of all reports.
    ///
    /// # Errors
    ///
    /// Fails if `answer` fails.
    pub fn finish(self, answer: impl FnOnce(Vec<Value>) -> Result<Value>) -> Result<()> {
        if self.output.json {
            tables::print_json(&answer(self.reports)?);
        }
        Ok(())
    }
}

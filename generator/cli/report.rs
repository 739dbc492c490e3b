//! Prints the answers of commands: as JSON for scripts, or as text for people.
//!
//! A command returns its answer as a [`CommandReport`], which can do both. Only this file asks which one the user wants.

use anyhow::Result;
use serde_json::{Value, json};

use crate::{OutputOptions, tables};

/// The answer of a command, or one part of it.
pub trait CommandReport {
    /// Returns the report for scripts.
    ///
    /// # Errors
    /// Fails if something that belongs to the report cannot be computed or written.
    fn json(&self) -> Result<Value>;

    /// Prints the report for people.
    ///
    /// # Errors
    /// Fails if something that belongs to the report cannot be computed or written.
    fn print(&self) -> Result<()>;
}

impl OutputOptions {
    /// Prints a report: as JSON with `--json`, and else as text.
    ///
    /// # Errors
    /// Fails if the report fails.
    pub fn report(self, report: &impl CommandReport) -> Result<()> {
        if self.json {
            tables::print_json(&report.json()?);
            Ok(())
        } else {
            report.print()
        }
    }

    /// Returns whether people read the answer, and not a script. For example, only people get an estimate of how long a check of
    /// several hours will take.
    pub fn is_for_people(self) -> bool {
        !self.json
    }

    /// Begins a list of reports.
    pub fn list(self) -> ReportList {
        ReportList { output: self, reports: Vec::new() }
    }
}

/// A list of reports of the same kind, for example one for each configuration. For people, each report is printed at once. For
/// scripts, all are printed together at the end.
pub struct ReportList {
    output: OutputOptions,
    reports: Vec<Value>,
}

impl ReportList {
    /// Adds a report, and prints it for people.
    ///
    /// # Errors
    /// Fails if the report fails.
    pub fn add(&mut self, report: &impl CommandReport) -> Result<()> {
        if self.output.json {
            self.reports.push(report.json()?);
            Ok(())
        } else {
            report.print()
        }
    }

    /// Ends the list of reports and returns `holds`, which says whether everything that the command checked holds. With `--json` it
    /// prints the reports and `holds`.
    ///
    /// # Errors
    /// Fails as [`ReportList::finish`] does.
    pub fn conclude(self, holds: bool) -> Result<bool> {
        self.finish(|reports| Ok(json!({ "ok": holds, "configurations": reports })))?;
        Ok(holds)
    }

    /// Ends the list. With `--json` it prints the answer of the command, which `answer` makes of all reports. For example,
    /// `finish(|reports| Ok(json!({ "ok": true, "schedules": reports })))`.
    ///
    /// # Errors
    /// Fails if `answer` fails.
    pub fn finish(self, answer: impl FnOnce(Vec<Value>) -> Result<Value>) -> Result<()> {
        if self.output.json {
            tables::print_json(&answer(self.reports)?);
        }
        Ok(())
    }
}

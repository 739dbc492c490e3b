//! `glint` without a command: generates the files of every configuration in `configs/`, co-simulates each, and reports the
//! results.

use std::path::Path;

use anyhow::Result;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::mismatch::Reproducer;
use super::{CONFIGS, FAILS, HOLDS, Loaded, OUTSIDE, cosim, generate, load, verdict};
use crate::report::CommandReport;
use crate::{OutputOptions, progress, say, tables};
use glint_base::text;
use glint_core::core::{TEST_POINTS, TEST_SEED};
use glint_core::cosim::Outcome;
use glint_core::package::HandshakeTiming;
use glint_core::registry::Registry;
use glint_golden::Bounds;

struct MainJobResult {
    timing: HandshakeTiming,
    bounds: Bounds,
    outcome: Outcome,
    /// A sentence for each failure; empty if everything holds.
    failures: Vec<String>,
}

/// Returns whether every configuration has passed. With `details`, also prints the operands of the largest error of each
/// configuration, and the remarks on its formula.
///
/// # Errors
/// Fails if a configuration has problems, if files cannot be written, or if a simulation cannot be run.
pub fn run(registry: &Registry, output: OutputOptions, details: bool) -> Result<bool> {
    let loaded = load(registry, &[])?;
    for one in &loaded {
        one.bound()?;
    }
    for (one, made) in loaded.iter().zip(generate::all_files(output, &loaded, true)?) {
        generate::write(Path::new("."), one, &made.files, false)?;
    }
    let bar = progress::bar(output, TEST_POINTS * loaded.len() as u64, "points checked");
    let findings: Vec<MainJobResult> =
        loaded.par_iter().map(|one| finding(one, &bar)).collect::<Result<_>>()?;
    bar.finish_and_clear();
    let holds = findings.iter().all(|finding| finding.failures.is_empty());
    output.report(&MainJobReport { loaded: &loaded, findings: &findings, details, holds })?;
    Ok(holds)
}

struct MainJobReport<'a> {
    loaded: &'a [Loaded],
    findings: &'a [MainJobResult],
    /// Whether people get more than the table.
    details: bool,
    holds: bool,
}

impl CommandReport for MainJobReport<'_> {
    fn json(&self) -> Result<Value> {
        let mut configurations = Vec::new();
        for (one, finding) in self.loaded.iter().zip(self.findings) {
            configurations.push(as_json(one, finding)?);
        }
        Ok(json!({ "ok": self.holds, "configurations": configurations }))
    }

    fn print(&self) -> Result<()> {
        print(self.loaded, self.findings, self.details)
    }
}

fn finding(one: &Loaded, bar: &indicatif::ProgressBar) -> Result<MainJobResult> {
    let lockstep = one.core.lockstep(TEST_SEED)?;
    let outcome = lockstep.run(TEST_POINTS, &|points| bar.inc(points))?;
    let bounds = one.core.contract.bounds();
    let failures = outcome.failures(&bounds);
    Ok(MainJobResult { timing: one.core.timing()?, bounds, outcome, failures })
}

/// The columns of the table. Only a line with counts follows the table.
const COLUMNS: &str = "configuration | device;6 | clocks/point:2 | points:4 | clocks:7 | registers, outputs:8 | ROM bits:3 | \
                       bound:1 | largest error: | verdict";

fn print(loaded: &[Loaded], findings: &[MainJobResult], details: bool) -> Result<()> {
    for (one, finding) in loaded.iter().zip(findings) {
        if details && let Some(worst) = &finding.outcome.worst {
            say!(
                "{}: {} registers and {} outputs equal the golden model on each of {} clocks; the largest error is at {}",
                one.path,
                finding.outcome.registers,
                finding.outcome.outputs,
                text::grouped(finding.outcome.clocks),
                cosim::worst_operands(one, worst)
            );
        }
        if details {
            for remark in one.core.contract.remarks() {
                say!("{}: {remark}", one.path);
            }
        }
        for failure in &finding.failures {
            say!("{}: FAILS: {failure}", one.path);
        }
        if let Some(mismatch) = &finding.outcome.mismatch {
            let where_to_look = Reproducer::of_run(one, mismatch)?.text(mismatch);
            say!("{}: {where_to_look}", one.path);
        }
    }
    let mut rows = Vec::new();
    for (one, finding) in loaded.iter().zip(findings) {
        let clocks = match finding.timing.clocks_per_point() {
            Some(clocks) => clocks.to_string(),
            None => "varies".to_owned(),
        };
        let largest_error = match &finding.outcome.worst {
            Some(worst) => format!("{:.3}", worst.units),
            None => "-".to_owned(),
        };
        rows.push(vec![
            short(&one.path).to_owned(),
            one.core.device().name.to_owned(),
            clocks,
            text::grouped(finding.outcome.points),
            text::grouped(finding.outcome.clocks),
            format!("{}, {}", finding.outcome.registers, finding.outcome.outputs),
            text::grouped(one.core.design.rom_bits()),
            finding.bounds.words(),
            largest_error,
            verdict(&finding.bounds, &finding.failures).to_owned(),
        ]);
    }
    tables::print(COLUMNS, rows);
    tables::print_line(&counts(findings));
    Ok(())
}

/// Returns the short name of a configuration in `configs/`, such as `rough` for `configs/rough.toml`, and the whole path of any
/// other configuration.
fn short(path: &str) -> &str {
    let name = path.strip_prefix(CONFIGS).and_then(|name| name.strip_prefix('/'));
    name.and_then(|name| name.strip_suffix(".toml")).unwrap_or(path)
}

/// Returns a sentence such as `19 of 21 hold; 2 FAIL.` A configuration whose contract has no bound counts only in the total.
fn counts(findings: &[MainJobResult]) -> String {
    let (mut hold, mut outside, mut fail) = (0, 0, 0);
    for finding in findings {
        match verdict(&finding.bounds, &finding.failures) {
            HOLDS => hold += 1,
            OUTSIDE => outside += 1,
            FAILS => fail += 1,
            _ => {}
        }
    }
    let mut parts = vec![format!("{hold} of {} hold", findings.len())];
    if outside > 0 {
        parts.push(format!("{outside} outside the accuracy contract, within their own bound"));
    }
    if fail > 0 {
        parts.push(format!("{fail} FAIL"));
    }
    format!("{}.", parts.join("; "))
}

fn as_json(one: &Loaded, finding: &MainJobResult) -> Result<Value> {
    let mut value = cosim::as_json(one, &finding.outcome, &finding.bounds, &finding.failures)?;
    value["clocks_per_point"] = json!(finding.timing.clocks_per_point());
    Ok(value)
}

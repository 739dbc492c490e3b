//! The main job: generate everything, co-simulate everything, say what was found.

use std::path::Path;

use anyhow::Result;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::mismatch::Reproducer;
use super::{Loaded, cosim, generate, load};
use crate::base::text;
use crate::cli::{Output, progress, tables};
use crate::core::{TEST_POINTS, TEST_SEED};
use crate::cosim::Outcome;
use crate::golden::Bound;
use crate::package::Timing;
use crate::registry::Registry;

/// What the main job found of one configuration.
struct Finding {
    timing: Timing,
    bound: Bound,
    outcome: Outcome,
    /// What does not hold.
    faults: Vec<String>,
}

/// The main job.
pub fn everything(registry: &Registry, output: Output) -> Result<bool> {
    let loaded = load(registry, &[])?;
    for one in &loaded {
        one.contract()?;
    }
    for (one, files) in loaded.iter().zip(generate::all_files(output, &loaded)?) {
        generate::write(Path::new("."), one, &files, false)?;
    }
    let bar = progress::bar(output, TEST_POINTS * loaded.len() as u64, "points checked");
    let findings: Vec<Finding> =
        loaded.par_iter().map(|one| finding(one, &bar)).collect::<Result<_>>()?;
    bar.finish_and_clear();
    let holds = findings.iter().all(|finding| finding.faults.is_empty());
    if output.json {
        let list: Vec<Value> = loaded
            .iter()
            .zip(&findings)
            .map(|(one, finding)| as_json(one, finding))
            .collect::<Result<_>>()?;
        tables::print_json(&json!({ "ok": holds, "configurations": list }));
        return Ok(holds);
    }
    print(&loaded, &findings)?;
    Ok(holds)
}

fn finding(one: &Loaded, bar: &indicatif::ProgressBar) -> Result<Finding> {
    let lockstep = one.unit.lockstep(TEST_SEED)?;
    let outcome = lockstep.run(TEST_POINTS, &|points| bar.inc(points))?;
    let bound = one.unit.contract.bound();
    let faults = outcome.faults(&bound);
    Ok(Finding { timing: one.unit.timing()?, bound, outcome, faults })
}

fn print(loaded: &[Loaded], findings: &[Finding]) -> Result<()> {
    let headings = [
        "device",
        "configuration",
        "clocks/point",
        "points",
        "clocks",
        "registers",
        "outputs",
        "ROM bits",
        "bound",
        "largest error",
        "verdict",
    ];
    let rows = loaded.iter().zip(findings).map(|(one, finding)| {
        let clocks = finding.timing.clocks_per_point();
        vec![
            one.unit.device.name.to_owned(),
            one.path.clone(),
            clocks.map_or_else(|| "varies".to_owned(), |clocks| clocks.to_string()),
            text::grouped(finding.outcome.points),
            text::grouped(finding.outcome.clocks),
            finding.outcome.registers.to_string(),
            finding.outcome.outputs.to_string(),
            text::grouped(one.unit.design.rom_bits()),
            format!("{:.3}", finding.bound.units),
            finding
                .outcome
                .worst
                .as_ref()
                .map_or_else(|| "-".to_owned(), |worst| format!("{:.3}", worst.units)),
            if finding.faults.is_empty() { "holds" } else { "FAILS" }.to_owned(),
        ]
    });
    let numbers = [
        "clocks/point",
        "points",
        "clocks",
        "registers",
        "outputs",
        "ROM bits",
        "bound",
        "largest error",
    ];
    tables::print(&headings, &numbers, rows);
    tables::print_line(
        "Registers and outputs are compared with the golden model on every clock. Errors are in output units, against the formula in f64. The largest error is at:",
    );
    for (one, finding) in loaded.iter().zip(findings) {
        if let Some(worst) = &finding.outcome.worst {
            tables::print_line(&format!("  {}: {}", one.path, cosim::place(one, worst)));
        }
        for fault in &finding.faults {
            tables::print_line(&format!("  {}: FAILS: {fault}", one.path));
        }
        if let Some(mismatch) = &finding.outcome.mismatch {
            let where_to_look = Reproducer::of_run(one, mismatch)?.text(mismatch);
            tables::print_line(&format!("  {}: {where_to_look}", one.path));
        }
    }
    Ok(())
}

fn as_json(one: &Loaded, finding: &Finding) -> Result<Value> {
    let mut value = cosim::as_json(one, &finding.outcome, &finding.bound, &finding.faults)?;
    value["clocks_per_point"] = json!(finding.timing.clocks_per_point());
    Ok(value)
}

//! `report`.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::json;

use crate::cli::own_file::OwnFile;
use crate::cli::tables::Column;
use crate::cli::{Output, progress, tables};
use crate::evidence;
use crate::evidence::benchmark;
use crate::evidence::claims::Verdict;
use crate::pages::report;
use crate::registry::Registry;
use crate::tools::Tool;

/// What `report` was asked for.
pub struct ReportRequest {
    /// Where the files go.
    pub out: PathBuf,
    /// Time W against Schlick's function.
    pub benchmark: bool,
    /// Synthesise W and Schlick's function.
    pub synthesis: bool,
    /// After which a run of Yosys is given up.
    pub time_limit: Duration,
}

/// `glint report`.
pub fn report(registry: &Registry, output: Output, request: &ReportRequest) -> Result<bool> {
    // Before the work: a directory that cannot be written is known now.
    fs::create_dir_all(&request.out)
        .with_context(|| format!("cannot make the directory `{}`", request.out.display()))?;
    let html = OwnFile::new(&request.out, "report.html", report::MARKER)?;
    let figures = OwnFile::new(&request.out, "report.json", OwnFile::JSON)?;
    let timings = match request.benchmark {
        true => Some(OwnFile::new(&request.out, "benchmark.json", OwnFile::JSON)?),
        false => None,
    };
    let mut notes = Vec::new();
    let yosys = match request.synthesis.then(|| Tool::find("yosys")) {
        None => None,
        Some(Ok(yosys)) => Some(yosys),
        Some(Err(missing)) => {
            notes.push(format!("{missing}: nothing is synthesised"));
            None
        }
    };
    // Alone, before the processors are busy.
    let timed = request.benchmark.then(benchmark::run);
    let steps = evidence::steps(registry, yosys.is_some());
    let bar = progress::bar(output, steps as u64, "measurements");
    let synthesis = yosys.as_ref().map(|yosys| (yosys, request.time_limit));
    let evidence = evidence::gather(registry, synthesis, &|| bar.inc(1))?;
    bar.finish_and_clear();
    notes.extend(evidence.notes.iter().cloned());
    let mut written = vec![
        figures.write_json(&evidence)?,
        html.write(&report::page(&evidence, timed.as_ref())?)?,
    ];
    if let (Some(target), Some(timed)) = (timings, &timed) {
        written.push(target.write_json(timed)?);
    }
    if output.json {
        tables::print_json(&json!({
            "ok": true,
            "written": written,
            "claims": evidence.claims,
            "benchmark": timed,
            "notes": notes,
        }));
        return Ok(true);
    }
    let rows = evidence.claims.iter().map(|claim| {
        let ours: Vec<&str> = claim.ours.iter().map(|one| one.text.as_str()).collect();
        vec![
            claim.claim.clone(),
            claim.seed.clone(),
            ours.join("; "),
            claim.verdict.words().to_owned(),
        ]
    });
    tables::print(&["claim", "the seed", "ours", "verdict"].map(Column::words), rows);
    let count = |verdict| {
        let claims = evidence.claims.iter();
        claims.filter(|claim| claim.verdict == verdict).count()
    };
    tables::print_line(&format!(
        "{} claims: {} hold, {} depend on the definition, {} nearly hold, {} do not hold.",
        evidence.claims.len(),
        count(Verdict::Holds),
        count(Verdict::Depends),
        count(Verdict::Nearly),
        count(Verdict::Fails),
    ));
    if let Some(timed) = &timed {
        tables::print_line(&timed.words);
    }
    for note in notes {
        tables::print_line(&format!("Note: {note}"));
    }
    tables::print_line(&format!("Written: {}", written.join(", ")));
    Ok(true)
}

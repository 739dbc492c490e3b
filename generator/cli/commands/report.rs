//! `report`.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use serde_json::json;

use super::yosys;
use crate::own_file::OwnFile;
use crate::{Output, TimeLimit, progress, say, tables};
use glint_core::registry::Registry;
use glint_prove::synth::Yosys;
use glint_show::evidence;
use glint_show::evidence::benchmark;
use glint_show::evidence::claims::Verdict;
use glint_show::evidence::hardware::Synthesis;
use glint_show::pages::report;

/// Measure all devices and the claims of their sources, and write a page about them
///
/// Writes report.html, one page that needs no network, and report.json with all its figures: error curves of
/// every device, the plots that the source documents (seeds 000 to 002) describe, and their claims, each with a
/// verdict. The same tools give the same files. With Yosys on PATH, W and Schlick's function are synthesised.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint report                            report/report.html and report/report.json
  glint report --out build --benchmark    also build/benchmark.json: W timed against Schlick
  glint report --json                     the claims, for scripts")]
pub struct Arguments {
    /// Where the files go
    #[arg(long, value_name = "DIR", default_value = "report")]
    out: PathBuf,
    /// Also time W against Schlick's function, into a file of its own
    #[arg(long)]
    benchmark: bool,
    /// Do not ask Yosys what W and Schlick's function take
    #[arg(long)]
    no_synthesis: bool,
    #[command(flatten)]
    time_limit: TimeLimit,
}

/// `glint report`.
pub fn run(registry: &Registry, output: Output, arguments: &Arguments) -> Result<bool> {
    let html = OwnFile::new(&arguments.out, "report.html", report::MARKER)?;
    let figures = OwnFile::new(&arguments.out, "report.json", OwnFile::JSON)?;
    let timings = if arguments.benchmark {
        Some(OwnFile::new(&arguments.out, "benchmark.json", OwnFile::JSON)?)
    } else {
        None
    };
    let mut notes = Vec::new();
    let wanted = !arguments.no_synthesis;
    let yosys = wanted.then(|| yosys("nothing is synthesised", &mut notes)).flatten();
    // Alone, before the processors are busy.
    let timed = arguments.benchmark.then(benchmark::run);
    let steps = evidence::steps(registry, yosys.is_some());
    let bar = progress::bar(output, steps as u64, "measurements");
    let synthesis = yosys.as_ref().map(|yosys| Yosys(yosys, arguments.time_limit.get()));
    let synthesis = synthesis.as_ref().map(|it| it as &dyn Synthesis);
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
    tables::print("claim | the seed | ours | verdict", rows);
    let counts = Verdict::ALL.into_iter().filter_map(|verdict| {
        let claims = evidence.claims.iter().filter(|claim| claim.verdict == verdict);
        Some((claims.count(), verdict.words())).filter(|(count, _)| *count > 0)
    });
    let counts: Vec<String> =
        counts.map(|(count, verdict)| format!("{verdict}: {count}")).collect();
    say!("{} claims. {}.", evidence.claims.len(), counts.join("; "));
    if let Some(timed) = &timed {
        tables::print_line(&timed.words);
    }
    for note in notes {
        say!("Note: {note}");
    }
    say!("Written: {}", written.join(", "));
    Ok(true)
}

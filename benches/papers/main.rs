//! Measures the claims that the seeds make about their functions and devices. A seed is a document from which a device comes:
//! `cargo run --release --manifest-path benches/papers/Cargo.toml -- DIR`.
//!
//! The program writes two files into the new directory `DIR`: `report.html`, a page that needs no network, and `report.json`
//! with all of its numbers. The files contain error curves of the ten highlight devices, the plots that the seeds 000 to 002
//! describe, and their claims, each with a verdict. With Yosys on PATH, the program synthesises W and Schlick's function.
//! `--benchmark` also measures their speed in software and writes `benchmark.json`.

mod evidence;

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use serde::Serialize;

use evidence::{benchmark, page};
use glint::evidence::hardware::Synthesis;
use glint::registry::Registry;
use glint::synth::Yosys;
use glint::tools::Tool;

/// For each run of Yosys.
const LIMIT: Duration = Duration::from_secs(600);

fn main() -> Result<()> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let timed = arguments.iter().position(|it| it == "--benchmark");
    // Alone, before the processors are busy.
    let timed = timed.map(|at| arguments.remove(at)).map(|_| benchmark::run());
    let [directory] = &arguments[..] else { bail!("usage: papers DIR [--benchmark]") };
    let directory = PathBuf::from(directory);
    fs::create_dir(&directory)
        .with_context(|| format!("`{}` is to be a new directory", directory.display()))?;
    let yosys = Tool::find("yosys");
    if let Err(missing) = &yosys {
        eprintln!("{missing}: nothing is synthesised");
    }
    let synthesis = yosys.as_ref().ok().map(|yosys| Yosys(yosys, LIMIT));
    let synthesis = synthesis.as_ref().map(|it| it as &dyn Synthesis);
    let evidence = evidence::gather(&Registry::shipped(), synthesis)?;
    fs::write(directory.join("report.json"), text(&evidence)?)?;
    fs::write(directory.join("report.html"), page::page(&evidence, timed.as_ref())?)?;
    if let Some(timed) = &timed {
        fs::write(directory.join("benchmark.json"), text(timed)?)?;
        println!("{}", timed.words);
    }
    for claim in &evidence.claims {
        println!("{}: {} ({})", claim.verdict.words(), claim.claim, claim.seed);
    }
    for note in &evidence.notes {
        println!("Note: {note}");
    }
    Ok(())
}

/// Returns a value as JSON, ending with a newline.
fn text(value: &impl Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}

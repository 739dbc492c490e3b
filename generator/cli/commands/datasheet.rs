//! `datasheet`.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use clap::Args;
use serde_json::json;

use super::{Loaded, load};
use crate::cli::failure::Usage;
use crate::cli::store::{self, Written};
use crate::cli::{Configs, Output, progress, tables};
use crate::cosim::exhaustive::Record;
use crate::package::Seal;
use crate::pages::datasheet::{self, Subject};
use crate::registry::Registry;
use crate::synth;
use crate::tools::Tool;

/// What `datasheet` was asked for.
#[derive(Args)]
pub struct DatasheetArguments {
    #[command(flatten)]
    configs: Configs,
    /// A directory, or for one configuration a file that ends in .html
    #[arg(long, value_name = "DIR|FILE.html", default_value = "datasheets")]
    out: PathBuf,
    /// Where records of `cosim --exhaustive --json` are; that of the configuration is found by its digest
    #[arg(long, value_name = "DIR", default_value = "proofs")]
    proofs: PathBuf,
    /// Where records of `synth --out` are; that of the configuration is found by its digest
    #[arg(long, value_name = "DIR", default_value = synth::DIRECTORY)]
    figures: PathBuf,
    /// Write the timing diagram for WaveDrom too, beside the page
    #[arg(long)]
    wavedrom: bool,
    /// Replace files that Glint did not write or that were edited since
    #[arg(long)]
    force: bool,
    /// Do not ask Yosys what a device takes of which there is no record
    #[arg(long)]
    no_synthesis: bool,
    /// Time limit of each run of Yosys, in seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 600, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    time_limit: u64,
}

/// `glint datasheet`.
pub fn datasheet(
    registry: &Registry,
    output: Output,
    request: &DatasheetArguments,
) -> Result<bool> {
    let loaded = load(registry, &request.configs.configs)?;
    let single = request.out.extension().is_some_and(|it| it.eq_ignore_ascii_case("html"));
    if single && loaded.len() != 1 {
        bail!(Usage(format!(
            "--out {}: a file takes one configuration, and there are {}; give a directory",
            request.out.display(),
            loaded.len()
        )));
    }
    // Before the work: whether everything can be written, and which records there are.
    let mut records = Vec::new();
    for one in &loaded {
        let (core, contract) = (&one.core, one.core.contract.as_ref());
        let proof = Record::find(&request.proofs, &core.contract_digest(), contract)?;
        records.push((proof, synth::Record::find(&request.figures, &core.core_digest())?));
        store::may_write(&path(request, one, single), Seal::Markup, request.force)?;
    }
    let mut notes = Vec::new();
    let yosys = match (!request.no_synthesis).then(|| Tool::find("yosys")) {
        None => None,
        Some(Ok(yosys)) => Some(yosys),
        Some(Err(missing)) => {
            notes.push(format!("{missing}: nothing is synthesised"));
            None
        }
    };
    let limit = Duration::from_secs(request.time_limit);
    let steps = records.iter().map(|(_, it)| datasheet::steps(yosys.is_some() && it.is_none()));
    let steps: usize = steps.sum();
    let bar = progress::bar(output, steps as u64, "datasheets");
    bar.tick();
    let mut report = Vec::new();
    for (one, (proof, figures)) in loaded.iter().zip(records) {
        let subject = Subject {
            core: &one.core,
            path: &one.path,
            proof,
            figures,
            synthesis: yosys.as_ref().map(|yosys| (yosys, limit)),
        };
        let made = datasheet::datasheet(&subject, &|| bar.inc(1));
        let made = made.with_context(|| format!("`{}`", one.path))?;
        let page = path(request, one, single);
        let mut files = vec![(page.clone(), made.page, Seal::Markup)];
        if request.wavedrom {
            let path = page.with_extension("wavedrom.json");
            files.push((path, made.wavedrom, Seal::Json));
        }
        for (path, text, seal) in files {
            let written = store::write_sealed(&path, &text, seal, request.force);
            let written = written.with_context(|| format!("`{}` has no datasheet", one.path))?;
            report.push((one, path.display().to_string().replace('\\', "/"), written));
        }
    }
    bar.finish_and_clear();
    tell(output, &report, &notes);
    Ok(true)
}

/// The page of a configuration.
fn path(request: &DatasheetArguments, one: &Loaded, single: bool) -> PathBuf {
    match single {
        true => request.out.clone(),
        false => request.out.join(format!("{}.html", one.core.config.name)),
    }
}

fn tell(output: Output, report: &[(&Loaded, String, Written)], notes: &[String]) {
    if output.json {
        let files = report.iter().map(|(one, path, written)| {
            json!({
                "config": one.path,
                "name": one.core.config.name,
                "file": path,
                "written": *written == Written::Replaced,
            })
        });
        let files: Vec<_> = files.collect();
        tables::print_json(&json!({ "ok": true, "datasheets": files, "notes": notes }));
        return;
    }
    for (one, path, written) in report {
        let what = match written {
            Written::Unchanged => "up to date",
            Written::Replaced => "written",
        };
        tables::print_line(&format!("{}: {path} {what}", one.path));
    }
    for note in notes {
        tables::print_line(&format!("Note: {note}"));
    }
}

//! `glint datasheet`: writes one HTML page for a configuration that needs no other file and no network.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use serde_json::{Value, json};

use super::{Loaded, load, yosys};
use crate::report::CommandReport;
use crate::store::{self, Written};
use crate::{Configs, OutputOptions, TimeLimit, progress, say, wrong_usage};
use glint_core::cosim::exhaustive::{PROOFS, Record};
use glint_core::package::Seal;
use glint_core::registry::Registry;
use glint_prove::synth;
use glint_prove::synth::Yosys;
use glint_show::evidence::hardware::Synthesis;
use glint_show::pages::datasheet::{self, Subject};

/// Write a datasheet, an HTML page that loads nothing from the network
///
/// The page resembles a vendor's product guide: key figures, block diagram, ports and formats, a worked example, a timing
/// diagram from simulation, the microprogram with its control lines, latency and throughput, the error bound with its proof
/// and plots, a rendered highlight, an instance in Verilog, and the sources. Area, frequency, points per second and longest
/// paths come from a record of `glint synth`. If there is no record and Yosys is on PATH, the page shows what Yosys counts
/// for iCE40, ECP5 and Xilinx 7, which takes a minute or more. A file that Glint did not write, or that was edited since, is
/// replaced only with --force.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint datasheet                                       all of configs/, into datasheets/
  glint datasheet my_core.toml --no-synthesis           in a second or two
  glint datasheet my_core.toml --out core.html          one page, under this name
  glint datasheet configs/rough.toml --wavedrom         also datasheets/rough.wavedrom.json")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
    /// A directory, or for one configuration a file that ends in .html
    #[arg(long, value_name = "DIR|FILE.html", default_value = "datasheets")]
    out: PathBuf,
    /// The directory with the records of `cosim --exhaustive --json`; a record is found by the digest of its configuration
    #[arg(long, value_name = "DIR", default_value = PROOFS)]
    proofs: PathBuf,
    /// The directory with the records of `synth --out`; a record is found by the digest of its configuration
    #[arg(long, value_name = "DIR", default_value = synth::DIRECTORY)]
    figures: PathBuf,
    /// Also write the timing diagram for WaveDrom, next to the page
    #[arg(long)]
    wavedrom: bool,
    /// Also replace files that Glint did not write or that were edited since
    #[arg(long)]
    force: bool,
    /// Do not run Yosys for a configuration that has no record
    #[arg(long)]
    no_synthesis: bool,
    #[command(flatten)]
    time_limit: TimeLimit,
}

/// Writes the datasheets.
///
/// # Errors
///
/// Fails if a configuration has problems, if a record cannot be read, or if a file was edited or cannot be written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let loaded = load(registry, &arguments.configs.paths)?;
    let single = arguments.out.extension().is_some_and(|it| it.eq_ignore_ascii_case("html"));
    if single && loaded.len() != 1 {
        wrong_usage!(
            "--out {}: one file holds the datasheet of one configuration, and there are {} configurations; \
             give a directory",
            arguments.out.display(),
            loaded.len()
        );
    }
    // Before the long work, this checks whether the pages can be written, and searches for records.
    let mut records = Vec::new();
    for one in &loaded {
        let (core, contract) = (&one.core, one.core.contract.as_ref());
        let proof = Record::find(&arguments.proofs, &core.contract_digest(), contract)?;
        let figures = synth::SynthesisRecord::find(&arguments.figures, &core.core_digest())?;
        records.push((core.backing(&arguments.proofs)?, proof, figures));
        store::may_write(&path(arguments, one, single), Seal::Markup, arguments.force)?;
    }
    let mut notes = Vec::new();
    let wanted = !arguments.no_synthesis;
    let yosys = wanted.then(|| yosys("no configuration is synthesised", &mut notes)).flatten();
    let limit = arguments.time_limit.get();
    let steps = records.iter().map(|(_, _, it)| datasheet::steps(yosys.is_some() && it.is_none()));
    let steps: usize = steps.sum();
    let bar = progress::bar(output, steps as u64, "datasheets");
    bar.tick();
    let synthesis = yosys.as_ref().map(|yosys| Yosys(yosys, limit));
    let mut report = Vec::new();
    for (one, (backing, proof, figures)) in loaded.iter().zip(records) {
        let subject = Subject {
            core: &one.core,
            path: &one.path,
            backing,
            proof,
            figures,
            synthesis: synthesis.as_ref().map(|it| it as &dyn Synthesis),
        };
        let made = datasheet::datasheet(&subject, &|| bar.inc(1));
        let made = made.with_context(|| format!("`{}`", one.path))?;
        let page = path(arguments, one, single);
        let mut files = vec![(page.clone(), made.page, Seal::Markup)];
        if arguments.wavedrom {
            let path = page.with_extension("wavedrom.json");
            files.push((path, made.wavedrom, Seal::Json));
        }
        for (path, text, seal) in files {
            let written = store::write_sealed(&path, &text, seal, arguments.force);
            let written = written
                .with_context(|| format!("the datasheet of `{}` was not written", one.path))?;
            report.push((one, path.display().to_string().replace('\\', "/"), written));
        }
    }
    bar.finish_and_clear();
    output.report(&DatasheetFiles { files: report, notes })?;
    Ok(true)
}

/// Returns a datasheet's path, usually of the form `datasheets/rough.html`. With `single`, it is the file that the user named.
fn path(arguments: &Arguments, one: &Loaded, single: bool) -> PathBuf {
    if single {
        arguments.out.clone()
    } else {
        arguments.out.join(format!("{}.html", one.core.config().name))
    }
}

struct DatasheetFiles<'a> {
    /// The configuration and the path of each file, and whether the file has changed.
    files: Vec<(&'a Loaded, String, Written)>,
    notes: Vec<String>,
}

impl CommandReport for DatasheetFiles<'_> {
    fn json(&self) -> Result<Value> {
        let mut files = Vec::new();
        for (one, path, written) in &self.files {
            files.push(json!({
                "config": one.path,
                "name": one.core.config().name,
                "file": path,
                "written": *written == Written::Replaced,
            }));
        }
        Ok(json!({ "ok": true, "datasheets": files, "notes": self.notes }))
    }

    fn print(&self) -> Result<()> {
        for (one, path, written) in &self.files {
            say!("{}: {path} {written}", one.path);
        }
        for note in &self.notes {
            say!("Note: {note}");
        }
        Ok(())
    }
}

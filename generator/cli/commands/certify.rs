//! `glint certify`: lets the prover Gappa prove the error bound of a sequential core's contract. If the contract states no
//! bound, Gappa finds one.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, bail};
use clap::Args;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::{Loaded, cosim, load_sequential};
use crate::own_file::OwnFile;
use crate::report::CommandReport;
use crate::{Configs, OutputOptions, progress, say};
use glint_base::{input, text};
use glint_core::cosim::exhaustive::Certificate;
use glint_core::package::{Seal, is_sealed};
use glint_core::registry::Registry;
use glint_golden::{Bound, Contract, Term};
use glint_prove::certify::{
    self, ProofOutcome, ProofSubject, Statement, prove, questions, statements,
};
use glint_rtl::netlist::Design;
use glint_tools::Tool;

/// Prove the error bound of a contract with Gappa, from the netlist and the microprogram
///
/// The command unrolls one computation of the core into its values. For each case of the saturations, clamps and tables it
/// writes a statement on real numbers with roundings: the output differs from the contract's formula by at most the bound.
/// Gappa proves the statements. The cases cover the whole domain, so the contract is proved if Gappa proves all statements.
/// With --coq, the kernel of Coq checks each proof again. If a step of the computation cannot be written as a statement, the
/// command names the step, and the exit code is 1.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint certify configs/cosine_power.toml
  glint certify configs/cosine_power.toml --out certificates   also writes the Gappa scripts
  glint certify configs/cosine_power.toml --coq                needs coqc, and Gappa's library for Coq")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
    /// Write each Gappa script to `DIR/<name>/<output>_<number>.g`, and the results to `DIR/<name>.json`
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Have Coq check each of Gappa's proofs
    #[arg(long)]
    coq: bool,
    /// Time limit of each proof, and of writing the statements of a configuration, in seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    time_limit: u64,
}

/// The first words of a script that Glint wrote.
const MARKER: &str = "# Certificate by Glint: ";

/// The beginning of the second line of a script; a point follows at which the hypotheses of the statement hold.
const WITNESS: &str = "# The hypotheses hold at ";

/// Prints the bound's terms, to help the reader of a failed proof. If a device has parts, the terms include the bounds of the
/// parts.
fn tell_terms(bound: &Bound) {
    if bound.is_stated() {
        say!(
            "  the contract states a bound of {} units, which this command did not prove; the terms of the \
             bound are:",
            bound.words()
        );
    }
    for Term { key, what, units } in &bound.terms {
        say!("  {}  {what} ({key})", text::rounded_up(*units, 3));
    }
}

/// Runs the command. Returns whether all statements are proved.
///
/// # Errors
///
/// Fails if a configuration has problems or is a named pipeline, if Gappa or Coq is missing, or if a file was edited or cannot
/// be written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let loaded = load_sequential(registry, &arguments.configs.paths, "certify")?;
    let limit = Duration::from_secs(arguments.time_limit);
    if let Some(out) = arguments.out.as_deref().filter(|out| out.exists() && !out.is_dir()) {
        bail!("`{}` is not a directory: give a directory with --out", out.display());
    }
    let gappa = Tool::find("gappa")?;
    gappa.ensure_works(limit)?;
    let coq = arguments.coq.then(|| Tool::find("coqc")).transpose()?;
    let mut list = output.list();
    let mut whole = true;
    for one in &loaded {
        let contract = one.core.contract.as_ref();
        let design = &one.core.design;
        let is_stated = contract.bounds().are_stated();
        if is_stated {
            one.contract()?;
        }
        let out = arguments.out.as_ref().map(|out| out.join(&one.core.config().name));
        let record = OwnFile::record(arguments.out.as_deref(), &one.core.config().name)?;
        let stated = if is_stated {
            statements(design, contract, limit)
                .map(|stated| (stated, contract.bounds().governing().units))
        } else {
            found(design, contract, &gappa, limit)?
        };
        let (stated, bound) = match stated {
            Ok(stated) => stated,
            Err(step) => {
                whole = false;
                // Scripts of an earlier run with other keys would still say that they were accepted.
                if let Some(directory) = out
                    && directory.exists()
                {
                    write(&directory, &one.path, &[], &[])?;
                }
                if let Some(record) = record {
                    record.write_json(&certificate(
                        one,
                        contract.bounds().governing().units,
                        false,
                        &[],
                    ))?;
                }
                list.add(&WithoutStatements {
                    one,
                    step,
                    bound: contract.bounds().governing().clone(),
                })?;
                continue;
            }
        };
        let bar = progress::bar(output, stated.len() as u64, "statements proved");
        let results: Vec<Result<ProofOutcome>> = stated
            .par_iter()
            .map(|statement| {
                let outcome = prove(&gappa, coq.as_ref(), statement, limit);
                bar.inc(1);
                outcome
            })
            .collect();
        bar.finish_and_clear();
        let outcomes: Vec<ProofOutcome> = results.into_iter().collect::<Result<_>>()?;
        if let Some(directory) = out {
            write(&directory, &one.path, &stated, &outcomes)?;
        }
        let report = Certification::new(one, bound, is_stated, arguments.coq, &stated, &outcomes);
        let is_certified = report.open.is_empty();
        whole &= is_certified;
        if let Some(record) = record {
            record.write_json(&certificate(one, bound, is_certified, &stated))?;
        }
        list.add(&report)?;
    }
    list.finish(|certificates| {
        let gappa = gappa.version()?;
        let coq = coq.map(|coq| coq.version()).transpose()?;
        Ok(json!({ "ok": whole, "gappa": gappa, "coq": coq, "certificates": certificates }))
    })?;
    Ok(whole)
}

/// Returns a certificate's record. `certified` says whether all statements in `stated` were proved. `bound` is in output units.
fn certificate(one: &Loaded, bound: f64, certified: bool, stated: &[Statement]) -> Certificate {
    Certificate {
        glint: env!("CARGO_PKG_VERSION").to_owned(),
        config: input::label(&one.path),
        contract: one.core.contract_digest(),
        bound,
        certified,
        statements: stated.len(),
        scripts: certify::digest(stated),
    }
}

/// A configuration for which no statements can be made.
struct WithoutStatements<'a> {
    one: &'a Loaded,
    /// A phrase about the step of the computation that cannot be a part of a statement.
    step: String,
    bound: Bound,
}

impl CommandReport for WithoutStatements<'_> {
    fn json(&self) -> Result<Value> {
        Ok(json!({
            "config": self.one.path,
            "certified": false,
            "step": self.step,
            "terms": cosim::terms(&self.bound),
        }))
    }

    fn print(&self) -> Result<()> {
        say!("{}: not certified: {}", self.one.path, self.step);
        tell_terms(&self.bound);
        Ok(())
    }
}

struct Certification<'a> {
    one: &'a Loaded,
    /// The bound is in output units.
    bound: f64,
    /// Whether the contract states the bound. Otherwise Gappa found it.
    is_stated: bool,
    with_coq: bool,
    statements: usize,
    /// The number of proved statements with hypotheses that contradict each other, so that these statements say nothing.
    contradictory: usize,
    /// The number of proved statements for which no point was found at which the hypotheses hold.
    without_witness: usize,
    open: Vec<(&'a Statement, &'a str)>,
}

impl<'a> Certification<'a> {
    fn new(
        one: &'a Loaded,
        bound: f64,
        is_stated: bool,
        with_coq: bool,
        statements: &'a [Statement],
        outcomes: &'a [ProofOutcome],
    ) -> Self {
        let mut report = Self {
            one,
            bound,
            is_stated,
            with_coq,
            statements: statements.len(),
            contradictory: 0,
            without_witness: 0,
            open: Vec::new(),
        };
        for (statement, outcome) in statements.iter().zip(outcomes) {
            match outcome {
                ProofOutcome::Open(why) => report.open.push((statement, why)),
                ProofOutcome::Proved(_, ProofSubject::Nothing) => report.contradictory += 1,
                ProofOutcome::Proved(_, ProofSubject::Unknown) => report.without_witness += 1,
                ProofOutcome::Proved(..) => (),
            }
        }
        report
    }
}

impl CommandReport for Certification<'_> {
    fn json(&self) -> Result<Value> {
        let mut open = Vec::new();
        for (statement, why) in &self.open {
            let Statement { output, number, also, .. } = statement;
            open.push(json!({ "number": number, "output": output, "also": also, "why": why }));
        }
        Ok(json!({
            "config": self.one.path,
            "certified": self.open.is_empty(),
            "bound": self.bound,
            "bound_found": !self.is_stated,
            "statements": self.statements,
            "contradictory": self.contradictory,
            "without_witness": self.without_witness,
            "open": open,
            "coq": self.with_coq,
        }))
    }

    fn print(&self) -> Result<()> {
        let (path, bound, statements) = (&self.one.path, self.bound, self.statements);
        let by =
            if self.with_coq { "proved by Gappa and checked by Coq" } else { "proved by Gappa" };
        let proved = statements - self.open.len() - self.contradictory;
        let empty = match self.contradictory {
            0 => String::new(),
            empty => format!(", and {empty} whose hypotheses contradict each other"),
        };
        let unknown = match self.without_witness {
            0 => String::new(),
            unknown => format!(", {unknown} of them without a witness"),
        };
        if self.open.is_empty() {
            let origin = if self.is_stated {
                ""
            } else {
                ", with a bound that Gappa found, because the contract states none"
            };
            say!(
                "{path}: certified: |output - formula| <= {bound:.6} units over the whole domain{origin}; {proved} statements {by}{unknown}{empty}"
            );
        } else {
            say!(
                "{path}: not certified: {proved} of {statements} statements {by}{unknown}{empty}, {} open",
                self.open.len()
            );
        }
        for (statement, why) in self.open.iter().take(3) {
            say!("  statement {} of output `{}`: {why}", statement.number, statement.output);
        }
        Ok(())
    }
}

/// Lets Gappa find an error bound, in output units, for a contract without a bound. The inner error is a phrase about a step that
/// cannot be a part of a statement, or about a bound that was not found.
fn found(
    design: &Design,
    contract: &dyn Contract,
    gappa: &Tool,
    limit: Duration,
) -> Result<Result<(Vec<Statement>, f64), String>> {
    let asked = match questions(design, contract, limit) {
        Ok(asked) => asked,
        Err(step) => return Ok(Err(step)),
    };
    let bound = certify::bound(gappa, &asked, limit)?;
    Ok(bound.map(|bound| (asked.iter().map(|one| one.within(bound)).collect(), bound)))
}

/// Writes each script into a file: the accepted script of a proved statement, or the first script of an open statement. For
/// example, `red_out_3.g` has statement 3 of the output `red_out`.
///
/// The function also deletes scripts of an earlier run with more statements, if the first line of a script still names its file.
/// A copy under a different name, or an edited script, belongs to the user and stays. A file that Glint did not write is an
/// error.
fn write(
    directory: &Path,
    config: &str,
    statements: &[Statement],
    outcomes: &[ProofOutcome],
) -> Result<()> {
    let (mut names, mut files) = (Vec::new(), Vec::new());
    for (statement, outcome) in statements.iter().zip(outcomes) {
        let Statement { output, number, also, scripts } = statement;
        let (chosen, state, witness) = match outcome {
            ProofOutcome::Proved(chosen, ProofSubject::Nothing) => {
                (*chosen, "accepted; its hypotheses contradict each other", String::new())
            }
            ProofOutcome::Proved(chosen, ProofSubject::Unknown) => {
                (*chosen, "accepted; no witness is found", String::new())
            }
            ProofOutcome::Proved(chosen, ProofSubject::Point(point)) => {
                (*chosen, "accepted", format!("{WITNESS}{point}\n"))
            }
            ProofOutcome::Open(_) => (0, "open", String::new()),
        };
        let name = format!("{output}_{number}.g");
        let outputs = [std::slice::from_ref(output), also.as_slice()].concat().join(" and ");
        let head =
            format!("{MARKER}{}, {outputs}, statement {number}: {state}.", input::label(config));
        let script = &scripts[chosen];
        let text = format!("{head} To check: gappa {name}\n{witness}\n{script}");
        // All files are opened before the first is written, so the command changes nothing if Glint did not write one of them.
        let file = OwnFile::new(directory, &name, Seal::Hash)?;
        files.push((file, text));
        names.push(name);
    }
    for (file, text) in files {
        file.write(text)?;
    }
    let entries = std::fs::read_dir(directory);
    for entry in entries.with_context(|| format!("cannot read `{}`", directory.display()))? {
        let path = entry.context("cannot read a directory")?.path();
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else { continue };
        let is_old = name.ends_with(".g")
            && !path.is_symlink()
            && !names.iter().any(|written| written == name);
        let is_own = |text: String| {
            let first = text.lines().next().unwrap_or_default();
            let is_named = first.ends_with(&format!(" gappa {name}"));
            first.starts_with(MARKER) && is_named && is_sealed(text.as_bytes(), Seal::Hash)
        };
        if is_old && std::fs::read_to_string(&path).is_ok_and(is_own) {
            std::fs::remove_file(&path)
                .with_context(|| format!("cannot remove `{}`", path.display()))?;
        }
    }
    Ok(())
}

//! `certify`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result};
use rayon::prelude::*;
use serde_json::json;

use super::load_sequential;
use crate::certify::{Outcome, Statement, prove, statements};
use crate::cli::own_file::OwnFile;
use crate::cli::{Output, progress, tables};
use crate::registry::Registry;
use crate::tools::Tool;

/// What a script of ours begins with: nothing else is overwritten.
const MARKER: &str = "# Certificate by Glint: ";

/// What `certify` was asked for.
pub struct CertifyRequest {
    /// The directory of the scripts.
    pub out: Option<PathBuf>,
    /// Coq checks what Gappa has proved.
    pub coq: bool,
    /// After which a proof is given up.
    pub time_limit: Duration,
}

/// `glint certify`.
pub fn certify(
    registry: &Registry,
    output: Output,
    configs: &[PathBuf],
    request: &CertifyRequest,
) -> Result<bool> {
    let loaded = load_sequential(registry, configs, "certify")?;
    let gappa = Tool::find("gappa")?;
    let coq = request.coq.then(|| Tool::find("coqc")).transpose()?;
    let mut list = Vec::new();
    let mut whole = true;
    for one in &loaded {
        let contract = one.core.contract.as_ref();
        let stated = match statements(&one.core.design, contract, request.time_limit) {
            Ok(stated) => stated,
            Err(step) => {
                whole = false;
                if !output.json {
                    tables::print_line(&format!("{}: not certified: {step}", one.path));
                }
                list.push(json!({ "config": one.path, "certified": false, "step": step }));
                continue;
            }
        };
        let bar = progress::bar(output, stated.len() as u64, "statements proved");
        let checked: Vec<Result<Outcome>> = stated
            .par_iter()
            .map(|statement| {
                let outcome = prove(&gappa, coq.as_ref(), statement, request.time_limit);
                bar.inc(1);
                outcome
            })
            .collect();
        bar.finish_and_clear();
        let checked = checked.into_iter().collect::<Result<Vec<_>>>()?;
        if let Some(out) = &request.out {
            write(&out.join(&one.core.config.name), &one.path, &stated, &checked)?;
        }
        let bound = contract.bound().units;
        let open: Vec<(&Statement, &str)> = stated
            .iter()
            .zip(&checked)
            .filter_map(|(statement, outcome)| match outcome {
                Outcome::Open(why) => Some((statement, why.as_str())),
                Outcome::Proved(_) => None,
            })
            .collect();
        whole &= open.is_empty();
        if !output.json {
            let by =
                if request.coq { "proved by Gappa and checked by Coq" } else { "proved by Gappa" };
            let proved = stated.len() - open.len();
            tables::print_line(&match open.is_empty() {
                true => format!(
                    "{}: certified: |output - formula| <= {bound:.6} units over the whole domain; {proved} statements {by}",
                    one.path
                ),
                false => format!(
                    "{}: not certified: {proved} of {} statements {by}, {} open",
                    one.path,
                    stated.len(),
                    open.len()
                ),
            });
            for (statement, why) in open.iter().take(3) {
                tables::print_line(&format!(
                    "  {} of {}: {why}",
                    statement.number, statement.output
                ));
            }
        }
        let open = open.iter().map(|(statement, why)| {
            json!({ "number": statement.number, "output": statement.output, "why": why })
        });
        let open: Vec<_> = open.collect();
        list.push(json!({
            "config": one.path,
            "certified": open.is_empty(),
            "bound": bound,
            "statements": stated.len(),
            "open": open,
            "coq": request.coq,
        }));
    }
    if output.json {
        let gappa = gappa.version()?;
        let coq = coq.map(|coq| coq.version()).transpose()?;
        tables::print_json(
            &json!({ "ok": whole, "gappa": gappa, "coq": coq, "certificates": list }),
        );
    }
    Ok(whole)
}

/// The scripts, each in a file: the accepted one, or of what is open the first. Those of an earlier run with more
/// statements go.
fn write(
    directory: &Path,
    config: &str,
    statements: &[Statement],
    outcomes: &[Outcome],
) -> Result<()> {
    std::fs::create_dir_all(directory)
        .with_context(|| format!("cannot make `{}`", directory.display()))?;
    let mut names = Vec::new();
    for (statement, outcome) in statements.iter().zip(outcomes) {
        let Statement { output, number, scripts } = statement;
        let (chosen, state) = match outcome {
            Outcome::Proved(chosen) => (*chosen, "accepted"),
            Outcome::Open(_) => (0, "open"),
        };
        let name = format!("{output}_{number}.g");
        let head = format!("{MARKER}{config}, {output}, statement {number}: {state}.");
        let text = format!("{head} To check: gappa {name}\n\n{}", scripts[chosen]);
        OwnFile::new(directory, &name, MARKER)?.write(&text)?;
        names.push(name);
    }
    let entries = std::fs::read_dir(directory);
    for entry in entries.with_context(|| format!("cannot read `{}`", directory.display()))? {
        let path = entry.context("cannot read a directory")?.path();
        let own = path.file_name().and_then(|name| name.to_str()).is_some_and(|name| {
            name.ends_with(".g") && !names.iter().any(|written| written == name)
        });
        if own && std::fs::read_to_string(&path).is_ok_and(|text| text.starts_with(MARKER)) {
            std::fs::remove_file(&path)
                .with_context(|| format!("cannot remove `{}`", path.display()))?;
        }
    }
    Ok(())
}

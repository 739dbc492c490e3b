//! `certify`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use serde_json::json;

use super::load_sequential;
use crate::base::transient::Directory;
use crate::certify::{Statement, statements};
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

/// What became of a statement.
enum Outcome {
    /// The script that was accepted.
    Proved(usize),
    /// What Gappa says of the last script.
    Open(String),
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
        let stated = match statements(&one.core.design, contract) {
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

/// Has one of the statement's scripts accepted.
fn prove(
    gappa: &Tool,
    coq: Option<&Tool>,
    statement: &Statement,
    limit: Duration,
) -> Result<Outcome> {
    let place = Directory::new().context("cannot make a temporary directory")?;
    let mut why = String::new();
    for (number, script) in statement.scripts.iter().enumerate() {
        std::fs::write(place.path().join("statement.g"), script)
            .context("cannot write a script for Gappa")?;
        let run = match gappa.run(["statement.g"], place.path(), limit) {
            Ok(run) => run,
            Err(error) if error.is::<crate::tools::LimitReached>() => {
                why = error.to_string();
                continue;
            }
            Err(error) => return Err(error),
        };
        // Of a rewriting that it cannot prove Gappa says so, and goes on.
        let assumed = run.output.contains("trivially equal");
        if !run.status.success() || assumed {
            let mut lines =
                run.output.lines().filter(|line| line.contains("rror") || line.contains("best"));
            why = lines.next_back().unwrap_or("Gappa assumes a step").trim().to_owned();
            continue;
        }
        if let Some(coq) = coq {
            let proof = gappa.run(["-Bcoq", "statement.g"], place.path(), limit)?;
            if !proof.status.success() {
                bail!("Gappa proves a statement, and cannot write it for Coq: {}", proof.output);
            }
            // Warnings come in between.
            let lines = proof.output.lines().filter(|line| !line.starts_with("Warning:"));
            let proof: String = lines.flat_map(|line| [line, "\n"]).collect();
            std::fs::write(place.path().join("statement.v"), proof)
                .context("cannot write a proof for Coq")?;
            let check = coq.run(["statement.v"], place.path(), limit * 10)?;
            if !check.status.success() {
                why = format!("Coq refuses: {}", check.output.lines().next().unwrap_or_default());
                continue;
            }
        }
        return Ok(Outcome::Proved(number));
    }
    Ok(Outcome::Open(why))
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

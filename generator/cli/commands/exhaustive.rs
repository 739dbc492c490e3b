//! `cosim --exhaustive` and `merge`.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, bail, ensure};
use serde_json::{Value, json};

use super::{Loaded, load};
use crate::cli::failure::Usage;
use crate::cli::{Output, progress, staged, tables};
use crate::cosim::exhaustive::{Job, Places, Proof, Shard, State};
use crate::golden::Values;
use crate::registry::Registry;
use crate::words;

/// How often the state is written.
const SAVE: Duration = Duration::from_secs(5);

/// What `cosim --exhaustive` was asked for beside configurations.
pub struct ExhaustiveRequest {
    /// Where the state stands.
    pub resume: Option<PathBuf>,
    /// Which part of the job.
    pub shard: Option<Shard>,
}

/// `glint cosim --exhaustive`: the factored proof of the accuracy contract.
pub fn exhaustive(
    registry: &Registry,
    output: Output,
    configs: &[PathBuf],
    request: &ExhaustiveRequest,
) -> Result<bool> {
    let loaded = load(registry, configs)?;
    if request.resume.is_some() && loaded.len() != 1 {
        bail!(Usage(format!(
            "--resume is for one configuration; here are {}",
            loaded.len()
        )));
    }
    let mut list = Vec::new();
    let mut holds = true;
    for one in &loaded {
        let job = Job::new(one.unit.contract.as_ref());
        let mut state = State::new(&one.unit.digest(), request.shard.unwrap_or(Shard::WHOLE));
        if let Some(path) = &request.resume
            && let Some(found) = read(path)?
        {
            ensure!(
                found.digest == state.digest && found.shard == state.shard,
                "`{}` is of another configuration, shard or version of Glint; name another file",
                path.display()
            );
            state = found;
        }
        if !output.json {
            announce(one, &job, &state);
        }
        prove(output, &job, &mut state, request.resume.as_deref())?;
        holds &= report(output, one, &job, &state, &mut list);
    }
    if output.json {
        tables::print_json(&json!({ "ok": holds, "configurations": list }));
    }
    Ok(holds)
}

/// `glint merge`: what the shards of one job give together.
pub fn merge(
    registry: &Registry,
    output: Output,
    config: &Path,
    files: &[PathBuf],
) -> Result<bool> {
    let loaded = load(registry, &[config.to_path_buf()])?;
    let one = &loaded[0];
    let job = Job::new(one.unit.contract.as_ref());
    let names: Vec<String> = files
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    let states = files
        .iter()
        .map(|path| read(path)?.with_context(|| format!("there is no `{}`", path.display())))
        .collect::<Result<Vec<_>>>()?;
    ensure!(
        states.iter().any(|state| state.digest == one.unit.digest()),
        "these shards are not of `{}` as it stands, or of another version of Glint",
        one.path
    );
    let merged = job.merge(&states, &names)?;
    if !output.json {
        announce(one, &job, &State::new("", Shard::WHOLE));
    }
    let mut list = Vec::new();
    let holds = report(output, one, &job, &merged, &mut list);
    if output.json {
        tables::print_json(&json!({ "ok": holds, "configurations": list }));
    }
    Ok(holds)
}

/// The state that a file holds, if there is one.
fn read(path: &Path) -> Result<Option<State>> {
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => {
            return Err(error).with_context(|| format!("cannot read `{}`", path.display()));
        }
    };
    let state = serde_json::from_str(&text)
        .map_err(|error| anyhow!("{error}"))
        .with_context(|| {
            format!(
                "`{}` does not hold the state of a proof; name another file",
                path.display()
            )
        })?;
    Ok(Some(state))
}

/// Goes on to the end of the shard, keeping the state in `file`.
fn prove(output: Output, job: &Job<'_>, state: &mut State, file: Option<&Path>) -> Result<()> {
    let save = |state: &State| -> Result<()> {
        match file {
            Some(path) => staged::replace(path, serde_json::to_string_pretty(state)?.as_bytes()),
            None => Ok(()),
        }
    };
    // Nothing is worth computing that cannot be kept.
    save(state)?;
    let bar = progress::bar(output, job.remaining(state), "evaluations");
    let mut saved = Instant::now();
    let mut failure = None;
    let end = job.run(state, &|done| bar.inc(done), &mut |state| {
        if saved.elapsed() < SAVE {
            return ControlFlow::Continue(());
        }
        saved = Instant::now();
        match save(state) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                failure = Some(error);
                ControlFlow::Break(())
            }
        }
    });
    bar.finish_and_clear();
    match (end, failure) {
        (ControlFlow::Break(()), Some(error)) => Err(error),
        _ => save(state),
    }
}

/// What is about to be done, and what is not.
fn announce(one: &Loaded, job: &Job<'_>, state: &State) {
    tables::print_line(&format!(
        "{}: {} evaluations of f ({}), {} colour products",
        one.path,
        words::grouped(job.f.count()),
        job.f.sweep().words(),
        words::grouped(job.colours.count())
    ));
    if !job.f.sweep().omits.is_empty() {
        tables::print_line(&format!("  not covered: {}", job.f.sweep().omits));
    }
    let (all, left) = (job.f.count() + job.colours.count(), job.remaining(state));
    if left != all {
        tables::print_line(&format!(
            "  shard {}: {} evaluations to do here",
            state.shard,
            words::grouped(left)
        ));
    }
}

/// Says what a state means; whether it is within the bound.
fn report(
    output: Output,
    one: &Loaded,
    job: &Job<'_>,
    state: &State,
    list: &mut Vec<Value>,
) -> bool {
    let contract = one.unit.contract.as_ref();
    let proof = Proof::new(contract, state.f.peak, state.colours.peak);
    if output.json {
        list.push(as_json(one, &job.f, &proof, state, job.colours.count()));
    } else {
        print(one, &job.f, &proof, state);
    }
    proof.faults.is_empty()
}

fn print(one: &Loaded, places: &Places<'_>, proof: &Proof, state: &State) {
    let at: Vec<String> = places
        .sweep()
        .axes
        .iter()
        .zip(places.place(proof.f.place))
        .map(|(axis, value)| format!("{}={value}", axis.name))
        .collect();
    let verdict = match (proof.faults.is_empty(), state.shard == Shard::WHOLE) {
        (true, true) => "holds",
        (true, false) => "holds so far; `glint merge` joins the shards",
        (false, _) => "FAILS",
    };
    tables::print_line(&format!(
        "  f is off by {:.3e} at most, {:.3} units, at raw {}; a colour multiplier by {:.3}; together {:.3} (bound {:.3}): {verdict}",
        proof.f.error,
        proof.f_units,
        at.join(" "),
        proof.colours.error,
        proof.together(),
        one.unit.contract.bound().units,
    ));
    for fault in &proof.faults {
        tables::print_line(&format!("  FAILS: {fault}"));
    }
}

/// A proof for scripts, and for the record.
fn as_json(
    one: &Loaded,
    places: &Places<'_>,
    proof: &Proof,
    state: &State,
    products: u64,
) -> Value {
    let axes: Vec<Value> = places
        .sweep()
        .axes
        .iter()
        .map(|axis| match &axis.values {
            Values::Range(low, high) => json!({ "name": axis.name, "from": low, "to": high }),
            Values::List(values) => json!({ "name": axis.name, "values": values }),
        })
        .collect();
    let mut value = json!({
        "config": one.path,
        "device": one.unit.device.name,
        "axes": axes,
        "not_covered": places.sweep().omits,
        "evaluations": places.count(),
        "colour_products": products,
        "f": {
            "error": proof.f.error,
            "units": proof.f_units,
            "place": proof.f.place,
            "at": places.place(proof.f.place),
        },
        "colour_units": proof.colours.error,
        "together": proof.together(),
        "bound": one.unit.contract.bound().units,
        "holds": proof.faults.is_empty(),
        "faults": proof.faults,
    });
    if state.shard != Shard::WHOLE {
        value["shard"] = json!(state.shard.to_string());
    }
    value
}

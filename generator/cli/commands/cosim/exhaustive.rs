//! `glint cosim --exhaustive`: checks a contract's error bound for every operand combination of the sweep, in one run or divided
//! into shards for several machines.

pub mod show;

use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use indicatif::HumanDuration;

use super::Arguments;
use crate::commands::load;
use crate::failure::Failure;
use crate::interrupt::Deferred;
use crate::{OutputOptions, destination, progress, say, wrong_usage};
use glint_base::{input, text};
use glint_core::cosim::exhaustive::{Job, Shard, ShardState, kept};
use glint_core::registry::Registry;
use glint_golden::Sweep;
use show::{announce, report};

/// The time between two writes of the state.
const SAVE: Duration = Duration::from_secs(5);

/// The estimated duration from which the command suggests to divide the check among more cores.
const WORTH_SHARING: Duration = Duration::from_secs(60);

/// The numbers of cores for which the duration is printed. For example, `about 1 hour on 1 core`.
const CORES: [u32; 3] = [1, 16, 1000];

/// Measures the errors at all operands, and compares them with the accuracy contract's bound. Also compares model and hardware
/// clock by clock for every combination of operands, if there are not too many combinations.
///
/// # Errors
/// Fails if a configuration has problems, if the values of `--values` are not valid. Fails if the file of `--resume` belongs to
/// another check or is damaged, or if a signal has interrupted the check. `--resume` with several configurations is wrong usage.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let loaded = load(registry, &arguments.configs.paths)?;
    if arguments.resume.is_some() && loaded.len() != 1 {
        wrong_usage!(
            "--resume needs exactly one configuration, and there are {}: name one configuration",
            loaded.len()
        );
    }
    let sweeps = loaded.iter().map(|one| arguments.sweep.of(one)).collect::<Result<Vec<_>>>()?;
    for (one, sweep) in loaded.iter().zip(&sweeps) {
        ensure!(
            is_countable(sweep),
            "`{}`: the operands have 2^64 combinations or more, and no check can go through them; choose values of \
             operands with --values, or check a narrower configuration",
            one.path
        );
    }
    let mut list = output.list();
    let mut holds = true;
    for (one, sweep) in loaded.iter().zip(sweeps) {
        let fingerprint = one.core.fingerprint(&sweep);
        let job = one.core.job_of(sweep)?;
        let mut state = ShardState::new(&fingerprint, arguments.shard.unwrap_or(Shard::WHOLE));
        if let Some(path) = &arguments.resume
            && let Some(found) = read(path)?
        {
            ensure!(
                found.digest == state.digest && found.shard == state.shard,
                "`{}` belongs to another configuration, sweep or shard, or to another build of Glint; give \
                 --resume another file",
                path.display()
            );
            job.validate(&found).with_context(|| {
                format!("`{}` is damaged; give --resume another file", path.display())
            })?;
            state = found;
        }
        if output.is_for_people() {
            announce(one, &job, &state);
            announce_duration(&job, &state, arguments.resume.as_deref())?;
        }
        prove(output, &job, &mut state, arguments.resume.as_deref())?;
        holds &= report(one, &job, &state, &mut list)?;
    }
    list.conclude(holds)
}

/// Returns the saved progress of a check, or `None` if the file does not exist.
///
/// # Errors
///
/// Fails if the file cannot be read, or if it contains no saved progress.
pub fn read(path: &Path) -> Result<Option<ShardState>> {
    let Some(text) = input::text(path)? else { return Ok(None) };
    let state = kept::from_text(&text).with_context(|| {
        format!("`{}` does not contain the state of a proof; name another file", path.display())
    })?;
    Ok(Some(state))
}

/// Runs the job until the shard is done, and saves the state in `file` every few seconds. After a signal, it saves the state
/// and fails with [`Failure::Interrupted`].
fn prove(
    output: OutputOptions,
    job: &Job<'_>,
    state: &mut ShardState,
    file: Option<&Path>,
) -> Result<()> {
    let save = |state: &ShardState| -> Result<()> {
        match file {
            Some(path) => destination::replace(path, kept::to_text(state)?.as_bytes()),
            None => Ok(()),
        }
    };
    // If the state cannot be saved, the check need not begin.
    save(state)?;
    let bar = progress::bar(output, job.remaining(state), "evaluations");
    // A signal is deferred only if the state is saved in a file.
    let deferred = file.map(|_| Deferred::begin());
    let interrupted = || deferred.as_ref().is_some_and(Deferred::noted);
    let mut saved = Instant::now();
    let mut failure = None;
    let end = job.run(state, &|done| bar.inc(done), &mut |state| {
        if interrupted() {
            return ControlFlow::Break(());
        }
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
    if let (ControlFlow::Break(()), Some(error)) = (end?, failure) {
        return Err(error);
    }
    save(state)?;
    let kept = || {
        let file = file.map_or_else(String::new, |file| file.display().to_string());
        format!(
            "{} evaluations remain; the finished evaluations are in `{file}`, and the same command continues \
             from that file",
            text::grouped(job.remaining(state))
        )
    };
    match deferred.and_then(|deferred| deferred.end(kept)) {
        Some(interrupted) => Err(Failure::Interrupted(interrupted).into()),
        None => Ok(()),
    }
}

fn is_countable(sweep: &Sweep) -> bool {
    let mut counts = sweep.axes.iter().map(|axis| axis.values.count());
    counts.try_fold(1, u64::checked_mul).is_some()
}

/// Prints an estimate of the duration from a short sample. For a long check, also says how the user can stop it and continue it
/// later. `resume` is the file with the saved state.
fn announce_duration(job: &Job<'_>, state: &ShardState, resume: Option<&Path>) -> Result<()> {
    if job.remaining(state) == 0 {
        return Ok(());
    }
    let threads = rayon::current_num_threads();
    let duration = job.estimate(state, threads)?;
    let here = format!("{} on {}", roughly(duration), text::counted(threads, "thread"));
    if duration < WORTH_SHARING {
        say!("  {here}");
        return Ok(());
    }
    // This assumes cores of the same speed, which a job array has for itself alone. A check can have any number of shards.
    let elsewhere = CORES.map(|cores| {
        let duration = duration.mul_f64(threads as f64 / f64::from(cores));
        format!("{} on {}", roughly(duration), text::counted(cores as usize, "core"))
    });
    say!("  {here} ({})", elsewhere.join(", "));
    match resume {
        Some(file) => say!(
            "  Ctrl-C stops the check; the same command continues it from `{}`",
            file.display()
        ),
        None => say!(
            "  Ctrl-C stops the check, and its work is lost; with --resume FILE, the same command continues it"
        ),
    }
    Ok(())
}

fn roughly(duration: Duration) -> String {
    match duration.as_secs() {
        0 => "less than a second".to_owned(),
        seconds => format!("about {}", HumanDuration(Duration::from_secs(seconds))),
    }
}

//! `glint merge`: joins the results of a check by `glint cosim --exhaustive --shard` that was divided among machines.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::Args;

use super::cosim::SweepValues;
use super::cosim::exhaustive::read;
use super::cosim::exhaustive::show::{announce, report};
use super::load;
use crate::OutputOptions;
use glint_core::cosim::exhaustive::{Shard, ShardState};
use glint_core::registry::Registry;

/// Join the parts of a `cosim --exhaustive` that was split with --shard
#[derive(Args)]
#[command(after_help = "\
Example, on four machines and then on one:
  glint cosim my_core.toml --exhaustive --shard 1/4 --resume part1.json
  glint merge my_core.toml part1.json part2.json part3.json part4.json")]
pub struct Arguments {
    /// The configuration
    config: PathBuf,
    /// The --resume files of all parts
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    sweep: SweepValues,
}

/// Joins the shards. Returns whether the whole check holds.
///
/// # Errors
///
/// Fails if a file cannot be read, or if the files are not the complete shards of this configuration and build.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let Arguments { config, files, .. } = arguments;
    let loaded = load(registry, std::slice::from_ref(config))?;
    let one = &loaded[0];
    let sweep = arguments.sweep.of(one)?;
    let fingerprint = one.core.fingerprint(&sweep);
    let job = one.core.job_of(sweep)?;
    let names: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
    let states = files
        .iter()
        .map(|path| read(path)?.with_context(|| format!("there is no file `{}`", path.display())))
        .collect::<Result<Vec<_>>>()?;
    ensure!(
        states.iter().any(|state| state.digest == fingerprint),
        "these shards do not belong to `{}`, or the file was changed since, or they belong to another sweep \
         (--values) or another build of Glint: compute the shards again",
        one.path
    );
    let merged = job.merge(&states, &names)?;
    if output.is_for_people() {
        announce(one, &job, &ShardState::new("", Shard::WHOLE));
    }
    let mut list = output.list();
    let holds = report(one, &job, &merged, &mut list)?;
    list.conclude(holds)
}

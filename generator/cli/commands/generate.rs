//! `glint generate`: writes each configuration's files, such as Verilog, ROM contents, manifest, FuseSoC core and test bench.
//! With `--check` it writes nothing, and compares the files on disk.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::{Loaded, load};
use crate::report::CommandReport;
use crate::store::{self, Written};
use crate::{Configs, OutputOptions, failure, progress, say};
use glint_base::program::Program;
use glint_core::cosim::directed::ComputationCache;
use glint_core::package::{self, OutputFiles, Seal};
use glint_core::registry::Registry;
use glint_prove::synth::TARGETS;
use glint_prove::tune::Cost;

/// Write Verilog, ROM contents, manifest, FuseSoC core and test bench
///
/// Each configuration gets the directories `rtl_out/<name>/` and `testbench/<name>/`, and with `package.software` also
/// `software/<name>/`. The command generates all files of a configuration before it replaces the first old file, and it
/// never leaves a file half-written. Files that Glint did not write, or that were edited since, are replaced only with
/// --force.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint generate                              everything in configs/, into rtl_out/ and testbench/
  glint generate my_core.toml --out build     one configuration, into build/
  glint generate --check                      checks that the files are up to date; writes nothing")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
    /// The directory in which `rtl_out/` and `testbench/` are created
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Write nothing; fail if a file differs from what would be written
    #[arg(long)]
    check: bool,
    /// Write no test bench; this makes the generation of a large core faster
    #[arg(long)]
    no_bench: bool,
    /// Also replace files that Glint did not write or that were edited since
    #[arg(long)]
    force: bool,
}

/// Writes the files. With `--check`, writes nothing, and returns whether the files on disk equal the generated files.
///
/// # Errors
///
/// Fails if a configuration has problems, or if a file was edited or cannot be written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let loaded = load(registry, &arguments.configs.paths)?;
    for one in &loaded {
        one.contract()?;
    }
    let made = all_files(output, &loaded, !arguments.no_bench)?;
    if arguments.check {
        return compare(output, &arguments.out, &loaded, &made);
    }
    let mut list = output.list();
    for (one, Made { files, .. }) in loaded.iter().zip(&made) {
        let written = write(&arguments.out, one, files, arguments.force)?;
        list.add(&GeneratedFiles { one, files, written })?;
    }
    for (one, Made { word_stride, .. }) in loaded.iter().zip(&made) {
        if *word_stride > 1 {
            failure::warn(&format!(
                "{}: to stay short, the test bench checks only one in every {word_stride} words of the \
                 memories; `{Program} cosim` checks more words",
                one.path
            ));
        }
    }
    let misfits = loaded.iter().filter_map(|one| Some((one, misfit(one)?)));
    for (one, excess) in misfits {
        failure::warn(&format!("{}: by the estimate, {excess}", one.path));
    }
    let shared = [package::driver().path];
    list.finish(|generated| Ok(json!({ "ok": true, "generated": generated, "shared": shared })))?;
    if output.is_for_people() {
        print_next_step(&arguments.out, &loaded, !arguments.no_bench);
    }
    Ok(true)
}

struct GeneratedFiles<'a> {
    one: &'a Loaded,
    files: &'a OutputFiles,
    written: Written,
}

impl CommandReport for GeneratedFiles<'_> {
    fn json(&self) -> Result<Value> {
        let paths: Vec<&str> = self.files.iter().map(|file| file.path.as_str()).collect();
        Ok(json!({
            "config": self.one.path,
            "name": self.one.core.config().name,
            "written": self.written == Written::Replaced,
            "files": paths,
        }))
    }

    fn print(&self) -> Result<()> {
        say!("{}: {} files {}", self.one.path, self.files.len(), self.written);
        Ok(())
    }
}

fn print_next_step(out: &Path, loaded: &[Loaded], with_bench: bool) {
    let (config, name) = match loaded {
        [only] => (only.path.as_str(), only.core.config().name.as_str()),
        _ => ("CONFIG", "NAME"),
    };
    if !with_bench {
        say!("To simulate: `{Program} cosim {config} --simulator icarus`.");
        return;
    }
    let directory = |folder: &str| out.join(folder).join(name).display().to_string();
    say!(
        "The Python test benches share the driver {}.",
        out.join(package::driver().path).display()
    );
    say!(
        "To simulate: `{Program} cosim {config} --simulator icarus`. By hand, copy the files of {} and {} \
         into one directory, where the simulator finds the memories, and run in it: iverilog -g2012 -s \
         {name}_tb -o sim {name}*.v && ./sim",
        directory("rtl_out"),
        directory("testbench"),
    );
}

/// Returns the resources that the smallest chip of a pipeline's target lacks, as a phrase such as `the core does not fit the
/// iCE40 UP5K: it takes 9 of 8 DSP blocks`. Returns `None` if the core fits, or is no pipeline for a known target.
fn misfit(one: &Loaded) -> Option<String> {
    let pipeline = one.core.design.pipeline.as_ref()?;
    let target = TARGETS.into_iter().find(|target| target.name() == pipeline.target)?;
    let excess = Cost::new(&one.core.design, target).excess(target);
    (!excess.is_empty()).then_some(excess)
}

pub struct Made {
    pub files: OutputFiles,
    /// The distance between two ROM words that the bench checks. For example, 4 means that the bench checks every fourth word.
    word_stride: usize,
}

/// Makes every file of each configuration in parallel, and returns them in the order of `loaded`.
///
/// # Errors
///
/// Fails if a configuration's files cannot be made, or if two configurations have modules of the same name.
pub fn all_files(output: OutputOptions, loaded: &[Loaded], with_bench: bool) -> Result<Vec<Made>> {
    let bar = progress::bar(output, loaded.len() as u64, "generating");
    let known = ComputationCache::default();
    let made: Result<_> = loaded
        .par_iter()
        .map(|one| {
            let files = files(one, &known, with_bench);
            bar.inc(1);
            files
        })
        .collect();
    bar.finish_and_clear();
    let made: Vec<Made> = made?;
    let named =
        loaded.iter().zip(&made).map(|(one, made)| (one.path.as_str(), made.files.as_slice()));
    package::module_names::check_together(named)?;
    Ok(made)
}

/// Makes a configuration's files. `known` is a cache of chosen computations.
fn files(one: &Loaded, known: &ComputationCache, with_bench: bool) -> Result<Made> {
    let vectors = with_bench.then(|| one.core.shipped_vectors_of(known)).transpose();
    let vectors = vectors.with_context(|| format!("`{}`", one.path))?;
    let word_stride = vectors.as_ref().map_or(1, |vectors| vectors.word_stride);
    Ok(Made { files: one.files(vectors)?, word_stride })
}

/// Writes the files of a configuration into `out`, and the Python driver that its bench shares with other benches. Without
/// `force`, the function refuses to replace edited files. Returns whether a file of the configuration has changed; the driver
/// does not count.
///
/// # Errors
/// Fails if a file was edited, or cannot be written.
pub fn write(out: &Path, one: &Loaded, files: &OutputFiles, force: bool) -> Result<Written> {
    let driver = package::driver();
    let path = out.join(&driver.path);
    // The driver is checked before anything is written. Other obstacles are found while files are written.
    if path.is_file() {
        store::may_write(&path, Seal::Hash, force)?;
    }
    let written = store::write(out, &one.core.config().name, files.as_slice(), force)
        .with_context(|| format!("the files of `{}` were not written", one.path))?;
    store::write_sealed(&path, &driver.contents, Seal::Hash, force)?;
    Ok(written)
}

/// Reports the files on disk that differ from the generated files, and returns whether all are equal.
fn compare(output: OutputOptions, out: &Path, loaded: &[Loaded], made: &[Made]) -> Result<bool> {
    let mut all = Vec::new();
    let driver = package::driver();
    if store::differs(out, &driver)? {
        all.push(driver.path);
    }
    for (one, Made { files, .. }) in loaded.iter().zip(made) {
        all.extend(store::differences(out, &one.core.config().name, files.as_slice())?);
    }
    let is_equal = all.is_empty();
    output.report(&Differences(all))?;
    Ok(is_equal)
}

struct Differences(Vec<String>);

impl CommandReport for Differences {
    fn json(&self) -> Result<Value> {
        Ok(json!({ "ok": self.0.is_empty(), "different": self.0 }))
    }

    fn print(&self) -> Result<()> {
        for path in &self.0 {
            say!("differs: {path}");
        }
        if self.0.is_empty() {
            say!("all files are up to date");
        }
        Ok(())
    }
}

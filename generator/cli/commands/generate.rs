//! `glint generate`: writes Verilog, ROM contents, manifest, FuseSoC core and test bench of each configuration.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use rayon::prelude::*;
use serde_json::json;

use super::{Loaded, load};
use crate::store::{self, Written};
use crate::{Configs, Output, progress, say, tables};
use glint_core::cosim::directed::Known;
use glint_core::package::{self, OutputFile, Seal};
use glint_core::registry::Registry;

/// Write Verilog, ROM contents, manifest, FuseSoC core and test bench
///
/// Each configuration gets the directories `rtl_out/<name>/` and `testbench/<name>/`, and with
/// `package.software` also `software/<name>/`. Their files are replaced when all are made, each as a whole. Files
/// that Glint did not write, or that were edited since, are left alone unless --force is given.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint generate                              everything in configs/, into rtl_out/ and testbench/
  glint generate my_core.toml --out build     one configuration, into build/
  glint generate --check                      are the files up to date? Writes nothing")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
    /// The directory in which `rtl_out/` and `testbench/` are made
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Write nothing; fail if a file differs from what would be written
    #[arg(long)]
    check: bool,
    /// Replace files that Glint did not write or that were edited since
    #[arg(long)]
    force: bool,
}

/// Runs `glint generate`.
pub fn run(registry: &Registry, output: Output, arguments: &Arguments) -> Result<bool> {
    let loaded = load(registry, &arguments.configs.paths)?;
    for one in &loaded {
        one.contract()?;
    }
    let made = all_files(output, &loaded)?;
    if arguments.check {
        return compare(output, &arguments.out, &loaded, &made);
    }
    let mut report = Vec::new();
    for (one, files) in loaded.iter().zip(&made) {
        let written = write(&arguments.out, one, files, arguments.force)?;
        if output.json {
            let paths: Vec<&str> = files.iter().map(|file| file.path.as_str()).collect();
            report.push(json!({
                "config": one.path,
                "name": one.core.config.name,
                "written": written == Written::Replaced,
                "files": paths,
            }));
        } else {
            say!("{}: {} files {written}", one.path, files.len());
        }
    }
    if output.json {
        let shared = [package::driver().path];
        tables::print_json(&json!({ "ok": true, "generated": report, "shared": shared }));
    }
    Ok(true)
}

/// Returns every file of each configuration, made in parallel.
pub fn all_files(output: Output, loaded: &[Loaded]) -> Result<Vec<Vec<OutputFile>>> {
    let bar = progress::bar(output, loaded.len() as u64, "generating");
    let known = Known::default();
    let made: Result<_> = loaded
        .par_iter()
        .map(|one| {
            let files = files(one, &known);
            bar.inc(1);
            files
        })
        .collect();
    bar.finish_and_clear();
    let made: Vec<Vec<OutputFile>> = made?;
    let named = loaded.iter().zip(&made).map(|(one, files)| (one.path.as_str(), &files[..]));
    package::module_names::check_together(named)?;
    Ok(made)
}

/// Returns every file of a configuration, with its bench.
fn files(one: &Loaded, known: &Known) -> Result<Vec<OutputFile>> {
    let vectors = one.core.shipped_vectors_of(known);
    let vectors = vectors.with_context(|| format!("`{}`", one.path))?;
    one.files(vectors)
}

/// Writes the files of a configuration, and the driver that its bench in Python shares with others.
pub fn write(out: &Path, one: &Loaded, files: &[OutputFile], force: bool) -> Result<Written> {
    let driver = package::driver();
    let path = out.join(&driver.path);
    // Before anything is written; what else is in the way shows in writing.
    if path.is_file() {
        store::may_write(&path, Seal::Python, force)?;
    }
    let written = store::write(out, &one.core.config.name, files, force)
        .with_context(|| format!("`{}` was not generated", one.path))?;
    store::write_sealed(&path, &driver.contents, Seal::Python, force)?;
    Ok(written)
}

/// Runs `--check`: returns whether what is there is what would be written.
fn compare(
    output: Output,
    out: &Path,
    loaded: &[Loaded],
    made: &[Vec<OutputFile>],
) -> Result<bool> {
    let mut all = Vec::new();
    let driver = package::driver();
    if store::differs(out, &driver)? {
        all.push(driver.path);
    }
    for (one, files) in loaded.iter().zip(made) {
        all.extend(store::differences(out, &one.core.config.name, files)?);
    }
    if output.json {
        tables::print_json(&json!({ "ok": all.is_empty(), "different": all }));
    } else {
        for path in &all {
            say!("differs: {path}");
        }
        if all.is_empty() {
            tables::print_line("everything is as it would be generated");
        }
    }
    Ok(all.is_empty())
}

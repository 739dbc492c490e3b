//! Defines the commands of `glint`, one in each module, and the code that they share.
//!
//! The function `run` of a command returns whether everything that the command checks holds.

pub mod certify;

pub mod compare;
pub mod cosim;
pub mod datasheet;
pub mod describe;
pub mod estimate;
pub mod eval;
pub mod explain;
pub mod generate;
pub mod list;
pub mod main_job;
pub mod merge;
mod mismatch;
pub mod mutate;
pub mod new;
pub mod new_device;
mod plot_file;
pub mod render;
mod rows;
pub mod schedule;
pub mod schema;
mod settings;
pub mod setup;
pub mod synth;
pub mod table;
pub mod tune;
pub mod verify;
pub mod worst;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};

use super::failure::{self, Failure};
use crate::wrong_usage;
use glint_base::input;
use glint_base::program::Program;
use glint_base::text;
use glint_config::{self as config, ConfigSource};
use glint_core::core::Core;
use glint_core::package::{OutputFiles, Vectors};
use glint_core::registry::{CLOCK_MHZ, Registry};
use glint_golden::Bounds;
use glint_show::evidence::advice;
use glint_tools::Tool;

/// The directory of the configurations that a command uses if the user names none.
const CONFIGS: &str = "configs";

pub struct Loaded {
    /// The path on the command line, with `/` as the separator, for example `configs/rough.toml`.
    path: String,
    core: Core,
    source: ConfigSource,
}

/// Returns the files in `named`. If `named` is empty, returns all TOML files in `configs/`, sorted.
fn paths(named: &[PathBuf]) -> Result<Vec<PathBuf>> {
    if !named.is_empty() {
        return Ok(named.to_vec());
    }
    let entries = std::fs::read_dir(CONFIGS).with_context(|| {
        format!("cannot read `{CONFIGS}/`; name a configuration file, or create one with `{Program} new \
                 DEVICE > FILE.toml`")
    })?;
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry.with_context(|| format!("cannot read `{CONFIGS}/`"))?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            paths.push(path);
        }
    }
    paths.sort();
    if paths.is_empty() {
        bail!(
            "there is no configuration in `{CONFIGS}/`; name a configuration file, or create one with \
             `{Program} new DEVICE > FILE.toml`"
        );
    }
    Ok(paths)
}

/// Reads the configurations `named`, or all in `configs/` if `named` is empty, and builds their designs. Reports the problems of
/// all files before it fails. Fails if two files name the same module, for example `rough`.
fn load(registry: &Registry, named: &[PathBuf]) -> Result<Vec<Loaded>> {
    if named.iter().filter(|path| path.as_path() == Path::new(input::STDIN)).count() > 1 {
        wrong_usage!("standard input can be read only once: name `-` only once");
    }
    let mut loaded: Vec<Loaded> = Vec::new();
    let mut failed: Vec<anyhow::Error> = Vec::new();
    for path in paths(named)? {
        match load_one(registry, &path) {
            Ok(one) => loaded.push(one),
            Err(error) => failed.push(error),
        }
    }
    for (at, one) in loaded.iter().enumerate() {
        if let Some(other) =
            loaded[..at].iter().find(|other| other.core.config().name == one.core.config().name)
        {
            failed.push(anyhow!(
                "`{}` and `{}` both name their module `{}`; set another `name` in one of them",
                other.path,
                one.path,
                one.core.config().name
            ));
        }
    }
    if failed.is_empty() { Ok(loaded) } else { Err(Failure::Several(failed).into()) }
}

/// Loads configurations like [`load`], for the command `command`, which works only on cores with a microprogram. If `named` is
/// empty, the pipelines in `configs/` are left out; a pipeline in `named` is an error.
fn load_sequential(registry: &Registry, named: &[PathBuf], command: &str) -> Result<Vec<Loaded>> {
    let (pipelines, loaded): (Vec<Loaded>, Vec<Loaded>) =
        load(registry, named)?.into_iter().partition(|one| one.core.design.pipeline.is_some());
    match pipelines.first().filter(|_| !named.is_empty()) {
        None => Ok(loaded),
        Some(one) => bail!(
            "`{}`: `{Program} {command}` works only on cores with a microprogram, and this core is a \
             pipeline; set architecture = \"sequential\", or see `{Program} schedule`",
            one.path
        ),
    }
}

fn load_one(registry: &Registry, path: &Path) -> Result<Loaded> {
    let name = path.display().to_string().replace('\\', "/");
    if name.contains(char::is_control) {
        bail!(
            "the file name {name:?} has control characters, and Glint writes the name into other files; \
             rename the file"
        );
    }
    let (opened, source) = registry.read(path).map_err(Failure::Problems)?;
    // If the file does not state a clock, Glint may choose a lower one.
    let core = match source.gives(CLOCK_MHZ) {
        true => Core::build(opened),
        false => Core::build_with_free_clock(opened),
    };
    let core = core.map_err(|error| located(error, &name, &source))?;
    for warning in &core.design.warnings {
        let (code, place) = (warning.code, warning.location);
        failure::warn(&format!("{name}: {} ({code}, {place})", warning.message));
    }
    Ok(Loaded { path: name, core, source })
}

/// Adds the location of the key in `file` to an error of a key, and the file's name to any other error. `source` has the
/// locations of the keys.
fn located(error: anyhow::Error, file: &str, source: &ConfigSource) -> anyhow::Error {
    match source.located(error) {
        Ok(problems) => Failure::Problems(problems).into(),
        Err(error) => error.context(format!("`{file}`")),
    }
}

/// Returns the end of a message about a name that is not in `names`: the most similar name, and a list of all names. `what` is
/// the plural noun for such names. For example, the text for `exponnt` begins with "; did you mean `exponent`?".
fn none_of(name: &str, what: &str, names: &[&str]) -> String {
    let near = config::nearest(name, names.iter().copied())
        .map_or_else(|| ".".to_owned(), |near| format!("; did you mean `{near}`?"));
    format!("{near} The {what} are: {}", names.join(", "))
}

/// Finds Yosys. If Yosys is missing, returns `None` and adds a note with the text `without`, which describes the command without
/// Yosys.
fn yosys(without: &str, notes: &mut Vec<String>) -> Option<Tool> {
    Tool::find("yosys").map_err(|missing| notes.push(format!("{missing}: {without}"))).ok()
}

/// The outputs are right, within a bound that keeps the accuracy contract.
const HOLDS: &str = "holds";

/// The outputs are right, within a bound that does not keep the accuracy contract.
const OUTSIDE: &str = "outside the contract";

/// The outputs are right, but were compared with no bound.
const UNSTATED: &str = "no bound is stated";

const FAILS: &str = "FAILS";

fn verdict(bounds: &Bounds, failures: &[String]) -> &'static str {
    match (failures.is_empty(), bounds.keep()) {
        (true, _) if !bounds.are_stated() => UNSTATED,
        (true, true) => HOLDS,
        (true, false) => OUTSIDE,
        (false, _) => FAILS,
    }
}

impl Loaded {
    /// Makes the core's files. If a key asks for something that the core cannot have, the error has the location of the key in
    /// the file.
    fn files(&self, vectors: impl Into<Option<Vectors>>) -> Result<OutputFiles> {
        let files = self.core.files(&self.path, vectors);
        files.map_err(|error| located(error, &self.path, &self.source))
    }

    /// Checks the bound with [`Loaded::bound`], and warns about a module name with `__`. If the device's own keys are not all at
    /// their defaults, also prints the contract's remarks on the formula as warnings.
    fn contract(&self) -> Result<()> {
        self.bound()?;
        let config = self.core.config();
        if config.name.contains("__") {
            failure::warn(&format!(
                "{}: the module name `{}` has two underscores in a row, and Verilator's lint rejects such a \
                 name if the core has a wrapper: set another `name`",
                self.path, config.name
            ));
        }
        if (self.core.device().schema)()
            .keys
            .iter()
            .any(|key| *config.value(key.name) != key.default)
        {
            for remark in self.core.contract.remarks() {
                failure::warn(&format!("{}: {remark}", self.path));
            }
        }
        Ok(())
    }

    /// Warns if the configuration does not keep the accuracy contract, or if the contract states no bound. With `strict = true`,
    /// fails instead.
    fn bound(&self) -> Result<()> {
        let bounds = self.core.contract.bounds();
        let bound = bounds.governing();
        if !bounds.are_stated() {
            let message = format!(
                "{}: the contract states no error bound; `{Program} certify` can find a bound for some \
                 configurations",
                self.path
            );
            if self.core.config().strict {
                bail!("{message}; `strict = true` makes this an error");
            }
            failure::warn(&message);
        } else if !bounds.keep() {
            let limit = bound.limiting().map_or_else(String::new, |term| {
                let units = text::rounded_up(term.units, 3);
                format!(
                    "; the largest part of the bound, {units} units, comes from `{}` ({})",
                    term.key, term.what
                )
            });
            let advice = match advice::of(&self.core) {
                Some(advice) => {
                    let keys = advice.changes.iter();
                    let places = keys.filter_map(|(key, ..)| self.source.position(key));
                    let places: Vec<String> = places
                        .map(|(line, column)| format!("{}:{line}:{column}", self.path))
                        .collect();
                    match places.is_empty() {
                        true => format!("; {advice}"),
                        false => format!("; {advice}: see {}", places.join(" and ")),
                    }
                }
                None => "; no change of a single key makes the bound smaller".to_owned(),
            };
            let message = format!(
                "{}: outside the accuracy contract: the error bound is {} units, not below {}{limit}{advice}",
                self.path,
                bound.words(),
                bound.limit
            );
            if self.core.config().strict {
                bail!("{message}; `strict = true` makes this an error");
            }
            failure::warn(&message);
        }
        Ok(())
    }
}

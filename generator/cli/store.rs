//! Writes the generated files of a configuration to disk, and replaces no file of the user, unless the user gives `--force`.
//!
//! All files are first written to a temporary directory next to the directories of the configuration, and then moved to their
//! places one by one. A file that exists already is replaced only if the digests in the manifest show that Glint wrote it and
//! nobody edited it since. A file that Glint neither wrote nor needs to write, such as an editor's swap file, is left alone.

mod staging;
mod survey;

#[cfg(test)]
mod tests;

use std::fmt;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};

use super::destination;
use super::directories::{create_directory, create_parent};
use glint_core::package::{OutputFile, Seal, is_sealed};
use staging::Staging;
use survey::Survey;

/// Whether [`write()`] or [`write_sealed`] changed any file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// They were there already, byte for byte.
    Unchanged,
    /// They were written.
    Replaced,
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unchanged => "up to date",
            Self::Replaced => "written",
        })
    }
}

/// Writes the files of configuration `name` below the directory `out`. Files of the user stay unless they have the path of a file
/// that must be written.
///
/// # Errors
/// Without `force`, fails if files of Glint's were edited, or if other files would be overwritten; `force` replaces
/// them, and still keeps files that are not in the way. Fails if a directory cannot be written. After an error, the
/// user's files are unchanged.
pub fn write(out: &Path, name: &str, files: &[OutputFile], force: bool) -> Result<Written> {
    // If two runs write into one directory, the second waits: between its first file and its manifest the first one's
    // files look foreign.
    create_directory(out)?;
    let _lock = locked(out);
    let found = Survey::new(out, name, files)?;
    if found.different.is_empty() {
        return Ok(Written::Unchanged);
    }
    if !found.edited.is_empty() && !force {
        let list: Vec<String> =
            found.edited.iter().map(|path| format!("  {}", path.display())).collect();
        bail!(
            "these files were not written by Glint, or were edited since; nothing was changed\n{}\n\
             move them away, choose another --out, or replace them with --force",
            list.join("\n")
        );
    }
    Staging::new(out, files)?.place(out, &found.stale)?;
    Ok(Written::Replaced)
}

/// Waits until no other run writes below a directory, and keeps others waiting until the result is dropped. Returns `None` on a
/// system that locks no directories.
fn locked(directory: &Path) -> Option<fs::File> {
    let opened = fs::File::open(directory).ok()?;
    opened.lock().ok()?;
    Some(opened)
}

/// Returns the files below `out` that differ from `files` or are missing, and the files of Glint's that are no longer
/// in `files`. For example, `rtl_out/rough/rough.v` after somebody edited it.
///
/// # Errors
/// Fails if a file cannot be read.
pub fn differences(out: &Path, name: &str, files: &[OutputFile]) -> Result<Vec<String>> {
    Ok(Survey::new(out, name, files)?.different)
}

/// Writes a single file that contains the digest of its own text.
///
/// # Errors
/// Without `force`, fails if there is a file that Glint did not write or that was edited since. Fails if a directory
/// cannot be written. After a failure, the old file is still there.
pub fn write_sealed(path: &Path, text: &str, seal: Seal, force: bool) -> Result<Written> {
    if may_write(path, seal, force)?.is_some_and(|found| found == text.as_bytes()) {
        return Ok(Written::Unchanged);
    }
    create_parent(path)?;
    destination::replace(path, text)?;
    Ok(Written::Replaced)
}

/// Checks that [`write_sealed`] may replace the file at `path`, and returns its contents; `None` if there is no file.
///
/// # Errors
/// Without `force`, fails if Glint did not write the file, or if it was edited since. Fails if it cannot be read.
pub fn may_write(path: &Path, seal: Seal, force: bool) -> Result<Option<Vec<u8>>> {
    let found = contents(path)?;
    if let Some(found) = &found
        && !force
    {
        ensure!(
            is_sealed(found, seal),
            "{}\nmove it away, choose another --out, or replace it with --force",
            not_glints(path)
        );
    }
    Ok(found)
}

/// Checks that a command without `--force` may replace the file at `path`, if there is one.
///
/// # Errors
/// Fails if Glint did not write the file, or if it was edited since. Fails if it cannot be read.
pub fn may_replace(path: &Path, seal: Seal) -> Result<()> {
    let is_own = contents(path)?.is_none_or(|found| is_sealed(&found, seal));
    ensure!(is_own, "{}\nmove it away, or choose another --out", not_glints(path));
    Ok(())
}

fn not_glints(path: &Path) -> String {
    format!(
        "`{}` was not written by Glint, or was edited since; nothing was changed",
        path.display()
    )
}

/// Returns the contents of a file; `None` if there is no file.
fn contents(path: &Path) -> Result<Option<Vec<u8>>> {
    match fs::read(path) {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).with_context(|| format!("cannot read `{}`", path.display())),
    }
}

/// Returns whether a file below `out` is missing, or differs from `file`.
///
/// # Errors
/// Fails if the file cannot be read.
pub fn differs(out: &Path, file: &OutputFile) -> Result<bool> {
    let path = out.join(&file.path);
    match fs::read(&path) {
        Ok(found) => Ok(found != file.contents.as_bytes()),
        // Or a file where a directory should be, or the other way around.
        Err(error)
            if [ErrorKind::NotFound, ErrorKind::NotADirectory, ErrorKind::IsADirectory]
                .contains(&error.kind()) =>
        {
            Ok(true)
        }
        Err(error) => Err(error).with_context(|| format!("cannot read `{}`", path.display())),
    }
}

/// Returns the directories of a configuration: for example, `rtl_out/rough`, `testbench/rough` and `software/rough`.
fn directories(out: &Path, name: &str) -> [PathBuf; 3] {
    ["rtl_out", "testbench", "software"].map(|top| out.join(top).join(name))
}

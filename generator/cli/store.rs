//! Writes the generated files of a configuration to disk, and deletes the outdated files of an earlier run. Without
//! `--force`, a write fails and changes nothing if it would replace a file that Glint did not write, or that somebody edited.
//!
//! Glint recognises its files by the digests in the manifest. The manifest has no digest of itself, so an edited manifest still
//! counts as Glint's. All files are first written to a temporary directory in the output directory, and then moved to their
//! places one by one.

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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// All files were there already with the same bytes.
    Unchanged,
    /// At least one file was written, replaced or deleted.
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

/// Writes `files` below `out`, and deletes the files of an earlier run that the configuration `name` no longer needs. A file of
/// the user stays, unless it has the path of a file that must be written.
///
/// # Errors
///
/// Without `force`, fails if somebody edited a file that Glint wrote, or if a file that Glint did not write is in the way. The
/// user's files are then unchanged. Fails if a directory cannot be written.
pub fn write(out: &Path, name: &str, files: &[OutputFile], force: bool) -> Result<Written> {
    // If two runs write into one directory, the second run waits. Until the first run has written its manifest, the second run
    // would take the new files for files of the user.
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

/// Waits until no other run of Glint writes below `directory`, and locks it until the caller drops the result. Returns `None` on
/// a system that locks no directories.
fn locked(directory: &Path) -> Option<fs::File> {
    let opened = fs::File::open(directory).ok()?;
    opened.lock().ok()?;
    Some(opened)
}

/// Returns the paths of the files below `out` that differ from `files`, are missing, or are outdated files of Glint.
///
/// # Errors
///
/// Fails if a file cannot be read.
pub fn differences(out: &Path, name: &str, files: &[OutputFile]) -> Result<Vec<String>> {
    Ok(Survey::new(out, name, files)?.different)
}

/// Writes `text`, which contains its own digest, to the file at `path`.
///
/// # Errors
///
/// Without `force`, fails if Glint did not write the existing file, or if somebody edited the file. Fails if the file cannot be
/// written. After a failure, the old file is still there.
pub fn write_sealed(path: &Path, text: &str, seal: Seal, force: bool) -> Result<Written> {
    if may_write(path, seal, force)?.is_some_and(|found| found == text.as_bytes()) {
        return Ok(Written::Unchanged);
    }
    create_parent(path)?;
    destination::replace(path, text)?;
    Ok(Written::Replaced)
}

/// Returns the contents of the file that [`write_sealed`] would replace, or `None` without a file.
///
/// # Errors
/// Without `force`, fails if Glint did not write the file, or if somebody edited the file since. Fails if the file cannot be
/// read.
pub fn may_write(path: &Path, seal: Seal, force: bool) -> Result<Option<Vec<u8>>> {
    let found = contents(path)?;
    if let Some(found) = &found
        && !force
    {
        ensure!(
            is_sealed(found, seal),
            "{}\nmove the file away, choose another --out, or replace the file with --force",
            not_glints(path)
        );
    }
    Ok(found)
}

/// Checks that a command without `--force` may replace the file at `path`.
///
/// # Errors
/// Fails if Glint did not write the file, if somebody edited the file since, or if the file cannot be read.
pub fn may_replace(path: &Path, seal: Seal) -> Result<()> {
    let is_own = contents(path)?.is_none_or(|found| is_sealed(&found, seal));
    ensure!(is_own, "{}\nmove the file away, or choose another --out", not_glints(path));
    Ok(())
}

fn not_glints(path: &Path) -> String {
    format!(
        "`{}` was not written by Glint, or was edited since; nothing was changed",
        path.display()
    )
}

fn contents(path: &Path) -> Result<Option<Vec<u8>>> {
    match fs::read(path) {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).with_context(|| format!("cannot read `{}`", path.display())),
    }
}

/// Returns whether the file below `out` is missing or has other contents than `file`.
///
/// # Errors
///
/// Fails if the file cannot be read.
pub fn differs(out: &Path, file: &OutputFile) -> Result<bool> {
    let path = out.join(&file.path);
    match fs::read(&path) {
        Ok(found) => Ok(found != file.contents.as_bytes()),
        // The file is missing, or a file is in the place of a directory, or a directory is in the place of the file.
        Err(error)
            if [ErrorKind::NotFound, ErrorKind::NotADirectory, ErrorKind::IsADirectory]
                .contains(&error.kind()) =>
        {
            Ok(true)
        }
        Err(error) => Err(error).with_context(|| format!("cannot read `{}`", path.display())),
    }
}

fn directories(out: &Path, name: &str) -> [PathBuf; 3] {
    ["rtl_out", "testbench", "software"].map(|top| out.join(top).join(name))
}

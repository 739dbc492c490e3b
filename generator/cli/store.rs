//! Writing what was generated, without ever costing the user a file.
//!
//! The directories of a configuration are replaced as a whole: everything is written beside them
//! first and moved into place when it is complete. What stands there already is replaced only when
//! the manifest's digests say that Glint wrote it and nobody edited it since.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use serde_json::Value;
use tempfile::TempDir;

use super::staged;
use crate::package::{OutputFile, Seal, digest, is_sealed};

/// What [`write()`] did with the directories of a configuration, or [`write_sealed`] with a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// They were there already, byte for byte.
    Unchanged,
    /// They were written.
    Replaced,
}

/// Writes the files of configuration `name` below `out`.
///
/// # Errors
/// Files that Glint did not write, unless `force` (which still keeps those that are not in the way);
/// a directory that cannot be written. Whatever fails, what was there before is there after.
pub fn write(out: &Path, name: &str, files: &[OutputFile], force: bool) -> Result<Written> {
    if differences(out, name, files)?.is_empty() {
        return Ok(Written::Unchanged);
    }
    let foreign = foreign_files(out, name)?;
    if !foreign.is_empty() && !force {
        let list: Vec<String> =
            foreign.iter().map(|path| format!("  {}", path.display())).collect();
        bail!(
            "these files were not written by Glint, or were edited since; nothing was changed\n{}\n\
             move them away, choose another --out, or replace them with --force",
            list.join("\n")
        );
    }
    create_directory(out)?;
    let staging = staging(out)?;
    stage(staging.path(), files)?;
    swap(out, staging, name, &foreign)?;
    Ok(Written::Replaced)
}

/// Writes a single file that vouches for itself.
///
/// # Errors
/// A file there that Glint did not write or that was edited since, unless `force`; a directory that cannot be
/// written. Whatever fails, what was there before is there after.
pub fn write_sealed(path: &Path, text: &str, seal: Seal, force: bool) -> Result<Written> {
    if may_write(path, seal, force)?.is_some_and(|found| found == text.as_bytes()) {
        return Ok(Written::Unchanged);
    }
    create_parent(path)?;
    staged::replace(path, text.as_bytes())?;
    Ok(Written::Replaced)
}

/// Whether [`write_sealed`] would refuse to replace what is there, which it returns.
///
/// # Errors
/// A file that Glint did not write or that was edited since, unless `force`; one that cannot be read.
pub fn may_write(path: &Path, seal: Seal, force: bool) -> Result<Option<Vec<u8>>> {
    match fs::read(path) {
        Ok(found) if !force && !is_sealed(&found, seal) => bail!(
            "`{}` was not written by Glint, or was edited since; nothing was changed\n\
             move it away, choose another --out, or replace it with --force",
            path.display()
        ),
        Ok(found) => Ok(Some(found)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).with_context(|| format!("cannot read `{}`", path.display())),
    }
}

/// The files below `out` that differ from `files`, or are missing, or stand there beside them.
///
/// # Errors
/// A file that cannot be read.
pub fn differences(out: &Path, name: &str, files: &[OutputFile]) -> Result<Vec<String>> {
    let mut different = Vec::new();
    for file in files {
        if differs(out, file)? {
            different.push(file.path.clone());
        }
    }
    for path in present(out, name)? {
        let relative = relative_name(out, &path);
        if !files.iter().any(|file| file.path == relative) {
            different.push(relative);
        }
    }
    different.sort();
    Ok(different)
}

/// Whether a file below `out` is not as it would be written, or missing.
///
/// # Errors
/// It cannot be read.
pub fn differs(out: &Path, file: &OutputFile) -> Result<bool> {
    let path = out.join(&file.path);
    match fs::read(&path) {
        Ok(found) => Ok(found != file.contents.as_bytes()),
        // Or a file where a directory should be.
        Err(error) if [ErrorKind::NotFound, ErrorKind::NotADirectory].contains(&error.kind()) => {
            Ok(true)
        }
        Err(error) => Err(error).with_context(|| format!("cannot read `{}`", path.display())),
    }
}

/// The directories of a configuration.
fn directories(out: &Path, name: &str) -> [PathBuf; 3] {
    ["rtl_out", "testbench", "software"].map(|top| out.join(top).join(name))
}

/// What stands in the directories of a configuration now, sorted.
fn present(out: &Path, name: &str) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for directory in directories(out, name) {
        let entries = match fs::read_dir(&directory) {
            Ok(entries) => entries,
            Err(error) if error.kind() == ErrorKind::NotFound => continue,
            Err(error) if error.kind() == ErrorKind::NotADirectory => {
                // Unless it is one above that is no directory.
                if fs::symlink_metadata(&directory).is_ok() {
                    found.push(directory);
                }
                continue;
            }
            Err(error) => {
                return Err(error)
                    .with_context(|| format!("cannot read `{}`", directory.display()));
            }
        };
        for entry in entries {
            found.push(
                entry.with_context(|| format!("cannot read `{}`", directory.display()))?.path(),
            );
        }
    }
    found.sort();
    Ok(found)
}

/// Those of the files that Glint did not write as they are.
fn foreign_files(out: &Path, name: &str) -> Result<Vec<PathBuf>> {
    let manifest = out.join("rtl_out").join(name).join(format!("{name}.json"));
    let digests = read_digests(&manifest);
    let mut foreign = Vec::new();
    for path in present(out, name)? {
        let ours = match &digests {
            None => false,
            Some(_) if path == manifest => true,
            Some(digests) => fs::read(&path).is_ok_and(|contents| {
                digests.get(&relative_name(out, &path)) == Some(&digest(&contents))
            }),
        };
        if !ours {
            foreign.push(path);
        }
    }
    Ok(foreign)
}

/// The digests that a manifest holds; `None` when it is no manifest of Glint's.
fn read_digests(manifest: &Path) -> Option<BTreeMap<String, String>> {
    let value: Value = serde_json::from_slice(&fs::read(manifest).ok()?).ok()?;
    let digests = value.get("sha256")?.as_object()?;
    digests.iter().map(|(path, digest)| Some((path.clone(), digest.as_str()?.to_owned()))).collect()
}

/// The path below `out`, with `/`, as [`OutputFile::path`] has it.
fn relative_name(out: &Path, path: &Path) -> String {
    let relative = path.strip_prefix(out).unwrap_or(path);
    let parts: Vec<_> = relative.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

/// A directory beside what is to be replaced; it goes when it is dropped.
fn staging(out: &Path) -> Result<TempDir> {
    tempfile::Builder::new().prefix(".glint-").tempdir_in(out).with_context(|| {
        format!("cannot write to `{}`; choose another directory with --out", out.display())
    })
}

fn create_parent(path: &Path) -> Result<()> {
    match path.parent() {
        Some(parent) => create_directory(parent),
        None => Ok(()),
    }
}

fn create_directory(path: &Path) -> Result<()> {
    fs::create_dir_all(path)
        .with_context(|| format!("cannot create the directory `{}`", path.display()))
}

fn stage(staging: &Path, files: &[OutputFile]) -> Result<()> {
    for file in files {
        let path = staging.join(&file.path);
        create_parent(&path)?;
        fs::write(&path, &file.contents).with_context(|| {
            format!("cannot write `{}`; what was there before is unchanged", file.path)
        })?;
    }
    Ok(())
}

/// Moves the old directories out of the way, the new ones into their place, and those of the
/// `foreign` files back that nothing new replaces. What is left of the old is deleted with `staging`.
fn swap(out: &Path, staging: TempDir, name: &str, foreign: &[PathBuf]) -> Result<()> {
    let mut moves = Moves::default();
    let Err(error) = swap_each(out, staging.path(), name, foreign, &mut moves) else {
        return Ok(());
    };
    if moves.undo().is_err() {
        let kept = staging.keep();
        return Err(error).context(format!("what was there before is now in `{}`", kept.display()));
    }
    Err(error)
}

fn swap_each(
    out: &Path,
    staging: &Path,
    name: &str,
    foreign: &[PathBuf],
    moves: &mut Moves,
) -> Result<()> {
    let aside = staging.join("old");
    let (new, old) = (directories(staging, name), directories(&aside, name));
    for ((place, new), old) in directories(out, name).into_iter().zip(new).zip(old) {
        if fs::symlink_metadata(&place).is_ok() {
            create_parent(&old)?;
            moves.rename(&place, &old)?;
        }
        // A directory that the configuration no longer asks for goes.
        if new.exists() {
            create_parent(&place)?;
            moves.rename(&new, &place)?;
        }
    }
    for path in foreign {
        let old = aside.join(path.strip_prefix(out).unwrap_or(path));
        // Not where something new stands.
        if fs::symlink_metadata(path).is_err() {
            create_parent(path)?;
            moves.rename(&old, path)?;
        }
    }
    Ok(())
}

/// Renames that can be undone.
#[derive(Default)]
struct Moves(Vec<(PathBuf, PathBuf)>);

impl Moves {
    fn rename(&mut self, from: &Path, to: &Path) -> Result<()> {
        fs::rename(from, to)
            .with_context(|| format!("cannot move `{}` to `{}`", from.display(), to.display()))?;
        self.0.push((from.to_owned(), to.to_owned()));
        Ok(())
    }

    /// Takes back what was done, the last first.
    fn undo(self) -> io::Result<()> {
        self.0.into_iter().rev().try_for_each(|(from, to)| fs::rename(to, from))
    }
}

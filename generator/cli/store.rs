//! Writing what was generated, without ever costing the user a file.
//!
//! The directories of a configuration are replaced as a whole: everything is written beside them
//! first and moved into place when it is complete. What stands there already is replaced only when
//! the manifest's digests say that Glint wrote it and nobody edited it since.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::emit::{OutputFile, digest};

/// What [`write`] did with the directories of a configuration.
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
        let list: Vec<String> = foreign.iter().map(|path| format!("  {}", path.display())).collect();
        bail!(
            "these files were not written by Glint, or were edited since; nothing was changed\n{}\n\
             move them away, choose another --out, or replace them with --force",
            list.join("\n")
        );
    }
    fs::create_dir_all(out).with_context(|| format!("cannot create `{}`", out.display()))?;
    let staging = tempfile::Builder::new()
        .prefix(".glint-")
        .tempdir_in(out)
        .with_context(|| format!("cannot write to `{}`; choose another directory with --out", out.display()))?;
    stage(staging.path(), files)?;
    for path in &foreign {
        // Kept, unless something new takes its place.
        let relative = path.strip_prefix(out).unwrap_or(path);
        let target = staging.path().join(relative);
        if !target.exists() && path.is_file() {
            create_parent(&target)?;
            fs::copy(path, &target).with_context(|| format!("cannot keep `{}`", path.display()))?;
        }
    }
    swap(out, staging.path(), name)?;
    Ok(Written::Replaced)
}

/// The files below `out` that differ from `files`, or are missing, or stand there beside them.
///
/// # Errors
/// A file that cannot be read.
pub fn differences(out: &Path, name: &str, files: &[OutputFile]) -> Result<Vec<String>> {
    let mut different = Vec::new();
    for file in files {
        let path = out.join(&file.path);
        match fs::read(&path) {
            Ok(found) if found == file.contents.as_bytes() => {}
            Ok(_) => different.push(file.path.clone()),
            Err(error) if error.kind() == ErrorKind::NotFound => different.push(file.path.clone()),
            // A file where a directory should be.
            Err(error) if error.kind() == ErrorKind::NotADirectory => different.push(file.path.clone()),
            Err(error) => return Err(error).with_context(|| format!("cannot read `{}`", path.display())),
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

/// The directories of a configuration.
fn directories(out: &Path, name: &str) -> [PathBuf; 2] {
    ["rtl_out", "testbench"].map(|top| out.join(top).join(name))
}

/// What stands in the directories of a configuration now, sorted.
fn present(out: &Path, name: &str) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for directory in directories(out, name) {
        let entries = match fs::read_dir(&directory) {
            Ok(entries) => entries,
            Err(error) if error.kind() == ErrorKind::NotFound => continue,
            Err(error) if error.kind() == ErrorKind::NotADirectory => {
                found.push(directory);
                continue;
            }
            Err(error) => return Err(error).with_context(|| format!("cannot read `{}`", directory.display())),
        };
        for entry in entries {
            found.push(entry.with_context(|| format!("cannot read `{}`", directory.display()))?.path());
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
            Some(digests) => fs::read(&path)
                .is_ok_and(|contents| digests.get(&relative_name(out, &path)) == Some(&digest(&contents))),
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
    digests
        .iter()
        .map(|(path, digest)| Some((path.clone(), digest.as_str()?.to_owned())))
        .collect()
}

/// The path below `out`, with `/`, as [`OutputFile::path`] has it.
fn relative_name(out: &Path, path: &Path) -> String {
    let relative = path.strip_prefix(out).unwrap_or(path);
    let parts: Vec<_> = relative.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

fn create_parent(path: &Path) -> Result<()> {
    match path.parent() {
        Some(parent) => {
            fs::create_dir_all(parent).with_context(|| format!("cannot create `{}`", parent.display()))
        }
        None => Ok(()),
    }
}

fn stage(staging: &Path, files: &[OutputFile]) -> Result<()> {
    for file in files {
        let path = staging.join(&file.path);
        create_parent(&path)?;
        fs::write(&path, &file.contents)
            .with_context(|| format!("cannot write `{}`; what was there before is unchanged", file.path))?;
    }
    Ok(())
}

/// Moves the old directories out of the way and the new ones into their place; undoes it when a
/// step fails. The old ones are deleted with `staging`.
fn swap(out: &Path, staging: &Path, name: &str) -> Result<()> {
    let mut done: Vec<(PathBuf, Option<PathBuf>)> = Vec::new();
    let result = swap_each(out, staging, name, &mut done);
    if result.is_err() {
        for (place, old) in done.iter().rev() {
            // The new one goes away with the staging directory; what was there comes back.
            let _ = fs::rename(place, staging.join("undone").join(place.file_name().unwrap_or_default()));
            if let Some(old) = old {
                let _ = fs::rename(old, place);
            }
        }
    }
    result
}

fn swap_each(out: &Path, staging: &Path, name: &str, done: &mut Vec<(PathBuf, Option<PathBuf>)>) -> Result<()> {
    let (new, old) = (directories(staging, name), directories(&staging.join("old"), name));
    for ((place, new), old) in directories(out, name).into_iter().zip(new).zip(old) {
        if !new.exists() {
            continue;
        }
        create_parent(&place)?;
        create_parent(&old)?;
        let kept = match fs::rename(&place, &old) {
            Ok(()) => Some(old),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(error).with_context(|| format!("cannot replace `{}`", place.display())),
        };
        done.push((place.clone(), kept));
        fs::rename(&new, &place).with_context(|| format!("cannot write `{}`", place.display()))?;
    }
    Ok(())
}

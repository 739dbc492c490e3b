//! Single files, written beside their place and moved there when they are whole.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};

use crate::base::transient::{self, File};

/// Where the file `path` is written: what a symbolic link leads to, which is not replaced by a file.
///
/// # Errors
/// A link that leads nowhere.
pub fn place(path: &Path) -> Result<PathBuf> {
    if !path.is_symlink() {
        return Ok(path.to_owned());
    }
    fs::canonicalize(path).with_context(|| {
        format!("cannot write `{}`: it is a symbolic link that leads nowhere", path.display())
    })
}

/// A temporary file in the directory of `path`, to be persisted there.
///
/// # Errors
/// The directory is missing or not writable.
pub fn beside(path: &Path) -> Result<File> {
    let directory = match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    transient::delete_left_files(directory);
    let cannot = |error: io::Error| match error.kind() {
        ErrorKind::NotFound => anyhow!("there is no directory `{}`; make it", directory.display()),
        _ => error.into(),
    };
    File::beside(directory)
        .map_err(cannot)
        .with_context(|| format!("cannot write `{}`", path.display()))
}

/// Replaces the file `path` as a whole, or leaves it as it was.
///
/// # Errors
/// It cannot be written.
pub fn replace(path: &Path, contents: &[u8]) -> Result<()> {
    let path = &place(path)?;
    let staged = beside(path)?;
    staged
        .reopen()
        .and_then(|mut file| file.write_all(contents))
        .and_then(|()| staged.persist(path))
        .with_context(|| format!("cannot write `{}`", path.display()))?;
    Ok(())
}

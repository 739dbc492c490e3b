//! Single files, written beside their place and moved there when they are whole.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result};

use crate::base::transient::File;

/// A temporary file in the directory of `path`, to be persisted there.
///
/// # Errors
/// The directory is missing or not writable.
pub fn beside(path: &Path) -> Result<File> {
    let directory = match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".glint-");
    // As any new file: the umask takes away from it.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    File::made(|| builder.tempfile_in(directory))
        .with_context(|| format!("cannot write `{}`", path.display()))
}

/// Replaces the file `path` as a whole, or leaves it as it was.
///
/// # Errors
/// It cannot be written.
pub fn replace(path: &Path, contents: &[u8]) -> Result<()> {
    let staged = beside(path)?;
    staged
        .reopen()
        .and_then(|mut file| file.write_all(contents))
        .and_then(|()| staged.persist(path))
        .with_context(|| format!("cannot write `{}`", path.display()))?;
    Ok(())
}

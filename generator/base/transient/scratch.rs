//! Temporary files and directories.

use std::io;
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempDir};

use super::list;

/// What the names of temporary directories for tools begin with.
const PREFIX: &str = "glint-";

/// A temporary directory; it goes with everything in it when it is dropped, or when the process is interrupted.
#[derive(Debug)]
pub struct Directory(Option<TempDir>);

impl Directory {
    /// One for the use of a tool, where the system keeps temporary files.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn new() -> io::Result<Self> {
        Self::made(|| tempfile::Builder::new().prefix(PREFIX).tempdir())
    }

    /// One in `parent`, with a name that begins with `prefix`.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn beside(parent: &Path, prefix: &str) -> io::Result<Self> {
        // The path stays right when the process changes its directory.
        let parent = std::path::absolute(parent)?;
        Self::made(|| tempfile::Builder::new().prefix(prefix).tempdir_in(&parent))
    }

    fn made(make: impl FnOnce() -> io::Result<TempDir>) -> io::Result<Self> {
        let mut list = list();
        let made = make()?;
        list.paths.insert(made.path().to_owned());
        Ok(Self(Some(made)))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.0.as_ref().map_or(Path::new(""), TempDir::path)
    }

    /// Keeps the directory, which is the user's from now on.
    pub fn keep(mut self) -> PathBuf {
        let path = self.path().to_owned();
        list().paths.remove(&path);
        self.0.take().map_or(path, TempDir::keep)
    }
}

impl AsRef<Path> for Directory {
    fn as_ref(&self) -> &Path {
        self.path()
    }
}

impl Drop for Directory {
    fn drop(&mut self) {
        if let Some(made) = self.0.take() {
            let path = made.path().to_owned();
            drop(made);
            list().paths.remove(&path);
        }
    }
}

/// A temporary file that is to be moved to its place; it goes when it is dropped before, or when the process is
/// interrupted.
#[derive(Debug)]
pub struct File(Option<NamedTempFile>);

impl File {
    /// One that `make` makes.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn made(make: impl FnOnce() -> io::Result<NamedTempFile>) -> io::Result<Self> {
        let mut list = list();
        let made = make()?;
        list.paths.insert(std::path::absolute(made.path())?);
        Ok(Self(Some(made)))
    }

    /// Another handle of the file.
    ///
    /// # Errors
    /// The system has no more files.
    pub fn reopen(&self) -> io::Result<std::fs::File> {
        match &self.0 {
            Some(made) => made.reopen(),
            None => Err(io::ErrorKind::NotFound.into()),
        }
    }

    /// Moves the file to `path`, in place of what is there.
    ///
    /// # Errors
    /// It cannot be moved; then it is deleted.
    pub fn persist(mut self, path: &Path) -> io::Result<()> {
        let Some(made) = self.0.take() else {
            return Err(io::ErrorKind::NotFound.into());
        };
        let listed = std::path::absolute(made.path());
        let done = made.persist(path).map(drop).map_err(|error| error.error);
        forget(listed);
        done
    }
}

impl Drop for File {
    fn drop(&mut self) {
        if let Some(made) = self.0.take() {
            let listed = std::path::absolute(made.path());
            drop(made);
            forget(listed);
        }
    }
}

fn forget(listed: io::Result<PathBuf>) {
    if let Ok(path) = listed {
        list().paths.remove(&path);
    }
}

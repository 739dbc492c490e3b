//! A single file that is written whole or not at all, and that is known to be writable before the work for it.

use std::fs::{self, File, OpenOptions};
use std::path::{Path, PathBuf};

use super::staged;
use crate::base::transient;
use anyhow::{Context, Result};

/// Where a file goes: written beside its place and moved there when it is whole. A pipe or a device is
/// written itself.
pub struct Destination {
    path: PathBuf,
    sink: Sink,
}

enum Sink {
    Itself(File),
    Beside(transient::File),
}

impl Destination {
    /// Makes sure that `path` can be written, before any work is done for it.
    ///
    /// # Errors
    /// It cannot.
    pub fn open(path: &Path) -> Result<Self> {
        if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
            let file = OpenOptions::new().write(true).open(path);
            let sink = Sink::Itself(file.with_context(|| cannot(path))?);
            return Ok(Self { path: path.to_owned(), sink });
        }
        let path = staged::place(path)?;
        let sink = Sink::Beside(staged::beside(&path)?);
        Ok(Self { path, sink })
    }

    /// The file to write.
    ///
    /// # Errors
    /// The system has no more files.
    pub fn file(&self) -> Result<File> {
        let file = match &self.sink {
            Sink::Itself(file) => file.try_clone(),
            Sink::Beside(staged) => staged.reopen(),
        };
        file.with_context(|| cannot(&self.path))
    }

    /// Moves the file into its place.
    ///
    /// # Errors
    /// It cannot be moved; then nothing was changed.
    pub fn commit(self) -> Result<()> {
        match self.sink {
            Sink::Itself(_) => Ok(()),
            Sink::Beside(staged) => staged.persist(&self.path).with_context(|| cannot(&self.path)),
        }
    }
}

/// The message when it cannot be written.
fn cannot(path: &Path) -> String {
    format!("cannot write `{}`", path.display())
}

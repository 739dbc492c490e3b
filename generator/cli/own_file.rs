//! Writes single files that Glint rewrites at each run, such as records. Each file contains a digest of its own text ([`Seal`]),
//! so Glint refuses to overwrite a file that it did not write, or that somebody has edited since.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::Serialize;

use super::destination::Destination;
use super::directories::create_directory;
use super::record_text::record_text;
use super::store;
use glint_core::package::{Seal, sealed, sealed_object};

pub struct OwnFile {
    path: PathBuf,
    seal: Seal,
    destination: Destination,
}

impl OwnFile {
    /// Opens the file `name` in `directory`, which is created if it is missing. A command calls this function before the work for
    /// the file, so it reports early if a path cannot be written. `seal` is the place of the digest in the file.
    ///
    /// # Errors
    ///
    /// Fails if the file cannot be written, if Glint did not write the existing file, or if somebody has edited it since.
    pub fn new(directory: &Path, name: &str, seal: Seal) -> Result<Self> {
        create_directory(directory)?;
        let path = directory.join(name);
        if path.is_file() {
            store::may_replace(&path, seal)?;
        }
        let destination = Destination::open(&path)?;
        Ok(Self { path, seal, destination })
    }

    /// Opens the record `<name>.json`, or returns `None` without a directory for records. For example, `--out mutation` makes
    /// `mutation/rough.json` the record of `rough`.
    ///
    /// # Errors
    ///
    /// Fails if the record cannot be written, if Glint did not write the existing record, or if somebody has edited it since.
    pub fn record(directory: Option<&Path>, name: &str) -> Result<Option<Self>> {
        directory.map(|it| Self::new(it, &format!("{name}.json"), Seal::Json)).transpose()
    }

    /// Adds the line with the digest, and returns the file's path.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn write(self, contents: String) -> Result<String> {
        let text = sealed(contents, self.seal);
        self.write_as_it_is(&text)
    }

    /// Writes `value` with a member for the digest added, and returns the file's path.
    ///
    /// # Errors
    ///
    /// Fails if the value is no object, or if the file cannot be written.
    pub fn write_json(self, value: &impl Serialize) -> Result<String> {
        let value = serde_json::to_value(value).context("cannot write JSON")?;
        self.write_as_it_is(&record_text(&sealed_object(value)?))
    }

    fn write_as_it_is(self, text: &str) -> Result<String> {
        let name = self.path.display().to_string().replace('\\', "/");
        self.destination.write(text)?;
        Ok(name)
    }
}

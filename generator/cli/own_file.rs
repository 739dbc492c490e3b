//! Writes single files that Glint rewrites at each run, such as records. It refuses to overwrite a file that Glint did not write.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use serde::Serialize;

use super::destination::Destination;
use super::directories::create_directory;
use super::record_text::record_text;

/// A file that will be written, with its destination.
pub struct OwnFile {
    path: PathBuf,
    destination: Destination,
}

impl OwnFile {
    /// The first characters of a JSON file that Glint wrote.
    pub const JSON: &str = "{\n  \"glint\":";

    /// Prepares to write the file `name` in `directory`, which is created if it is missing. If the file exists, it must contain
    /// `marker`. A command calls this function before the work for the file, so that a path that cannot be written is reported
    /// early.
    ///
    /// # Errors
    /// Fails if something else is there, or if the file cannot be written.
    pub fn new(directory: &Path, name: &str, marker: &str) -> Result<Self> {
        create_directory(directory)?;
        let path = directory.join(name);
        // Other problems with the file show in writing.
        let foreign = path.is_file()
            && fs::read(&path).is_ok_and(|bytes| {
                let found = std::str::from_utf8(&bytes);
                !found.is_ok_and(|text| text.contains(marker))
            });
        if foreign {
            bail!(
                "`{}` is not of Glint's making: move it away, or give another directory with --out",
                path.display()
            );
        }
        let destination = Destination::open(&path)?;
        Ok(Self { path, destination })
    }

    /// Returns the record `<name>.json`, if there is a directory for records. For example, `--out mutation` makes
    /// `mutation/rough.json` the record of `rough`.
    ///
    /// # Errors
    /// Fails as [`OwnFile::new`] does.
    pub fn record(directory: Option<&Path>, name: &str) -> Result<Option<Self>> {
        directory.map(|it| Self::new(it, &format!("{name}.json"), Self::JSON)).transpose()
    }

    /// Writes the file and returns its path.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn write(self, contents: &str) -> Result<String> {
        let name = self.path.display().to_string().replace('\\', "/");
        self.destination.write(contents)?;
        Ok(name)
    }

    /// Writes `value` as the JSON of a record, as [`OwnFile::write`] does.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn write_json(self, value: &impl Serialize) -> Result<String> {
        let value = serde_json::to_value(value).context("cannot write JSON")?;
        self.write(&record_text(&value))
    }
}

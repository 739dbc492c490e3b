//! Writes a single file whole or not at all, and makes sure before the work for it that it can be written.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};

use glint_tools::transient::Directory;

/// The file while it is written, in a directory of its own.
const UNFINISHED: &str = "unfinished";

/// The place of a file. The file is written beside it and moved there when it is whole. A pipe or a device is written
/// directly.
pub struct Destination {
    path: PathBuf,
    sink: Sink,
}

enum Sink {
    Itself(File),
    Beside(Directory),
}

impl Destination {
    /// Makes sure that `path` can be written, before any work is done for it. If `path` is a symbolic link, the file
    /// behind it is replaced, and not the link.
    ///
    /// # Errors
    /// Fails if `path` cannot be written, if a link leads nowhere, or if the directory is missing.
    pub fn open(path: &Path) -> Result<Self> {
        if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
            let file = OpenOptions::new().write(true).open(path);
            let sink = Sink::Itself(file.with_context(|| cannot(path))?);
            return Ok(Self { path: path.to_owned(), sink });
        }
        let path = match path.is_symlink() {
            true => fs::canonicalize(path).with_context(|| {
                format!("{}: it is a symbolic link that leads nowhere", cannot(path))
            })?,
            false => path.to_owned(),
        };
        let directory = match path.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
        let missing = |error: io::Error| match error.kind() {
            ErrorKind::NotFound => {
                anyhow!("there is no directory `{}`; make it", directory.display())
            }
            _ => error.into(),
        };
        let made = || -> Result<Directory> {
            let beside = Directory::beside(directory).map_err(missing)?;
            File::create(beside.path().join(UNFINISHED))?;
            Ok(beside)
        };
        let sink = Sink::Beside(made().with_context(|| cannot(&path))?);
        Ok(Self { path, sink })
    }

    /// Opens a file that is not there yet, as [`Destination::open`] does, or one that may be replaced by `force`.
    ///
    /// # Errors
    /// Without `force`, fails if the file is there. Fails if [`Destination::open`] fails.
    pub fn fresh(path: &Path, force: bool) -> Result<Self> {
        if path.is_file() && !force {
            bail!(
                "`{}` is there already; move it away, name another file, or add --force to replace it",
                path.display()
            );
        }
        Self::open(path)
    }

    /// Returns the file to write.
    ///
    /// # Errors
    /// Fails if the system has no more files.
    pub fn file(&self) -> Result<File> {
        let file = match &self.sink {
            Sink::Itself(file) => file.try_clone(),
            Sink::Beside(staged) => {
                OpenOptions::new().read(true).write(true).open(staged.path().join(UNFINISHED))
            }
        };
        file.with_context(|| cannot(&self.path))
    }

    /// Returns the path of the finished file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Moves the file into its place.
    ///
    /// # Errors
    /// Fails if the file cannot be moved; then nothing was changed.
    pub fn commit(self) -> Result<()> {
        match self.sink {
            Sink::Itself(_) => Ok(()),
            Sink::Beside(staged) => fs::rename(staged.path().join(UNFINISHED), &self.path)
                .with_context(|| cannot(&self.path)),
        }
    }

    /// Writes the whole file and moves it into its place.
    ///
    /// # Errors
    /// Fails if the file cannot be written or moved; then nothing was changed.
    pub fn write(self, contents: impl AsRef<[u8]>) -> Result<()> {
        self.file()?.write_all(contents.as_ref()).with_context(|| cannot(&self.path))?;
        self.commit()
    }
}

/// Replaces the file `path` as a whole, or leaves it as it was.
///
/// # Errors
/// Fails if the file cannot be written.
pub fn replace(path: &Path, contents: impl AsRef<[u8]>) -> Result<()> {
    Destination::open(path)?.write(contents)
}

/// Returns the message when it cannot be written.
fn cannot(path: &Path) -> String {
    format!("cannot write `{}`", path.display())
}

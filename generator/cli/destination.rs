//! Writes a single file completely or not at all. Only a pipe or a device is written directly.
//!
//! A command opens the destination before it starts the work, so it reports early if a path cannot be written. Missing
//! directories above the file are created, and removed again if the file is not written.

use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use super::directories::MadeDirectories;
use glint_tools::transient::Directory;

/// The name of the file while Glint writes it, in a temporary directory next to its place.
const UNFINISHED: &str = "unfinished";

/// A file that is written under a temporary name near its place, and moved to its place when it is complete.
pub struct Destination {
    path: PathBuf,
    sink: Sink,
    /// The created directories. They are dropped after the sink, which lies inside them.
    made: MadeDirectories,
}

enum Sink {
    Itself(File),
    Beside(Directory),
}

impl Destination {
    /// Opens the destination. A path that is no regular file, such as a pipe, is opened and written directly. If `path` is a
    /// symbolic link, the file to which the link leads is replaced, and not the link.
    ///
    /// # Errors
    ///
    /// Fails if `path` cannot be written, if a link leads nowhere, or if the directory cannot be made.
    pub fn open(path: &Path) -> Result<Self> {
        if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
            let file = OpenOptions::new().write(true).open(path);
            let sink = Sink::Itself(file.with_context(|| cannot(path))?);
            return Ok(Self { path: path.to_owned(), sink, made: MadeDirectories::default() });
        }
        let path = match path.is_symlink() {
            true => fs::canonicalize(path)
                .with_context(|| format!("{}: the symbolic link leads nowhere", cannot(path)))?,
            false => path.to_owned(),
        };
        let directory = match path.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
        let made = MadeDirectories::make(directory).with_context(|| cannot(&path))?;
        let staged = || -> Result<Directory> {
            let beside = Directory::beside(directory)?;
            File::create(beside.path().join(UNFINISHED))?;
            Ok(beside)
        };
        let sink = Sink::Beside(staged().with_context(|| cannot(&path))?);
        Ok(Self { path, sink, made })
    }

    /// Opens the destination only if no file exists there. With `force`, an existing file may be replaced.
    ///
    /// # Errors
    ///
    /// Fails if `path` cannot be written ([`Destination::open`]), and without `force` also if the file exists.
    pub fn fresh(path: &Path, force: bool) -> Result<Self> {
        if path.is_file() && !force {
            bail!(
                "`{}` exists already; move it away, name another file, or add --force to replace it",
                path.display()
            );
        }
        Self::open(path)
    }

    /// Returns the file that the caller must write.
    ///
    /// # Errors
    ///
    /// Fails if the file cannot be opened.
    pub fn file(&self) -> Result<File> {
        let file = match &self.sink {
            Sink::Itself(file) => file.try_clone(),
            Sink::Beside(staged) => {
                OpenOptions::new().read(true).write(true).open(staged.path().join(UNFINISHED))
            }
        };
        file.with_context(|| cannot(&self.path))
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Moves the file to its place. The caller must have written the whole file.
    ///
    /// # Errors
    ///
    /// Fails if the file cannot be moved; then nothing was changed.
    pub fn commit(mut self) -> Result<()> {
        if let Sink::Beside(staged) = &self.sink {
            fs::rename(staged.path().join(UNFINISHED), &self.path)
                .with_context(|| cannot(&self.path))?;
        }
        self.made.keep();
        Ok(())
    }

    /// Writes the file and moves it to its place.
    ///
    /// # Errors
    ///
    /// Fails if the file cannot be written or moved; then the old file is unchanged. A pipe or a device may have received a
    /// part of the contents.
    pub fn write(self, contents: impl AsRef<[u8]>) -> Result<()> {
        self.file()?.write_all(contents.as_ref()).with_context(|| cannot(&self.path))?;
        self.commit()
    }
}

/// Replaces the file `path` as a whole. If that is not possible, for example because the disk is full, the old file stays
/// unchanged. A pipe or a device is written directly.
///
/// # Errors
/// Fails if the file cannot be written.
pub fn replace(path: &Path, contents: impl AsRef<[u8]>) -> Result<()> {
    Destination::open(path)?.write(contents)
}

fn cannot(path: &Path) -> String {
    format!("cannot write `{}`", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directories_are_made_for_a_file_and_removed_without_it() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("made/for/it.txt");
        drop(Destination::open(&path).unwrap());
        assert!(!place.path().join("made").exists());
        Destination::open(&path).unwrap().write("text").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "text");
        drop(Destination::open(&place.path().join("made/other/it.txt")).unwrap());
        assert!(path.exists() && !place.path().join("made/other").exists());
    }
}

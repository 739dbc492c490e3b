//! Temporary files and directories.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::time::Duration;

use tempfile::{NamedTempFile, TempDir};

use super::list;

/// The prefix of the names of temporary directories for tools.
const PREFIX: &str = "glint-";

/// The file in such a directory that says whose it is, and is locked while the directory is in use.
const LOCK: &str = "glint.lock";

/// The prefix of the names of temporary files; [`RANDOM`] characters follow.
const FILE_PREFIX: &str = ".glint-unfinished-";
const RANDOM: usize = 12;

/// How old a file without a lock is at least when it is deleted: it may have been made a moment ago.
const UNLOCKED: Duration = Duration::from_secs(60);

static SWEEP: Once = Once::new();

/// A temporary directory; it goes with everything in it when it is dropped, or when the process is interrupted.
#[derive(Debug)]
pub struct Directory {
    made: Option<TempDir>,
    lock: Option<fs::File>,
}

impl Directory {
    /// One for the use of a tool, where the system keeps temporary files. The first deletes those that killed processes
    /// have left.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn new() -> io::Result<Self> {
        SWEEP.call_once(|| delete_left_directories(&std::env::temp_dir()));
        let mut directory = Self::made(|| tempfile::Builder::new().prefix(PREFIX).tempdir())?;
        let mut lock = fs::File::create(directory.path().join(LOCK))?;
        // Before it says anything: what is empty is nobody's. A system without locks goes without.
        let _ = lock.try_lock();
        lock.write_all(statement(directory.path().file_name()).as_bytes())?;
        directory.lock = Some(lock);
        Ok(directory)
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
        let made = make().map_err(without_path)?;
        list.paths.insert(made.path().to_owned());
        Ok(Self { made: Some(made), lock: None })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.made.as_ref().map_or(Path::new(""), TempDir::path)
    }

    /// Keeps the directory, which is the user's from now on.
    pub fn keep(mut self) -> PathBuf {
        let path = self.path().to_owned();
        list().paths.remove(&path);
        self.made.take().map_or(path, TempDir::keep)
    }
}

impl AsRef<Path> for Directory {
    fn as_ref(&self) -> &Path {
        self.path()
    }
}

impl Drop for Directory {
    fn drop(&mut self) {
        self.lock = None;
        if let Some(made) = self.made.take() {
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
    /// One in `directory`, with the permissions of any new file.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn beside(directory: &Path) -> io::Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(FILE_PREFIX).rand_bytes(RANDOM);
        // The umask takes away from it.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut list = list();
        let made = builder.tempfile_in(directory).map_err(without_path)?;
        // Elsewhere nobody else could write what is locked. A system without locks goes without.
        #[cfg(unix)]
        let _ = made.as_file().try_lock();
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

/// Deletes the temporary files in `directory` that killed processes have left.
pub fn delete_left_files(directory: &Path) {
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let random = name.to_str().and_then(|name| name.strip_prefix(FILE_PREFIX));
        let path = entry.path();
        let is_left = random.is_some_and(|random| random.len() == RANDOM)
            && entry.metadata().is_ok_and(|found| {
                let age = found.modified().ok().and_then(|time| time.elapsed().ok());
                found.is_file() && age.is_some_and(|age| age > UNLOCKED)
            })
            && is_unlocked(&path);
        if is_left {
            // Another process has deleted it, or it is not this user's.
            let _ = fs::remove_file(&path);
        }
    }
}

/// Deletes the temporary directories in `place` that killed processes have left: those that say that they are, under their own
/// name, and that nobody has locked.
pub fn delete_left_directories(place: &Path) {
    for entry in fs::read_dir(place).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let lock = entry.path().join(LOCK);
        let is_left = name.to_string_lossy().starts_with(PREFIX)
            && fs::symlink_metadata(&lock).is_ok_and(|found| found.is_file())
            && fs::read_to_string(&lock).is_ok_and(|text| text == statement(Some(&name)))
            && is_unlocked(&lock);
        if is_left {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

fn is_unlocked(path: &Path) -> bool {
    fs::File::open(path).is_ok_and(|file| file.try_lock().is_ok())
}

/// Returns the contents of the file in a directory of this name.
fn statement(name: Option<&OsStr>) -> String {
    let name = name.unwrap_or_default().to_string_lossy();
    format!("Glint works in {name}. The next run deletes what a killed one has left.\n")
}

/// An error of a temporary path without its name, which says nothing to anybody.
fn without_path(error: io::Error) -> io::Error {
    let text = error.to_string();
    io::Error::new(error.kind(), text.split(" at path ").next().unwrap_or_default())
}

fn forget(listed: io::Result<PathBuf>) {
    if let Ok(path) = listed {
        list().paths.remove(&path);
    }
}

//! Makes temporary directories, and deletes the directories of earlier, killed processes.
//!
//! Each directory has a lock file with the directory's own name. The process locks this file while it uses the directory.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Once;

use tempfile::TempDir;

use super::list;

/// The prefixes of the names of temporary directories: for tools, and for files that are later moved into the parent directory.
const FOR_TOOLS: &str = "glint-";
const BESIDE: &str = ".glint-";

/// The name of the lock file in each directory.
const LOCK: &str = "glint.lock";

static SWEEP: Once = Once::new();

/// A temporary directory. Dropping the value deletes the directory with its contents, and so does an interruption of the process.
#[derive(Debug)]
pub struct Directory {
    made: Option<TempDir>,
    lock: Option<fs::File>,
}

impl Directory {
    /// Makes a directory for a tool, where the system keeps temporary files. The first call deletes the directories that
    /// killed processes have left there.
    ///
    /// # Errors
    /// Fails if the directory cannot be made, or if the path of the system's temporary directory contains a blank.
    pub fn new() -> io::Result<Self> {
        let place = std::env::temp_dir();
        // Some tools that work in the directory, such as make and abc, split a path at blanks.
        if place.to_string_lossy().contains(char::is_whitespace) {
            let message = format!(
                "the path of the directory for temporary files, `{}`, has a blank, and make and abc do not \
                 accept blanks: set TMPDIR to another directory",
                place.display()
            );
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        SWEEP.call_once(|| sweep(&place, FOR_TOOLS));
        Self::made(&place, FOR_TOOLS)
    }

    /// Makes a directory in `parent`, for files that are later moved into `parent`. First deletes the directories that killed
    /// processes have left in `parent`.
    ///
    /// # Errors
    ///
    /// Fails if the directory cannot be made.
    pub fn beside(parent: &Path) -> io::Result<Self> {
        // The absolute path stays valid if the process changes its current directory.
        let parent = std::path::absolute(parent)?;
        sweep(&parent, BESIDE);
        Self::made(&parent, BESIDE)
    }

    fn made(parent: &Path, prefix: &str) -> io::Result<Self> {
        let made = {
            let mut list = list();
            let made = tempfile::Builder::new().prefix(prefix).tempdir_in(parent);
            let made = made.map_err(without_path)?;
            list.paths.insert(made.path().to_owned());
            made
        };
        let mut directory = Self { made: Some(made), lock: None };
        let mut lock = fs::File::create(directory.path().join(LOCK))?;
        // The file is locked while it is empty, because [`sweep`] ignores an empty lock file. On a system without locks, the file
        // stays unlocked.
        let _ = lock.try_lock();
        lock.write_all(title(directory.path()).as_bytes())?;
        directory.lock = Some(lock);
        Ok(directory)
    }

    pub fn path(&self) -> &Path {
        self.made.as_ref().map_or(Path::new(""), TempDir::path)
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

/// Deletes the directories that killed processes have left in `parent`. The name of such a directory begins with `prefix`. Its
/// lock file contains the directory's own name and is not locked.
fn sweep(parent: &Path, prefix: &str) {
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let (path, lock) = (entry.path(), entry.path().join(LOCK));
        let is_own = entry.file_name().to_string_lossy().starts_with(prefix)
            && fs::symlink_metadata(&lock).is_ok_and(|found| found.is_file())
            && fs::read_to_string(&lock).is_ok_and(|text| text == title(&path));
        if let Ok(lock) = fs::File::open(&lock)
            && is_own
            && lock.try_lock().is_ok()
        {
            let _ = fs::remove_dir_all(&path);
        }
    }
}

fn title(directory: &Path) -> String {
    let name = directory.file_name().unwrap_or_default().to_string_lossy();
    format!("Glint works in {name}. The next run deletes the files that a killed run has left.\n")
}

/// Returns every file and symbolic link below a directory, sorted by path. Links are not followed.
///
/// # Errors
/// Fails if a directory cannot be read.
pub fn files_below(directory: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut pending = vec![directory.to_owned()];
    while let Some(directory) = pending.pop() {
        for entry in fs::read_dir(&directory)? {
            let entry = entry?;
            if entry.file_type()?.is_dir() { &mut pending } else { &mut found }.push(entry.path());
        }
    }
    found.sort();
    Ok(found)
}

/// Returns the part of `path` below `root`, with `/` between its parts on every system. A path that is not below `root` stays
/// whole.
pub fn relative_name(root: &Path, path: &Path) -> String {
    let relative = path.strip_prefix(root).unwrap_or(path);
    let parts: Vec<_> = relative.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

/// Removes a temporary path, whose random name tells a user nothing, from a message. For example, `Permission denied (os error
/// 13) at path "/t/glint-a1B2c3"` becomes `Permission denied (os error 13)`.
fn without_path(error: io::Error) -> io::Error {
    let text = error.to_string();
    io::Error::new(error.kind(), text.split(" at path ").next().unwrap_or_default())
}

//! Temporary directories, each with a file in it that says whose it is and is locked while the directory is in use.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Once;

use tempfile::TempDir;

use super::list;

/// The prefixes of the names of directories for tools, and of those beside files that they are made for.
const FOR_TOOLS: &str = "glint-";
const BESIDE: &str = ".glint-";

/// The file that says whose the directory is.
const LOCK: &str = "glint.lock";

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
        let place = std::env::temp_dir();
        SWEEP.call_once(|| {
            left(&place, FOR_TOOLS).iter().for_each(|left| drop(fs::remove_dir_all(&left.path)));
        });
        Self::made(&place, FOR_TOOLS)
    }

    /// One in `parent`, for files that are moved into their places beside it. The files that are made in it are stated by
    /// [`Directory::state`].
    ///
    /// # Errors
    /// It cannot be made.
    pub fn beside(parent: &Path) -> io::Result<Self> {
        // The path stays right when the process changes its directory.
        Self::made(&std::path::absolute(parent)?, BESIDE)
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
        let lock = fs::File::create(directory.path().join(LOCK))?;
        // Before it says anything: what is empty is nobody's. A system without locks goes without.
        let _ = lock.try_lock();
        directory.lock = Some(lock);
        directory.state(&title(directory.path()))?;
        Ok(directory)
    }

    /// Adds a line to the file that says whose the directory is.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn state(&mut self, line: &str) -> io::Result<()> {
        self.lock.as_mut().map_or(Ok(()), |lock| writeln!(lock, "{line}"))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.made.as_ref().map_or(Path::new(""), TempDir::path)
    }

    /// Keeps the directory, as a process does that is killed.
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

/// A directory that a killed process has left. It is locked while this lives.
pub struct Left {
    /// Where it is.
    pub path: PathBuf,
    /// What was stated of it, line by line.
    pub stated: Vec<String>,
    _lock: fs::File,
}

/// The directories that killed processes have left in `parent` beside files, and in which nothing stands but what was
/// stated: what else is there may be somebody's.
pub fn left_beside(parent: &Path) -> Vec<Left> {
    let mut all = left(parent, BESIDE);
    all.retain(|left| {
        files_below(&left.path).is_ok_and(|files| {
            let mut names = files.iter().map(|file| relative_name(&left.path, file));
            names.all(|name| name == LOCK || left.stated.contains(&name))
        })
    });
    all
}

/// The directories that killed processes have left in `parent`: those that say that they are, under their own name, and
/// that nobody has locked.
fn left(parent: &Path, prefix: &str) -> Vec<Left> {
    let of_entry = |entry: fs::DirEntry| {
        let (path, name) = (entry.path(), entry.file_name());
        let lock = path.join(LOCK);
        let is_named = name.to_string_lossy().starts_with(prefix);
        if !is_named || !fs::symlink_metadata(&lock).is_ok_and(|found| found.is_file()) {
            return None;
        }
        let text = fs::read_to_string(&lock).ok()?;
        let mut lines = text.lines().map(str::to_owned);
        let lock = fs::File::open(&lock).ok()?;
        let is_left = lines.next()? == title(&path) && lock.try_lock().is_ok();
        is_left.then(|| Left { path, stated: lines.collect(), _lock: lock })
    };
    let entries = fs::read_dir(parent).into_iter().flatten().flatten();
    entries.filter_map(of_entry).collect()
}

/// The first line of the file in a directory.
fn title(directory: &Path) -> String {
    let name = directory.file_name().unwrap_or_default().to_string_lossy();
    format!("Glint works in {name}. The next run deletes what a killed one has left.")
}

/// Everything below a directory that is none, sorted; links are not followed.
///
/// # Errors
/// A directory that cannot be read.
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

/// The path below `root`, with `/`.
pub fn relative_name(root: &Path, path: &Path) -> String {
    let relative = path.strip_prefix(root).unwrap_or(path);
    let parts: Vec<_> = relative.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

/// An error of a temporary path without its name, which says nothing to anybody.
fn without_path(error: io::Error) -> io::Error {
    let text = error.to_string();
    io::Error::new(error.kind(), text.split(" at path ").next().unwrap_or_default())
}

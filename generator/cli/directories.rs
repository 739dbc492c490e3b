//! Creates the directories for files that Glint writes.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// Directories that Glint created for a file. If the file is not written in the end, they are removed again, unless they contain
/// something else. For `made/for/it.txt` in an empty directory, these are `made` and `made/for`.
#[derive(Default)]
pub struct MadeDirectories {
    /// The paths of the directories, the outermost first.
    paths: Vec<PathBuf>,
}

impl MadeDirectories {
    /// Makes `directory` and the missing directories above it.
    ///
    /// # Errors
    ///
    /// Fails if a directory cannot be made.
    pub fn make(directory: &Path) -> Result<Self> {
        let missing =
            directory.ancestors().take_while(|it| !it.as_os_str().is_empty() && !it.exists());
        let mut paths: Vec<PathBuf> = missing.map(Path::to_owned).collect();
        paths.reverse();
        let made = Self { paths };
        create_directory(directory)?;
        Ok(made)
    }

    /// Lets the directories stay. A caller calls this function once the file is written.
    pub fn keep(&mut self) {
        self.paths.clear();
    }
}

impl Drop for MadeDirectories {
    fn drop(&mut self) {
        for path in self.paths.iter().rev() {
            // A directory with something in it stays.
            let _ = fs::remove_dir(path);
        }
    }
}

/// Makes the directory `path` and the missing directories above it.
///
/// # Errors
///
/// Fails if the directory cannot be made.
pub fn create_directory(path: &Path) -> Result<()> {
    fs::create_dir_all(path)
        .with_context(|| format!("cannot create the directory `{}`", path.display()))
}

/// Creates the directory for the file `path`, and the missing directories above it.
///
/// # Errors
/// Fails if the directory cannot be made.
pub fn create_parent(path: &Path) -> Result<()> {
    match path.parent() {
        Some(parent) => create_directory(parent),
        None => Ok(()),
    }
}

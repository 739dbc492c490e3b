//! Reads and writes files of the repository and of temporary directories. Each function panics if that fails.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::Sure;

/// Returns the directory of the repository, in which the tests run.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the text of a file.
///
/// # Panics
/// It cannot be read.
#[track_caller]
pub fn read(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    fs::read_to_string(path).sure_of(path.display())
}

/// Returns a file that is JSON.
///
/// # Panics
/// It is none.
#[track_caller]
pub fn json(path: impl AsRef<Path>) -> Value {
    let path = path.as_ref();
    serde_json::from_str(&read(path)).sure_of(path.display())
}

/// Writes a file, with the directories that it needs.
///
/// # Panics
/// It cannot be written.
#[track_caller]
pub fn put(path: impl AsRef<Path>, contents: impl AsRef<[u8]>) {
    let path = path.as_ref();
    fs::create_dir_all(path.parent().expect("a directory")).sure_of(path.display());
    fs::write(path, contents).sure_of(path.display());
}

/// Returns the paths in a directory that end so, sorted, with `/`.
///
/// # Panics
/// There are none.
#[track_caller]
pub fn paths(directory: impl AsRef<Path>, ending: &str) -> Vec<String> {
    let directory = directory.as_ref();
    let entries = fs::read_dir(directory).sure_of(directory.display());
    let shown = |path: PathBuf| path.display().to_string().replace('\\', "/");
    let paths = entries.map(|entry| shown(entry.expect("an entry").path()));
    let mut paths: Vec<String> = paths.filter(|path| path.ends_with(ending)).collect();
    assert!(!paths.is_empty(), "no {ending} in {}", directory.display());
    paths.sort();
    paths
}

/// Returns every file below a directory.
///
/// # Panics
/// It cannot be read.
pub fn below(directory: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(directory).sure_of(directory.display());
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths.flat_map(|path| if path.is_dir() { below(&path) } else { vec![path] }).collect()
}

/// Returns a text with another in place of one of its parts, wherever that is.
///
/// # Panics
/// It is nowhere.
#[track_caller]
pub fn replaced(text: &str, right: &str, wrong: &str) -> String {
    assert!(text.contains(right), "`{right}` is not in\n{text}");
    text.replace(right, wrong)
}

//! What the user gives to be read: files, or standard input.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// The path that stands for standard input.
pub const STDIN: &str = "-";

/// Opens a file, or standard input where the path is [`STDIN`].
///
/// # Errors
/// The file cannot be read; what stands there is a directory, a pipe or a device, which might never end.
pub fn open(path: &Path) -> io::Result<Box<dyn Read>> {
    if path == Path::new(STDIN) {
        return Ok(Box::new(io::stdin().lock()));
    }
    let found = fs::metadata(path)?;
    if found.is_dir() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a directory"));
    }
    if !found.is_file() {
        let message = "it is a pipe or a device, not a file; `-` reads standard input";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    Ok(Box::new(File::open(path)?))
}

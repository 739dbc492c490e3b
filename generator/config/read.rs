//! Reads a configuration file from disk or from standard input, and parses it.

use std::io::{self, Read};
use std::path::Path;

use super::nearest::nearest;
use super::parse::parse_located;
use super::problems::{Problems, STANDARD_INPUT};
use super::schema::Schema;
use super::source::ConfigSource;
use super::values::Config;
use glint_base::config_error::ConfigError;
use glint_base::input;
use glint_base::program::Program;

/// The largest size of a file in bytes, because a huge file would exhaust the memory.
const LARGEST: u64 = 1 << 16;

/// Reads a configuration file, or standard input if the path is `-`. `schemas` must contain the schemas of all devices.
///
/// # Errors
/// Fails with all problems at once. Fails if the path is a pipe, a device or a directory, or if the file cannot be read. Fails if
/// the file has more than 65,536 bytes, is not UTF-8, or has a problem that [`parse`](super::parse()) finds.
pub fn read(path: &Path, schemas: &[Schema]) -> Result<Config, Problems> {
    read_located(path, schemas).map(|(config, _)| config)
}

/// Reads a file like [`read`]. Also returns the location of each key in the file, for errors that are found later.
pub fn read_located(path: &Path, schemas: &[Schema]) -> Result<(Config, ConfigSource), Problems> {
    let file_name = if path == Path::new(input::STDIN) {
        STANDARD_INPUT.to_owned()
    } else {
        path.display().to_string()
    };
    let bytes = contents(path).map_err(|(message, remedy)| {
        let mut problems = Problems::of_file(&file_name, "");
        problems.push("", message, remedy);
        problems
    })?;
    match std::str::from_utf8(&bytes) {
        Ok(text) => parse_located(&file_name, text, schemas),
        Err(error) => {
            // Up to the wrong byte, the converted text equals the file, so the location of the wrong byte is correct.
            let lossy = String::from_utf8_lossy(&bytes);
            let start = error.valid_up_to();
            let end = start + char::REPLACEMENT_CHARACTER.len_utf8();
            let mut problems = Problems::of_file(&file_name, &lossy);
            let message = format!("the file is not UTF-8: byte {start} is {:#04x}", bytes[start]);
            let remedy = match bytes.as_slice() {
                [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => {
                    "save the file as UTF-8; the file looks like UTF-16"
                }
                _ => "save the file as UTF-8 text",
            };
            problems.push_error_at(start..end, ConfigError::new("", message, remedy));
            Err(problems)
        }
    }
}

/// Reads all bytes of a file. Fails with a message and a remedy if the file cannot be read or is too large.
fn contents(path: &Path) -> Result<Vec<u8>, (String, String)> {
    let mut bytes = Vec::new();
    let read = input::open(path).and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes));
    match read {
        Err(error) if error.kind() == io::ErrorKind::IsADirectory => {
            Err(("the path is a directory".to_owned(), "give the path of a TOML file".to_owned()))
        }
        Err(error) if error.kind() == io::ErrorKind::InvalidInput => {
            let remedy = "give the path of a TOML file, or - for standard input".to_owned();
            Err(("the path is a pipe or a device, not a file".to_owned(), remedy))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let remedy = match neighbour(path) {
                Some(neighbour) => format!("did you mean `{neighbour}`?"),
                None => format!("write a configuration with `{Program} new DEVICE > FILE.toml`"),
            };
            Err(("there is no such file".to_owned(), remedy))
        }
        Err(error) => {
            let remedy = "check the path and its permissions".to_owned();
            Err((format!("the file cannot be read: {error}"), remedy))
        }
        Ok(size) if size as u64 > LARGEST => {
            let message = format!("the file has more than {LARGEST} bytes");
            Err((message, "give the path of a TOML file".to_owned()))
        }
        Ok(_) => Ok(bytes),
    }
}

/// Returns the path of the TOML file in the same directory with the name most similar to `path`. Returns `None` if no name is
/// similar.
fn neighbour(path: &Path) -> Option<String> {
    let wanted = path.file_name()?.to_str()?;
    let parent = path.parent()?;
    let directory = if parent.as_os_str().is_empty() { Path::new(".") } else { parent };
    let entries = std::fs::read_dir(directory).ok()?;
    let mut names: Vec<String> = entries
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".toml"))
        .collect();
    names.sort();
    let near = nearest(wanted, names.iter().map(String::as_str))?;
    Some(parent.join(near).display().to_string())
}

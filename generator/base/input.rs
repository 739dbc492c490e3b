//! Reads the user's data: text from a file or from standard input, or the JSON records in a directory.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::de::DeserializeOwned;

/// The path of standard input.
pub const STDIN: &str = "-";

/// Returns the name by which written files mention the file `path`. The name has no directories, so it is the same on every
/// machine. For example, `configs/rough.toml` becomes `rough.toml`.
///
/// A name with blanks or other signs of a shell is in single quotes, such as `'my core.toml'`. A name with a character that could
/// end a comment or a string of an emitted file has no quotes. In such a name, every character except letters, digits and `._+-`
/// becomes `%` with its bytes in hexadecimal, as in a URL.
pub fn label(path: &str) -> String {
    let name = path.rsplit('/').next().unwrap_or(path);
    let plain = |sign: char| sign.is_alphanumeric() || "._+-".contains(sign);
    // A shell does not change a name between single quotes.
    let quotable = |sign: char| plain(sign) || " ()[]{},;=@#%&~!?^".contains(sign);
    if !name.chars().all(plain) && name.chars().all(quotable) {
        return format!("'{name}'");
    }
    let escaped =
        |sign: char| sign.to_string().bytes().map(|byte| format!("%{byte:02X}")).collect();
    name.chars().map(|sign| if plain(sign) { sign.to_string() } else { escaped(sign) }).collect()
}

/// Opens a file, or standard input if the path is [`STDIN`]. Fails for a directory, and for a pipe or a device, which might never
/// end.
pub fn open(path: &Path) -> io::Result<Box<dyn Read>> {
    if path == Path::new(STDIN) {
        return Ok(Box::new(io::stdin().lock()));
    }
    let found = fs::metadata(path)?;
    if found.is_dir() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "the path is a directory"));
    }
    if !found.is_file() {
        let message = "the path is a pipe or a device, not a file; give `-` to read standard input";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    Ok(Box::new(File::open(path)?))
}

/// Returns the text of a file, or of standard input if the path is [`STDIN`]. Returns `None` if the file does not exist. Fails
/// for a directory, a pipe, a device, or text that is not UTF-8.
pub fn text(path: &Path) -> Result<Option<String>> {
    let mut text = String::new();
    match open(path).and_then(|mut file| file.read_to_string(&mut text)) {
        Ok(_) => Ok(Some(text)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).with_context(|| format!("cannot read `{}`", path.display())),
    }
}

/// Returns the `*.json` files in `directory` that can be read as a `T`, each with its path, in the order of their names. Ignores
/// other files, and JSON of another structure. The result is empty if `directory` is missing.
///
/// # Errors
/// Fails if the directory or a `*.json` file in it cannot be read, or if such a file is no JSON.
pub fn records<T: DeserializeOwned>(directory: &Path) -> Result<Vec<(PathBuf, T)>> {
    let entries = match fs::read_dir(directory) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => {
            return Err(error).with_context(|| format!("cannot read `{}`", directory.display()));
        }
    };
    let mut paths = entries
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<io::Result<Vec<_>>>()
        .with_context(|| format!("cannot read `{}`", directory.display()))?;
    paths.retain(|path| path.extension().is_some_and(|it| it == "json") && path.is_file());
    paths.sort();
    let mut records = Vec::new();
    for path in paths {
        let bytes = fs::read(&path).with_context(|| format!("cannot read `{}`", path.display()))?;
        match serde_json::from_slice(&bytes) {
            Ok(record) => records.push((path, record)),
            Err(error) if error.is_data() => {}
            Err(error) => return Err(error).with_context(|| damaged(&path)),
        }
    }
    Ok(records)
}

/// Returns the error message for a record that cannot be understood.
pub fn damaged(path: &Path) -> String {
    format!(
        "the record `{}` is damaged: restore the record, move it away, or make it again with the command \
         that wrote it",
        path.display()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_end_no_comment() {
        for (path, wanted) in [
            ("configs/lyon.toml", "lyon.toml"),
            ("/designs/glänzend-2.toml", "glänzend-2.toml"),
            ("a\nendmodule.toml", "a%0Aendmodule.toml"),
            ("a */ b", "' b'"),
            ("c d (2).toml", "'c d (2).toml'"),
            ("it's.toml", "it%27s.toml"),
            ("\"\"\" # \\", "%22%22%22%20%23%20%5C"),
            ("\u{202e}", "%E2%80%AE"),
            (STDIN, "-"),
        ] {
            assert_eq!(label(path), wanted);
        }
    }
}

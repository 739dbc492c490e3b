//! Reads samples, the measured points of a curve, from a text file that a configuration of the device `function` names, such as a
//! CSV file.

use std::path::Path;
use std::{fs, io};

/// Reads the points of a file in the form `x,y x,y`. For example, the lines `x,y`, `0,0` and `1; -0.5 # low` give `0,0 1,-0.5`.
///
/// A line must have two numbers, with or without quotes, that are separated by a comma, a semicolon, blanks or a tab. Lines
/// without a number before the first point are headings, `#` begins a comment, and empty lines are skipped.
///
/// # Errors
///
/// Fails with a message and a remedy if the file is no regular file, cannot be read or is not UTF-8. Fails if a line is not two
/// finite numbers, or the file has no points.
pub(super) fn read(path: &Path) -> Result<String, (String, String)> {
    let name = path.display();
    let text = text(path).map_err(|error| {
        let remedy =
            "give the path of a CSV file, relative to the configuration's directory".to_owned();
        (format!("`{name}` cannot be read: {error}"), remedy)
    })?;
    let mut points: Vec<String> = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        let cells: Vec<&str> = line
            .split(|c: char| ",;".contains(c) || c.is_whitespace())
            .map(|cell| cell.trim_matches('"'))
            .filter(|cell| !cell.is_empty())
            .collect();
        let numbers = cells.iter().filter(|cell| cell.parse().is_ok_and(f64::is_finite)).count();
        match cells[..] {
            [] => {}
            [x, y] if numbers == 2 => points.push(format!("{x},{y}")),
            _ if points.is_empty() && numbers == 0 => {}
            _ if has_decimal_commas(line) => {
                let message = format!("line {} of `{name}` has decimal commas: `{line}`", at + 1);
                return Err((message, "write decimal points: `0.5` in place of `0,5`".to_owned()));
            }
            _ => {
                let message = format!("line {} of `{name}` is not two numbers: `{line}`", at + 1);
                return Err((message, "write x and the result in each line".to_owned()));
            }
        }
    }
    if points.is_empty() {
        let remedy = "write x and the result in each line".to_owned();
        return Err((format!("`{name}` has no samples"), remedy));
    }
    Ok(points.join(" "))
}

/// Returns whether a line has two cells, at least one with a decimal comma, as in `0,5;1,25`. Spreadsheets write such numbers in
/// many languages.
fn has_decimal_commas(line: &str) -> bool {
    let cells = line.split(|c: char| c == ';' || c.is_whitespace()).filter(|cell| !cell.is_empty());
    let is_decimal = |cell: &str| {
        let digits = cell.trim_matches('"').replacen(',', ".", 1);
        cell.contains(',') && digits.parse::<f64>().is_ok()
    };
    let is_decimal: Vec<bool> = cells.map(is_decimal).collect();
    is_decimal.len() == 2 && is_decimal.contains(&true)
}

/// Reads a file in UTF-8, and converts all line ends to newlines. The path must name a regular file, because a pipe may never
/// end.
pub(super) fn text(path: &Path) -> io::Result<String> {
    let refused = |message: String| Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    if !fs::metadata(path)?.is_file() {
        return refused("the path is not a regular file".to_owned());
    }
    let bytes = fs::read(path)?;
    if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        return refused("the file is UTF-16; save the file as UTF-8".to_owned());
    }
    match String::from_utf8(bytes) {
        // Some spreadsheets begin a file with a byte order mark.
        Ok(text) => {
            Ok(text.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n"))
        }
        Err(error) => {
            let valid = error.utf8_error().valid_up_to();
            let line = 1 + error.as_bytes()[..valid].iter().filter(|byte| **byte == b'\n').count();
            let byte = error.as_bytes()[valid];
            refused(format!(
                "line {line} has the byte {byte:02X}, which is not UTF-8; save the file as UTF-8"
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_points() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("curve.csv");
        let of = |text: &str| {
            fs::write(&path, text).unwrap();
            read(&path).map_err(|(message, _)| message.replace(&*path.to_string_lossy(), "it"))
        };
        assert_eq!(of("x,y\n0,0\n\n1; -0.5 # low\n2\t1e-3\r\n").unwrap(), "0,0 1,-0.5 2,1e-3");
        assert_eq!(of("\u{feff}0,0\n1,1\n").unwrap(), "0,0 1,1");
        assert_eq!(of("\"0\",\"0\"\r1 +1\r").unwrap(), "0,0 1,+1");
        for (bytes, message) in [
            (
                &b"# H\xF6he\n0,0\n"[..],
                "line 1 has the byte F6, which is not UTF-8; save the file as UTF-8",
            ),
            (b"\xFF\xFE0\x00,\x000\x00", "the file is UTF-16; save the file as UTF-8"),
        ] {
            fs::write(&path, bytes).unwrap();
            assert!(read(&path).unwrap_err().0.ends_with(message));
        }
        assert!(read(dir.path()).unwrap_err().0.ends_with("the path is not a regular file"));
        for (text, message) in [
            ("0,0\n1,\n", "line 2 of `it` is not two numbers: `1,`"),
            ("0,0\nx,y\n", "line 2 of `it` is not two numbers: `x,y`"),
            ("0,0;0\n0,5;0,25\n", "line 1 of `it` has decimal commas: `0,0;0`"),
            ("0;0\n0,5;0,25\n", "line 2 of `it` has decimal commas: `0,5;0,25`"),
            ("0,0,0\n", "line 1 of `it` is not two numbers: `0,0,0`"),
            ("x,y\n", "`it` has no samples"),
        ] {
            assert_eq!(of(text).unwrap_err(), message);
        }
    }
}

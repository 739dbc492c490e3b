//! Reads measured points from a CSV file.

use std::path::Path;
use std::{fs, io};

/// Reads the points of a file as `x,y x,y`. Two numbers a line, with a comma, a semicolon, blanks or a tab between them; a
/// first line of words is a heading, and what follows `#` a comment.
///
/// # Errors
/// The file cannot be read, or a line is not two numbers: a message and a remedy.
pub(super) fn read(path: &Path) -> Result<String, (String, String)> {
    let name = path.display();
    let text = text(path).map_err(|error| {
        let remedy = "give the path of a CSV file, from the configuration's directory".to_owned();
        (format!("`{name}` cannot be read: {error}"), remedy)
    })?;
    // What some spreadsheets write first.
    let text = text.trim_start_matches('\u{feff}');
    let mut points: Vec<String> = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        let cells: Vec<&str> = line
            .split(|c: char| ",;".contains(c) || c.is_whitespace())
            .filter(|cell| !cell.is_empty())
            .collect();
        let numbers = cells.iter().filter(|cell| cell.parse().is_ok_and(f64::is_finite)).count();
        match cells[..] {
            [] => {}
            [x, y] if numbers == 2 => points.push(format!("{x},{y}")),
            _ if points.is_empty() && numbers == 0 => {}
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

/// Reads a file; a pipe, which may never end, is none.
fn text(path: &Path) -> io::Result<String> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file"));
    }
    fs::read_to_string(path)
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
        assert!(read(dir.path()).unwrap_err().0.ends_with("it is no regular file"));
        for (text, message) in [
            ("0,0\n1,\n", "line 2 of `it` is not two numbers: `1,`"),
            ("0,0\nx,y\n", "line 2 of `it` is not two numbers: `x,y`"),
            ("0,0,0\n", "line 1 of `it` is not two numbers: `0,0,0`"),
            ("x,y\n", "`it` has no samples"),
        ] {
            assert_eq!(of(text).unwrap_err(), message);
        }
    }
}

//! Adds a SHA-256 digest to generated files that no manifest lists, and checks the digest of such a file.
//!
//! The digest shows whether anybody changed the file since Glint wrote it. The digest is in the last line of a text file, or in
//! a member of a JSON object. In Python, the line is `# sha256` and 64 hexadecimal digits.

use anyhow::{Context, Result};
use serde_json::Value;

use super::output_file::digest;

/// The position of the digest in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seal {
    /// Markdown and HTML: a last line `<!-- … -->`, which no reader of the page sees.
    Markup,
    /// Python and Gappa: a last line `# …`.
    Hash,
    /// JSON: a member of the object.
    Json,
}

/// The member of sealed JSON with the digest of the other members.
const MEMBER: &str = "sha256";

/// Returns `text`, which must end with a newline, with one line more that has the digest of the text. A JSON file cannot have
/// such a line and stays as it is: see [`sealed_json`].
pub fn sealed(text: String, seal: Seal) -> String {
    let line = last_line(text.as_bytes(), seal);
    text + &line
}

fn last_line(above: &[u8], seal: Seal) -> String {
    match seal {
        Seal::Markup => format!("<!-- sha256 {} -->\n", digest(above)),
        Seal::Hash => format!("# sha256 {}\n", digest(above)),
        Seal::Json => String::new(),
    }
}

/// Adds the member `sha256`, which has the digest of the other members, to a JSON object.
///
/// # Errors
/// Fails if the value is no object.
pub fn sealed_object(mut value: Value) -> Result<Value> {
    let digest = digest(value.to_string().as_bytes());
    let members = value.as_object_mut().context("no object")?;
    members.insert(MEMBER.to_owned(), Value::String(digest));
    Ok(value)
}

/// Returns the JSON text of [`sealed_object`], indented, with a newline at its end.
///
/// # Errors
/// Fails if the value is no object.
pub fn sealed_json(value: Value) -> Result<String> {
    Ok(serde_json::to_string_pretty(&sealed_object(value)?)? + "\n")
}

/// Returns whether nobody has edited the file since Glint wrote it, by its digest. In JSON, only the members count, and not
/// the spaces and lines between them. An editor who computes the digest again is not noticed. A file without a digest at the
/// position `seal` gives `false`.
pub fn is_sealed(contents: &[u8], seal: Seal) -> bool {
    match seal {
        Seal::Json => is_sealed_json(contents),
        Seal::Markup | Seal::Hash => ends_with_seal(contents, seal),
    }
}

fn ends_with_seal(contents: &[u8], seal: Seal) -> bool {
    let Some(body) = contents.strip_suffix(b"\n") else {
        return false;
    };
    let last = body.iter().rposition(|&byte| byte == b'\n');
    let (above, line) = contents.split_at(last.map_or(0, |at| at + 1));
    line == last_line(above, seal).as_bytes()
}

fn is_sealed_json(contents: &[u8]) -> bool {
    let Ok(Value::Object(mut members)) = serde_json::from_slice(contents) else {
        return false;
    };
    let found = members.remove(MEMBER);
    let others = Value::Object(members).to_string();
    found == Some(Value::String(digest(others.as_bytes())))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn an_edited_file_is_not_glints() {
        for (seal, other) in [(Seal::Markup, Seal::Hash), (Seal::Hash, Seal::Markup)] {
            let file = sealed("# title\n\ntext\n".to_owned(), seal);
            let is_sealed = |text: &str| super::is_sealed(text.as_bytes(), seal);
            assert!(is_sealed(&file));
            assert!(!super::is_sealed(file.as_bytes(), other));
            assert!(!super::is_sealed(file.as_bytes(), Seal::Json));
            assert!(!is_sealed(&file.replace("text", "test")));
            assert!(!is_sealed(&format!("{file}more\n")));
            assert!(!is_sealed(file.trim_end()));
            assert!(!is_sealed(""));
            assert!(!is_sealed("# title\n"));
        }
    }

    #[test]
    fn edited_json_is_not_glints() {
        let file = sealed_json(json!({ "a": 1, "b": [2] })).expect("an object");
        let is_sealed = |text: &str| super::is_sealed(text.as_bytes(), Seal::Json);
        assert!(is_sealed(&file));
        assert!(!is_sealed(&file.replace('2', "3")));
        assert!(!is_sealed("{}"));
        assert!(!is_sealed("[]"));
        assert!(sealed_json(json!([1])).is_err());
    }
}

//! The page of a configuration: what the device is, for people, in Markdown.

mod markdown;

use anyhow::{Context, Result};
use askama::Template;
use serde_json::Value;

use super::account::{self, PageInputs};
use crate::netlist::Design;
use markdown::{prose, table};

#[derive(Template)]
#[template(path = "page.md")]
struct Page<'a> {
    title: String,
    device: &'a str,
    name: &'a str,
    formula: &'a str,
    source: String,
    notes: Vec<String>,
    ports: String,
    numbering: &'static str,
    blocks: String,
    roms: String,
    fields: String,
    words: String,
    clocks: String,
    accuracy: String,
    terms: String,
    limit: String,
    proof: String,
    domain: String,
    remarks: Vec<String>,
    example: String,
    keys: String,
    config: &'a str,
}

/// The page of a design, ending with a newline.
///
/// # Errors
/// A template that fails to print.
pub fn page(design: &Design, inputs: &PageInputs) -> Result<String> {
    let about = &design.about;
    let bound = inputs.contract.bound();
    let text = super::render(&Page {
        title: prose(&about.title),
        device: &about.device,
        name: &design.name,
        formula: &about.formula,
        source: prose(&about.source),
        notes: about.notes.iter().map(|note| prose(note)).collect(),
        ports: table(&account::ports(design)),
        numbering: account::numbering(design),
        blocks: table(&account::blocks::table(design)),
        roms: table(&account::roms(design)),
        fields: table(&account::fields(design)),
        words: table(&account::words(design)),
        clocks: table(&account::clocks(inputs.timing)),
        accuracy: account::accuracy(&bound),
        terms: table(&account::terms(&bound)),
        limit: prose(&account::limit(&bound)),
        proof: prose(&account::proof(inputs)),
        domain: table(&account::domain(inputs.contract)),
        remarks: inputs
            .contract
            .remarks()
            .iter()
            .map(|remark| format!("Remark: {}.", prose(remark)))
            .collect(),
        example: table(&account::example(inputs.contract, inputs.example)),
        keys: table(&account::keys(inputs.schema, inputs.config)),
        config: inputs.path,
    })?;
    Ok(sealed(text))
}

/// A page with a last line that vouches for those above. It ends with a newline, as the text must.
pub fn sealed(text: String) -> String {
    let seal = seal(text.as_bytes());
    text + &seal
}

/// Whether a file is a page as [`sealed`] made it.
pub fn is_page(contents: &[u8]) -> bool {
    let Some(body) = contents.strip_suffix(b"\n") else {
        return false;
    };
    let last = body.iter().rposition(|&byte| byte == b'\n');
    let (above, line) = contents.split_at(last.map_or(0, |at| at + 1));
    line == seal(above).as_bytes()
}

/// JSON, an object, with a member `sha256` that vouches for the others; it ends with a newline.
///
/// # Errors
/// The value is no object.
pub fn sealed_json(mut value: Value) -> Result<String> {
    let digest = super::digest(value.to_string().as_bytes());
    let members = value.as_object_mut().context("no object")?;
    members.insert(DIGEST.to_owned(), Value::String(digest));
    Ok(serde_json::to_string_pretty(&value)? + "\n")
}

/// Whether a file holds the value of [`sealed_json`].
pub fn is_sealed_json(contents: &[u8]) -> bool {
    let Ok(Value::Object(mut members)) = serde_json::from_slice(contents) else {
        return false;
    };
    let digest = members.remove(DIGEST);
    let others = Value::Object(members).to_string();
    digest == Some(Value::String(super::digest(others.as_bytes())))
}

/// The member of sealed JSON that vouches for the others.
const DIGEST: &str = "sha256";

/// The last line of a page, which no reader sees.
fn seal(above: &[u8]) -> String {
    format!("<!-- sha256 {} -->\n", super::digest(above))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edited_page_is_no_page() {
        let page = format!("# title\n\ntext\n{}", seal(b"# title\n\ntext\n"));
        assert!(is_page(page.as_bytes()));
        assert!(!is_page(page.replace("text", "test").as_bytes()));
        assert!(!is_page(format!("{page}more\n").as_bytes()));
        assert!(!is_page(page.trim_end().as_bytes()));
        assert!(!is_page(b""));
        assert!(!is_page(b"# title\n"));
    }
}

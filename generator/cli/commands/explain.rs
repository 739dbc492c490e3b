//! `glint explain`: explains the code of an error in a device's description, or lists all codes.

use anyhow::Result;
use clap::Args;
use serde_json::{Value, json};

use crate::failure::wrong_usage;
use crate::report::CommandReport;
use crate::{OutputOptions, say, tables};
use glint_base::codes;
use glint_core::registry::Registry;

/// Explain the code of a mistake in a description, or list all codes
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint explain           all codes
  glint explain G0201     what the code means, and how to correct the mistake")]
pub struct Arguments {
    /// The code in the brackets of a message: for example, G0201 for `error[G0201]`
    code: Option<String>,
}

/// Prints the explanation, or the list. Fails if the code does not exist.
pub fn run(_: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let wanted =
        |code: &str| arguments.code.as_ref().is_none_or(|it| it.eq_ignore_ascii_case(code));
    let pages: Vec<_> = codes::pages().filter(|page| wanted(page.0)).collect();
    if pages.is_empty() {
        let code = arguments.code.as_deref().unwrap_or_default();
        wrong_usage!("there is no code `{code}`; `explain` without a code lists all codes");
    }
    output.report(&Explanation { pages, single: arguments.code.is_some() })?;
    Ok(true)
}

struct Explanation {
    /// The code of each page, its title and its text.
    pages: Vec<(&'static str, &'static str, &'static str)>,
    single: bool,
}

impl CommandReport for Explanation {
    fn json(&self) -> Result<Value> {
        let mut codes = Vec::new();
        for (code, title, text) in &self.pages {
            codes.push(json!({ "code": code, "title": title, "text": text }));
        }
        Ok(json!({ "codes": codes }))
    }

    fn print(&self) -> Result<()> {
        if self.single {
            let (code, title, text) = self.pages[0];
            say!("{code}: {title}\n");
            tables::print_line(text);
            return Ok(());
        }
        let mut rows = Vec::new();
        for (code, title, _) in &self.pages {
            rows.push(vec![(*code).to_owned(), (*title).to_owned()]);
        }
        tables::print("code | mistake", rows);
        Ok(())
    }
}

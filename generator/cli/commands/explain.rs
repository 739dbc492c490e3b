//! `glint explain`: explains the code of a mistake in a description, or lists all codes.

use anyhow::Result;
use clap::Args;
use serde_json::json;

use crate::failure::wrong_usage;
use crate::{OutputOptions, say, tables};
use glint_base::codes;
use glint_core::registry::Registry;

/// Explain the code of a mistake in a description, or list all codes
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint explain           all codes
  glint explain G0201     what it means, and what to do")]
pub struct Arguments {
    /// The code, as `error[G0201]` has it
    code: Option<String>,
}

/// Runs `glint explain`.
pub fn run(_: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let wanted =
        |code: &str| arguments.code.as_ref().is_none_or(|it| it.eq_ignore_ascii_case(code));
    let pages: Vec<_> = codes::pages().filter(|page| wanted(page.0)).collect();
    if pages.is_empty() {
        let code = arguments.code.as_deref().unwrap_or_default();
        wrong_usage!("there is no code `{code}`; `explain` alone lists all");
    }
    if output.json {
        let page = |(code, title, text): &(&str, &str, &str)| json!({ "code": code, "title": title, "text": text });
        tables::print_json(&json!({ "codes": pages.iter().map(page).collect::<Vec<_>>() }));
    } else if arguments.code.is_some() {
        let (code, title, text) = pages[0];
        say!("{code}: {title}\n");
        tables::print_line(text);
    } else {
        let rows = pages.iter().map(|(code, title, _)| vec![code.to_string(), title.to_string()]);
        tables::print("code | mistake", rows);
    }
    Ok(true)
}

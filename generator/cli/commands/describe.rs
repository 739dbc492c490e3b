//! `describe`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::json;

use super::load;
use crate::cli::store::{self, Written};
use crate::cli::{Output, tables};
use crate::package::Seal;
use crate::registry::Registry;

/// `glint describe`.
pub fn describe(
    registry: &Registry,
    output: Output,
    configs: &[PathBuf],
    out: Option<&Path>,
    force: bool,
) -> Result<bool> {
    let loaded = load(registry, configs)?;
    let mut report = Vec::new();
    for (at, one) in loaded.iter().enumerate() {
        let page = one.core.page(&one.path);
        let page = page.with_context(|| format!("`{}`", one.path))?;
        let name = &one.core.config.name;
        let written = match out {
            Some(out) => {
                let written = store::write_sealed(
                    &out.join(format!("{name}.md")),
                    &page,
                    Seal::Markup,
                    force,
                );
                Some(written.with_context(|| format!("`{}` was not described", one.path))?)
            }
            None => None,
        };
        match written {
            _ if output.json => report.push(match written {
                None => json!({ "config": one.path, "name": name, "page": page }),
                Some(written) => json!({
                    "config": one.path,
                    "name": name,
                    "written": written == Written::Replaced,
                    "file": format!("{name}.md"),
                }),
            }),
            None => {
                let gap = if at > 0 { "\n" } else { "" };
                tables::print_line(&format!("{gap}{}", page.trim_end()));
            }
            Some(Written::Unchanged) => {
                tables::print_line(&format!("{}: {name}.md up to date", one.path));
            }
            Some(Written::Replaced) => {
                tables::print_line(&format!("{}: {name}.md written", one.path));
            }
        }
    }
    if output.json {
        tables::print_json(&json!({ "ok": true, "described": report }));
    }
    Ok(true)
}

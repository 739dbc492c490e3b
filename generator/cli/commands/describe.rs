//! `glint describe`: prints or writes a page of documentation about a configuration, in Markdown.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use serde_json::json;

use super::load;
use crate::store::{self, Written};
use crate::{Configs, OutputOptions, say, tables};
use glint_core::cosim::exhaustive::PROOFS;
use glint_core::package::Seal;
use glint_core::registry::Registry;
use glint_show::pages;

/// Print a page of documentation, in Markdown
///
/// Ports, blocks, microprogram, clocks, accuracy, a worked example and the keys of a configuration, from the
/// description that the Verilog is made of. With --out, each configuration gets the file `DIR/<name>.md`; a page that
/// Glint did not write, or that was edited since, is left alone unless --force is given.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint describe my_core.toml
  glint describe configs/rough.toml --out docs/devices")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
    /// Write the pages into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace pages that Glint did not write or that were edited since
    #[arg(long, requires = "out")]
    force: bool,
}

/// Runs `glint describe`.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let loaded = load(registry, &arguments.configs.paths)?;
    let mut report = Vec::new();
    for (at, one) in loaded.iter().enumerate() {
        let page = pages::of(&one.core, &one.path, Path::new(PROOFS));
        let page = page.with_context(|| format!("`{}`", one.path))?;
        let name = &one.core.config.name;
        let written = match &arguments.out {
            Some(out) => {
                let written = store::write_sealed(
                    &out.join(format!("{name}.md")),
                    &page,
                    Seal::Markup,
                    arguments.force,
                );
                Some(written.with_context(|| format!("`{}` was not described", one.path))?)
            }
            None => None,
        };
        match written {
            Some(written) if output.json => report.push(json!({
                "config": one.path,
                "name": name,
                "written": written == Written::Replaced,
                "file": format!("{name}.md"),
            })),
            Some(written) => say!("{}: {name}.md {written}", one.path),
            None if output.json => {
                report.push(json!({ "config": one.path, "name": name, "page": page }));
            }
            None => {
                let gap = if at > 0 { "\n" } else { "" };
                say!("{gap}{}", page.trim_end());
            }
        }
    }
    if output.json {
        tables::print_json(&json!({ "ok": true, "described": report }));
    }
    Ok(true)
}

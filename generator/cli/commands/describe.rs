//! `glint describe`: prints or writes the documentation page of a configuration, in Markdown.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use serde_json::{Value, json};

use super::{Loaded, load};
use crate::report::CommandReport;
use crate::store::{self, Written};
use crate::{Configs, OutputOptions, say};
use glint_core::cosim::exhaustive::PROOFS;
use glint_core::package::Seal;
use glint_core::registry::Registry;
use glint_show::pages;

/// Print a page of documentation about a configuration, in Markdown
///
/// The page has the ports, blocks, microprogram, clocks, accuracy, a worked example and the keys of the configuration. It is
/// made from the same description as the Verilog. With --out, the page of each configuration is written to `DIR/<name>.md`.
/// A page that Glint did not write, or that was edited since, is replaced only with --force.
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
    /// Also replace pages that Glint did not write or that were edited since
    #[arg(long, requires = "out")]
    force: bool,
}

/// Prints or writes the pages.
///
/// # Errors
///
/// Fails if a configuration has problems, if a page cannot be made, or if a page on disk was edited or cannot be written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let loaded = load(registry, &arguments.configs.paths)?;
    let mut list = output.list();
    for (at, one) in loaded.iter().enumerate() {
        let page = pages::of(&one.core, &one.path, Path::new(PROOFS));
        let page = page.with_context(|| format!("`{}`", one.path))?;
        let name = &one.core.config().name;
        let written = match &arguments.out {
            Some(out) => {
                let written = store::write_sealed(
                    &out.join(format!("{name}.md")),
                    &page,
                    Seal::Markup,
                    arguments.force,
                );
                Some(
                    written
                        .with_context(|| format!("the page of `{}` was not written", one.path))?,
                )
            }
            None => None,
        };
        list.add(&DescribedPage { one, page, written, is_first: at == 0 })?;
    }
    list.finish(|pages| Ok(json!({ "ok": true, "described": pages })))?;
    Ok(true)
}

struct DescribedPage<'a> {
    one: &'a Loaded,
    page: String,
    /// Whether the file on disk has changed; `None` if the page is printed.
    written: Option<Written>,
    is_first: bool,
}

impl CommandReport for DescribedPage<'_> {
    fn json(&self) -> Result<Value> {
        let (config, name) = (&self.one.path, &self.one.core.config().name);
        Ok(match self.written {
            Some(written) => json!({
                "config": config,
                "name": name,
                "written": written == Written::Replaced,
                "file": format!("{name}.md"),
            }),
            None => json!({ "config": config, "name": name, "page": self.page }),
        })
    }

    fn print(&self) -> Result<()> {
        match self.written {
            Some(written) => {
                say!("{}: {}.md {written}", self.one.path, self.one.core.config().name);
            }
            None => {
                let gap = if self.is_first { "" } else { "\n" };
                say!("{gap}{}", self.page.trim_end());
            }
        }
        Ok(())
    }
}

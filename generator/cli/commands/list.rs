//! `glint list`: lists the devices, and the configurations in `configs/`.

use std::path::Path;

use anyhow::Result;
use clap::Args;
use serde_json::json;

use super::{CONFIGS, paths};
use crate::{OutputOptions, say, tables};
use glint_base::program::Program;
use glint_core::registry::Registry;

/// List the devices, and the configurations in configs/
#[derive(Args)]
#[command(after_help = "\
Example:
  glint list --json")]
pub struct Arguments;

/// Runs `glint list`.
pub fn run(registry: &Registry, output: OutputOptions, _: &Arguments) -> Result<bool> {
    let configs: Vec<String> = if Path::new(CONFIGS).is_dir() {
        paths(&[]).unwrap_or_default().iter().map(|path| path.display().to_string()).collect()
    } else {
        Vec::new()
    };
    if output.json {
        let devices: Vec<_> = registry
            .devices()
            .iter()
            .map(|device| json!({ "name": device.name, "summary": device.summary }))
            .collect();
        tables::print_json(&json!({ "devices": devices, "configs": configs }));
        return Ok(true);
    }
    let rows = registry
        .devices()
        .iter()
        .map(|device| vec![device.name.to_owned(), device.summary.to_owned()]);
    tables::print("device | what it computes", rows);
    say!(
        "Most are sequential cores or, with architecture = \"pipelined\", pipelines that take a point every few clocks, at twice the rate from a multiplier or two, or one every clock; \
         `{Program} tune DEVICE --error E --rate R` chooses."
    );
    for config in configs {
        tables::print_line(&config);
    }
    Ok(true)
}

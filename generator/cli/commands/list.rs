//! `glint list`: lists the devices, and the configurations in `configs/`.

use std::path::Path;

use anyhow::Result;
use clap::Args;
use serde_json::{Value, json};

use super::{CONFIGS, paths};
use crate::report::CommandReport;
use crate::{OutputOptions, say, tables};
use glint_base::program::Program;
use glint_core::registry::{Device, Registry};

/// List the devices, and the configurations in configs/
#[derive(Args)]
#[command(after_help = "\
Example:
  glint list --json")]
pub struct Arguments;

/// Runs `glint list`, which lists the devices, and the configurations in `configs/`. Returns true, because the command checks
/// nothing.
pub fn run(registry: &Registry, output: OutputOptions, _: &Arguments) -> Result<bool> {
    let configs: Vec<String> = if Path::new(CONFIGS).is_dir() {
        paths(&[]).unwrap_or_default().iter().map(|path| path.display().to_string()).collect()
    } else {
        Vec::new()
    };
    output.report(&Inventory { devices: registry.devices(), configs })?;
    Ok(true)
}

/// The devices, and the paths of the configurations in `configs/`.
struct Inventory<'a> {
    devices: &'a [Device],
    configs: Vec<String>,
}

impl CommandReport for Inventory<'_> {
    fn json(&self) -> Result<Value> {
        let mut devices = Vec::new();
        for device in self.devices {
            devices.push(json!({ "name": device.name, "summary": device.summary }));
        }
        Ok(json!({ "devices": devices, "configs": self.configs }))
    }

    fn print(&self) -> Result<()> {
        let mut rows = Vec::new();
        for device in self.devices {
            rows.push(vec![device.name.to_owned(), device.summary.to_owned()]);
        }
        tables::print("device | what it computes", rows);
        say!(
            "Most are sequential cores or, with architecture = \"pipelined\", pipelines that take a point every few clocks, at twice the rate from a multiplier or two, or one every clock; \
             `{Program} tune DEVICE --error E --rate R` chooses."
        );
        for config in &self.configs {
            tables::print_line(config);
        }
        Ok(())
    }
}

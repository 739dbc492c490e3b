//! `glint list`: lists the devices, and the configurations in `configs/`.

use std::path::Path;

use anyhow::Result;
use clap::Args;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::{CONFIGS, paths};
use crate::report::CommandReport;
use crate::{OutputOptions, say, tables};
use glint_base::program::Program;
use glint_core::registry::{Device, Registry};
use glint_prove::synth::Target;
use glint_prove::tune::architectures;

/// List the devices, and the configurations in configs/
#[derive(Args)]
#[command(after_help = "\
Example:
  glint list --json")]
pub struct Arguments;

pub fn run(registry: &Registry, output: OutputOptions, _: &Arguments) -> Result<bool> {
    let configs: Vec<String> = if Path::new(CONFIGS).is_dir() {
        paths(&[]).unwrap_or_default().iter().map(|path| path.display().to_string()).collect()
    } else {
        Vec::new()
    };
    output.report(&Inventory { devices: registry.devices(), configs })?;
    Ok(true)
}

struct Inventory<'a> {
    devices: &'a [Device],
    configs: Vec<String>,
}

impl Inventory<'_> {
    /// Prints the devices whose pipeline with the longest interval dominates the sequential core, by the estimate for ECP5.
    fn print_longest_intervals(&self) {
        let rows: Vec<Option<Vec<String>>> =
            self.devices.par_iter().map(longest_interval).collect();
        let rows: Vec<Vec<String>> = rows.into_iter().flatten().collect();
        if rows.is_empty() {
            return;
        }
        say!(
            "\nFor these devices, the pipeline with the longest interval beats the sequential core (default \
             keys, estimated for ECP5):"
        );
        tables::print(
            "device | DSP, sequential: | M points/s, sequential: | interval: | DSP, pipeline: | M points/s, pipeline:",
            rows,
        );
    }
}

/// Returns a row that compares a sequential core with the pipeline with the longest interval, or `None` if the pipeline does not
/// dominate.
fn longest_interval(device: &Device) -> Option<Vec<String>> {
    let opened = device.open(device.defaults()).ok()?;
    let sequential = architectures::sequential(&opened, Target::Ecp5).ok()?;
    let pipeline = architectures::longest_interval(&sequential, Target::Ecp5)?;
    if !pipeline.dominates(&sequential) {
        return None;
    }
    Some(vec![
        device.name.to_owned(),
        sequential.cost.dsps.to_string(),
        format!("{:.1}", sequential.rate()),
        pipeline.interval?.to_string(),
        pipeline.cost.dsps.to_string(),
        format!("{:.1}", pipeline.rate()),
    ])
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
            "Most devices are sequential cores or, with architecture = \"pipelined\", pipelines that take a \
             point every clock or every few clocks; `{Program} tune DEVICE --error E --rate R` chooses the \
             architecture."
        );
        self.print_longest_intervals();
        for config in &self.configs {
            tables::print_line(config);
        }
        Ok(())
    }
}

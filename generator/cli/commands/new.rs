//! `glint new`: prints a commented configuration of a device, or of a function by its name.

use anyhow::{Result, bail};
use clap::Args;
use serde_json::json;

use super::none_of;
use crate::failure::WrongUsage;
use crate::{Output, tables, wrong_usage};
use glint_config::{self as config, Config};
use glint_core::registry::Registry;
use glint_keys::presets;

/// Print a commented configuration of a device, or of a function by its name
#[derive(Args)]
#[command(after_help = "\
Example:
  glint new rough --name my_core > my_core.toml
  glint new rsqrt > rsqrt.toml")]
pub struct Arguments {
    /// A device of `glint list`, or a function: exp2, exp, log2, ln, reciprocal, rsqrt, sqrt, sin, cos, atan, sigmoid, tanh,
    /// gelu, silu, softplus, gamma
    device: String,
    /// The name of the top module [default: the device's, with _ for -]
    #[arg(long)]
    name: Option<String>,
}

/// The line by which editors find the schema, and how it comes there.
const SCHEMA: &str =
    "#:schema glint.schema.json\n# Editors check keys by it: glint schema > glint.schema.json\n\n";

/// Runs `glint new`.
pub fn run(registry: &Registry, output: Output, arguments: &Arguments) -> Result<bool> {
    let Arguments { device, name } = arguments;
    let preset = presets::values(device);
    let of_preset = preset.as_ref().and_then(|_| registry.device(presets::DEVICE));
    let Some(found) = registry.device(device).or(of_preset) else {
        let names = registry.devices().iter().map(|device| device.name);
        let names: Vec<&str> = names.chain(presets::names()).collect();
        wrong_usage!("there is no device `{device}`{}", none_of(device, "devices", &names));
    };
    let schema = (found.schema)();
    let own = || if preset.is_some() { device.replace('-', "_") } else { schema.module() };
    let name = name.clone().unwrap_or_else(own);
    let text = match preset.map(|values| Config::from_values(&schema, &name, values)) {
        Some(Ok(config)) => config::commented_values(&schema, &config),
        _ => config::commented(&schema, &name),
    };
    // A name that the reader would refuse is refused here.
    if let Err(problems) = config::parse("<new>", &text, &[schema]) {
        let found: Vec<String> = problems
            .iter()
            .map(|problem| format!("{}; {}", problem.message, problem.remedy))
            .collect();
        bail!(WrongUsage(found.join("\n")));
    }
    let text = format!("{SCHEMA}{text}");
    if output.json {
        tables::print_json(&json!({ "ok": true, "device": device, "name": name, "text": text }));
    } else {
        tables::print_line(text.trim_end());
    }
    Ok(true)
}

//! `new`.

use anyhow::{Result, bail};
use clap::Args;
use serde_json::json;

use crate::cli::failure::WrongUsage;
use crate::cli::{Output, tables, wrong_usage};
use crate::config;
use crate::registry::Registry;

/// Print a commented configuration of a device
#[derive(Args)]
#[command(after_help = "\
Example:
  glint new rough --name my_core > my_core.toml")]
pub struct Arguments {
    /// A device of `glint list`
    device: String,
    /// The name of the top module [default: the device's, with _ for -]
    #[arg(long)]
    name: Option<String>,
}

/// `glint new`.
pub fn run(registry: &Registry, output: Output, arguments: &Arguments) -> Result<bool> {
    let Arguments { device, name } = arguments;
    let Some(found) = registry.device(device) else {
        let names: Vec<&str> = registry.devices().iter().map(|device| device.name).collect();
        let near = config::nearest(device, names.iter().copied())
            .map_or_else(|| ".".to_owned(), |near| format!("; did you mean `{near}`?"));
        wrong_usage!("there is no device `{device}`{near} The devices are: {}", names.join(", "));
    };
    let schema = (found.schema)();
    let name = name.clone().unwrap_or_else(|| device.replace('-', "_"));
    let text = config::commented(&schema, &name);
    // A name that the reader would refuse is refused here.
    if let Err(problems) = config::parse("<new>", &text, &[schema]) {
        let found: Vec<String> = problems
            .iter()
            .map(|problem| format!("{}; {}", problem.message, problem.remedy))
            .collect();
        bail!(WrongUsage(found.join("\n")));
    }
    if output.json {
        tables::print_json(&json!({ "ok": true, "device": device, "name": name, "text": text }));
    } else {
        tables::print_line(text.trim_end());
    }
    Ok(true)
}

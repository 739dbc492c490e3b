//! `list` and `new`.

use std::path::Path;

use anyhow::{Result, bail};
use serde_json::json;

use super::{CONFIGS, paths};
use crate::cli::failure::Usage;
use crate::cli::tables::Column;
use crate::cli::{Output, tables};
use crate::config;
use crate::registry::Registry;

/// `glint list`.
pub fn list(registry: &Registry, output: Output) -> Result<bool> {
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
    tables::print(&[Column::words("device"), Column::words("what it computes")], rows);
    for config in configs {
        tables::print_line(&config);
    }
    Ok(true)
}

/// `glint new`.
pub fn new(registry: &Registry, output: Output, device: &str, name: Option<&str>) -> Result<bool> {
    let Some(found) = registry.device(device) else {
        let names: Vec<&str> = registry.devices().iter().map(|device| device.name).collect();
        let near = config::nearest(device, names.iter().copied())
            .map_or_else(|| ".".to_owned(), |near| format!("; did you mean `{near}`?"));
        bail!(Usage(format!(
            "there is no device `{device}`{near} The devices are: {}",
            names.join(", ")
        )));
    };
    let schema = (found.schema)();
    let name = name.map_or_else(|| device.replace('-', "_"), str::to_owned);
    let text = config::commented(&schema, &name);
    // A name that the reader would refuse is refused here.
    if let Err(problems) = config::parse("<new>", &text, &[schema]) {
        let faults: Vec<String> = problems
            .iter()
            .map(|problem| format!("{}; {}", problem.message, problem.remedy))
            .collect();
        bail!(Usage(faults.join("\n")));
    }
    if output.json {
        tables::print_json(&json!({ "ok": true, "device": device, "name": name, "text": text }));
    } else {
        tables::print_line(text.trim_end());
    }
    Ok(true)
}

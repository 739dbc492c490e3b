//! `glint schema`: prints a JSON Schema of the configuration keys, for editors and validators.

use anyhow::Result;
use clap::Args;

use crate::{OutputOptions, tables};
use glint_config as config;
use glint_core::registry::Registry;

/// Print a JSON Schema of the configuration keys, for editors and validators
///
/// The schema has the names, types, ranges, defaults and descriptions of the keys. Glint checks conditions between keys when
/// it reads a configuration.
#[derive(Args)]
#[command(after_help = "\
Example:
  glint schema > glint.schema.json
  and in the first line of my_core.toml: #:schema ./glint.schema.json")]
pub struct Arguments;

pub fn run(registry: &Registry, _: OutputOptions, _: &Arguments) -> Result<bool> {
    tables::print_json(&config::json_schema(&registry.schemas()));
    Ok(true)
}

//! `glint new`: prints a configuration file for a device, or for a function or an expression that the user gives by name.

use anyhow::Result;
use clap::Args;
use clap::builder::PossibleValuesParser;
use serde_json::{Value, json};

use super::none_of;
use super::settings::KeyAssignment;
use crate::failure::Failure;
use crate::report::CommandReport;
use crate::{OutputOptions, number, tables, wrong_usage};
use glint_base::program::Program;
use glint_base::target::TIMING_NAMES;
use glint_config::{self as config, Problem, Schema, Value as ConfigValue};
use glint_core::registry::{CLOCK_MHZ, DesignError, OpenedConfig, Registry};
use glint_keys::presets;
use glint_prove::synth::Target;
use glint_prove::tune::architectures;

/// Print a configuration of a device, a function or an expression
///
/// The file has a line for each key of the device. Keys that you do not set are comments: they show their defaults, which
/// adjust to the keys that you set. `glint generate` accepts the file unchanged.
#[derive(Args)]
#[command(after_help = format!("\
Expressions:
{}
Examples:
  glint new rsqrt > rsqrt.toml
  glint new rsqrt --pipelined --stream --clock 100 > rsqrt.toml
  glint new cosine-power --name highlight --set cosine.fraction=16 > highlight.toml
  glint new rough --name my_core --all > my_core.toml     every key, with its meaning and its range",
    presets::purposes_of_expressions()))]
pub struct Arguments {
    /// A device of `glint list`; or a function: exp2, exp, log2, ln, reciprocal, rsqrt, sqrt, sin, cos, atan, sigmoid, tanh,
    /// gelu, silu, softplus, gamma; or an expression of the list below
    device: String,
    /// The name of the top module [default: the device's, with _ for -]
    #[arg(long)]
    name: Option<String>,
    /// Show every key with its meaning and the values that it accepts
    #[arg(long)]
    all: bool,
    /// Set a key to a value, for example `cosine.fraction=16`; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Make a pipeline, which computes a point every clock: `architecture = "pipelined"`
    #[arg(long)]
    pipelined: bool,
    /// Add an AXI4-Stream wrapper around the core: `interface.stream = true`
    #[arg(long)]
    stream: bool,
    /// The clock in MHz: for a pipeline, the clock that its stages must reach; for a sequential core, the clock in its
    /// constraints file
    #[arg(long, value_name = "MHZ", value_parser = number)]
    clock: Option<f64>,
    /// The FPGA family whose delays a pipeline is scheduled for: `pipeline.target`
    #[arg(long, requires = "pipelined", value_parser = PossibleValuesParser::new(TIMING_NAMES))]
    target: Option<String>,
}

/// The head of a file with all keys. Editors find the JSON Schema of the keys by this comment.
const SCHEMA: &str = "#:schema glint.schema.json\n# Editors check keys with this schema. To write the \
                      schema: glint schema > glint.schema.json\n\n";

/// Prints the configuration. Fails if no device or function has the name, or if an option has a value that a configuration cannot
/// have.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let device = &arguments.device;
    // A device of the user's own may have a preset's name, such as `fresnel`.
    let is_hidden =
        |preset: &presets::Preset| preset.device != device && registry.device(device).is_some();
    let preset = presets::find(device).filter(|preset| !is_hidden(preset));
    let device_of_preset = preset.as_ref().and_then(|preset| registry.device(preset.device));
    let Some(found) = registry.device(device).or(device_of_preset) else {
        let names = registry.devices().iter().map(|device| device.name);
        let names: Vec<&str> = names.chain(presets::names()).collect();
        wrong_usage!("there is no device `{device}`{}", none_of(device, "devices", &names));
    };
    let schema = (found.schema)();
    let default_name = || if preset.is_some() { device.replace('-', "_") } else { schema.module() };
    let name = arguments.name.clone().unwrap_or_else(default_name);
    let mut settings = arguments.settings()?;
    for (key, value) in preset.iter().flat_map(|preset| &preset.values) {
        if settings.iter().all(|setting| setting.key != *key) {
            settings.push(KeyAssignment { key: key.clone(), value: value.toml() });
        }
    }
    let mut opened = opened(registry, &schema, &name, &settings)?;
    if arguments.clock.is_some() && needs_registered_multipliers(&opened, &settings)? {
        settings.push(KeyAssignment::word(MULTIPLIERS, REGISTERED));
        opened.config.set(MULTIPLIERS, ConfigValue::Text(REGISTERED.to_owned()));
    }
    let config = &opened.config;
    let given: Vec<String> = settings.into_iter().map(|setting| setting.key).collect();
    let text = if arguments.all {
        format!("{SCHEMA}{}", config::commented(&schema, config, &given))
    } else {
        let head = format!(
            "# A Glint configuration. Keys in comments have their defaults, which adjust to the keys that are set.\n\
             # `{Program} new {device} --all` explains every key; `{Program} generate FILE` writes the core.\n"
        );
        let purpose = preset.and_then(|preset| preset.purpose);
        let purpose = purpose.map_or(String::new(), |purpose| format!("# For {purpose}.\n"));
        let hint = hint(&opened, &given).unwrap_or_default();
        head + &purpose + &hint + &config::brief(&schema, config, &given)
    };
    output.report(&NewConfiguration { device, name, text })?;
    Ok(true)
}

/// The key that asks for registers inside the multipliers of a pipeline.
const MULTIPLIERS: &str = "pipeline.multipliers";
const REGISTERED: &str = "registered";

/// Returns whether a pipeline reaches its clock only with registers inside its multipliers, and the user has not chosen the
/// multipliers.
///
/// # Errors
///
/// Fails if even registers do not let the pipeline reach its clock, or if no netlist can be made.
fn needs_registered_multipliers(opened: &OpenedConfig, settings: &[KeyAssignment]) -> Result<bool> {
    let Err(DesignError::Key(error)) = opened.design() else { return Ok(false) };
    let is_chosen = settings.iter().any(|setting| setting.key == MULTIPLIERS);
    if error.key == CLOCK_MHZ && !is_chosen {
        let mut registered = opened.config.clone();
        registered.set(MULTIPLIERS, ConfigValue::Text(REGISTERED.to_owned()));
        if opened.with_config(registered)?.design().is_ok() {
            return Ok(true);
        }
    }
    Err(Failure::WrongUsage(format!("{}; {}", error.message, error.remedy)).into())
}

/// Returns a comment about the pipeline with the longest interval, if it dominates the sequential core: by the estimate, it has
/// no more DSP blocks and no lower rate, and an advantage in one of them. Returns `None` if it does not, or if the user has
/// chosen an architecture.
fn hint(opened: &OpenedConfig, given: &[String]) -> Option<String> {
    if given.iter().any(|key| key == "architecture") {
        return None;
    }
    let sequential = architectures::sequential(opened, Target::Ecp5).ok()?;
    let pipeline = architectures::longest_interval(&sequential, Target::Ecp5)?;
    if !pipeline.dominates(&sequential) {
        return None;
    }
    Some(format!(
        "# This sequential core has {} (estimated for ECP5).\n# With {}, the core has {}.\n",
        sequential.figures(),
        pipeline.keys()?,
        pipeline.figures()
    ))
}

struct NewConfiguration<'a> {
    /// The name of the device or of the function that the user gave.
    device: &'a str,
    name: String,
    text: String,
}

impl CommandReport for NewConfiguration<'_> {
    fn json(&self) -> Result<Value> {
        let Self { device, name, text } = self;
        Ok(json!({ "ok": true, "device": device, "name": name, "text": text }))
    }

    fn print(&self) -> Result<()> {
        tables::print_line(self.text.trim_end());
        Ok(())
    }
}

impl Arguments {
    /// Returns the keys that the options set. For example, `--pipelined --clock 100` sets `architecture` and
    /// `pipeline.clock_mhz`. `--clock 100` alone sets `package.constraints` and `package.clock_mhz`.
    fn settings(&self) -> Result<Vec<KeyAssignment>> {
        let mut settings = Vec::new();
        if self.pipelined {
            settings.push(KeyAssignment::word("architecture", "pipelined"));
        }
        if let Some(target) = &self.target {
            settings.push(KeyAssignment::word("pipeline.target", target));
        }
        if self.stream {
            settings.push(KeyAssignment::parse("interface.stream=true")?);
        }
        for given in &self.set {
            settings.push(KeyAssignment::parse(given)?);
        }
        if let Some(clock) = self.clock {
            let is_pipelined = settings.iter().any(|setting| {
                setting.key == "architecture" && setting.value.contains("pipelined")
            });
            if is_pipelined {
                settings.push(KeyAssignment::parse(&format!("pipeline.clock_mhz={clock}"))?);
            } else {
                settings.push(KeyAssignment::parse("package.constraints=true")?);
                settings.push(KeyAssignment::parse(&format!("package.clock_mhz={clock}"))?);
            }
        }
        Ok(settings)
    }
}

/// Opens the configuration. Fails if the reader would refuse a file with this name and these settings.
fn opened(
    registry: &Registry,
    schema: &Schema,
    name: &str,
    settings: &[KeyAssignment],
) -> Result<OpenedConfig> {
    let head = [KeyAssignment::word("device", schema.device), KeyAssignment::word("name", name)];
    let text: String = head.iter().chain(settings).map(KeyAssignment::line).collect();
    let opened = registry.parse("<new>", &text).map(|(opened, _)| opened);
    opened.map_err(|problems| {
        let mut lines: Vec<String> = Vec::new();
        for Problem { error, .. } in problems.iter() {
            lines.push(format!("{}; {}", error.message, error.remedy));
        }
        Failure::WrongUsage(lines.join("\n")).into()
    })
}

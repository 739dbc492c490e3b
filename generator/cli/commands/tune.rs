//! `glint tune`: searches for the configuration of a device with the smallest estimated area or other cost, and an error bound of
//! at most a given limit. The search changes one or two keys at a time, so a better configuration may exist.

mod plot;

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use clap::Args;
use indicatif::ProgressBar;
use serde_json::{Value as Json, json};

use super::settings::KeyAssignment;
use crate::choice;
use crate::destination::Destination;
use crate::failure::{self, Failure};
use crate::report::CommandReport;
use crate::tables;
use crate::{Force, OutputOptions, number, progress, say, wrong_usage};
use glint_base::program::Program;
use glint_base::text;
use glint_config::{self as config, Config};
use glint_core::registry::{Device, Registry};
use glint_prove::synth::Target;
use glint_prove::tune::{self, Answer, Candidate, ErrorUnit, Objective, TuningGoal};

/// Find the smallest configuration of a device for an error
///
/// The command compares the error bound of the accuracy contract with --error, so the result keeps the error for all
/// operands of the domain. It searches the keys that change neither ports nor formula. It searches keys that add
/// microinstructions, such as one multiplier for several products, only with --rate, with --objective dsps, or if nothing
/// else fits the chip. If two configurations have equal cost, it takes the one with the smaller error. Formats, domain and
/// formula keep their defaults or the values of --set. Area and clock are estimates that were fitted to synthesis results;
/// `glint synth` measures the result.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint tune cosine-power --error 0.75                     3/4 of the outputs' last bit, on ECP5
  glint tune blinn --error 0.0005 --unit f --target ice40
  glint tune rough --error 0.9 --set cosine.fraction=16 --set exponent.bits=7 --out small_rough.toml
  glint tune cosine-power --error 0.75 --rate 30           a sequential core, or a pipeline that reaches the rate
  glint tune lyon --error 1.5 --rate 20 --max-multipliers 6
  glint tune gauss --error 0.001 --unit f --csv            the trade-off of error and area")]
pub struct Arguments {
    /// A device of `glint list`
    device: String,
    /// The largest error
    #[arg(long, value_name = "E", value_parser = number)]
    error: f64,
    /// The unit of the error: the reflectance f, from 0 to 1, or the outputs' least significant bit
    #[arg(long, value_parser = choice::error_unit(), default_value = "output")]
    unit: ErrorUnit,
    /// The technology that area and clock are estimated for
    #[arg(long, value_name = "TARGET", value_parser = choice::target(), default_value = "ecp5")]
    target: Target,
    /// The cost to minimise
    #[arg(long, value_parser = choice::objective(), default_value = "area")]
    objective: Objective,
    /// The clock in MHz that the core must reach, by the estimate
    #[arg(long, value_name = "MHZ", value_parser = number)]
    clock: Option<f64>,
    /// The million points per second that the core must compute, from the estimated clock and the clocks per point. Without
    /// `--set architecture=…` the command also tries pipelines, and takes the longest interval that reaches the rate
    #[arg(long, value_name = "MPOINTS", value_parser = number)]
    rate: Option<f64>,
    /// The largest number of DSP blocks that the core may have. Without `--set architecture=…` the command also tries
    /// pipelines, and takes the longest interval that reaches the goals
    #[arg(long, value_name = "N")]
    max_multipliers: Option<u64>,
    /// Fix a key to a value, for example a format or the domain; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// The name of the module [default: the device's, with _ for -]
    #[arg(long)]
    name: Option<String>,
    /// Write the configuration to a new file
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    /// Plot area over error into a new file
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Print the trade-off of error and area as CSV
    #[arg(long)]
    csv: bool,
}

/// Searches for a configuration and reports it.
///
/// # Errors
///
/// Fails if an option is not valid, if no configuration reaches the goal, or if a file cannot be written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    if arguments.csv && !output.is_for_people() {
        wrong_usage!("--json and --csv cannot be used together: give one of them");
    }
    if !(arguments.error > 0.0 && arguments.error.is_finite()) {
        wrong_usage!("--error {}: give a number above 0", arguments.error);
    }
    for (option, wanted) in [("--clock", arguments.clock), ("--rate", arguments.rate)] {
        let Some(wanted) = wanted else { continue };
        let is_usable = wanted > 0.0 && wanted.is_finite();
        if !is_usable {
            wrong_usage!("{option} {wanted}: give a number above 0");
        }
    }
    if arguments.target.family().is_none() {
        wrong_usage!(
            "--target {}: Glint cannot estimate the cost of a configuration for this target; tune for an \
             FPGA, and measure with `{Program} synth`",
            arguments.target
        );
    }
    if let (Some(out), Some(plot)) = (&arguments.out, &arguments.plot)
        && std::path::absolute(out).ok() == std::path::absolute(plot).ok()
    {
        wrong_usage!("--out and --plot both name `{}`: give different files", out.display());
    }
    let (device, base, fixed) = base(registry, arguments)?;
    let file = fresh_file(arguments.out.as_deref(), arguments.force)?;
    let drawing = fresh_file(arguments.plot.as_deref(), arguments.force)?;
    let goal = TuningGoal {
        error: arguments.error,
        unit: arguments.unit,
        target: arguments.target,
        objective: arguments.objective,
        clock: arguments.clock,
        rate: arguments.rate,
        most_dsps: arguments.max_multipliers,
    };
    let bar: ProgressBar = progress::bar(output, 0, "configurations");
    let fixed_keys: Vec<&str> = fixed.iter().map(String::as_str).collect();
    let found = tune::tune(&device, &base, &fixed_keys, &goal, &|looked_at| {
        bar.set_length(looked_at as u64);
        bar.set_position(looked_at as u64);
    });
    bar.finish_and_clear();
    let answer = found?;
    let text = toml(&device, &answer.best, arguments);
    if let Some(drawing) = drawing {
        drawing.write(plot::plot(&answer, arguments)?)?;
    }
    if let Some(file) = file {
        file.write(&text)?;
    }
    output.report(&TunedConfiguration { device: &device, answer: &answer, arguments, text })?;
    let excess = answer.best.cost.excess(arguments.target);
    if !excess.is_empty() {
        failure::warn(&format!("{}: by the estimate, {excess}", arguments.device));
    }
    Ok(true)
}

struct TunedConfiguration<'a> {
    device: &'a Device,
    answer: &'a Answer,
    arguments: &'a Arguments,
    /// The best configuration, as the text of a TOML file.
    text: String,
}

impl CommandReport for TunedConfiguration<'_> {
    fn json(&self) -> Result<Json> {
        Ok(as_json(self.answer, self.arguments, &self.text))
    }

    fn print(&self) -> Result<()> {
        if self.arguments.csv {
            return print_csv(self.answer);
        }
        print(self.device, self.answer, self.arguments, &self.text);
        Ok(())
    }
}

/// Opens an option's file, or returns `None` without the option. Fails if the file exists and `--force` is not given.
fn fresh_file(path: Option<&Path>, force: Force) -> Result<Option<Destination>> {
    match path {
        Some(path) => Ok(Some(Destination::fresh(path, force.force)?)),
        None => Ok(None),
    }
}

/// Returns the device, the configuration from which the search starts, and the keys of `--set`, which the search must not
/// change.
fn base(registry: &Registry, arguments: &Arguments) -> Result<(Device, Config, Vec<String>)> {
    let Some(device) = registry.device(&arguments.device) else {
        let names: Vec<&str> = registry.devices().iter().map(|device| device.name).collect();
        let hint = match config::nearest(&arguments.device, names.iter().copied()) {
            Some(near) => format!("did you mean `{near}`? "),
            None => String::new(),
        };
        bail!("there is no device `{}`; {hint}devices: {}", arguments.device, names.join(", "));
    };
    let name = arguments.name.clone().unwrap_or_else(|| (device.schema)().module());
    // This uses the reader of configuration files, so the messages are the same.
    let mut given_text = format!("device = \"{}\"\nname = \"{name}\"\n", device.name);
    let mut fixed = Vec::new();
    for given in &arguments.set {
        let setting = KeyAssignment::parse(given)?;
        given_text += &setting.line();
        fixed.push(setting.key);
    }
    let (opened, _) = registry.parse("--set", &given_text).map_err(Failure::Problems)?;
    Ok((*device, opened.config, fixed))
}

fn origin(device: &Device) -> &'static str {
    if device.proved { "proved" } else { "stated by its author" }
}

/// Returns the configuration as TOML. Comments at the beginning state the search's result.
fn toml(device: &Device, best: &Candidate, arguments: &Arguments) -> String {
    let cost = &best.cost;
    let clocks = match best.clocks {
        Some(clocks) => format!(", {clocks} clocks a point"),
        None => String::new(),
    };
    let head = format!(
        "# The smallest `{}` with an error of at most {} {} that `{Program} tune` found for {}.\n# Error \
         bound ({}): {} of f, {} output units. Estimate: {:.0} LUTs, {} DSP blocks, {} block RAMs,\n# {} \
         bits of ROM, {:.0} MHz{clocks}; `{Program} synth` measures.\n{}",
        device.name,
        arguments.error,
        arguments.unit,
        arguments.target.title(),
        origin(device),
        text::rounded_up(best.bounds.f, 6),
        best.bounds.words(),
        cost.luts,
        cost.dsps,
        cost.block_rams,
        cost.rom_bits,
        cost.mhz,
        match cost.excess(arguments.target).as_str() {
            "" => String::new(),
            excess => format!("# By the estimate, {excess}.\n"),
        }
    );
    head + &best.config.to_toml(&(device.schema)())
}

/// Returns the keys that the search varied, for example `cosine.fraction = 16, exponent.bits = 8`.
fn widths(answer: &Answer, candidate: &Candidate) -> String {
    let mut shown = Vec::new();
    for key in &answer.free {
        shown.push(format!("{key} = {}", candidate.config.value(key).toml()));
    }
    shown.join(", ")
}

fn print(device: &Device, answer: &Answer, arguments: &Arguments, text: &str) {
    let mut rows = Vec::new();
    for candidate in &answer.front {
        let cost = &candidate.cost;
        let rate = match candidate.rate() {
            Some(rate) => format!("{rate:.1}"),
            None => "-".to_owned(),
        };
        rows.push(vec![
            text::rounded_up(candidate.bounds.f, 6),
            candidate.bounds.words(),
            format!("{:.0}", cost.luts),
            cost.dsps.to_string(),
            cost.block_rams.to_string(),
            cost.rom_bits.to_string(),
            format!("{:.0}", cost.mhz),
            rate,
            widths(answer, candidate),
        ]);
    }
    tables::print(
        "error of f: | output units: | LUT: | DSP: | RAM:1 | ROM bits:3 | MHz:2 | M points/s:4 | keys",
        rows,
    );
    say!(
        "Bounds are {}; LUTs and MHz are estimates for {}. The search tried {} configurations.",
        origin(device),
        arguments.target.title(),
        answer.looked_at
    );
    match &arguments.out {
        Some(path) => say!("{} written", path.display()),
        None => say!("\n{}", text.trim_end()),
    }
}

fn candidate_json(answer: &Answer, target: Target, candidate: &Candidate) -> Json {
    let mut keys = serde_json::Map::new();
    for key in &answer.free {
        keys.insert((*key).to_owned(), json!(candidate.config.value(key)));
    }
    json!({
        "error_of_f": candidate.bounds.f,
        "output_units": candidate.bounds.governing_units(),
        "cost": candidate.cost,
        "fits": candidate.cost.excess(target).is_empty(),
        "clocks_per_point": candidate.clocks,
        "million_points_per_second": candidate.rate(),
        "keys": keys,
    })
}

fn as_json(answer: &Answer, arguments: &Arguments, text: &str) -> Json {
    let mut front = Vec::new();
    for candidate in &answer.front {
        front.push(candidate_json(answer, arguments.target, candidate));
    }
    json!({
        "ok": true,
        "device": arguments.device,
        "target": arguments.target,
        "error": arguments.error,
        "unit": arguments.unit,
        "best": candidate_json(answer, arguments.target, &answer.best),
        "front": front,
        "looked_at": answer.looked_at,
        "configuration": text,
    })
}

fn print_csv(answer: &Answer) -> Result<()> {
    let figures =
        ["error_of_f", "output_units", "luts", "dsps", "block_rams", "rom_bits", "mhz", "mpoints"];
    let mut heading: Vec<String> = figures.map(str::to_owned).to_vec();
    for key in &answer.free {
        heading.push((*key).to_owned());
    }
    let mut rows = vec![heading];
    for candidate in &answer.front {
        let cost = &candidate.cost;
        let rate = match candidate.rate() {
            Some(rate) => format!("{rate:.2}"),
            None => String::new(),
        };
        let mut row = vec![
            candidate.bounds.f.to_string(),
            candidate.bounds.governing_units().to_string(),
            format!("{:.0}", cost.luts),
            cost.dsps.to_string(),
            cost.block_rams.to_string(),
            cost.rom_bits.to_string(),
            format!("{:.1}", cost.mhz),
            rate,
        ];
        for key in &answer.free {
            row.push(candidate.config.value(key).bare());
        }
        rows.push(row);
    }
    tables::print_csv(rows)
}

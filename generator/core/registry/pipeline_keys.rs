//! Makes a pipeline with the options that configuration keys state. If the pipeline builder fails, the module names the key
//! that the user should change.

use glint_base::config_error::ConfigError;
use glint_base::diagnostic::Diagnostic;
use glint_base::target;
use glint_config::{Config, Shared};
use glint_rtl::netlist::Design;
use glint_rtl::pipeline::{self, PassResult, PipelineError, PipelineErrorKind};

/// The key with the clock frequency in MHz for which a pipeline is scheduled.
pub const CLOCK_MHZ: &str = "pipeline.clock_mhz";

/// Returns the pipeline, or `None` if the configuration has a sequential architecture.
///
/// # Errors
/// Fails if the pipeline cannot be made. The error names the key that the user should change.
pub fn pipelined(sequential: &Design, config: &Config) -> Result<Option<Design>, ConfigError> {
    let keys = Shared::of(config);
    if keys.architecture != "pipelined" {
        return Ok(None);
    }
    match pipeline::pipeline(sequential, &options(&keys)) {
        Ok(design) => Ok(Some(Design { warnings: sequential.warnings.clone(), ..design })),
        Err(error) => Err(key_error(&error, &keys, &config.name)),
    }
}

/// Returns the computation before the passes and after each pass, or `None` for a sequential architecture. Fails if the
/// microprogram cannot be unrolled.
pub fn pass_results(
    sequential: &Design,
    config: &Config,
) -> Result<Option<Vec<PassResult>>, ConfigError> {
    let keys = Shared::of(config);
    if keys.architecture != "pipelined" {
        return Ok(None);
    }
    let results = pipeline::pass_results(sequential, &options(&keys));
    results.map(Some).map_err(|error| key_error(&error, &keys, &config.name))
}

fn options(keys: &Shared) -> pipeline::Options {
    pipeline::Options {
        target: target::Timing::named(&keys.target).unwrap_or(&target::TIMINGS[0]),
        goal: match keys.stages {
            0 => pipeline::Goal::ClockMhz(keys.pipeline_clock_mhz),
            stages => pipeline::Goal::Stages(stages as usize),
        },
        interval: match keys.interval.parse() {
            Ok(clocks) => pipeline::IntervalGoal::Clocks(clocks),
            Err(_) if keys.rate != 0.0 => pipeline::IntervalGoal::Rate(keys.rate),
            Err(_) => pipeline::IntervalGoal::Multipliers(keys.max_multipliers as usize),
        },
        registered: keys.multipliers == "registered",
        stall: keys.stall == "ready",
        side: keys.side,
        delays: match keys.delays.as_str() {
            "registers" => pipeline::Delays::Registers,
            "auto" => pipeline::Delays::Auto,
            _ => pipeline::Delays::Memory,
        },
    }
}

/// Names the key that the user should change. For example, a clock that is too fast is an error of `pipeline.clock_mhz`, with
/// the fastest possible clock as the nearest value. `name` is the name of the module.
fn key_error(error: &PipelineError, keys: &Shared, name: &str) -> ConfigError {
    let diagnostic = &error.diagnostic;
    let of_key = |key: &str, remedy: String| {
        let message = with_location(&diagnostic.message, diagnostic);
        ConfigError::new(key, message, remedy)
    };
    match error.kind {
        PipelineErrorKind::Microprogram => {
            of_key("architecture", "set architecture = \"sequential\"".to_owned())
        }
        PipelineErrorKind::Clock { nearest, registered } => {
            let mut remedy = format!("set {CLOCK_MHZ} to {nearest} or less");
            if let Some(higher) = registered {
                remedy +=
                    &format!(", or to {higher} or less with pipeline.multipliers = \"registered\"");
            }
            of_key(CLOCK_MHZ, remedy).with_nearest(nearest)
        }
        PipelineErrorKind::TooManyStages { most } => {
            let remedy = format!("set pipeline.stages to {most} or less");
            of_key("pipeline.stages", remedy).with_nearest(most as f64)
        }
        PipelineErrorKind::TooFewStages { least } => {
            let remedy = format!("set pipeline.stages to {least} or more");
            of_key("pipeline.stages", remedy).with_nearest(least as f64)
        }
        PipelineErrorKind::Interval { most } => {
            let remedy = format!(
                "set pipeline.interval to {most} or less, or architecture = \"sequential\""
            );
            of_key("pipeline.interval", remedy).with_nearest(most as f64)
        }
        PipelineErrorKind::RateWithoutClock => {
            // The user knows the number of stages as `pipeline.stages`.
            let words = format!(
                "with pipeline.stages, the clock of `{name}` is not fixed, so no interval can be chosen for \
                 pipeline.rate"
            );
            let remedy = format!("set {CLOCK_MHZ} in place of pipeline.stages");
            ConfigError::new("pipeline.rate", with_location(&words, diagnostic), remedy)
        }
        PipelineErrorKind::Rate { most } => {
            let wanted = keys.rate;
            let remedy =
                format!("set pipeline.rate to {most} or less, or {CLOCK_MHZ} to {wanted} or more");
            of_key("pipeline.rate", remedy).with_nearest(most)
        }
        PipelineErrorKind::Multipliers { fewest } => {
            let remedy = format!("set pipeline.max_multipliers to {fewest} or more");
            of_key("pipeline.max_multipliers", remedy).with_nearest(fewest as f64)
        }
        PipelineErrorKind::Unsolved => {
            let remedy = format!("set another {CLOCK_MHZ} or pipeline.stages");
            of_key(CLOCK_MHZ, remedy)
        }
    }
}

/// Adds the code of the diagnostic and the location in the Rust source, in brackets.
fn with_location(message: &str, diagnostic: &Diagnostic) -> String {
    format!("{message} ({}, {})", diagnostic.code, diagnostic.location)
}

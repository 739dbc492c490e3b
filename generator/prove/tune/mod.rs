//! Searches for the configuration of a device with the smallest estimated cost and an error of at most a limit that the user
//! gives. The search is local, so a cheaper configuration may exist.
//!
//! The error is the proved bound of the accuracy contract, so the answer of [`tune`] holds for every operand of the domain. The
//! cost is estimated from the netlist ([`model`]). The search changes only keys that change neither a port nor the formula
//! (`space`). It changes keys that add clocks only for a rate, for fewer DSP blocks, or if no other configuration fits the chip.

pub mod architectures;
pub mod model;
mod search;
mod space;

use std::fmt;

use anyhow::{Context, Result};
use serde::Serialize;

use glint_config::{Config, Shared, Value};
use glint_core::registry::Device;
use glint_golden::Bounds;
pub use model::{Cost, area, family};
use search::Search;
pub use search::{Answer, Candidate};
use space::SearchSpace;

use crate::synth::Target;

/// The unit of the largest error that the user of `glint tune` states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ErrorUnit {
    /// The reflectance f, from 0 to 1: the error is a value of f.
    F,
    Output,
}

impl ErrorUnit {
    pub fn of(self, bounds: &Bounds) -> f64 {
        match self {
            Self::F => bounds.f,
            Self::Output => bounds.governing_units(),
        }
    }
}

impl fmt::Display for ErrorUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::F => "of f",
            Self::Output => "output units",
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Objective {
    /// Look-up tables. A DSP block or a block RAM counts for as many look-up tables as the chip has for each such block.
    Area,
    Luts,
    /// The number of DSP blocks, and the area among equal numbers.
    Dsps,
    /// The number of bits in the ROMs, and the area among equal numbers.
    Memory,
}

/// The limits that the user states, and the cost that the search minimises.
#[derive(Clone, Debug)]
pub struct TuningGoal {
    pub error: f64,
    pub unit: ErrorUnit,
    /// The FPGA family for which costs are estimated.
    pub target: Target,
    pub objective: Objective,
    /// The lowest acceptable clock frequency in MHz, estimated.
    pub clock: Option<f64>,
    /// The lowest acceptable rate in million points a second, at the estimated clock frequency.
    pub rate: Option<f64>,
    pub most_dsps: Option<u64>,
}

/// The longest interval that is tried, in clocks. No sequential core of the catalogue takes more clocks for a point.
const LONGEST: i64 = 64;

/// The keys that decide a pipeline's rate. The answer lists them among the keys that the search has changed.
const ARCHITECTURE: [&str; 2] = ["architecture", "pipeline.interval"];

/// Searches for the configuration with the smallest cost that meets `goal`.
///
/// `base` has the keys that are part of the user's question. The search changes the other keys, except the keys in `fixed`. It
/// also tries pipelines if the goal has a rate or a limit of DSP blocks, and the target is an FPGA family. Such a pipeline
/// accepts a point (a set of operands) as seldom as the goal allows, so several products can share a multiplier. The search tries
/// no pipeline if `fixed` contains `pipeline.interval`, or contains `architecture` and `base` is sequential. `progress` is called
/// with the number of configurations that were evaluated.
///
/// # Errors
/// Fails if `base` makes no design, or if the search finds no configuration that meets the goal. The message then names the term
/// of the bound, the clock, or the DSP blocks that prevent this.
pub fn tune(
    device: &Device,
    base: &Config,
    fixed: &[&str],
    goal: &TuningGoal,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Answer> {
    // The configurations that were looked at in the architectures before.
    let mut looked_at_before = 0;
    let mut best_pipeline = None;
    for config in pipelines(device, base, fixed, goal) {
        let shown = |looked_at: usize| progress(looked_at_before + looked_at);
        if let Ok(mut answer) = of_architecture(device, &config, fixed, goal, &shown) {
            looked_at_before += answer.looked_at;
            answer.free.splice(0..0, ARCHITECTURE);
            best_pipeline = Some(answer);
            break;
        }
    }
    if Shared::of(base).architecture == "pipelined"
        && let Some(pipeline) = best_pipeline
    {
        return Ok(pipeline);
    }
    let shown = |looked_at: usize| progress(looked_at_before + looked_at);
    let of_base = of_architecture(device, base, fixed, goal, &shown);
    let Some(pipeline) = best_pipeline else { return of_base };
    let Ok(mut sequential) = of_base else { return Ok(pipeline) };
    sequential.free.splice(0..0, ARCHITECTURE);
    let front = goal.front([sequential.front, pipeline.front].concat());
    let looked_at = sequential.looked_at + pipeline.looked_at;
    let is_pipeline_smaller = goal.order(&pipeline.best) < goal.order(&sequential.best);
    let (best, free) = match is_pipeline_smaller {
        true => (pipeline.best, pipeline.free),
        false => (sequential.best, sequential.free),
    };
    Ok(Answer { best, front, free, looked_at })
}

/// Returns the pipelines that [`tune`] tries, the longest interval first. For example, a clock of 50 MHz and a rate of 10
/// million points a second allow the intervals 5, 4, 3, 2 and 1.
fn pipelines(device: &Device, base: &Config, fixed: &[&str], goal: &TuningGoal) -> Vec<Config> {
    let Some(family) = goal.target.family() else { return Vec::new() };
    if goal.rate.is_none() && goal.most_dsps.is_none() {
        return Vec::new();
    }
    let is_pipelined = Shared::of(base).architecture == "pipelined";
    if fixed.contains(&"pipeline.interval") || fixed.contains(&"architecture") && !is_pipelined {
        return Vec::new();
    }
    let mut pipeline = base.clone();
    pipeline.set("architecture", Value::Text("pipelined".to_owned()));
    pipeline.reset_keys_without_effect(&(device.schema)());
    if !fixed.contains(&"pipeline.target") {
        pipeline.set("pipeline.target", Value::Text(family.name().to_owned()));
    }
    if let Some(clock) = goal.clock
        && !fixed.contains(&"pipeline.clock_mhz")
    {
        pipeline.set("pipeline.clock_mhz", Value::Number(clock));
    }
    let clock = Shared::of(&pipeline).pipeline_clock_mhz;
    let longest = match goal.rate {
        Some(rate) => ((clock / rate) as i64).clamp(0, LONGEST),
        None => LONGEST,
    };
    let mut pipelines = Vec::new();
    for interval in (1..=longest).rev() {
        let mut config = pipeline.clone();
        config.set("pipeline.interval", Value::Text(interval.to_string()));
        pipelines.push(config);
    }
    pipelines
}

/// Searches like [`tune`], but only in the architecture of `base`.
fn of_architecture(
    device: &Device,
    base: &Config,
    fixed: &[&str],
    goal: &TuningGoal,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Answer> {
    let slower =
        goal.rate.is_some() || goal.most_dsps.is_some() || goal.objective == Objective::Dsps;
    let run = |slower| -> Result<Answer> {
        let space = SearchSpace::new(device, base, fixed, slower)?;
        Search::new(device, &space, goal, progress).run(base)
    };
    let of_device = || format!("the search for a configuration of `{}` failed", device.name);
    let answer = run(slower).with_context(of_device)?;
    let fits = |answer: &Answer| answer.best.cost.excess(goal.target).is_empty();
    if slower || fits(&answer) {
        return Ok(answer);
    }
    let shared = run(true).with_context(of_device)?;
    Ok(if fits(&shared) { shared } else { answer })
}

/// Tries all combinations of the `values` of keys, and returns the configuration with the smallest cost that meets the goal. It
/// is for tests of the search, and for small spaces.
///
/// # Errors
/// Fails if `base` makes no design, or if a key does not exist.
pub fn exhaustive(
    device: &Device,
    base: &Config,
    values: &[(&str, Vec<glint_config::Value>)],
    goal: &TuningGoal,
) -> Result<Option<Candidate>> {
    let space = SearchSpace::new(device, base, &[], true)?;
    Search::new(device, &space, goal, &|_| ()).exhaustive(base, values)
}

//! Builds a configuration in each of its architectures and estimates the cost: the sequential core, and pipelines with at most 64
//! clocks from one point to the next.
//!
//! A pipeline of a sequential configuration is scheduled for the target, at the default clock or else at the fastest clock that a
//! schedule reaches.

use anyhow::{Context, Result};
use rayon::prelude::*;

use super::model::Cost;
use crate::synth::Target;
use glint_config::{Shared, Value};
use glint_core::core::Core;
use glint_core::registry::OpenedConfig;
use glint_rtl::netlist::{Design, Driver, Op};
use glint_show::evidence::comparison::{EXPONENT, clocks_per_point};

pub struct Architecture {
    pub core: Core,
    /// The number of clocks from one point to the next in a pipeline; `None` for a sequential core.
    pub interval: Option<u32>,
    /// The number of clocks from one point to the next. It may be a fraction for a sequential core that computes lines of
    /// points.
    pub clocks_per_point: f64,
    pub multipliers: usize,
    pub cost: Cost,
}

impl Architecture {
    fn new(core: Core, target: Target) -> Result<Self> {
        let design = &core.design;
        let interval = design.pipeline.as_ref().map(|pipeline| pipeline.interval as u32);
        let clocks = clocks_per_point(design, core.contract.as_ref(), EXPONENT)?;
        let multipliers = multipliers(design);
        let cost = Cost::new(design, target);
        Ok(Self { core, interval, clocks_per_point: clocks, multipliers, cost })
    }

    /// Returns the rate in million points a second, at the estimated clock frequency.
    pub fn rate(&self) -> f64 {
        self.cost.mhz / self.clocks_per_point
    }

    /// Returns a name of the architecture, for example `sequential` or `pipeline, interval 8`.
    pub fn words(&self) -> String {
        match self.interval {
            None => "sequential".to_owned(),
            Some(interval) => format!("pipeline, interval {interval}"),
        }
    }

    /// Returns the keys that make this pipeline, for example `architecture = "pipelined", pipeline.interval = 8`. Returns `None`
    /// for a sequential core.
    pub fn keys(&self) -> Option<String> {
        let interval = self.interval?;
        Some(format!("architecture = \"pipelined\", pipeline.interval = {interval}"))
    }

    /// Returns a text such as `1 DSP block, 18.1 million points a second`.
    pub fn figures(&self) -> String {
        let blocks = match self.cost.dsps {
            1 => "1 DSP block".to_owned(),
            count => format!("{count} DSP blocks"),
        };
        format!("{blocks}, {:.1} million points a second", self.rate())
    }

    /// Returns whether this architecture is at least as good as `other` in rate and DSP blocks, and better in one of them.
    pub fn dominates(&self, other: &Self) -> bool {
        let (rate, dsps) = (self.rate(), self.cost.dsps);
        let is_as_good = rate >= other.rate() && dsps <= other.cost.dsps;
        is_as_good && (rate > other.rate() || dsps < other.cost.dsps)
    }
}

/// Counts the multipliers. A shared multiplier counts once.
fn multipliers(design: &Design) -> usize {
    let products = design.nets.iter().filter(|net| matches!(net.driver, Driver::Op(Op::Mul(..))));
    products.count()
}

/// Builds the sequential core of `base`.
///
/// # Errors
///
/// Fails if the configuration makes no core.
pub fn sequential(base: &OpenedConfig, target: Target) -> Result<Architecture> {
    let mut config = base.config.clone();
    config.set("architecture", Value::Text("sequential".to_owned()));
    config.reset_keys_without_effect(&(base.device.schema)());
    Architecture::new(Core::build(base.with_config(config)?)?, target)
}

/// Returns the pipeline with the longest interval that can be built: at most the clocks of its sequential core, and at most 64.
/// For example, `cosine-power` has an interval of 8, the clocks of its sequential core. Returns `None` if no pipeline can be
/// built.
pub fn longest_interval(sequential: &Architecture, target: Target) -> Option<Architecture> {
    let base = &sequential.core.opened;
    intervals(sequential).rev().find_map(|interval| pipeline(base, target, interval).ok())
}

/// The largest value of `pipeline.interval`, in clocks.
const LONGEST: u32 = 64;

fn intervals(sequential: &Architecture) -> std::ops::RangeInclusive<u32> {
    let clocks = sequential.clocks_per_point.ceil() as u32;
    1..=clocks.min(LONGEST)
}

/// Builds `base` as a pipeline with an interval of `interval` clocks. If `base` is sequential, the pipeline is scheduled for the
/// target, at the default clock or the fastest clock that a schedule reaches.
fn pipeline(base: &OpenedConfig, target: Target, interval: u32) -> Result<Architecture> {
    let mut config = base.config.clone();
    config.set("architecture", Value::Text("pipelined".to_owned()));
    config.set("pipeline.interval", Value::Text(interval.to_string()));
    config.reset_keys_without_effect(&(base.device.schema)());
    let core = if Shared::of(&base.config).architecture == "pipelined" {
        Core::build(base.with_config(config)?)?
    } else {
        if let Some(family) = target.family() {
            config.set("pipeline.target", Value::Text(family.name().to_owned()));
        }
        Core::build_with_free_clock(base.with_config(config)?)?
    };
    Architecture::new(core, target)
}

/// Returns the sequential core of `base`, and then its pipelines from the longest interval to 1. A pipeline is left out if a
/// shorter interval needs no more multipliers, unless its interval is `kept`. For example, `cosine-power` has the intervals 8, 4,
/// 3, 2 and 1: with 5, 6 and 7 it needs two multipliers, as with 4.
///
/// # Errors
///
/// Fails if the configuration makes no sequential core or no pipeline.
pub fn all(base: &OpenedConfig, kept: Option<u32>, target: Target) -> Result<Vec<Architecture>> {
    let sequential = sequential(base, target)?;
    let intervals: Vec<u32> = intervals(&sequential).collect();
    let made: Vec<Result<Architecture>> =
        intervals.par_iter().map(|&interval| pipeline(base, target, interval)).collect();
    let mut pipelines: Vec<Architecture> = Vec::new();
    let mut fewest = usize::MAX;
    let mut refused = None;
    for architecture in made {
        match architecture {
            Ok(made) => {
                let saves_multipliers = made.multipliers < fewest;
                fewest = fewest.min(made.multipliers);
                if saves_multipliers || made.interval == kept {
                    pipelines.push(made);
                }
            }
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    if pipelines.is_empty() {
        let reason = refused.context("no interval is possible")?;
        return Err(reason.context(format!("`{}` cannot be a pipeline", base.device.name)));
    }
    pipelines.push(sequential);
    pipelines.reverse();
    Ok(pipelines)
}

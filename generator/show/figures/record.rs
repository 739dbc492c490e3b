//! The record of a measurement: written by `glint synth --out`, shown by datasheets, `glint compare` and docs/measurements.md.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::Result;
use serde::{Deserialize, Serialize};

use super::{Figures, Target};
use glint_base::input;

/// The directory of this repository's records.
pub const DIRECTORY: &str = "records/synthesis";

/// A configuration with all that was measured of it, `<name>.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SynthesisRecord<F = Figures> {
    /// The version of Glint.
    pub glint: String,
    /// The file of the configuration.
    pub config: String,
    /// The name of the module.
    pub name: String,
    /// The device.
    pub device: String,
    /// Tells the core from others: [`glint_core::core::Core::core_digest`].
    pub core: String,
    /// From one `start` to the next; 1 of a pipeline.
    pub clocks_per_point: f64,
    /// The measurements, one for each target.
    pub targets: Vec<F>,
}

impl SynthesisRecord {
    /// Returns the record of a core, among all in a directory. Returns `None` if there is no such record, or no such
    /// directory. It ignores files that are no records.
    ///
    /// # Errors
    /// Fails if the directory or a file in it cannot be read, or if a record is damaged.
    pub fn find(directory: &Path, core: &str) -> Result<Option<Self>> {
        let records = input::records::<Self>(directory)?.into_iter();
        let mut records = records.map(|(_, record)| record);
        Ok(records.find(|record| record.core == core))
    }

    /// Returns the measurement for a target.
    pub fn of(&self, target: Target) -> Option<&Figures> {
        self.targets.iter().find(|figures| figures.target == target)
    }

    /// Returns the tools that measured, each once.
    pub fn tools(&self) -> BTreeSet<&str> {
        tools(&self.targets)
    }
}

/// Returns the tools of all figures, each once.
pub fn tools<'a>(figures: impl IntoIterator<Item = &'a Figures>) -> BTreeSet<&'a str> {
    figures.into_iter().flat_map(|it| &it.tools).map(String::as_str).collect()
}

/// How many points a core computes. For example, 50 MHz and 5 clocks a point are 10 million points a second.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rate {
    /// Millions a second, at the median frequency.
    #[serde(rename = "million_points_per_second")]
    pub points: f64,
    /// Millions a second for each look-up table.
    #[serde(rename = "million_points_per_second_per_lut")]
    pub per_lut: Option<f64>,
    /// Millions a second for each DSP block.
    #[serde(rename = "million_points_per_second_per_dsp")]
    pub per_dsp: Option<f64>,
}

impl Rate {
    /// Returns the rate of a core that takes `clocks_per_point` clocks a point. Returns `None` if no frequency was
    /// measured.
    pub fn new(figures: &Figures, clocks_per_point: f64) -> Option<Self> {
        let points = figures.frequency?.median / clocks_per_point;
        let per = |units: Option<u64>| Some(points / units.filter(|units| *units > 0)? as f64);
        Some(Self { points, per_lut: per(figures.area.luts), per_dsp: per(figures.area.dsps) })
    }
}

//! Defines the record of a core's measurements, and finds it among a directory's files.
//!
//! `glint synth --out` writes the record, `<name>.json`. Datasheets, `glint compare` and docs/measurements.md show its numbers.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::Result;
use serde::{Deserialize, Serialize};

use super::{Figures, Target};
use glint_base::input;

/// The directory with the synthesis records of this repository.
pub const DIRECTORY: &str = "records/synthesis";

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SynthesisRecord<F = Figures> {
    pub glint: String,
    pub config: String,
    pub name: String,
    pub device: String,
    /// A digest of the core: [`glint_core::core::Core::core_digest`].
    pub core: String,
    /// The clocks from one `start` to the next, divided by the number of results between them. It is 1 for a pipeline that takes
    /// a point every clock, and may be a fraction for a device that computes lines.
    pub clocks_per_point: f64,
    pub targets: Vec<F>,
}

impl SynthesisRecord {
    /// Returns the record in `directory` of the core with the digest `core`, or `None` if no file is such a record.
    ///
    /// # Errors
    ///
    /// Fails if the directory or a file in it cannot be read, or if a record is damaged.
    pub fn find(directory: &Path, core: &str) -> Result<Option<Self>> {
        let records = input::records::<Self>(directory)?.into_iter();
        let mut records = records.map(|(_, record)| record);
        Ok(records.find(|record| record.core == core))
    }

    pub fn of(&self, target: Target) -> Option<&Figures> {
        self.targets.iter().find(|figures| figures.target == target)
    }

    /// Returns each tool once, with its version, in alphabetical order.
    pub fn tools(&self) -> BTreeSet<&str> {
        tools(&self.targets)
    }
}

/// Returns each tool once, with its version, in alphabetical order.
pub fn tools<'a>(figures: impl IntoIterator<Item = &'a Figures>) -> BTreeSet<&'a str> {
    figures.into_iter().flat_map(|it| &it.tools).map(String::as_str).collect()
}

/// The points that a core computes per second. For example, 50 MHz and 5 clocks a point are 10 million.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rate {
    /// The rate in million points per second, at the median frequency.
    #[serde(rename = "million_points_per_second")]
    pub points: f64,
    /// The rate for each look-up table, or `None` if the core has no look-up table.
    #[serde(rename = "million_points_per_second_per_lut")]
    pub per_lut: Option<f64>,
    /// The rate for each DSP block, or `None` if the core has no DSP block.
    #[serde(rename = "million_points_per_second_per_dsp")]
    pub per_dsp: Option<f64>,
}

impl Rate {
    /// Computes the rate, or returns `None` if no frequency was measured.
    pub fn new(figures: &Figures, clocks_per_point: f64) -> Option<Self> {
        let points = figures.frequency?.median / clocks_per_point;
        let per = |units: Option<u64>| Some(points / units.filter(|units| *units > 0)? as f64);
        Some(Self { points, per_lut: per(figures.area.luts), per_dsp: per(figures.area.dsps) })
    }
}

//! Defines the results of measuring a core on a target: area, frequency and critical path.
//!
//! A target is an FPGA family or a standard-cell library. On some targets, only the area is measured. `glint synth` measures
//! these results with synthesis and place-and-route tools.

mod record;

use std::fmt;

use serde::{Deserialize, Serialize};

use glint_base::target::{FAMILIES, Family, Usage};

pub use record::{DIRECTORY, Rate, SynthesisRecord, tools};

/// An FPGA family or a standard-cell library for which cores are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Target {
    /// Lattice iCE40 UltraPlus 5K: area and frequency.
    Ice40,
    /// Lattice iCE40 HX8K: area and frequency.
    #[serde(rename = "ice40-hx")]
    Ice40Hx,
    /// Lattice ECP5, speed grade 6: area and frequency.
    Ecp5,
    /// Xilinx 7 series: area.
    Xilinx7,
    /// Gowin GW2A, such as on the Tang Nano 20K: area.
    Gowin,
    /// Gowin GW1N, such as on the Tang Nano 9K: area.
    #[serde(rename = "gowin-gw1n")]
    GowinGw1n,
    /// Lattice Nexus, speed grade 9: area and frequency.
    Nexus,
    /// Cologne Chip GateMate: area and frequency.
    Gatemate,
    /// Standard cells of 0.18 µm, the OSU library, before layout: area and delay.
    Osu018,
}

pub const TARGETS: [Target; 9] = [
    Target::Ice40,
    Target::Ice40Hx,
    Target::Ecp5,
    Target::Xilinx7,
    Target::Gowin,
    Target::GowinGw1n,
    Target::Nexus,
    Target::Gatemate,
    Target::Osu018,
];

/// The targets of a record of `glint synth`. A sequential core is measured for these targets unless the user names different
/// ones.
pub const RECORDED_TARGETS: [Target; 4] =
    [Target::Ice40, Target::Ecp5, Target::Xilinx7, Target::Osu018];

impl Target {
    /// Returns the name in options and JSON, for example `ice40`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ice40 => "ice40",
            Self::Ice40Hx => "ice40-hx",
            Self::Ecp5 => "ecp5",
            Self::Xilinx7 => "xilinx7",
            Self::Gowin => "gowin",
            Self::GowinGw1n => "gowin-gw1n",
            Self::Nexus => "nexus",
            Self::Gatemate => "gatemate",
            Self::Osu018 => "osu018",
        }
    }

    /// Returns the name in tables and messages, for example `0.18 µm cells`.
    pub fn title(self) -> &'static str {
        self.family().map_or("0.18 µm cells", |family| family.title)
    }

    /// Returns whether open tools know all delays of the FPGA, so a core has a frequency.
    pub fn is_timed_fpga(self) -> bool {
        matches!(self, Self::Ice40 | Self::Ice40Hx | Self::Ecp5 | Self::Nexus | Self::Gatemate)
    }

    /// Returns the FPGA family, or `None` for a standard-cell library.
    pub fn family(self) -> Option<&'static Family> {
        FAMILIES.iter().find(|family| family.name() == self.name())
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    pub target: Target,
    /// The chip or the cell library.
    pub device: String,
    /// The area without the registers that the measurement adds around the core.
    pub area: Area,
    /// The frequency between the registers that the measurement adds around the core. It is `None` if the target has no timing,
    /// or if the core does not fit on the chip.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub frequency: Option<Frequency>,
    /// The longest path between registers in the run with the median frequency, with the description's names.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub critical_path: Vec<PathPoint>,
    /// The reason why no frequency was measured.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub untimed: Option<String>,
    pub tools: Vec<String>,
}

/// A core's area. A resource that the target does not have is `None`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Area {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub luts: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dsps: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub block_rams: Option<u64>,
    pub flip_flops: u64,
    /// The area of the standard cells, as a multiple of the area of a two-input NAND gate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gates: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub square_micrometres: Option<f64>,
}

/// The frequencies in MHz that several runs of placement and routing reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frequency {
    pub lowest: f64,
    /// The frequency of the run in the middle. For an even number of runs, it is the slower of the two middle runs.
    pub median: f64,
    pub highest: f64,
    pub runs: u32,
}

/// A net on the longest path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathPoint {
    /// The name in the description, with `ROM` before the name of a ROM, for example `ROM coefficient`.
    pub name: String,
    /// The time in nanoseconds from the clock edge until the net's value is stable.
    pub ns: f64,
}

impl Figures {
    /// Makes the figures, without a frequency. `device` is the name of the chip or of the cell library.
    pub fn new(target: Target, device: &str, area: Area) -> Self {
        Self {
            target,
            device: device.to_owned(),
            area,
            frequency: None,
            critical_path: Vec::new(),
            untimed: None,
            tools: Vec::new(),
        }
    }

    /// Returns the critical path as text, such as `first 0.4 → second 3.1 → third 7.9 ns`. The path must have a point.
    pub fn path_in_words(&self) -> String {
        let steps = self.critical_path.iter().map(|step| format!("{} {:.1}", step.name, step.ns));
        format!("{} ns", Vec::from_iter(steps).join(" → "))
    }

    /// Adds the results of several runs, each a frequency in MHz and the longest path. The critical path comes from the run
    /// with the median frequency. For example, the median of runs with 100, 110, 120 and 130 MHz is 110 MHz.
    pub fn with_runs(mut self, mut runs: Vec<(f64, Vec<PathPoint>)>) -> Self {
        runs.sort_by(|one, other| one.0.total_cmp(&other.0));
        let (Some(first), Some(last)) = (runs.first(), runs.last()) else {
            return self;
        };
        let (lowest, highest) = (rounded(first.0), rounded(last.0));
        let count = runs.len();
        let (median, path) = runs.swap_remove((count - 1) / 2);
        let median = rounded(median);
        self.frequency = Some(Frequency { lowest, median, highest, runs: count as u32 });
        self.critical_path = path;
        self
    }
}

impl Area {
    /// Returns the resources of an FPGA, or `None` for an area in standard cells.
    pub fn usage(&self) -> Option<Usage> {
        let flip_flops = self.flip_flops;
        let (luts, dsps, block_rams) = (self.luts?, self.dsps?, self.block_rams?);
        Some(Usage { luts, dsps, block_rams, flip_flops })
    }
}

impl From<Usage> for Area {
    fn from(usage: Usage) -> Self {
        Self {
            luts: Some(usage.luts),
            dsps: Some(usage.dsps),
            block_rams: Some(usage.block_rams),
            flip_flops: usage.flip_flops,
            ..Self::default()
        }
    }
}

/// Rounds to two decimals, since the tools are not more exact.
pub fn rounded(number: f64) -> f64 {
    (number * 100.0).round() / 100.0
}

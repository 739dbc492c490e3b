//! Measures a core with Yosys and a nextpnr that writes its timing as a report in JSON: nextpnr-ecp5, nextpnr-nexus and
//! nextpnr-himbaechel.
//!
//! The settings of each FPGA family are a [`Recipe`]. The core is placed on the first chip of the family that is large enough;
//! a core that fits on no chip gets its area, and no frequency.

use anyhow::{Context, Result};
use serde_json::Value;

use super::SynthesisSubject;
use super::netlist::{self, Netlist};
use super::routes::routed;
use super::workspace::Workspace;
use glint_base::target::Chip;
use glint_show::figures::{Figures, PathPoint, Target};
use glint_tools::Tool;

/// The settings with which nextpnr measures a core on an FPGA family.
pub struct Recipe {
    pub target: Target,
    /// The speed grade in words, for example `speed grade 6`; may be empty.
    pub speed: &'static str,
    /// Options besides the chip and the frequency.
    pub options: &'static str,
    /// The frequency in MHz that nextpnr is asked for. No core may reach it, so the placer does its best.
    pub goal: u32,
    /// Checks that nextpnr knows the delay of every cell of the netlist, and prepares the files that nextpnr reads.
    pub prepare: fn(&Workspace, &Netlist) -> Result<()>,
}

/// Measures the area of a core alone, and its frequency in its harness for each seed. Calls `done` after synthesis and after each
/// seed.
///
/// # Errors
///
/// Fails if a tool fails, takes too long or reports no frequency, or if the recipe's `prepare` fails.
pub fn measure(
    recipe: &Recipe,
    yosys: &Tool,
    nextpnr: &Tool,
    subject: &SynthesisSubject,
    done: &(dyn Fn() + Sync),
) -> Result<Figures> {
    let workspace = Workspace::new(yosys, subject)?;
    let (usage, netlist) = workspace.synthesise(recipe.target)?;
    (recipe.prepare)(&workspace, &netlist)?;
    done();
    let family = recipe.target.family().context("nextpnr knows no such family")?;
    // All chips of a family are equally fast, so the first chip that is large enough is used.
    let fitting = family.chips.iter().find(|chip| chip.lack(usage.taken()).is_empty());
    let chip = fitting.unwrap_or(&family.chips[family.chips.len() - 1]);
    let mut name = format!("{} {}", family.title, chip.name);
    if !recipe.speed.is_empty() {
        name += &format!(", {}", recipe.speed);
    }
    let mut figures = Figures::new(recipe.target, &name, usage.into());
    figures.untimed = fitting.is_none().then(|| "does not fit".to_owned());
    routed(figures, subject, done, |seed| route(recipe, nextpnr, &workspace, &netlist, chip, seed))
}

/// Returns the frequency in MHz and the longest path for one seed.
fn route(
    recipe: &Recipe,
    nextpnr: &Tool,
    workspace: &Workspace,
    netlist: &Netlist,
    chip: &Chip,
    seed: u32,
) -> Result<(f64, Vec<PathPoint>)> {
    let report = format!("seed{seed}.json");
    let goal = recipe.goal;
    let mut options = format!("--freq {goal} --report {report}");
    for own in [chip.options, recipe.options] {
        if !own.is_empty() {
            options += &format!(" {own}");
        }
    }
    workspace.nextpnr(nextpnr, seed, &options)?;
    let report = workspace.sources.json(&report)?;
    // The report also lists clock pins of DSP blocks that are tied to ground as a clock.
    let clocks = report["fmax"].as_object().into_iter().flatten();
    let clock = clocks
        .filter(|(name, _)| !name.contains("PACKER"))
        .find_map(|(name, clock)| Some((name, clock["achieved"].as_f64()?)));
    let (clock, frequency) =
        clock.with_context(|| format!("`{nextpnr}` does not report the frequency of the clock"))?;
    Ok((frequency, steps(netlist, &report, &format!("posedge {clock}"))))
}

/// Returns the points of the longest path between two registers, with times in nanoseconds. `clock` is the clock edge in the
/// report, such as `posedge clk`.
fn steps(netlist: &Netlist, report: &Value, clock: &str) -> Vec<PathPoint> {
    let paths = report["critical_paths"].as_array().into_iter().flatten();
    let path = paths.into_iter().find(|path| path["from"] == clock && path["to"] == clock);
    let pieces = path.and_then(|path| path["path"].as_array()).into_iter().flatten();
    let mut points = Vec::new();
    let mut time = 0.0;
    for piece in pieces {
        // A net's time is the end of its route.
        time += piece["delay"].as_f64().unwrap_or(0.0);
        let name = match piece["type"].as_str() {
            Some("routing") => piece["net"].as_str().and_then(|net| netlist.name(net)),
            Some("setup") => piece["to"]["cell"].as_str().and_then(|cell| netlist.register(cell)),
            _ => None,
        };
        points.extend(name.map(|name| (name.to_owned(), time)));
    }
    netlist::path(points)
}

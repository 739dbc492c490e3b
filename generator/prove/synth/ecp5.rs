//! Measures a core on the FPGA family ECP5 with Yosys and nextpnr-ecp5.
//!
//! nextpnr-ecp5 knows the delays of block RAMs, and of multipliers that have no register or only a register at the output. The
//! measurement fails if a multiplier has other registers inside.

use anyhow::{Context, Result};
use serde_json::Value;

use super::netlist::{self, Netlist};
use super::routes::routed;
use super::workspace::Workspace;
use super::{SynthesisSubject, Target};
use glint_base::target::{Chip, ECP5};
use glint_show::figures::{Figures, PathPoint};
use glint_tools::Tool;

/// Out of reach, so that the placer tries hardest, in MHz.
const GOAL: &str = "200";

pub fn measure(
    yosys: &Tool,
    nextpnr: &Tool,
    subject: &SynthesisSubject,
    done: &(dyn Fn() + Sync),
) -> Result<Figures> {
    let workspace = Workspace::new(yosys, subject)?;
    let (usage, netlist) = workspace.synthesise(Target::Ecp5)?;
    netlist.check_timed("MULT18X18D", is_timed, |is| {
        format!("has registers inside ({is}), which nextpnr does not time")
    })?;
    done();
    // All are as fast.
    let fitting = ECP5.chips.iter().find(|chip| chip.lack(usage.taken()).is_empty());
    let chip = fitting.unwrap_or(&ECP5.chips[ECP5.chips.len() - 1]);
    let name = format!("ECP5 {}, speed grade 6", chip.name);
    let mut figures = Figures::new(Target::Ecp5, &name, usage.into());
    figures.untimed = fitting.is_none().then(|| "does not fit".to_owned());
    routed(figures, subject, done, |seed| route(nextpnr, &workspace, &netlist, chip, seed))
}

/// Returns whether nextpnr-ecp5 times a multiplier with this parameter. It times the way to the register at the output,
/// and cannot time the inside of a multiplier with other registers. For example, `REG_OUTPUT_CLK` may be a clock, and
/// `REG_INPUTA_CLK` must be `NONE`.
fn is_timed(parameter: &str, value: &Value) -> bool {
    let clocked = parameter.starts_with("REG_") && parameter.ends_with("_CLK");
    !clocked || parameter == "REG_OUTPUT_CLK" || value == "NONE"
}

fn route(
    nextpnr: &Tool,
    workspace: &Workspace,
    netlist: &Netlist,
    chip: &Chip,
    seed: u32,
) -> Result<(f64, Vec<PathPoint>)> {
    let report = format!("seed{seed}.json");
    let options = format!(
        "--lpf-allow-unconstrained {} --speed 6 --freq {GOAL} --report {report}",
        chip.options
    );
    workspace.nextpnr(nextpnr, seed, &options)?;
    let report = workspace.sources.json(&report)?;
    // Clock pins of DSP blocks that are tied to ground are listed as a clock too.
    let clocks = report["fmax"].as_object().into_iter().flatten();
    let clock = clocks
        .filter(|(name, _)| !name.contains("PACKER"))
        .find_map(|(name, clock)| Some((name, clock["achieved"].as_f64()?)));
    let (clock, frequency) =
        clock.context("`nextpnr-ecp5` does not tell the frequency of the clock")?;
    Ok((frequency, steps(netlist, &report, &format!("posedge {clock}"))))
}

/// Returns the longest path from the clock to the clock.
fn steps(netlist: &Netlist, report: &Value, clock: &str) -> Vec<PathPoint> {
    let paths = report["critical_paths"].as_array().into_iter().flatten();
    let path = paths.into_iter().find(|path| path["from"] == clock && path["to"] == clock);
    let pieces = path.and_then(|path| path["path"].as_array()).into_iter().flatten();
    let mut points = Vec::new();
    let mut time = 0.0;
    for piece in pieces {
        // A net settles at the end of its route.
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

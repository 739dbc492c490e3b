//! Measures a core on the FPGAs iCE40 UltraPlus 5K and HX8K: Yosys synthesises, nextpnr-ice40 places and routes, and icetime times.
//!
//! nextpnr-ice40 treats every DSP block as a register and ignores its delay. icetime knows the delay of a block only if the block
//! is a pure multiplier; the measurement fails for all other blocks. [`glint_tools::synthesis`] therefore maps products to pure
//! multipliers. A core that does not fit on the chip gets its area, and no frequency.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use serde_json::Value;

use super::netlist::{self, Netlist};
use super::routes::routed;
use super::workspace::Workspace;
use super::{SynthesisSubject, Target};
use glint_base::target::{Chip, ICE40, ICE40_HX};
use glint_show::figures::{Figures, PathPoint};
use glint_tools::Tool;

/// The settings with which the tools measure a core on a chip of iCE40.
pub struct IceRecipe {
    target: Target,
    /// The chip and its package, as a page shows them.
    device: &'static str,
    chip: &'static Chip,
    /// The options of icetime that select the chip and its package.
    icetime: [&'static str; 4],
    /// The frequency in MHz that nextpnr is asked for. No core reaches it, so the placer does its best.
    goal: &'static str,
}

/// The largest chip of the family that has DSP blocks.
pub const UP5K: IceRecipe = IceRecipe {
    target: Target::Ice40,
    device: "iCE40 UP5K, SG48",
    chip: &ICE40.chips[0],
    icetime: ["-d", "up5k", "-P", "sg48"],
    goal: "60",
};

/// The largest chip of the fast family.
pub const HX8K: IceRecipe = IceRecipe {
    target: Target::Ice40Hx,
    device: "iCE40 HX8K, CT256",
    chip: &ICE40_HX.chips[0],
    icetime: ["-d", "hx8k", "-P", "ct256"],
    goal: "200",
};

/// Measures the area of a core alone, and its frequency in its harness for each seed. Calls `done` after synthesis and after each
/// seed. `timing` is nextpnr-ice40 and icetime.
///
/// # Errors
/// Fails if a tool fails, takes too long or does not report a figure, or if a DSP block is no pure multiplier.
pub fn measure(
    recipe: &IceRecipe,
    yosys: &Tool,
    timing: [&Tool; 2],
    subject: &SynthesisSubject,
    done: &(dyn Fn() + Sync),
) -> Result<Figures> {
    let workspace = Workspace::new(yosys, subject)?;
    let (usage, netlist) = workspace.synthesise(recipe.target)?;
    netlist.check_timed("SB_MAC16", is_pure, |is| {
        format!("is more than a multiplier ({is}), which icetime cannot time")
    })?;
    done();
    let mut figures = Figures::new(recipe.target, recipe.device, usage.into());
    let lack = recipe.chip.lack(usage.taken()).into_iter().map(|(at, wanted, there)| {
        let what = ["LUTs", "DSP blocks", "block RAMs"][at];
        format!("{wanted} {what}, {} has {there}", recipe.chip.name)
    });
    let lack: Vec<String> = lack.collect();
    figures.untimed = (!lack.is_empty()).then(|| format!("does not fit: {}", lack.join("; ")));
    routed(figures, subject, done, |seed| {
        route(recipe, timing, subject, &workspace, &netlist, seed)
    })
}

/// Returns whether a DSP block with this value of `parameter` can be a pure multiplier. The selects of both output halves must
/// end with `11`, the signs of the factors may have any value, and every remaining parameter must be all zeros.
fn is_pure(parameter: &str, value: &Value) -> bool {
    let value = value.as_str().unwrap_or_default();
    match parameter {
        "TOPOUTPUT_SELECT" | "BOTOUTPUT_SELECT" => value.ends_with("11"),
        "A_SIGNED" | "B_SIGNED" => true,
        _ => !value.contains('1'),
    }
}

/// Returns the frequency in MHz and the longest path for one seed.
fn route(
    recipe: &IceRecipe,
    [nextpnr, icetime]: [&Tool; 2],
    subject: &SynthesisSubject,
    workspace: &Workspace,
    netlist: &Netlist,
    seed: u32,
) -> Result<(f64, Vec<PathPoint>)> {
    let (bits, timing) = (format!("seed{seed}.asc"), format!("seed{seed}.json"));
    let placed = format!("placed{seed}.json");
    let options = format!(
        "{} --pcf-allow-unconstrained --freq {} --asc {bits} --write {placed}",
        recipe.chip.options, recipe.goal
    );
    workspace.nextpnr(nextpnr, seed, &options)?;
    let mut arguments = recipe.icetime.to_vec();
    arguments.extend(["-i", "-t", "-j", &timing, &bits]);
    let said = icetime.run_to_success(arguments, workspace.sources.path(), subject.limit)?;
    let nanoseconds = said.lines().find_map(|line| {
        line.strip_prefix("Total path delay: ")?.split(' ').next()?.parse::<f64>().ok()
    });
    let nanoseconds = nanoseconds.context("`icetime` does not report the longest path")?;
    let (path, placed) = (workspace.sources.json(&timing)?, workspace.sources.json(&placed)?);
    Ok((1000.0 / nanoseconds, steps(netlist, &path, &placed)))
}

/// Returns the longest path's points, with times in nanoseconds. `path` is icetime's report, and `placed` the netlist that
/// nextpnr has placed. icetime often gives a net the name of the next net on the path. The function therefore finds a net by the
/// location of the cell that drives it.
fn steps(netlist: &Netlist, path: &Value, placed: &Value) -> Vec<PathPoint> {
    let outputs = outputs(placed);
    let points = path[0].as_array().into_iter().flatten();
    netlist::path(points.filter_map(|point| {
        let net = outputs.get(&location_of(point["cell"].as_str()?)?)?;
        let name = netlist.name(net)?;
        Some((name.to_owned(), point["delay_ns"].as_f64()?))
    }))
}

/// Returns the location of a cell in nextpnr's notation, from icetime's name. For example, `lc40_16_2_0` is at `16 2 0`. Returns
/// `None` for routing.
fn location_of(cell: &str) -> Option<String> {
    let mut parts = cell.split('_');
    let kind = parts.next()?;
    // A DSP block or a block RAM occupies at least a whole tile, so the tile of its first part is its location.
    let location: Vec<&str> = parts.collect();
    match kind {
        "lc40" => (location.len() == 3).then(|| location.join(" ")),
        "MAC16" | "ram" | "ram40" => Some(format!("{} {}", location.first()?, location.get(1)?)),
        _ => None,
    }
}

/// Returns a net that each cell drives, by the cell's location. For a DSP block or a block RAM, it is the net of one output.
fn outputs(placed: &Value) -> BTreeMap<String, String> {
    // nextpnr writes a single module, which it calls `top`.
    let Some(module) = placed["modules"].as_object().and_then(|modules| modules.values().next())
    else {
        return BTreeMap::new();
    };
    let objects = |value: &'_ Value| value.as_object().cloned().unwrap_or_default();
    let nets: BTreeMap<u64, String> = objects(&module["netnames"])
        .iter()
        .filter_map(|(name, net)| Some((net["bits"][0].as_u64()?, name.clone())))
        .collect();
    let mut found = BTreeMap::new();
    for cell in objects(&module["cells"]).values() {
        // X16/Y2/lc0
        let bel = cell["attributes"]["NEXTPNR_BEL"].as_str().unwrap_or_default();
        let mut parts =
            bel.split('/').map(|part| part.trim_start_matches(|c: char| !c.is_ascii_digit()));
        let (Some(x), Some(y), Some(z)) = (parts.next(), parts.next(), parts.next()) else {
            continue;
        };
        let (prefix, location) = match cell["type"].as_str() {
            Some("ICESTORM_LC") => ("O", format!("{x} {y} {z}")),
            Some("ICESTORM_DSP") => ("O_", format!("{x} {y}")),
            Some("ICESTORM_RAM") => ("RDATA_", format!("{x} {y}")),
            _ => continue,
        };
        let connections = objects(&cell["connections"]);
        let driven = connections.iter().filter(|(port, _)| match prefix {
            "O" => *port == "O",
            _ => port.starts_with(prefix),
        });
        let net = driven.filter_map(|(_, bits)| nets.get(&bits[0].as_u64()?)).next();
        found.extend(net.map(|net| (location, net.clone())));
    }
    found
}

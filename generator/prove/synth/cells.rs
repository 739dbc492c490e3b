//! Measures a core in standard cells of 0.18 µm before layout, with Yosys for the area and OpenSTA for the delay.
//!
//! Yosys buffers nets with a large fan-out and sizes the cells. By default, the cell library is from Oklahoma State
//! University, in the typical corner, as Debian's package `qflow-tech-osu018` has it. The number of gates is the area of all
//! cells, divided by the area of the cell NAND2X1.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use super::harness::TOP;
use super::netlist::{self, Netlist};
use super::workspace::{self, HARNESS, Workspace};
use super::{SynthesisSubject, Target};
use glint_core::package;
use glint_show::figures::{Area, Figures, PathPoint, rounded};
use glint_tools::Tool;
use glint_tools::gates::cells::{LOAD, MAPPING};
use glint_tools::sources::YosysSources;

const DEVICE: &str = "OSU 0.18 µm, typical corner, before layout";
const NETLIST: &str = "cells.v";
const STATISTICS: &str = "cells.txt";
const GATE: &str = "NAND2X1";
const CONSTRAINTS: &str = "cells.constr";

/// A file of standard cells in the format Liberty, with its contents.
pub struct CellLibrary {
    path: PathBuf,
    text: String,
}

impl CellLibrary {
    /// Reads the library.
    ///
    /// # Errors
    ///
    /// Fails if the file is missing or cannot be read. For a missing file, the message says how to install it.
    pub fn read(path: &Path) -> Result<Self> {
        if !path.is_file() {
            bail!(
                "the Liberty file `{}`, which describes cells of 0.18 µm, does not exist; install it \
                 (Debian, Ubuntu: `apt install qflow-tech-osu018`), or name another file with --liberty",
                path.display()
            );
        }
        let text = fs::read_to_string(path)
            .with_context(|| format!("cannot read `{}`", path.display()))?;
        Ok(Self { path: path.to_owned(), text })
    }

    /// Returns the SHA-256 of the contents, in hexadecimal.
    pub fn digest(&self) -> String {
        package::digest(self.text.as_bytes())
    }
}

/// Measures the area of a core alone, and its longest path in its harness. Calls `done` after synthesis and after timing.
///
/// # Errors
/// Fails if a tool fails, takes too long or does not report a figure, or if the library has no area of the cell NAND2X1.
pub fn measure(
    yosys: &Tool,
    sta: &Tool,
    CellLibrary { path, text }: &CellLibrary,
    subject: &SynthesisSubject,
    done: &(dyn Fn() + Sync),
) -> Result<Figures> {
    let gate = gate(text).with_context(|| {
        format!(
            "`{}` does not state the area of the cell {GATE}, the unit of gates",
            path.display()
        )
    })?;
    let workspace = Workspace::new(yosys, subject)?;
    let (sources, library) = (&workspace.sources, "cells.lib");
    sources.write(library, text)?;
    sources.write(CONSTRAINTS, LOAD)?;
    let map = |top: &str| format!("synth -flatten -top {top}; {MAPPING}");
    let name = &subject.design.name;
    let commands = [
        "design -save source".to_owned(),
        map(name),
        format!("tee -q -o {STATISTICS} stat -liberty {library}"),
        "design -load source".to_owned(),
        format!("read_verilog {HARNESS}"),
        map(TOP),
        // These commands give every net a name that both the netlist and OpenSTA use.
        "splitnets; opt_clean -purge; rename -enumerate -pattern glint_%".to_owned(),
        format!("write_json {}", workspace::NETLIST),
        format!("write_verilog -noattr -noexpr -simple-lhs {NETLIST}"),
    ];
    sources.run(&commands.join("; "))?;
    done();
    let area = area(&sources.text(STATISTICS)?, gate)
        .context("`yosys` does not report the area of the cells")?;
    let netlist = workspace.netlist()?;
    let (period, path) = timing(sta, subject, sources, &netlist)?;
    done();
    Ok(Figures::new(Target::Osu018, DEVICE, area).with_runs(vec![(1000.0 / period, path)]))
}

/// Returns the area of the cell [`GATE`] in a cell library, in µm².
fn gate(liberty: &str) -> Option<f64> {
    let (_, cell) = liberty.split_once(&format!("cell ({GATE})"))?;
    let (_, area) = cell.split_once("area :")?;
    area.split(';').next()?.trim().parse().ok()
}

/// Returns the area of the cells in µm² and in gates, and the number of flip-flops, from the text of Yosys's `stat`. `gate` is
/// the area of a gate in µm². For example, the line `Chip area for module 'rsqrt': 24000.0` gives 24 000 µm².
fn area(statistics: &str, gate: f64) -> Option<Area> {
    let total = statistics.lines().find_map(|line| {
        let (before, area) = line.split_once(": ")?;
        before.trim_start().starts_with("Chip area").then(|| area.trim().parse::<f64>().ok())?
    })?;
    let flip_flops = statistics.lines().filter_map(|line| {
        let (cell, count) = line.trim().split_once(' ')?;
        cell.starts_with("DFF").then(|| count.trim().parse::<u64>().ok())?
    });
    Some(Area {
        flip_flops: flip_flops.sum(),
        gates: Some((total / gate).round()),
        square_micrometres: Some(rounded(total)),
        ..Area::default()
    })
}

/// Returns the shortest period in nanoseconds, and the longest path.
fn timing(
    sta: &Tool,
    subject: &SynthesisSubject,
    sources: &YosysSources,
    netlist: &Netlist,
) -> Result<(f64, Vec<PathPoint>)> {
    // The period must be longer than any path: the longest path's delay is this period minus the slack.
    const PERIOD: f64 = 1000.0;
    const SCRIPT: &str = "timing.tcl";
    let script = format!(
        "read_liberty cells.lib\nread_verilog {NETLIST}\nlink_design {TOP}\n\
         create_clock -name clk -period {PERIOD} [get_ports clk]\n\
         report_checks -path_delay max -fields {{net}} -digits 4\nexit\n"
    );
    sources.write(SCRIPT, &script)?;
    let said =
        sta.run_to_success(["-no_splash", "-exit", SCRIPT], sources.path(), subject.limit)?;
    if let Some(error) = said.lines().find(|line| line.starts_with("Error")) {
        bail!("`sta` failed: {error}");
    }
    let slack = said
        .lines()
        .find_map(|line| line.trim().strip_suffix("slack (MET)")?.trim().parse::<f64>().ok());
    let slack = slack.context("`sta` does not report the longest path")?;
    Ok((PERIOD - slack, steps(netlist, &said)))
}

/// Returns the points of the longest path in OpenSTA's report, with times in nanoseconds. The last point is the register at the
/// path's end.
fn steps(netlist: &Netlist, said: &str) -> Vec<PathPoint> {
    let mut points = Vec::new();
    let mut time = 0.0;
    for line in said.lines() {
        let mut words = line.split_whitespace();
        let first = words.next().unwrap_or_default();
        if line.contains("data arrival time") {
            break;
        }
        if line.trim_end().ends_with("(net)") {
            let name = words.next().and_then(|net| netlist.name(net));
            points.extend(name.map(|name| (name.to_owned(), time)));
        } else if let Some(arrival) = words.next().and_then(|word| word.parse().ok())
            && first.parse::<f64>().is_ok()
        {
            time = arrival;
        }
    }
    let end = said.lines().find_map(|line| line.strip_prefix("Endpoint: ")?.split(' ').next());
    let end = end.and_then(|cell| netlist.register(cell));
    points.extend(end.map(|name| (name.to_owned(), time)));
    netlist::path(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Figures are cached by the library's digest, so a library that differs in one number must have another digest.
    #[test]
    fn libraries_with_other_contents_have_other_digests() {
        let library = |area: &str| CellLibrary {
            path: PathBuf::from("cells.lib"),
            text: format!("cell ({GATE}) {{ area : {area}; }}"),
        };
        assert_eq!(library("24").digest(), library("24").digest());
        assert_ne!(library("24").digest(), library("25").digest());
    }

    #[test]
    fn a_missing_library_is_told_with_its_package() {
        let missing = CellLibrary::read(Path::new("nowhere/cells.lib"));
        let message = missing.map(|_| ()).expect_err("no file").to_string();
        assert!(message.contains("`nowhere/cells.lib`"), "{message}");
        assert!(message.contains("qflow-tech-osu018"), "{message}");
    }
}

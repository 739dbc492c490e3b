//! Tests `glint synth`: a measured clock includes the delay of a multiplier, and `--front` marks the smallest architecture with
//! the rate.
//!
//! The areas and frequencies must not be much worse than in `records/synthesis/`. `tests/kinds.toml` says how
//! many a run measures again.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::Command;

use glint::base::input;
use glint::dsl::{Designer, end, step, valid};
use glint::fixed::{Format, Overflow, Rounding};
use glint::hdl::netlist::Design;
use glint::package::{self, EmitInputs, FileKind};
use glint::synth::{self, Area, Figures, Flow, SynthesisRecord, SynthesisSubject, Target};

use crate::common::Sure;
use crate::common::cores::configuration;
use crate::common::files::root;
use crate::common::sample::sampled;
use crate::common::tools::{LIMIT, succeeded};
use serde_json::Value;

/// Returns the flow of a target, its tools from the Python environment that `tools/install` makes, or from `PATH`.
fn flow(target: Target) -> Flow {
    let venv = root().join("target/tools/venv/bin");
    let path = env::var_os("PATH").unwrap_or_default();
    let dirs = env::split_paths(&path).chain([venv]);
    let search: OsString = env::join_paths(dirs).expect("a search path");
    let liberty = Path::new("/usr/share/qflow/tech/osu018/osu018_stdcells.lib");
    Flow::find(target, &search, liberty).sure()
}

fn measured(target: Target, design: &Design, seeds: u32) -> Figures {
    let emitted = package::emit_core(design, &EmitInputs::default()).expect("Verilog");
    let files = emitted.sources_for(FileKind::CORE_SOURCES, target.name());
    let subject = SynthesisSubject { design, files: &files, seeds, limit: LIMIT };
    flow(target).measure(&subject, &|| ()).sure()
}

/// Returns a register, a product of 16 by 16 bits, a register.
fn square() -> Design {
    let d = Designer::new("square_of_x");
    let x = d.operand("x", Format::unsigned(0, 16));
    let product = d.mul("product", x.q(), x.q());
    let y = d.register("y", Format::unsigned(0, 32));
    y.takes(d.narrow("whole", product, y.format(), Rounding::Truncate, Overflow::Saturate));
    d.output("y_out", y.q());
    d.microprogram([
        step("idle", []),
        step("square", [y.load()]),
        step("result", [valid(), end()]),
    ]);
    d.finish().sure()
}

/// The multipliers' delays stand in the tools' tables: 16 by 16 bits take at least 6.6 ns in UP5K (`icetime`, to the
/// lowest of the upper output bits), any take 3.9 ns in ECP5's speed grade 6 (nextpnr-ecp5), and 18 by 18 bits take 1.69 ns in the
/// multiplier of Nexus alone (nextpnr-nexus). GateMate has none: a carry goes through eight rows of cells, each 0.4 ns or more.
#[test]
fn the_delay_of_a_multiplier_is_not_left_out() {
    let delays =
        [(Target::Ice40, 6.6), (Target::Ecp5, 3.9), (Target::Nexus, 1.69), (Target::Gatemate, 3.2)];
    for (target, delay) in delays {
        let figures = measured(target, &square(), 1);
        let blocks = if target == Target::Gatemate { 0 } else { 1 };
        assert_eq!(figures.area.dsps, Some(blocks), "{figures:?}");
        let frequency = figures.frequency.expect("a frequency");
        assert!(1000.0 / frequency.median > delay, "{figures:?}");
        let names: Vec<&str> =
            figures.critical_path.iter().map(|step| step.name.as_str()).collect();
        // The product has the bits of the value that it is narrowed to, and Yosys keeps one of both names.
        let is_named = names == ["x_reg", "product", "y"] || names == ["x_reg", "whole", "y_out"];
        assert!(is_named, "{figures:?}");
        let end = figures.critical_path.last().expect("a path").ns;
        assert!(end <= 1000.0 / frequency.median + 0.01, "{figures:?}");
    }
}

/// The area of a chip in look-up tables by hand: an LFE5U-25F has 24 288 look-up tables, 28 DSP blocks and 56 block RAMs.
fn area_on_ecp5(area: &Value) -> f64 {
    let number = |key: &str| area[key].as_f64().expect(key);
    number("luts") + 867.0 * number("dsps") + 434.0 * number("block_rams")
}

/// `--front` measures the sequential core and the pipelines from the longest interval to 1, each as `synth` measures it alone, and
/// marks the smallest with the rate. The second run takes the figures from the cache.
#[test]
fn the_front_has_every_architecture_and_marks_the_smallest_with_the_rate() {
    const RATE: f64 = 20.0;
    let directory = tempfile::tempdir().expect("a directory");
    let venv = root().join("target/tools/venv/bin");
    let path = env::var_os("PATH").unwrap_or_default();
    let search = env::join_paths(std::iter::once(venv).chain(env::split_paths(&path)));
    let glint = |arguments: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_glint"));
        command.args(arguments.split(' ')).current_dir(directory.path());
        command.env("PATH", search.as_ref().expect("a search path"));
        succeeded(&mut command)
    };
    let parsed = |text: String| -> Value { serde_json::from_str(&text).expect("JSON") };
    let written = |name: &str, text: String| fs::write(directory.path().join(name), text);
    written("core.toml", glint("new rsqrt")).expect("written");
    written("fast.toml", glint("new rsqrt --pipelined")).expect("written");
    let command = format!("synth core.toml --front --rate {RATE} --seeds 1 --json");
    let report = parsed(glint(&format!("{command} --plot front.svg")));
    let front = report["front"].as_array().expect("architectures");
    let intervals: Vec<u64> = front.iter().map(|it| it["interval"].as_u64().unwrap_or(0)).collect();
    let pipelines = &intervals[1..];
    assert!(intervals[0] == 0 && pipelines.last() == Some(&1), "{intervals:?}");
    assert!(pipelines.is_sorted_by(|longer, shorter| longer > shorter), "{intervals:?}");
    let mut smallest: Option<&Value> = None;
    for it in front {
        let mhz = it["figures"]["frequency"]["median"].as_f64().expect("a frequency");
        let rate = mhz / it["clocks_per_point"].as_f64().expect("clocks");
        assert!((it["million_points_per_second"].as_f64().expect("a rate") - rate).abs() < 1e-9);
        let area = area_on_ecp5(&it["figures"]["area"]);
        assert_eq!(it["area_in_luts"].as_f64(), Some(area), "{it}");
        let is_smaller =
            smallest.is_none_or(|other| area < area_on_ecp5(&other["figures"]["area"]));
        if rate >= RATE && is_smaller {
            smallest = Some(it);
        }
    }
    let chosen: Vec<&Value> = front.iter().filter(|it| it["chosen"] == true).collect();
    assert_eq!(chosen, [smallest.expect("an architecture with the rate")]);
    let alone = parsed(glint("synth fast.toml --target ecp5 --seeds 1 --json"));
    let fastest = &front[front.len() - 1]["figures"];
    assert_eq!(fastest["area"], alone["synthesis"][0]["targets"][0]["area"]);
    assert_eq!(fastest["frequency"], alone["synthesis"][0]["targets"][0]["frequency"]);
    let svg = fs::read_to_string(directory.path().join("front.svg")).expect("a plot");
    assert!(svg.starts_with("<svg ") && svg.contains("chosen"), "{svg}");
    assert_eq!(parsed(glint(&command)), report);
}

/// No open tool times all cells of Gowin and Xilinx 7, so that there is no frequency, and the reason is told.
#[test]
fn a_family_that_no_tool_times_has_no_frequency() {
    for target in [Target::Gowin, Target::GowinGw1n, Target::Xilinx7] {
        let figures = measured(target, &square(), 1);
        assert_eq!(figures.area.dsps, Some(1), "{figures:?}");
        assert_eq!(figures.frequency, None, "{figures:?}");
        assert!(figures.untimed.is_some_and(|reason| !reason.is_empty()));
    }
}

/// A product needs about a full adder for each pair of bits, and those are about four gates or more.
#[test]
fn cells_are_counted_in_gates() {
    let figures = measured(Target::Osu018, &square(), 1);
    let gates = figures.area.gates.expect("gates");
    assert!((16.0 * 16.0 * 4.0..16.0 * 16.0 * 16.0).contains(&gates), "{figures:?}");
    // NAND2X1 is 24 µm² in that library.
    let area = figures.area.square_micrometres.expect("an area");
    assert!((area / 24.0 - gates).abs() < 1.0, "{figures:?}");
    let names: Vec<&str> = figures.critical_path.iter().map(|step| step.name.as_str()).collect();
    assert_eq!((names.first(), names.last()), (Some(&"x_reg"), Some(&"y")), "{figures:?}");
}

/// The cost of a later change of description or emission is seen here: areas of more than 51/50 of the record are too
/// large. `glint synth --out synthesis` makes the record anew.
#[test]
fn areas_are_those_of_the_record() {
    let pairs = recorded();
    assert!(!pairs.is_empty(), "no records");
    for (config, recorded) in sampled("synth", pairs) {
        let unit = configuration(&config);
        // No seed, no run of place and route.
        let now = measured(recorded.target, &unit.design, 0);
        assert_eq!(now.tools[0], recorded.tools[0], "{config}: the record is of another Yosys");
        let of = |area: &Area| {
            let gates = area.gates.map(|gates| gates as u64);
            [area.luts, area.dsps, area.block_rams, Some(area.flip_flops), gates]
        };
        let pairs = of(&now.area).into_iter().zip(of(&recorded.area));
        let grown =
            pairs.filter(|(now, recorded)| now.unwrap_or(0) * 50 > recorded.unwrap_or(0) * 51);
        assert_eq!(grown.count(), 0, "{config}: {:?}, in the record {:?}", now.area, recorded.area);
    }
}

/// The clock frequency after place and route is at least nine tenths of the lowest frequency in the record. That much a placement
/// may lose by chance where a net has another name; the spread over seeds in the records is as wide.
#[test]
fn frequencies_are_those_of_the_record() {
    let timed = recorded().into_iter().filter(|(_, figures)| figures.frequency.is_some());
    for (config, recorded) in sampled("frequencies", timed) {
        let unit = configuration(&config);
        let now = measured(recorded.target, &unit.design, 1);
        assert_eq!(now.tools, recorded.tools, "{config}: the record is of other tools");
        let (now, then) = (now.frequency.expect("a frequency"), recorded.frequency);
        let least = 0.9 * then.expect("a frequency").lowest;
        assert!(
            now.median >= least,
            "{config}, {}: {now:?}, in the record {then:?}",
            recorded.target
        );
    }
}

/// Returns every configuration with a record, and its figures for each target.
fn recorded() -> Vec<(String, Figures)> {
    let directory = root().join(synth::DIRECTORY);
    let records = input::records::<SynthesisRecord>(&directory).expect("records");
    let pairs = records.into_iter().flat_map(|(_, record)| {
        let config = record.config.clone();
        record.targets.into_iter().map(move |figures| (config.clone(), figures))
    });
    pairs.collect()
}

//! Tests `glint cosim`: the two external simulators, waveform files, the report of a difference, and exhaustive checks that are
//! divided into shards, killed and resumed.

use std::collections::BTreeSet;

use serde_json::Value;
use vcd::{Command, VarType};

use crate::common::json::Json;
use crate::common::waveform::waveform;
use crate::workspace::Workspace;
#[cfg(feature = "outside-tools")]
use crate::workspace::{COSINE_POWER, Run};

const ROUGH: &str = "device = \"rough\"\n";

#[cfg(feature = "outside-tools")]
#[test]
fn emitted_verilog_holds_in_both_simulators() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    for simulator in ["icarus", "verilator"] {
        let text = dir.done(["cosim", "core.toml", "--points", "3", "--simulator", simulator]);
        assert!(text.starts_with("core.toml: 3 points, ") && text.ends_with(": holds\n"), "{text}");
    }
    let run = dir.glint(["cosim", "core.toml", "--points", "3", "--simulator", "icarus", "--json"]);
    let one = &run.json()["configurations"][0];
    assert_eq!((&one["simulator"], &one["passed"]), (&"icarus".into(), &true.into()), "{run:?}");
    assert!(one["transcript"].text().contains("PASS"), "{one}");
    assert_eq!(dir.files().len(), 1, "something is left");
}

#[test]
fn a_waveform_has_ports_and_microinstructions() {
    let dir = Workspace::with("core.toml", ROUGH);
    dir.done(["generate", "core.toml"]);
    let manifest = dir.json("rtl_out/core/core.json");
    dir.done(["cosim", "core.toml", "--points", "20", "--vcd", "wave.vcd"]);
    let (found, values) = waveform(&dir.at("wave.vcd"));
    let size = |name: &str| {
        found.iter().find(|(path, _)| path == name).map(|(_, var)| u64::from(var.size))
    };
    for port in manifest["ports"].list() {
        let name = port["name"].text();
        assert_eq!(size(&format!("core.{name}")), port["width"].as_u64(), "{name}");
    }
    // By the defaults of the configuration, and by the ten microinstructions of the patent.
    assert_eq!(size("core.cos_gamma"), Some(21));
    assert_eq!(size("core.datapath.reg11_cos_cos"), Some(23));
    assert_eq!(size("core.control.word_address"), Some(4));

    let (_, executed) =
        found.iter().find(|(path, _)| path == "core.control.microinstruction").expect("a name");
    let mut seen = BTreeSet::new();
    for command in values {
        if let Command::ChangeString(code, text) = command.unwrap()
            && code == executed.code
        {
            seen.insert(text);
        }
    }
    // The views name what is in the waveform, all of it, and the binary points of the manifest.
    let view = dir.read("wave.gtkw");
    let traces = || view.lines().filter(|line| line.starts_with("core."));
    let plain = |trace: &str| trace.split('[').next().unwrap_or_default().to_owned();
    let shown: BTreeSet<String> = traces().map(plain).collect();
    let there: BTreeSet<String> = found.iter().map(|(path, _)| path.clone()).collect();
    assert_eq!((shown.len(), &shown), (traces().count(), &there));
    let adds = dir.read("wave.sucl");
    let adds = adds.lines().filter_map(|line| line.strip_prefix("variable_add "));
    assert_eq!(adds.map(str::to_owned).collect::<BTreeSet<_>>(), there);
    let fraction = |port: &Value| format!("[fpshift_count] {}\ncore.", port["fraction_bits"]);
    for name in ["cos_gamma", "exponent"] {
        let port = manifest["ports"].of("name", name);
        let pointed = view.contains(&format!("{}{name}[", fraction(port)));
        assert_eq!(pointed, name == "cos_gamma", "{view}");
    }
    // The user's view stays.
    dir.write("wave.gtkw", "mine");
    dir.done(["cosim", "core.toml", "--points", "20", "--vcd", "wave.vcd", "--force"]);
    assert_eq!(dir.read("wave.gtkw"), "mine");

    let words = manifest["control"]["words"].list();
    assert_eq!((executed.var_type, executed.size), (VarType::String, 1));
    // A VCD string has no spaces.
    let names = words.iter().map(|word| word["name"].text().replace(' ', "_"));
    let unseen: Vec<String> = names.filter(|name| !seen.contains(name)).collect();
    assert!(unseen.is_empty(), "{unseen:?} not in {seen:?}");
}

/// A pipeline's nets are in a scope of their stage, its handshake in one of its own.
#[test]
fn a_waveform_of_a_pipeline_has_its_stages() {
    let dir = Workspace::with("core.toml", ROUGH);
    dir.write("core.toml", format!("architecture = \"pipelined\"\n{ROUGH}"));
    dir.done(["cosim", "core.toml", "--points", "20", "--vcd", "wave.vcd"]);
    let (found, _) = waveform(&dir.at("wave.vcd"));
    let schedule = dir.glint(["schedule", "core.toml", "--json"]).good().json();
    let stages = schedule["schedules"][0]["stages"].list().len();
    for stage in 0..=stages {
        let scope = format!("core.stage_{stage}.");
        let nets: Vec<&str> = found.iter().filter_map(|it| it.0.strip_prefix(&scope)).collect();
        assert!(!nets.is_empty(), "{scope}");
        // A register says its stage in its name.
        let other = |net: &&&str| {
            let stage_of_name = net.rsplit_once("_s").and_then(|(_, at)| at.parse().ok());
            stage_of_name.is_some_and(|at: usize| at != stage)
        };
        assert_eq!(nets.iter().find(other), None, "{scope}");
    }
    assert!(found.iter().any(|it| it.0.starts_with("core.control.valid")), "{found:?}");
}

/// Verilog in which red is multiplied as green should be, as far as the simulator knows.
#[cfg(all(unix, feature = "outside-tools"))]
#[test]
fn a_difference_in_verilog_is_told_with_its_place() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    let spoil = "/bin/sed -i 's/accumulator . red_reg;/accumulator * green_reg;/' core_datapath.v";
    dir.script(
        "tools/iverilog",
        &format!("{spoil}\nexec /usr/bin/env PATH=\"$SOUND\" iverilog \"$@\""),
    );
    dir.script("tools/vvp", "exec /usr/bin/env PATH=\"$SOUND\" vvp \"$@\"");
    let run = |json: &[&str]| {
        let mut command = dir.command();
        command.env("SOUND", std::env::var_os("PATH").unwrap());
        command.env("PATH", dir.at("tools"));
        command.args(["cosim", "core.toml", "--points", "9", "--simulator", "icarus"]);
        Run::of(command.args(json).output())
    };
    let value = run(&["--json"]).json();
    let one = &value["configurations"][0]["mismatch"];
    assert_eq!((&one["signal"], &one["seed"]), (&"red_out".into(), &1.into()), "{value}");
    assert_eq!(one["vcd"], "core_mismatch.vcd");
    assert_ne!(one["golden"], one["simulated"]);
    assert!(dir.read("core_mismatch.vcd").contains("red_out"));
    let (clock, during) = (&one["clock"], one["during"].text());
    let told = format!("FAILS: seed 1, clock {clock}, {during}: `red_out` is ");
    let text = run(&[]);
    assert_eq!(text.code, 1, "{text:?}");
    assert!(text.out.contains(&told), "{told}\n{}", text.out);
    let again = one["reproduce"].text();
    assert_eq!(again, "glint cosim core.toml --simulator icarus --seed 1 --points 9");
}

/// A job that is killed, resumed, and divided reports what an uninterrupted one does.
#[test]
fn an_exhaustive_check_in_parts_gives_the_whole() {
    // The operands of the one are too many for all combinations, those of the other few.
    let wide = "device = \"cosine-power\"\npower = 2\ndomain.exponent_max = 100\n";
    for text in [wide, include_str!("../../../configs/reduced/cosine_power.toml")] {
        in_parts(text);
    }
}

fn in_parts(text: &str) {
    let dir = Workspace::with("core.toml", text);
    let whole = dir.done(["cosim", "core.toml", "--exhaustive", "--json"]);
    let proof = ["cosim", "core.toml", "--exhaustive", "--json", "--resume"];

    let mut child = dir
        .command()
        .args(proof)
        .arg("state.json")
        .stdout(std::process::Stdio::null())
        .spawn()
        .expect("started");
    while !dir.at("state.json").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child.kill().expect("killed");
    child.wait().expect("ended");
    let resumed = dir.done(proof.iter().chain(&["state.json"]));
    assert_eq!(resumed, whole);
    // There is nothing left to do the second time.
    assert_eq!(dir.done(proof.iter().chain(&["state.json"])), whole);

    for shard in ["1/2", "2/2"] {
        let file = format!("part{}.json", &shard[..1]);
        dir.done(proof.iter().chain(&[file.as_str(), "--shard", shard]));
    }
    let merge = ["merge", "core.toml", "--json", "part2.json", "part1.json"];
    assert_eq!(dir.done(merge), whole);

    let refused = |arguments: &[&str]| {
        let run = dir.glint(arguments);
        assert_eq!(run.code, 1, "{run:?}");
        run.err
    };
    let error = refused(&["merge", "core.toml", "part2.json"]);
    assert!(error.contains("missing: shard 1/2"), "{error}");
    let error = refused(&["merge", "core.toml", "part2.json", "core.toml"]);
    assert!(error.contains("`core.toml` does not contain the state"), "{error}");
    let error = refused(&["cosim", "core.toml", "--exhaustive", "--resume", "part1.json"]);
    assert!(error.contains("belongs to another configuration, sweep or shard"), "{error}");
    // A bit that a disk has turned over.
    let part = dir.read("part1.json");
    let damaged = part.replacen("\"done\": ", "\"done\": 1", 1);
    assert_ne!(damaged, part);
    dir.write("part1.json", damaged);
    let error = refused(&["merge", "core.toml", "part1.json", "part2.json"]);
    assert!(error.contains("the checksum is wrong"), "{error}");
    dir.write("part1.json", part);
    dir.write("core.toml", "device = \"cosine-power\"\npower = 4\n");
    let error = refused(&["merge", "core.toml", "part1.json", "part2.json"]);
    assert!(error.contains("do not belong to `core.toml`"), "{error}");
    let error =
        refused(&["cosim", "core.toml", "--exhaustive", "--resume", "core.toml/state.json"]);
    assert!(error.contains("core.toml/state.json"), "{error}");
}

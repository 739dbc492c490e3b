//! Tests the files for vendors' tools: Tcl scripts with stand-ins for the tools' commands, IP-XACT against its schema and the
//! Verilog, FuseSoC's targets, and ROM contents inside the Verilog.

use std::fs;
use std::path::Path;

use crate::common::Sure;
use crate::common::cores::{Emitted, configuration_between, configuration_with};
use crate::common::files::{below, read, root};
use crate::common::sample::sampled_by_name;
use crate::common::tools::{
    LIMIT, assert_bench_passes, assert_files_are_clean, benched, ran, tool, yosys,
};
use glint::core::Core;
use glint::package::FileKind;
use glint::tools::VerilogSimulator;
use rayon::prelude::*;

const ALL: &str = "stream = true\nregisters = \"wishbone\"\n[package]\nconstraints = true\n\
                   vivado = true\nquartus = true\nip_xact = true\n";

const INLINE: &str = "\n[package]\nmemories = \"inline\"\n";

/// Returns the files in `rtl_out` of a configuration, in a directory.
fn emitted(core: &Core) -> tempfile::TempDir {
    Emitted::new(core, 1, 1).beside("rtl_out")
}

fn cosine_power() -> tempfile::TempDir {
    emitted(&configuration_between("configs/cosine_power.toml", ALL))
}

/// Returns the calls of a script, with the slack that Vivado's stand-in tells of, and whether it ends well. Paths are relative.
fn calls(dir: &Path, script: &str, arguments: &[&str], slack: &str) -> (bool, String) {
    let stubs = root().join("tests/tools/vendor/stubs.tcl");
    let (stubs, slack) = (stubs.display().to_string(), format!("SLACK={slack}"));
    let dir = dir.canonicalize().expect("a directory");
    let script = dir.join(script).display().to_string();
    let run_in = dir.join("run");
    fs::create_dir_all(&run_in).expect("a directory");
    let command = [slack.as_str(), "tclsh", &stubs, &script];
    let run = tool("env").run(command.iter().chain(arguments), &run_in, LIMIT).sure();
    let output = run.output.replace(&format!("{}/", dir.display()), "");
    (run.status.success(), output)
}

/// Plays a case of `calls.txt`.
fn play(case: &str) {
    let (heading, steps) = case.split_once('\n').expect("a heading");
    let (registers, _) = heading.split_once(':').expect("registers and a title");
    let keys = ALL.replace("wishbone", registers);
    let dir = emitted(&configuration_between("configs/cosine_power.toml", &keys));
    let here = dir.path().canonicalize().expect("a directory").display().to_string();
    let steps = steps.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
    let steps: Vec<&str> = steps.collect();
    let mut told = String::new();
    for (at, step) in steps.iter().enumerate() {
        let (what, text) = step.split_once(' ').expect("a step");
        let text = text.replace("\\n", "\n");
        match what {
            "0$" | "1$" => {
                let (slack, run) = match text.strip_prefix("slack=") {
                    Some(rest) => rest.split_once(" | ").expect("a script"),
                    None => ("", text.as_str()),
                };
                let words: Vec<&str> = run.split(" | ").collect();
                let (ok, calls) = calls(dir.path(), words[0], &words[1..], slack);
                told = calls.replace(&here, "PLACE");
                assert_eq!(ok, what == "0$", "{heading}: {step}\n{told}");
                let all: Vec<&str> =
                    steps[at + 1..].iter().map_while(|step| step.strip_prefix("= ")).collect();
                assert!(all.is_empty() || told.lines().eq(all), "{heading}: {step}\n{told}");
            }
            "=" => (),
            ">" => assert!(told.contains(&text), "{heading}: {step}\n{told}"),
            "x>" => assert!(!told.contains(&text), "{heading}: {step}\n{told}"),
            "-" => fs::remove_file(dir.path().join(text)).expect("removed"),
            _ => panic!("{heading}: {step}"),
        }
    }
}

#[test]
fn scripts_make_the_calls_that_are_stated() {
    let cases: Vec<&str> = include_str!("calls.txt").split("\n## ").skip(1).collect();
    cases.into_par_iter().for_each(play);
}

#[test]
fn components_follow_their_schema_and_the_verilog() {
    let axi_lite = ALL.replace("wishbone", "axi-lite");
    let stream = "stream = true\nuser_bits = 1\n[package]\nip_xact = true\n";
    [
        ("cosine_power", ALL, "axis wb"),
        ("cosine_power", &axi_lite, "axil"),
        ("quad_cosine", stream, "axis"),
        ("rough_pipelined", stream, "axis"),
    ]
    .into_par_iter()
    .for_each(|(name, keys, suffixes)| {
        let dir = emitted(&configuration_between(&format!("configs/{name}.toml"), keys));
        let suffixes = suffixes.split(' ').map(|suffix| format!("{name}_{suffix}"));
        let mut files = Vec::new();
        for top in suffixes.chain([name.to_owned()]) {
            let script = format!(
                "read_verilog {name}*.v; hierarchy -top {top}; proc; write_json {top}.ports"
            );
            yosys(dir.path(), &script);
            files.extend([format!("{top}.xml"), format!("{top}.ports")]);
        }
        let told = validate(dir.path(), &files);
        assert_eq!(told.sure().lines().count(), files.len() / 2);
        // The test can fail: an element that is missing, a port that is wider.
        for (right, wrong) in [
            ("<ipxact:library>ip</ipxact:library>", ""),
            ("<ipxact:left>7<", "<ipxact:left>8<"),
            ("</ipxact:ports>", "<ipxact:port/></ipxact:ports>"),
        ] {
            let path = dir.path().join(&files[0]);
            let text = read(&path);
            let faulty = text.replacen(right, wrong, 1);
            if faulty != text {
                fs::write(&path, faulty).expect("written");
                assert!(validate(dir.path(), &files[..2]).is_err(), "{right} {wrong}");
                fs::write(&path, text).expect("written");
            }
        }
    });
}

fn validate(dir: &Path, files: &[String]) -> anyhow::Result<String> {
    let script = root().join("tests/tools/vendor/ip_xact.py");
    let arguments = std::iter::once(script.display().to_string()).chain(files.iter().cloned());
    tool("python").run_to_success(arguments, dir, LIMIT)
}

#[test]
fn constraints_are_read_by_opensta() {
    let dir = cosine_power();
    let cells = "/usr/share/qflow/tech/osu018/osu018_stdcells.lib";
    for (top, clock) in [("cosine_power", "clk"), ("cosine_power_wb", "wb_clk_i")] {
        let synthesis = format!(
            "read_verilog cosine_power*.v; synth -flatten -top {top}; dfflibmap -liberty {cells}; \
             abc -liberty {cells}; splitnets; opt_clean -purge; \
             write_verilog -noattr -noexpr -simple-lhs netlist.v"
        );
        yosys_quietly(dir.path(), &synthesis);
        let script = format!(
            "read_liberty {cells}\nread_verilog netlist.v\nlink_design {top}\nread_sdc {top}.sdc\n\
             puts \"period [get_property [get_clocks {clock}] period]\"\nreport_checks -format end\nexit\n"
        );
        fs::write(dir.path().join("read.tcl"), script).expect("written");
        let told = ran("sta", ["-exit", "read.tcl"], dir.path());
        assert!(told.contains("period 10.000"), "{told}");
        let wrong = ["warning", "error"].iter().any(|word| told.to_lowercase().contains(word));
        assert!(!wrong, "{told}");
        // Paths from register to register are constrained.
        assert!(told.contains("/D (DFF"), "{told}");
    }
}

/// Yosys with its warnings, of which it has some about liberty files.
fn yosys_quietly(dir: &Path, commands: &str) {
    ran("yosys", ["-q", "-p", commands], dir);
}

#[test]
fn rom_contents_in_the_verilog_are_those_of_the_files() {
    let names = ["blinn", "quad_cosine", "rough", "threshold", "blinn_pipelined"];
    sampled_by_name("ROMs in the Verilog", names, |name| (*name).to_owned())
        .into_par_iter()
        .for_each(|name| {
            let path = format!("configs/{name}.toml");
            let core = configuration_with(&path, INLINE);
            let emitted = Emitted::new(&core, 300, 1);
            let rtl = emitted.rtl();
            assert!(emitted.files.of(&[FileKind::Memory]).is_empty());
            assert!(rtl.iter().all(|(_, text)| !text.contains("$readmem")));
            for (file, text) in &rtl {
                let long = text.lines().find(|line| line.len() > 100);
                assert_eq!(long, None, "{file}");
            }
            // The bench of the configuration with files, word for word.
            let with_files = Emitted::new(&configuration_with(&path, ""), 300, 1);
            let bench = with_files.files.sources(FileKind::BENCH_SOURCES);
            for simulator in [VerilogSimulator::Icarus, VerilogSimulator::Verilator] {
                let files: Vec<_> = rtl.iter().chain(&bench).cloned().collect();
                assert_bench_passes(simulator, &files, &with_files.bench());
            }
            assert_files_are_clean(&rtl, &emitted.name);
            // A wrong word is noticed.
            let wrong = wrong_word(&rtl);
            let files: Vec<_> = wrong.into_iter().chain(bench).collect();
            let outcome = benched(VerilogSimulator::Icarus, &files, &with_files.bench());
            assert!(!outcome.passed, "{name}");
        });
}

/// Returns the Verilog with all words of its first memory with a table inverted.
fn wrong_word(rtl: &[(String, String)]) -> Vec<(String, String)> {
    let inverted = |text: &str| {
        let line = |line: &str| {
            if line.contains("_rom[") && line.contains("'h") {
                line.replacen("'h", "'h0 | ~", 1).replace("~", "~'h")
            } else {
                line.to_owned()
            }
        };
        text.lines().map(|it| line(it) + "\n").collect::<String>()
    };
    rtl.iter().map(|(name, text)| (name.clone(), inverted(text))).collect()
}

#[test]
fn synthesis_makes_block_ram_of_rom_contents_in_the_verilog() {
    let cells = |more: &str| {
        let dir = emitted(&configuration_with("configs/rough.toml", more));
        let script = "read_verilog rough*.v; synth_ice40 -dsp -top rough; tee -o stat.txt stat";
        yosys(dir.path(), script);
        let figures = read(dir.path().join("stat.txt"));
        // Small ROMs are logic, which comes out a little different where names do.
        let same = |line: &&str| ["SB_RAM", "SB_MAC", "SB_DFF"].iter().any(|it| line.contains(it));
        figures.lines().filter(same).collect::<Vec<_>>().join("\n")
    };
    let (files, inline) = (cells(""), cells(INLINE));
    assert!(files.contains("SB_RAM40_4K") && files.contains("SB_DFF"), "{files}");
    assert_eq!(files, inline);
}

#[test]
fn fusesoc_sets_up_the_vendors_projects() {
    let dir = tempfile::tempdir().expect("a directory");
    let [rtl, benches] =
        ["rtl_out", "testbench"].map(|name| root().join(name).display().to_string());
    let run = |arguments: &[&str]| {
        let common = ["--cores-root", &rtl, "--cores-root", &benches, "run"];
        let core = ["glint:device:cosine_power"];
        let all = common.iter().chain(arguments).chain(&core);
        ran("fusesoc", all, dir.path())
    };
    let text_below = |target: &str, ending: &str| {
        let files = below(&dir.path().join("build")).into_iter();
        let names = files.map(|path| path.display().to_string());
        let names = names.filter(|name| name.contains(target) && name.ends_with(ending));
        let found: String = names.map(read).collect();
        assert!(!found.is_empty(), "{target}: no {ending}");
        found
    };
    run(&["--setup", "--target", "vivado"]);
    let project = text_below("vivado", ".tcl");
    assert!(
        project.contains("cosine_power.xdc") && project.contains("xc7a35tcsg324-1"),
        "{project}"
    );
    run(&["--setup", "--target", "quartus"]);
    let project = text_below("quartus", ".tcl");
    assert!(project.contains("cosine_power.sdc") && project.contains("5CEBA4F23C7"), "{project}");
    // As far as synthesis: not everybody has the rest.
    for (target, cell) in [("ecp5", "TRELLIS_FF"), ("gowin", "\"DFF")] {
        run(&["--setup", "--target", target]);
        let core = "glint_device_cosine_power_0.1.0";
        let directory = dir.path().join("build").join(core).join(target);
        let netlist = format!("{core}.json");
        ran("make", [&netlist], &directory);
        assert!(text_below(&format!("/{target}/"), ".json").contains(cell), "{target}");
    }
    // The clock of the constraints, which this core does not reach there, without an end before the bitstream.
    let rules = text_below("/ecp5/", "Makefile");
    assert!(rules.contains("--freq=100 --timing-allow-fail"), "{rules}");
}

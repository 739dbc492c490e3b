//! The files for vendors' tools: Tcl against stand-ins for their commands, IP-XACT against its schema and the
//! Verilog, FuseSoC's targets, and ROM contents in the Verilog.

use std::fs;
use std::path::Path;

use crate::common::Sure;
use crate::common::cores::{Emitted, configuration_between, configuration_with, write};
use crate::common::sample::sampled;
use crate::common::tools::{LIMIT, assert_bench_passes, assert_lint_clean, ran, tool, yosys};
use glint::core::Core;
use glint::tools::Simulator;
use rayon::prelude::*;

/// Configurations with ROM contents in the Verilog that the test runs by default.
const SAMPLE: usize = 2;

const ALL: &str = "stream = true\nregisters = \"wishbone\"\n[package]\nconstraints = true\n\
                   vivado = true\nquartus = true\nip_xact = true\n";

const INLINE: &str = "\n[package]\nmemories = \"inline\"\n";

/// The files in `rtl_out` of a configuration, in a directory.
fn emitted(core: &Core) -> tempfile::TempDir {
    Emitted::new(core, 1, 1).beside("rtl_out/")
}

fn cosine_power() -> tempfile::TempDir {
    emitted(&configuration_between("configs/cosine_power.toml", ALL))
}

/// Returns the calls of a script, with the slack that Vivado's stand-in tells of, and whether it ends well. Paths are relative.
fn calls(dir: &Path, script: &str, arguments: &[&str], slack: &str) -> (bool, String) {
    let stubs = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tools/vendor/stubs.tcl");
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

#[test]
fn vivado_builds_a_module() {
    let dir = cosine_power();
    let arguments = ["cosine_power_axis", "xc7k70tfbg484-1"];
    let (ok, calls_made) = calls(dir.path(), "cosine_power_vivado.tcl", &arguments, "0.25");
    assert!(ok, "{calls_made}");
    let expected = "\
read_verilog cosine_power_axis.v
read_verilog cosine_power.v
read_verilog cosine_power_control.v
read_verilog cosine_power_datapath.v
read_mem cosine_power_control.mem
read_xdc -mode out_of_context cosine_power_axis.xdc
synth_design -top cosine_power_axis -part xc7k70tfbg484-1 -mode out_of_context
opt_design
place_design
phys_opt_design
route_design
write_checkpoint run/cosine_power_axis_vivado/cosine_power_axis.dcp
report_utilization -file run/cosine_power_axis_vivado/utilization.txt
report_timing_summary -file run/cosine_power_axis_vivado/timing.txt
get_timing_paths -delay_type max
get_property SLACK path0
cosine_power_axis on xc7k70tfbg484-1: slack 0.25 ns
";
    assert_eq!(calls_made, expected);
}

#[test]
fn vivado_fails_where_it_should() {
    let dir = cosine_power();
    let script = "cosine_power_vivado.tcl";
    let (ok, told) = calls(dir.path(), script, &["cosine"], "1");
    assert!(!ok && told.contains("there is no module cosine; there are: cosine_power, "), "{told}");
    for (slack, module) in [("-0.1", "cosine_power"), ("", "cosine_power_wb")] {
        let (ok, told) = calls(dir.path(), script, &[module], slack);
        assert!(!ok && told.contains(&format!("the clock of {module}.xdc is not met")), "{told}");
    }
    // What a run left, or anything else of that name, is not written over.
    let (ok, told) = calls(dir.path(), script, &[], "1");
    assert!(!ok && told.contains("run/cosine_power_vivado is there already"), "{told}");
    assert!(!told.contains("synth_design"), "{told}");
    // A source that is missing.
    fs::remove_file(dir.path().join("cosine_power_control.mem")).expect("removed");
    let (ok, told) = calls(dir.path(), script, &["cosine_power_axis"], "1");
    assert!(!ok && told.contains("there is no "), "{told}");
}

#[test]
fn vivado_packages_ip() {
    let dir = cosine_power();
    let script = "cosine_power_vivado_ip.tcl";
    let (ok, told) = calls(dir.path(), script, &["cosine_power_axis"], "");
    assert!(ok, "{told}");
    for call in [
        "add_files -norecurse cosine_power_control.mem\n",
        "set_property top cosine_power_axis sources_1\n",
        "ipx::package_project -root_dir run/cosine_power_axis_ip/ip -vendor glint -library ip \
         -taxonomy /UserIP -import_files\n",
        "set_property version 0.1 core0\n",
        "ipx::infer_bus_interface aclk xilinx.com:signal:clock_rtl:1.0 core0\n",
        "ipx::infer_bus_interface aresetn xilinx.com:signal:reset_rtl:1.0 core0\n",
        "set_property value ACTIVE_LOW parameter0\n",
        "ipx::associate_bus_interfaces -busif s_axis -clock aclk core0\n",
        "ipx::associate_bus_interfaces -busif m_axis -clock aclk core0\n",
        "ipx::associate_bus_interfaces -clock aclk -reset aresetn core0\n",
    ] {
        assert!(told.contains(call), "{call}{told}");
    }
    assert!(told.ends_with("ipx::save_core core0\nclose_project\n"), "{told}");
    assert!(!told.contains("interrupt"), "{told}");
    let (ok, told) = calls(dir.path(), script, &["cosine_power_wb"], "");
    assert!(ok && told.contains("set_property value ACTIVE_HIGH parameter0\n"), "{told}");
    for call in [
        "ipx::infer_bus_interface irq xilinx.com:signal:interrupt_rtl:1.0 core0\n",
        "set_property value LEVEL_HIGH parameter0\n",
    ] {
        assert!(told.contains(call), "{call}{told}");
    }
    assert!(
        told.contains("infer_bus_interface wb_clk_i xilinx.com:signal:clock_rtl:1.0"),
        "{told}"
    );
}

#[test]
fn quartus_builds_a_module() {
    let dir = cosine_power();
    let script = "cosine_power_quartus.tcl";
    let arguments = ["cosine_power_wb", "Cyclone 10 LP", "10CL025YU256C8G"];
    let (ok, told) = calls(dir.path(), script, &arguments, "");
    assert!(ok, "{told}");
    let expected = "\
project_new cosine_power_wb
set_global_assignment -name FAMILY {Cyclone 10 LP}
set_global_assignment -name DEVICE 10CL025YU256C8G
set_global_assignment -name TOP_LEVEL_ENTITY cosine_power_wb
set_global_assignment -name VERILOG_INPUT_VERSION VERILOG_2001
set_global_assignment -name VERILOG_FILE cosine_power_wb.v
set_global_assignment -name VERILOG_FILE cosine_power_registers.v
set_global_assignment -name VERILOG_FILE cosine_power.v
set_global_assignment -name VERILOG_FILE cosine_power_control.v
set_global_assignment -name VERILOG_FILE cosine_power_datapath.v
set_global_assignment -name SEARCH_PATH PLACE
set_global_assignment -name SDC_FILE cosine_power_wb.sdc
set_instance_assignment -name VIRTUAL_PIN ON -to *
set_instance_assignment -name VIRTUAL_PIN OFF -to wb_clk_i
export_assignments
execute_flow -compile
project_close
";
    let here = dir.path().canonicalize().expect("a directory").display().to_string();
    assert_eq!(told.replace(&here, "PLACE"), expected);
    let (ok, told) = calls(dir.path(), script, &arguments, "");
    assert!(!ok && told.contains("cosine_power_wb_quartus is there already"), "{told}");
}

#[test]
fn platform_designer_gets_interfaces() {
    let registers = ALL.replace("wishbone", "axi-lite");
    let dir = emitted(&configuration_between("configs/cosine_power.toml", &registers));
    let of_top = |top: &str| {
        let (ok, told) = calls(dir.path(), &format!("{top}_hw.tcl"), &[], "");
        assert!(ok, "{told}");
        told
    };
    let told = of_top("cosine_power_axil");
    for call in [
        "set_module_property VERSION 0.1.0\n",
        "add_fileset synthesis QUARTUS_SYNTH\n",
        "add_fileset_file cosine_power_axil.v VERILOG PATH cosine_power_axil.v TOP_LEVEL_FILE\n",
        "add_fileset_file cosine_power_control.mem OTHER PATH cosine_power_control.mem\n",
        "add_interface_port reset aresetn reset_n Input 1\n",
        "add_interface s_axil axi4lite end\n",
        "add_interface_port s_axil s_axil_wdata wdata Input 32\n",
        "add_interface_port s_axil s_axil_rvalid rvalid Output 1\n",
        "add_interface_port irq irq irq Output 1\n",
    ] {
        assert!(told.contains(call), "{call}{told}");
    }
    let told = of_top("cosine_power_axis");
    assert!(told.contains("add_interface s_axis axi4stream end\n"), "{told}");
    assert!(told.contains("add_interface m_axis axi4stream start\n"), "{told}");
    // Nine operands and results as bytes: 3 + 2 + 3 in, 3 out.
    assert!(told.contains("add_interface_port s_axis s_axis_tdata tdata Input 64\n"), "{told}");
    assert!(told.contains("add_interface_port m_axis m_axis_tdata tdata Output 24\n"), "{told}");
    let told = of_top("cosine_power");
    assert!(told.contains("add_interface_port signals cos_gamma cos_gamma Input 21\n"), "{told}");
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
            let text = fs::read_to_string(&path).expect("a component");
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
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tools/vendor/ip_xact.py");
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
    sampled("ROMs in the Verilog", names, SAMPLE).into_par_iter().for_each(|name| {
        let path = format!("configs/{name}.toml");
        let core = configuration_with(&path, INLINE);
        let emitted = Emitted::new(&core, 300, 1);
        let rtl = emitted.rtl();
        assert!(rtl.iter().all(|(name, text)| name.ends_with(".v") && !text.contains("$readmem")));
        for (file, text) in &rtl {
            let long = text.lines().find(|line| line.len() > 100);
            assert_eq!(long, None, "{file}");
        }
        // The bench of the configuration with files, word for word.
        let with_files = Emitted::new(&configuration_with(&path, ""), 300, 1);
        let mut bench = with_files.simulated();
        bench.retain(|(name, _)| with_files.rtl().iter().all(|(other, _)| other != name));
        for simulator in [Simulator::Icarus, Simulator::Verilator] {
            let files: Vec<_> = rtl.iter().chain(&bench).cloned().collect();
            assert_bench_passes(simulator, &files, &with_files.bench());
        }
        let dir = tempfile::tempdir().expect("a directory");
        write(dir.path(), &rtl);
        assert_lint_clean(dir.path(), &emitted.name);
        // A wrong word is noticed.
        let wrong = wrong_word(&rtl);
        let files: Vec<_> = wrong.into_iter().chain(bench).collect();
        let limit = LIMIT;
        let outcome =
            glint::tools::run_bench(Simulator::Icarus, &files, &with_files.bench(), limit);
        assert!(!outcome.expect("it runs").passed, "{name}");
    });
}

/// The Verilog with all words of its first memory with a table inverted.
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
        let figures = fs::read_to_string(dir.path().join("stat.txt")).expect("figures");
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
    let root = env!("CARGO_MANIFEST_DIR");
    let (rtl, benches) = (format!("{root}/rtl_out"), format!("{root}/testbench"));
    let run = |arguments: &[&str]| {
        let common = ["--cores-root", &rtl, "--cores-root", &benches, "run"];
        let core = ["glint:device:cosine_power"];
        let all = common.iter().chain(arguments).chain(&core);
        ran("fusesoc", all, dir.path())
    };
    let text_below = |target: &str, ending: &str| {
        let mut found = String::new();
        let mut directories = vec![dir.path().join("build")];
        while let Some(directory) = directories.pop() {
            for entry in fs::read_dir(directory).expect("a directory") {
                let path = entry.expect("an entry").path();
                let name = path.display().to_string();
                if path.is_dir() {
                    directories.push(path);
                } else if name.contains(target) && name.ends_with(ending) {
                    found += &fs::read_to_string(path).expect("text");
                }
            }
        }
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

//! Tests the wrappers around cores, for streams and for buses: their Verilog has no lint warnings, their properties are proved,
//! and they work with bus models that Glint did not write.

mod planted;
mod processors;

use std::fs;

use crate::common::Sure;
use crate::common::cores::{Emitted, all_configurations, configuration_between, parsed};
use crate::common::files::read;
use crate::common::tools::{LIMIT, assert_bench_passes, assert_lint_clean, ran, tool};
use crate::faults::{Fault, faults};
use glint::core::Core;
use glint::package::FileKind;
use glint::tools::{VerilogSimulator, prove};
use rayon::prelude::*;

/// Bits of tuser in these tests.
const STREAM: &str = "stream = true\nuser_bits = 9\n";

/// A stream around a core whose operands have buffers.
const BUFFERED: &str = "stream = true\nuser_bits = 9\n[operands]\nbuffered = true\n";

/// Streams as DMA engines want them.
const PADDED: &str = "stream = true\nuser_bits = 9\ndata_width = \"power-of-two\"\nkeep = true\n";

/// Configurations of which the wrapper is proved: a core of each kind that a wrapper knows.
const PROVED: [(&str, &str); 8] = [
    ("cosine_power", STREAM),
    ("quad_cosine", STREAM),
    ("cosine_power_pipelined", STREAM),
    ("cosine_power", BUFFERED),
    ("quad_cosine", BUFFERED),
    ("cosine_power", PADDED),
    ("quad_cosine", PADDED),
    ("cosine_power_pipelined", PADDED),
];

/// Returns every configuration with these keys in its table `interface`, and pipelines that take a point every few clocks; some as
/// DMA engines want them.
fn with_streams() -> Vec<(String, Core)> {
    let padded =
        ["cosine_power", "quad_cosine", "cosine_power_pipelined", "function"].map(|name| {
            let path = format!("configs/{name}.toml");
            let core = configuration_between(&path, PADDED);
            (path, core)
        });
    with_interface(STREAM).into_iter().chain(padded).collect()
}

fn with_interface(keys: &str) -> Vec<(String, Core)> {
    let with = |(path, _): (String, Core)| {
        let core = configuration_between(&path, keys);
        (path, core)
    };
    let own = all_configurations().into_iter().map(with);
    own.chain([2, 4].map(|clocks| (format!("every {clocks} clocks"), slower(clocks, keys))))
        .collect()
}

/// Returns a pipeline that takes a point every so many clocks, with these keys in its table `interface`.
fn slower(clocks: u32, keys: &str) -> Core {
    let text = read("configs/cosine_power_pipelined.toml");
    let own = text.split("\n[interface]\n").next().expect("its keys");
    let interval = format!("[pipeline]\ninterval = {clocks}\n");
    let own = own.replacen("[pipeline]\n", &interval, 1);
    parsed("configs/cosine_power_pipelined.toml", &format!("{own}\n[interface]\n{keys}"))
}

#[test]
fn streams_are_clean_verilog() {
    with_streams().par_iter().for_each(|(path, core)| {
        let emitted = Emitted::new(core, 1, 1);
        let dir = emitted.beside("rtl_out");
        assert_lint_clean(dir.path(), &format!("{}_axis", emitted.name));
        let kinds = [FileKind::StreamWrapper, FileKind::WrapperProof, FileKind::Bench];
        for file in emitted.files.of(&kinds) {
            let long = file.contents.lines().find(|line| line.len() > 100);
            assert_eq!(long, None, "{path}: {}", file.path);
        }
    });
}

#[test]
fn streams_are_proved() {
    PROVED.par_iter().for_each(|(name, keys)| {
        let dir = proof(name, keys);
        prove(dir.path(), &format!("{name}_axis_formal.sv"), LIMIT)
            .sure_of(format_args!("{name}, {keys}"));
    });
    for clocks in [2, 4] {
        let dir = Emitted::new(&slower(clocks, STREAM), 1, 1).all_beside();
        prove(dir.path(), "cosine_power_pipelined_axis_formal.sv", LIMIT)
            .sure_of(format_args!("every {clocks} clocks"));
    }
}

#[test]
fn faults_break_the_proofs() {
    for (heading, keys) in [("streams", STREAM), ("buffered streams", BUFFERED)] {
        faults(heading)
            .par_iter()
            .for_each(|fault| breaks_the_proof(fault, &fault.of, keys, "axis"));
    }
}

fn breaks_the_proof(fault: &Fault, name: &str, keys: &str, wrapper: &str) {
    let module = format!("{name}_{wrapper}");
    fault.assert_breaks(proof(name, keys).path(), &module, &format!("{module}.v"));
}

/// Returns the wrapper of a configuration, and what is proved of it, in a directory of their own.
fn proof(name: &str, keys: &str) -> tempfile::TempDir {
    let core = configuration_between(&format!("configs/{name}.toml"), keys);
    Emitted::new(&core, 1, 1).all_beside()
}

/// Source and sink of cocotbext-axi.
#[test]
fn streams_carry_every_point() {
    with_streams().par_iter().for_each(|(path, core)| {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/tools/wrappers/stream.py");
        assert_all_pass(path, core, &[script, &core.config().name], 6);
    });
}

/// Asserts that a script in Python passes so many tests in the directory of a core.
fn assert_all_pass(path: &str, core: &Core, arguments: &[&str], tests: usize) {
    let dir = Emitted::new(core, 1, 1).tree();
    let run = tool("python").run(arguments, dir.path(), LIMIT).sure();
    let says = format!("PASS {}: {tests} tests, 0 failed", core.config().name);
    assert!(run.status.success() && run.output.contains(&says), "{path}:\n{}", run.output);
}

/// The benches that go with streams as DMA engines want them.
#[test]
fn shipped_benches_pass_on_padded_streams() {
    ["cosine_power", "quad_cosine", "cosine_power_pipelined"].par_iter().for_each(|name| {
        let core = configuration_between(&format!("configs/{name}.toml"), PADDED);
        let emitted = Emitted::new(&core, 200, 1);
        for simulator in [VerilogSimulator::Icarus, VerilogSimulator::Verilator] {
            assert_bench_passes(simulator, &emitted.simulated(), &format!("{name}_axis_tb"));
        }
        let dir = emitted.tree();
        let script = format!("testbench/{name}/test_{name}_axis.py");
        ran("python", [script], dir.path());
    });
}

/// Buses, each with the key and what its wrapper is called after.
const BUSES: [(&str, &str); 2] =
    [("registers = \"axi-lite\"\n", "axil"), ("registers = \"wishbone\"\n", "wb")];

/// Pipelines that registers start: one that takes a point every clock, and one that takes a point every few clocks.
const STARTED_PIPELINES: [&str; 2] = ["cosine_power_pipelined", "lyon_up5k_pipelined"];

/// Returns every default configuration of a core that computes a point at a time by a microprogram, and some pipelines, on each bus.
fn on_buses() -> Vec<(String, Core, &'static str)> {
    let points = |core: &Core| core.design.pipeline.is_none() && core.contract.length().is_none();
    let mut paths: Vec<String> = all_configurations()
        .into_iter()
        .filter(|(path, core)| points(core) && !path.contains("studies"))
        .map(|(path, _)| path)
        .collect();
    paths.extend(STARTED_PIPELINES.map(|name| format!("configs/{name}.toml")));
    let of_bus = |(keys, bus): (&str, &'static str)| {
        let of_path = |path: &String| (path.clone(), configuration_between(path, keys), bus);
        paths.iter().map(of_path).collect::<Vec<_>>()
    };
    BUSES.into_iter().flat_map(of_bus).collect()
}

#[test]
fn registers_are_clean_verilog() {
    on_buses().par_iter().for_each(|(path, core, bus)| {
        let emitted = Emitted::new(core, 1, 1);
        let dir = emitted.beside("rtl_out");
        assert_lint_clean(dir.path(), &format!("{}_{bus}", emitted.name));
        let kinds =
            [FileKind::BusWrapper, FileKind::WrapperProof, FileKind::Bench, FileKind::Software];
        for file in emitted.files.of(&kinds) {
            assert!(file.contents.is_ascii(), "{path}: {} is not ASCII", file.path);
            let long = file.contents.lines().find(|line| line.len() > 120);
            assert_eq!(long, None, "{path}: {}", file.path);
        }
    });
}

#[test]
fn registers_are_proved() {
    // Operands of more than 32 bits, and results that fill several registers, too.
    let proved = ["cosine_power", "lyon", "blinn", "rough"];
    proved.iter().chain(&STARTED_PIPELINES).par_bridge().for_each(|name| {
        for (keys, bus) in BUSES {
            let one_point = format!("{keys}queue = 1\n");
            let is_pipeline = STARTED_PIPELINES.contains(name);
            let kinds: &[(&str, Option<&str>)] = match is_pipeline {
                true => &[(keys, Some("queue")), (&one_point, Some("single"))],
                false => &[(keys, None)],
            };
            for (keys, around) in kinds {
                let dir = proof(name, keys);
                for wrapper in [bus, "registers"].into_iter().chain(*around) {
                    prove(dir.path(), &format!("{name}_{wrapper}_formal.sv"), LIMIT)
                        .sure_of(format_args!("{name}_{wrapper}"));
                }
            }
        }
    });
}

#[test]
fn faults_break_the_proofs_of_registers() {
    let all = [faults("registers"), faults("buses")].concat();
    all.par_iter().for_each(|fault| {
        // The registers are the same behind either bus.
        let bus = BUSES.into_iter().find(|(_, bus)| *bus == fault.of).unwrap_or(BUSES[0]);
        breaks_the_proof(fault, "cosine_power", bus.0, &fault.of);
    });
    for (heading, queue) in
        [("pipelines behind registers", "queue = 1\n"), ("queues behind registers", "queue = 4\n")]
    {
        let keys = format!("{}{queue}", BUSES[0].0);
        faults(heading).par_iter().for_each(|fault| {
            breaks_the_proof(fault, "cosine_power_pipelined", &keys, &fault.of);
        });
    }
}

/// A pipeline that cannot stall, and one with a side channel: the proof and the bench pass.
#[test]
fn registers_start_pipelines_of_every_kind() {
    for keys in
        ["stall = \"none\"", "stall = \"none\"\ninterval = 3", "side = 8", "side = 8\ninterval = 2"]
    {
        for (queue, around) in [(1, "single"), (2, "queue"), (8, "queue")] {
            let text = format!(
                "device = \"expression\"\nname = \"lerp\"\narchitecture = \"pipelined\"\n\
                 operands.a = {{ bits = 30, fraction = 20, signed = true }}\n\
                 operands.b = {{ bits = 6, fraction = 5 }}\n\
                 results.r = {{ formula = \"a * b\", fraction = 20 }}\n\
                 results.is_more = {{ formula = \"if(a > b, 1, 0)\", fraction = 0 }}\n\
                 interface.registers = \"wishbone\"\ninterface.queue = {queue}\n[pipeline]\n{keys}\n"
            );
            let emitted = Emitted::new(&parsed("lerp.toml", &text), 40, 1);
            assert_bench_passes(VerilogSimulator::Icarus, &emitted.simulated(), "lerp_wb_tb");
            let dir = emitted.all_beside();
            for wrapper in [around, "registers"] {
                prove(dir.path(), &format!("lerp_{wrapper}_formal.sv"), LIMIT).sure_of(keys);
            }
        }
    }
}

/// The masters of cocotbext-axi and cocotbext-wishbone.
#[test]
fn registers_start_cores_and_give_their_results() {
    on_buses().par_iter().for_each(|(path, core, bus)| {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/tools/wrappers/registers.py");
        assert_all_pass(path, core, &[script, &core.config().name, bus], 9);
    });
}

/// Operands whose last bit weighs 2, 4 and 2^40.
const COARSE: &str = "device = \"expression\"
name = \"coarse\"
operands.a = { bits = 6, fraction = -2 }
operands.b = { bits = 6, fraction = -40, signed = true }
operands.c = { bits = 8, fraction = -1, signed = true }
results.r = { formula = \"a / 4 + b / 2^40 + c / 2\", fraction = 0 }
package.software = true
package.systemverilog = true
package.vhdl = true
";

/// The conversions of the C header and of the Rust module, with a call written as in both languages: a value, its fraction bits
/// and the raw operand, by hand.
const COARSE_CONVERSIONS: [(&str, i64, i32, i64); 16] = [
    ("a", 100, 0, 25),
    ("a", 2, 0, 1),
    ("a", 1, 0, 0),
    ("a", 100 << 20, 20, 25),
    ("a", 1000, 0, 63),
    ("a", -4, 0, 0),
    ("a", 5, -2, 5),
    ("a", 5, -3, 10),
    ("b", 3 << 40, 0, 3),
    ("b", -(3 << 40), 0, -3),
    ("b", i64::MAX, 30, 0),
    ("b", 1, -62, 31),
    ("b", -1, -62, -32),
    ("c", -3, 0, -1),
    ("c", 1, -110, 127),
    ("c", 0, -110, 0),
];

#[test]
fn conversions_of_operands_with_coarse_units() {
    for bus in ["axi-lite", "wishbone"] {
        let core = parsed("core.toml", &format!("{COARSE}interface.registers = \"{bus}\"\n"));
        let dir = Emitted::new(&core, 1, 1).tree();
        let dir = &dir.path().join("software/coarse");
        let mut c = String::from("#include \"coarse_registers.h\"\nint main(void)\n{\n");
        let mut rust = String::from(
            "#[path = \"coarse_registers.rs\"]\n#[allow(dead_code)]\nmod registers;\nfn main() {\n",
        );
        for (at, (operand, value, fraction, raw)) in COARSE_CONVERSIONS.iter().enumerate() {
            let raw = *raw as i32 as u32;
            let place = at + 1;
            c += &format!(
                "    if (coarse_{operand}_from_fixed(INT64_C({value}), {fraction}) != {raw}u) return {place};\n"
            );
            rust += &format!(
                "    assert_eq!(registers::{operand}_from_fixed({value}, {fraction}), {raw}, \"{place}\");\n"
            );
        }
        c += "    return COARSE_A_FRACTION == -2 ? 0 : 99;\n}\n";
        rust += "}\n";
        fs::write(dir.join("main.c"), c).expect("written");
        fs::write(dir.join("main.rs"), rust).expect("written");
        let strict = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];
        let sanitized = ["-fsanitize=undefined", "-fno-sanitize-recover", "main.c", "-o", "main_c"];
        ran("cc", [&strict[..], &sanitized].concat(), dir);
        ran("rustc", ["--edition=2021", "main.rs", "-o", "main_rs"], dir);
        for program in ["./main_c", "./main_rs"] {
            ran("sh", ["-c", program], dir);
        }
    }
}

/// Checks of the header's conversions, by hand: 1.0; a tie, upward; one below a tie; negative; too large.
const CONVERSIONS: &str = include_str!("conversions.c");

/// Checks of the Rust module's conversions.
const RUST_CONVERSIONS: &str = r#"
#![deny(warnings)]
#[path = "cosine_power_registers.rs"]
mod registers;
use registers::{cos_gamma_from_fixed, exponent_from_fixed};
fn main() {
    assert_eq!(cos_gamma_from_fixed(1 << 30, 30), 1 << 20);
    assert_eq!(cos_gamma_from_fixed(3, 21), 2);
    assert_eq!(cos_gamma_from_fixed(5, 22), 1);
    assert_eq!(cos_gamma_from_fixed(-1, 2), 0);
    assert_eq!(cos_gamma_from_fixed(i64::MAX, 0), 0x1fffff);
    assert_eq!(exponent_from_fixed(1024 << 20, 20), 1023);
    assert_eq!((registers::REG_RESULTS, registers::RESULTS_BLUE_OUT_SHIFT), (0x34, 16));
}
"#;

#[test]
fn registers_for_software() {
    let core = configuration_between("configs/cosine_power.toml", BUSES[1].0);
    let dir = Emitted::new(&core, 1, 1).tree();
    let dir = &dir.path().join("software/cosine_power");
    fs::write(dir.join("main.c"), CONVERSIONS).expect("written");
    fs::write(dir.join("main.rs"), RUST_CONVERSIONS).expect("written");
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];
    let sanitized = ["-fsanitize=undefined", "-fno-sanitize-recover", "main.c", "-o", "main_c"];
    let run = |name: &str, arguments: &[&str]| ran(name, arguments, dir);
    run("cc", &[&strict[..], &sanitized].concat());
    run("rustc", &["--edition=2021", "main.rs", "-o", "main_rs"]);
    for program in ["./main_c", "./main_rs"] {
        run("sh", &["-c", program]);
    }
    // Nothing of `std` is used.
    let bare = "#![no_std]\n#[path = \"cosine_power_registers.rs\"]\npub mod registers;\n";
    fs::write(dir.join("bare.rs"), bare).expect("written");
    run("rustc", &["--edition=2021", "--crate-type=lib", "--emit=metadata", "bare.rs"]);
    // PeakRDL puts every register where Glint does.
    let made = [("c-header", "peak.h"), ("ip-xact", "peak.xml"), ("html", "peak")];
    for (kind, to) in made {
        run("peakrdl", &[kind, "cosine_power.rdl", "-o", to]);
    }
    let xml = read(dir.join("peak.xml"));
    for (register, offset) in [("control", "'h14"), ("cos_gamma", "'h20"), ("results", "'h34")] {
        let says = format!("<ipxact:name>{register}</ipxact:name>");
        let at = xml.find(&says).unwrap_or_else(|| panic!("no {register} in {xml}"));
        let offset = format!("<ipxact:addressOffset>{offset}</ipxact:addressOffset>");
        assert!(xml[at..].contains(&offset), "{register}: {xml}");
    }
    assert!(dir.join("peak/index.html").exists());
}

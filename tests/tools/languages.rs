//! Tests the files of a core in other languages: the VHDL entity, the types of SystemVerilog, and transfers in C and Python.
//! For some tests, `tests/kinds.toml` says which of the five cores a run takes.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use glint::core::Core;
use glint::fixed::Format;
use glint::hdl::netlist::{Design, Role};
use glint::package::FileKind;
use glint::tools::VerilogSimulator;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rayon::prelude::*;
use serde_json::Value;

use crate::common::cores::{Emitted, configuration_between, parsed};
use crate::common::files::{json, read};
use crate::common::json::Json;
use crate::common::sample::sampled_by_name;
use crate::common::tools::{benched, ran, yosys};

/// Numbers with a sign, of more than 32 bits, and of one; both architectures; all wrappers.
const CORES: [(&str, &str); 5] = [
    ("cosine_power", "stream = true\nregisters = \"wishbone\"\n"),
    ("quad_cosine", "stream = true\ndata_width = \"power-of-two\"\nkeep = true\n"),
    ("lyon_pipelined", "stream = true\nkeep = true\n"),
    ("rough", "stream = true\nregisters = \"axi-lite\"\n"),
    ("function", "stream = true\ndata_width = \"power-of-two\"\n"),
];

const PACKAGE: &str = "[package]\nvhdl = true\nsystemverilog = true\nmemories = \"inline\"\n";

fn cores() -> impl ParallelIterator<Item = (String, Core)> {
    of_cores(CORES.to_vec())
}

/// Returns the cores that a run takes for a kind of check.
fn some_cores(kind: &str) -> impl ParallelIterator<Item = (String, Core)> + use<> {
    of_cores(sampled_by_name(kind, CORES, |(name, _)| (*name).to_owned()))
}

fn of_cores(
    cores: Vec<(&'static str, &'static str)>,
) -> impl ParallelIterator<Item = (String, Core)> {
    cores.into_par_iter().map(|(name, interface)| {
        let core = configuration_between(
            &format!("configs/{name}.toml"),
            &format!("{interface}{PACKAGE}"),
        );
        (core.config().name.clone(), core)
    })
}

/// The shipped bench, with the entity between it and the core: GHDL makes Verilog of it.
#[test]
fn the_entity_in_vhdl_is_the_core() {
    cores().for_each(|(name, core)| {
        let emitted = Emitted::new(&core, 100, 1);
        let dir = emitted.beside("rtl_out");
        let top = format!("{name}_fixed");
        ran("ghdl", ["-a", "--std=08", &format!("{name}.vhd")], dir.path());
        let made = ran("ghdl", ["synth", "--std=08", "--out=verilog", &top], dir.path());
        // Of the component GHDL makes a module without contents.
        let (stand_in, entity) = made.split_once("endmodule\n").expect("two modules");
        assert!(stand_in.contains(&format!("module {name}\n")), "{stand_in}");
        let entity = entity.split("module ").nth(1).expect("the entity");
        let entity = entity.split_inclusive("endmodule\n").next().expect("its end");
        let mut files = emitted.simulated();
        let bench = emitted.files.of(&[FileKind::Bench])[0].name();
        for (file, text) in &mut files {
            if file == bench {
                let through = text.replace("dut.", "dut.core.");
                let through = through.replace(&format!("{name} dut"), &format!("{top} dut"));
                assert!(through.contains(&format!("{top} dut")), "{through}");
                *text = through;
            }
        }
        files.push((format!("{top}.v"), format!("module {entity}")));
        let outcome = benched(VerilogSimulator::Icarus, &files, &emitted.bench());
        assert!(outcome.passed, "{name}:\n{}\n{}", outcome.build, outcome.transcript);
    });
}

/// Names that VHDL takes as extended identifiers alone.
#[test]
fn names_that_vhdl_reserves_are_analysed() {
    for name in [
        "entity",
        "out__put",
        "Upper",
        "ends_",
        "std_logic",
        "work",
        "to_real",
        "natural",
        "START",
        "Core",
        "Wrapped",
        "red_out_bits",
        "clk_",
    ] {
        let text = format!(
            "device = \"schlick\"\nname = \"{name}\"\n[interface]\nstream = true\n[package]\nvhdl = true\n"
        );
        let dir = Emitted::new(&parsed("core.toml", &text), 1, 1).beside("rtl_out");
        ran("ghdl", ["-a", "--std=08", &format!("{name}.vhd")], dir.path());
    }
}

/// A number of one bit that is a sign.
#[test]
fn a_sign_alone_is_a_type_of_systemverilog() {
    let text = "device = \"function\"\nname = \"f\"\n[function]\nformula = \"-x\"\nfrom = 0\nto = 1\nto_included = true\n\
                [operand]\nfraction = 0\n[result]\nfraction = 0\n[package]\nsystemverilog = true\n";
    let dir = Emitted::new(&parsed("core.toml", text), 1, 1).beside("rtl_out");
    let check = "module check;\n    import f_pkg::*;\n    initial $display(\"%0d %0d\", y_from(-3.0), y_from(2.0));\nendmodule\n";
    let package = read(dir.path().join("f_pkg.sv"));
    let result = package.split("function automatic real ").nth(2).expect("the result");
    let result = result.split("_value").next().expect("its name");
    fs::write(dir.path().join("check.sv"), check.replace("y_from", &format!("{result}_from")))
        .expect("written");
    ran("iverilog", ["-g2012", "-Wall", "-o", "check.vvp", "f_pkg.sv", "check.sv"], dir.path());
    assert_eq!(ran("vvp", ["-n", "check.vvp"], dir.path()).trim(), "-1 0");
}

/// The ports of a module: direction and width.
type Ports = BTreeMap<String, (String, u64)>;

/// Returns those that Yosys finds in the Verilog.
fn ports_of_verilog(dir: &Path, name: &str, top: &str) -> Ports {
    yosys(
        dir,
        &format!("read_verilog {name}*.v; hierarchy -top {top}; proc; write_json {top}.json"),
    );
    let netlist = json(dir.join(format!("{top}.json")));
    let ports = netlist["modules"][top]["ports"].object().iter();
    let port = |(name, port): (&String, &Value)| {
        let width = port["bits"].list().len() as u64;
        (name.clone(), (port["direction"].text().to_owned(), width))
    };
    ports.map(port).collect()
}

/// Returns those of each component of a package in VHDL.
fn ports_of_components(text: &str) -> BTreeMap<String, Ports> {
    let components = text.split("\n  component ").skip(1);
    let of = |component: &str| {
        let name = component.split(' ').next().expect("a name").to_owned();
        let component = component.split("end component").next().expect("its end");
        let ports = component.split("port (").nth(1).expect("ports");
        let port = |line: &str| {
            let (port, kind) = line.trim().trim_end_matches(';').split_once(" : ")?;
            let (direction, kind) = kind.split_once(' ')?;
            let width = match kind.strip_prefix("std_logic_vector(") {
                Some(high) => high.strip_suffix(" downto 0)")?.parse::<u64>().ok()? + 1,
                None => 1,
            };
            Some((port.trim_matches('\\').to_owned(), (format!("{direction}put"), width)))
        };
        (name, ports.lines().filter_map(port).collect())
    };
    components.map(of).collect()
}

#[test]
fn components_of_vhdl_have_the_ports_of_the_verilog() {
    let compared: usize = some_cores("components of VHDL")
        .map(|(name, core)| {
            let emitted = Emitted::new(&core, 1, 1);
            let dir = emitted.beside("rtl_out");
            let text = read(dir.path().join(format!("{name}.vhd")));
            let components = ports_of_components(&text);
            for (top, ports) in &components {
                assert_eq!(*ports, ports_of_verilog(dir.path(), &name, top), "{top}");
            }
            components.len()
        })
        .sum();
    assert!(compared >= 2, "{compared}");
}

/// Returns the operands or the results of a core, with their formats.
fn numbers(design: &Design, is: impl Fn(Role) -> bool) -> Vec<(String, Format)> {
    let ports = design.ports.iter().filter(|port| is(port.role));
    ports.map(|port| design.net(port.net)).map(|net| (net.name.clone(), net.format)).collect()
}

fn operands(design: &Design) -> Vec<(String, Format)> {
    numbers(design, |role| matches!(role, Role::Operand { .. } | Role::Point))
}

fn results(design: &Design) -> Vec<(String, Format)> {
    numbers(design, |role| role == Role::Result)
}

/// Bytes of a number, and of a transfer.
fn bytes(format: Format) -> usize {
    format.width().div_ceil(8) as usize
}

fn transfer(core: &Core, numbers: &[(String, Format)]) -> usize {
    let bytes: usize = numbers.iter().map(|(_, format)| bytes(*format)).sum();
    let padded = core.config().choice("interface.data_width") == "power-of-two";
    if padded { bytes.next_power_of_two() } else { bytes }
}

/// The conversions of the package, and the places of the numbers in its structures, under both simulators.
#[test]
fn types_of_systemverilog_hold_the_numbers() {
    some_cores("types of SystemVerilog").for_each(|(name, core)| {
        let emitted = Emitted::new(&core, 1, 1);
        let dir = emitted.beside("rtl_out");
        let values = [-1e30, -3.7, -2.0, -1.5, -0.25, 0.0, 1e-8, 0.75, 1.0, 1.999, 2.0, 300.5, 7e9];
        let mut functions = String::new();
        let mut text = String::new();
        let mut wanted = String::new();
        let mut show = |code: &str, value: String| {
            writeln!(text, "        $display(\"%0d\", {code});").expect("text");
            writeln!(wanted, "{value}").expect("text");
        };
        let (operands, results) = (operands(&core.design), results(&core.design));
        for (number, format) in operands.iter().chain(&results) {
            for value in values {
                let nearest = format.quantise(value);
                show(&format!("{number}_from({value:?})"), nearest.to_string());
                // In lowest bits, which a real holds exactly.
                let unit = format!("({number}_value({number}_from({value:?})) * 2.0 ** {})", format.frac);
                show(&format!("longint'({unit})"), nearest.to_string());
            }
        }
        for (net, numbers) in [("s_axis_tdata", &operands), ("m_axis_tdata", &results)] {
            show(&format!("$bits({net}_t)"), (8 * transfer(&core, numbers)).to_string());
            let mut low = 0;
            for (number, format) in numbers {
                let ones = format!("({width}'b{})", "1".repeat(format.width() as usize), width = format.width());
                let word = format!("$bits({net}_t)'({ones}) << {low}");
                show(&format!("all_ones_{net}_{number}({word})"), "1".to_owned());
                functions += &format!(
                    "    function automatic bit all_ones_{net}_{number}(logic [$bits({net}_t)-1:0] word);\n        {net}_t same;\n        \
                     same = '0;\n        same.{number} = '1;\n        return word == same;\n    endfunction\n"
                );
                low += 8 * bytes(*format);
            }
        }
        let text = format!(
            "module check;\n    import {name}_pkg::*;\n{functions}    initial begin\n{text}        $finish;\n    end\nendmodule\n"
        );
        fs::write(dir.path().join("check.sv"), text).expect("written");
        let package = format!("{name}_pkg.sv");
        let said = ran("iverilog", ["-g2012", "-Wall", "-o", "check.vvp", &package, "check.sv"], dir.path());
        assert_eq!(said, "", "{name}");
        assert_eq!(ran("vvp", ["-n", "check.vvp"], dir.path()).trim(), wanted.trim(), "{name}");
        let lint = ran("verilator", ["--lint-only", "-Wall", &package], dir.path());
        assert_eq!(lint, "", "{name}");
        ran("verilator", ["--binary", "--timing", "-Wno-WIDTH", &package, "check.sv", "--top", "check"], dir.path());
        let said = ran("sh", ["-c", "obj_dir/Vcheck"], dir.path());
        let said: Vec<&str> = said.lines().filter(|line| !line.starts_with("- ")).collect();
        assert_eq!(said.join("\n").trim(), wanted.trim(), "{name}");
    });
}

/// Returns a raw integer of a format, drawn at random, often at its limits.
fn drawn(format: Format, random: &mut ChaCha8Rng) -> i128 {
    match random.next_u32() % 4 {
        0 => format.min_raw(),
        1 => format.max_raw(),
        _ => format.raw(random.next_u64() & glint::fixed::mask(format.width())),
    }
}

/// Transfers in C and Python, against bytes that this test makes.
#[test]
fn transfers_are_packed_and_unpacked() {
    cores().for_each(|(name, core)| {
        let emitted = Emitted::new(&core, 1, 1);
        let dir = emitted.tree();
        let dir = dir.path().join(format!("software/{name}"));
        let (operands, results) = (operands(&core.design), results(&core.design));
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut c = format!("#include <stdio.h>\n#include \"{name}_stream.h\"\nint main(void) {{\n");
        let upper = name.to_uppercase();
        writeln!(c, "uint8_t sent[{upper}_SENT_BYTES];").expect("text");
        let mut python = format!("import numpy as np\nimport {name}_stream as s\n");
        let mut wanted = String::new();
        let mut transferred = |numbers: &[(String, Format)]| {
            let values = numbers.iter().map(|(_, format)| drawn(*format, &mut random));
            let values: Vec<i128> = values.collect();
            let mut word = Vec::new();
            for (value, (_, format)) in values.iter().zip(numbers) {
                word.extend(&value.to_le_bytes()[..bytes(*format)]);
            }
            word.resize(transfer(&core, numbers), 0);
            (values, word)
        };
        for _ in 0..50 {
            let (values, word) = transferred(&operands);
            let arguments: Vec<String> = values.iter().map(|value| format!("{value}ll")).collect();
            writeln!(
                c,
                "{name}_pack(sent, {});\nfor (int i = 0; i < {upper}_SENT_BYTES; i++) printf(\"%02x\", sent[i]);\nputs(\"\");",
                arguments.join(", ").replace("9223372036854775808ll", "9223372036854775808ull")
            )
            .expect("text");
            let named = operands.iter().zip(&values).map(|((name, _), value)| format!("\"{name}\": [{value}]"));
            writeln!(python, "print(s.pack({{{}}}).tobytes().hex())", named.collect::<Vec<_>>().join(", ")).expect("text");
            writeln!(wanted, "{}", word.iter().map(|byte| format!("{byte:02x}")).collect::<String>()).expect("text");

            let (values, word) = transferred(&results);
            let list: Vec<String> = word.iter().map(u8::to_string).collect();
            writeln!(c, "{{ const uint8_t got[{upper}_RECEIVED_BYTES] = {{{}}};", list.join(", ")).expect("text");
            writeln!(python, "got = s.unpack(bytes([{}]))", list.join(", ")).expect("text");
            for ((number, format), value) in results.iter().zip(&values) {
                let field = number.to_lowercase();
                let print = if format.signed { "%lld\\n\", (long long)" } else { "%llu\\n\", (unsigned long long)" };
                writeln!(c, "printf(\"{print}{name}_unpack_{field}(got));").expect("text");
                writeln!(python, "print(got[\"{number}\"][0])").expect("text");
                writeln!(wanted, "{value}").expect("text");
            }
            c += "}\n";
        }
        c += "return 0; }\n";
        fs::write(dir.join("main.c"), c).expect("written");
        fs::write(dir.join("main.py"), python).expect("written");
        let strict = "-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Werror -fsanitize=undefined -fno-sanitize-recover main.c -o main";
        ran("cc", strict.split(' '), &dir);
        assert_eq!(ran("sh", ["-c", "./main"], &dir), wanted, "{name} in C");
        assert_eq!(ran("python", ["main.py"], &dir), wanted, "{name} in Python");
    });
}

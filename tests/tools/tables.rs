//! Tests tables that can be written: a core that is loaded with the image of another function computes this function, in Icarus
//! Verilog and in Verilator, through its own ports and through bus registers. The functions in C find damaged images.

use std::fs;

use glint::core::Core;
use glint::package::{FileKind, TableLayout};
use glint::tools::{VerilogSimulator, prove};

use crate::common::Sure;
use crate::common::bench::Bench;
use crate::common::cores::{Emitted, Files, parsed};
use crate::common::files::put;
use crate::common::tools::{LIMIT, assert_lint_clean, ran};
use crate::faults::faults;

/// The reciprocal exponential at 12 bits, whose table also holds two other curves.
const FOG: &str = "device = \"function\"\nname = \"fog\"\n\
    function = { formula = \"exp(-x)\", from = 0, to = 4 }\noperand.fraction = 10\nresult.fraction = 12\n\
    approximation.tables = \"writable\"\nimages.squared = \"exp(-x^2)\"\nimages.linear = \"max(1 - x/4, 0)\"\n";

/// The kinds of cores, with the keys that make them.
const CORES: [(&str, &str); 5] = [
    ("core.v", ""),
    ("core.v", "operands.buffered = true\n"),
    ("pipeline.v", "architecture = \"pipelined\"\n"),
    ("pipeline.v", "architecture = \"pipelined\"\npipeline.interval = 2\n"),
    ("registers.v", "interface.registers = \"wishbone\"\n"),
];

type Curve = fn(f64) -> f64;

fn curve(name: &str) -> Curve {
    match name {
        "squared" => |x| (-x * x).exp(),
        "linear" => |x| (1.0 - x / 4.0).max(0.0),
        other => panic!("no curve {other}"),
    }
}

fn core(keys: &str) -> Core {
    let (device, rest) = FOG.split_once('\n').expect("the device and its keys");
    parsed("fog.toml", &format!("{device}\n{keys}{rest}"))
}

/// Returns the words of an image, each with its parts side by side, for `$readmemh`.
fn words(layout: &TableLayout, image: &[Vec<i64>]) -> String {
    let mut lines = String::new();
    for word in image {
        let mut bits = 0u64;
        for (raw, (_, format)) in word.iter().zip(&layout.parts) {
            bits = bits << format.width() | format.bits(i128::from(*raw));
        }
        lines += &format!("{bits:x}\n");
    }
    lines
}

/// Returns the bench from `tests/tools/tables` for a core.
fn bench(file: &str, core: &Core, layout: &TableLayout) -> String {
    let template = fs::read_to_string(format!("tests/tools/tables/{file}")).sure();
    let (mut parts, mut writes) = (String::new(), String::new());
    let mut below = layout.word_bits();
    // The words of the table follow the operand, which is the register at word 8.
    for (place, (port, format)) in (9..).zip(&layout.parts) {
        let high = below - 1;
        below -= format.width();
        parts += &format!(".{port}(now[{high}:{below}]), ");
        let pad = 32 - format.width();
        writes += &format!("put({place}, {{{pad}'d0, now[{high}:{below}]}}); ");
    }
    let address = 9 + layout.parts.len();
    let high = (4 * (address + 1)).ilog2();
    let changes = [
        ("@NAME@", core.config().name.clone()),
        ("@ADDRESS@", ((layout.words - 1).ilog2()).to_string()),
        ("@LAST@", (layout.words - 1).to_string()),
        ("@PARTS@", parts),
        ("@WRITES@", writes),
        ("@ADDRESS_PLACE@", address.to_string()),
        ("@RESULT@", (address + 1).to_string()),
        ("@HIGH@", high.to_string()),
    ];
    changes.iter().fold(template, |text, (from, to)| text.replace(from, to))
}

/// Checks 4096 printed results against a curve: each differs from it by less than one unit of 2^−12.
fn check(transcript: &str, name: &str, what: &str) {
    let results = transcript.lines().filter_map(|line| line.trim().parse::<f64>().ok());
    let mut count = 0;
    for (raw, result) in results.enumerate() {
        let x = raw as f64 / 1024.0;
        let exact = curve(name)(x) * 4096.0;
        assert!((result - exact).abs() < 1.0, "{what}, {name}: {result} at x = {x}, not {exact}");
        count += 1;
    }
    assert_eq!(count, 4096, "{what}: {transcript}");
    assert!(!transcript.contains("not"), "{what}: {transcript}");
}

#[test]
fn a_loaded_core_computes_another_function() {
    for (file, keys) in CORES {
        let core = core(keys);
        let layout = TableLayout::of(&core.design).expect("a table that can be written");
        let emitted = Emitted::new(&core, 60, 1);
        let mut files: Files = emitted.rtl();
        files.push(("bench.v".to_owned(), bench(file, &core, &layout)));
        files.push(("words.hex".to_owned(), String::new()));
        for simulator in [VerilogSimulator::Icarus, VerilogSimulator::Verilator] {
            let built = Bench::build_quietly(simulator, &files, "bench");
            for image in core.images().sure() {
                built.replace("words.hex", &words(&layout, &image.words));
                check(&built.run().output, &image.name, &format!("{keys}{simulator}"));
            }
        }
    }
}

#[test]
fn wrappers_with_a_table_are_clean_and_proved() {
    let wrappers = "interface = { stream = true, registers = \"axi-lite\", processor = \"cfu\" }\n";
    for keys in ["", "architecture = \"pipelined\"\n"] {
        let emitted = Emitted::new(&core(&format!("{keys}{wrappers}")), 60, 1);
        let dir = emitted.beside("rtl_out");
        for module in ["fog_axis", "fog_axil", "fog_cfu"] {
            assert_lint_clean(dir.path(), module);
        }
        let all = emitted.all_beside();
        for file in emitted.files.of(&[FileKind::CoreProof, FileKind::WrapperProof]) {
            prove(all.path(), file.name(), LIMIT).sure_of(&file.path);
        }
    }
}

/// A core that loads words while it computes, or whose registers lose a word, does not keep the properties.
#[test]
fn faults_break_the_proofs_of_tables() {
    for fault in faults("tables") {
        let keys = match fault.of.as_str() {
            "fog_registers" => "interface.registers = \"axi-lite\"\n",
            "fog" => "architecture = \"pipelined\"\n",
            _ => "",
        };
        let dir = Emitted::new(&core(keys), 60, 1).all_beside();
        let proof = if fault.of == "fog_registers" { "fog_registers" } else { "fog" };
        fault.assert_breaks(dir.path(), proof, &format!("{}.v", fault.of));
    }
}

#[test]
fn software_finds_damaged_images() {
    let core = core("interface.registers = \"axi-lite\"\n");
    let dir = Emitted::new(&core, 60, 1).tree();
    let software = dir.path().join("software/fog");
    put(software.join("table.c"), fs::read_to_string("tests/tools/tables/table.c").sure());
    let layout = TableLayout::of(&core.design).expect("a table that can be written");
    let images = core.images().sure();
    fs::write(software.join("squared.bin"), layout.binary(&images[0])).sure();
    let flags = "-std=c99 -O2 -Wall -Wextra -Wpedantic -Wconversion -Werror -fsanitize=undefined";
    let arguments = flags.split(' ').chain(["-o", "check", "table.c"]);
    ran("cc", arguments, &software);
    ran("env", ["./check", "squared.bin"], &software);
}

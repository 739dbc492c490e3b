//! Tests the wrappers by which processors call a core with an instruction: their Verilog has no lint warnings and passes its bench,
//! their properties are proved, and the functions in C compile.

use crate::common::Sure;
use crate::common::cores::{Emitted, parsed};
use crate::common::tools::{LIMIT, assert_bench_passes, assert_lint_clean, ran};
use crate::faults::faults;
use glint::package::FileKind;
use glint::tools::{VerilogSimulator, prove};
use rayon::prelude::*;

/// Cores with instructions, each with a name: a unit, a pipeline with operands that share a register, results of each sign, and a
/// device of highlights.
const INSTRUCTED: [(&str, &str); 4] = [
    (
        "unit",
        "device = \"unit\"\nfunctions.rcp = { operands.x = { from = 0.5, to = 1, fraction = 12 }, \
         results.r = { formula = \"1 / x\", fraction = 11 } }\nfunctions.turn = { operands.angle = { bits = 12, \
         fraction = 12 }, results.s = { formula = \"sin(2 * pi * angle)\", fraction = 11 }, \
         results.c = { formula = \"cos(2 * pi * angle)\", fraction = 11 } }\nfunctions.mean = { operands.a = \
         { bits = 9, fraction = 4, signed = true }, operands.b = { bits = 9, fraction = 4, signed = true }, \
         results.m = { formula = \"(a + b) / 2\", fraction = 5 } }\n",
    ),
    (
        "lerp",
        "device = \"expression\"\narchitecture = \"pipelined\"\noperands.a = { bits = 12, fraction = 8, signed = true }\n\
         operands.b = { bits = 12, fraction = 8 }\noperands.word_0 = { bits = 8, fraction = 8 }\n\
         results.r = { formula = \"a + (b - a) * word_0\", fraction = 8 }\nresults.s = { formula = \"b\", fraction = 8 }\n",
    ),
    (
        "wide",
        "device = \"expression\"\noperands.x = { bits = 32, fraction = 16, signed = true }\n\
         results.r = { formula = \"abs(x)\", fraction = 15 }\n",
    ),
    ("highlight", "device = \"cosine-power\"\ninterface.registers = \"wishbone\"\n"),
];

const PROCESSORS: [&str; 2] = ["cfu", "pcpi"];

fn instructed(name: &str, keys: &str, processor: &str) -> Emitted {
    let (device, rest) = keys.split_once('\n').expect("a device and its keys");
    let text =
        format!("{device}\nname = \"{name}\"\ninterface.processor = \"{processor}\"\n{rest}");
    Emitted::new(&parsed("core.toml", &text), 60, 1)
}

fn for_each_instructed(check: impl Fn(&Emitted, &str, &str) + Sync) {
    INSTRUCTED.par_iter().for_each(|(name, keys)| {
        for processor in PROCESSORS {
            check(&instructed(name, keys, processor), name, processor);
        }
    });
}

#[test]
fn instructions_are_clean_verilog_and_pass_their_bench() {
    for_each_instructed(|emitted, name, processor| {
        let dir = emitted.beside("rtl_out");
        assert_lint_clean(dir.path(), &format!("{name}_{processor}"));
        let kinds = [FileKind::ProcessorWrapper, FileKind::WrapperProof, FileKind::Bench];
        for file in emitted.files.of(&kinds) {
            let long = file.contents.lines().find(|line| line.len() > 100);
            assert_eq!(long, None, "{}", file.path);
        }
        for simulator in [VerilogSimulator::Icarus, VerilogSimulator::Verilator] {
            let bench = format!("{name}_{processor}_tb");
            assert_bench_passes(simulator, &emitted.simulated(), &bench);
        }
    });
}

#[test]
fn instructions_are_proved() {
    for_each_instructed(|emitted, name, processor| {
        let dir = emitted.all_beside();
        prove(dir.path(), &format!("{name}_{processor}_formal.sv"), LIMIT).sure_of(name);
    });
}

#[test]
fn faults_break_the_proofs_of_instructions() {
    faults("instructions").par_iter().for_each(|fault| {
        let (name, keys) = INSTRUCTED[0];
        let dir = instructed(name, keys, &fault.of).all_beside();
        let module = format!("{name}_{}", fault.of);
        fault.assert_breaks(dir.path(), &module, &format!("{module}.v"));
    });
}

/// The functions in C compile without a warning for RISC-V.
#[test]
fn instructions_for_software() {
    for_each_instructed(|emitted, name, _| {
        let dir = emitted.tree();
        let dir = &dir.path().join(format!("software/{name}"));
        let strict = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];
        let bare = ["-march=rv32im", "-mabi=ilp32", "-ffreestanding", "-c", "-x", "c"];
        let header = format!("{name}_instructions.h");
        let to = ["-o", "all.o", &header];
        ran("riscv64-unknown-elf-gcc", [&strict[..], &bare, &to].concat(), dir);
    });
}

//! Tests the emitted Verilog under Icarus Verilog and Verilator: the linters report no warnings, and the bench passes.
//!
//! The golden model and the built-in simulator must agree on the expected values of a bench, and the bench compares every
//! output on every clock. A bench must fail with one wrong bit in an expected output or, in a core with a microprogram, in a
//! ROM. Icarus Verilog builds the benches of all configurations, and Verilator some of them.

use crate::common::Sure;
use crate::common::bench::{Bench, with_flipped_bit};
use crate::common::cores::{Emitted, Files, all_configurations, configuration, parsed, write};
use crate::common::sample::sampled_by_name;
use crate::common::tools::{LIMIT, assert_lint_clean, tool};
use glint::core::Core;
use glint::hdl::netlist::{Design, Driver, RomId};
use glint::hdl::sim::Simulator;
use glint::package::FileKind;
use glint::tools::VerilogSimulator;
use rayon::prelude::*;

/// Points of a bench here; committed benches are shorter.
const POINTS: u64 = 300;

/// The stimulus of the benches here; committed benches have another.
const SEED: u64 = 5;

/// The longest line of a file.
const COLUMNS: usize = 100;

#[test]
fn every_configuration_is_clean_verilog() {
    all_configurations().par_iter().for_each(|(path, core)| {
        let emitted = Emitted::new(core, 4, SEED);
        let dir = emitted.beside("rtl_out");
        assert_lint_clean(dir.path(), &emitted.name);
        // A FuseSoC core names a file twice in a line, and XML breaks no text.
        let long = [
            FileKind::Manifest,
            FileKind::CorePackage,
            FileKind::BenchPackage,
            FileKind::VendorScript,
        ];
        for file in &emitted.files {
            let dir = format!("{path}: {}", file.path);
            assert!(file.contents.is_ascii(), "{dir} is not ASCII");
            assert!(file.contents.ends_with('\n'), "{dir} has no last newline");
            for (at, line) in file.contents.lines().enumerate() {
                assert!(!line.ends_with(' ') && !line.contains('\t'), "{dir}:{}: blanks", at + 1);
                assert!(
                    line.len() <= COLUMNS || long.contains(&file.kind),
                    "{dir}:{} is longer than {COLUMNS} columns",
                    at + 1
                );
            }
            if file.kind.is_verilog() {
                let text = &file.contents;
                assert!(
                    text.contains("\n`default_nettype none\n"),
                    "{dir} declares nets by mistake"
                );
                assert!(text.ends_with("\n`default_nettype wire\n"), "{dir} does not restore it");
                // A pipeline and its delay lines are one file.
                let silenced = text.replace("verilator lint_off DECLFILENAME", "");
                assert!(!silenced.contains("lint_off"), "{dir} silences a linter");
            }
        }
    });
}

#[test]
fn every_configuration_passes_in_icarus() {
    let all = all_configurations();
    let noticed = all.par_iter().map(|(_, core)| {
        let (emitted, bench) = build(core, VerilogSimulator::Icarus);
        bench.assert_passes();
        notices_every_output(core, &emitted, &bench);
        // Which word tells is known by the microprogram.
        match core.design.pipeline {
            None => notices_every_rom(core, &emitted, &bench),
            Some(_) => 0,
        }
    });
    let noticed = noticed.sum::<usize>();
    assert!(noticed > 20, "{noticed} ROMs");
}

#[test]
fn configurations_pass_in_verilator() {
    let path_of = |(path, _): &(String, Core)| path.clone();
    sampled_by_name("Verilator", all_configurations(), path_of).par_iter().for_each(|(_, core)| {
        let (_, bench) = build(core, VerilogSimulator::Verilator);
        bench.assert_passes();
    });
}

/// A computation without a reset before it: with initial values the handshake and the results are known from the first
/// clock on, without them never.
#[test]
fn initial_values_are_known_without_a_reset() {
    let bench = include_str!("benches/without_reset.v");
    let shown = |values: bool| {
        let more = format!("\nname = \"core\"\n[package]\ninitial_values = {values}\n");
        let text = format!("device = \"cosine-power\"{more}");
        let emitted = Emitted::new(&parsed("core.toml", &text), 4, SEED);
        let dir = tempfile::tempdir().expect("a directory");
        let mut files = emitted.rtl();
        files.push(("bench.v".to_owned(), bench.to_owned()));
        write(dir.path(), &files);
        let sources = ["core_control.v", "core_datapath.v", "core.v", "bench.v"];
        let build =
            tool("iverilog").run(["-o", "bench"].iter().chain(&sources), dir.path(), LIMIT).sure();
        assert!(build.status.success(), "{}", build.output);
        tool("vvp").run(["bench"], dir.path(), LIMIT).sure().output
    };
    assert!(shown(true).contains("before 0 00000000\nvalid 200\n"), "{}", shown(true));
    assert!(shown(false).contains("before x xxxxxxxx\n"), "{}", shown(false));
    assert!(!shown(false).contains("valid"), "{}", shown(false));
}

#[test]
fn a_bench_fails_in_verilator_too() {
    let core = configuration("configs/rough.toml");
    let (emitted, bench) = build(&core, VerilogSimulator::Verilator);
    notices_every_output(&core, &emitted, &bench);
    assert!(notices_every_rom(&core, &emitted, &bench) > 0, "no ROM");
}

fn build(core: &Core, simulator: VerilogSimulator) -> (Emitted, Bench) {
    let emitted = Emitted::new(core, POINTS, SEED);
    let bench = Bench::build(simulator, &emitted.simulated(), &emitted.bench());
    (emitted, bench)
}

fn memory<'a>(files: &'a Files, name: &str) -> &'a str {
    let file = files.iter().find(|(file, _)| file == name);
    &file.unwrap_or_else(|| panic!("no file {name}")).1
}

/// One wrong bit in one expected word, of each output in turn, fails the bench.
fn notices_every_output(core: &Core, emitted: &Emitted, bench: &Bench) {
    let files = emitted.simulated();
    let name = format!("{}_expected.mem", emitted.name);
    let expected = memory(&files, &name);
    let vectors = core.vectors(POINTS, SEED).expect("vectors");
    let last = vectors.expected.len() - 1;
    // From the low end: the outputs of a word stand in port order from the top.
    let outputs: Vec<_> = core.design.outputs().collect();
    let mut low = 0;
    for port in outputs.into_iter().rev() {
        bench.replace(&name, &with_flipped_bit(expected, last, low));
        bench.assert_fails(&format!("a wrong {}", core.design.net(port.net).name));
        low += core.design.width(port.net);
    }
    bench.replace(&name, expected);
    bench.assert_passes();
}

/// Returns one wrong bit in one word of a ROM, of each ROM in turn, fails the bench. Returns how many ROMs there are.
fn notices_every_rom(core: &Core, emitted: &Emitted, bench: &Bench) -> usize {
    // Words in the Verilog have no file; `vendor` has wrong ones noticed.
    if core.config().choice("package.memories") != "files" {
        return 0;
    }
    let files = emitted.simulated();
    let design = &core.design;
    for (at, rom) in design.roms.iter().enumerate() {
        let name = format!("{}_{}.mem", emitted.name, rom.name);
        let contents = memory(&files, &name);
        let (word, bit) = if RomId(at as u32) == design.control.rom {
            // Word 1 carries on with word 2; its lowest bit is what makes it do so, or end.
            (1, 0)
        } else {
            (telling_word(core, RomId(at as u32)), design.width(rom.data) - 1)
        };
        bench.replace(&name, &with_flipped_bit(contents, word, bit));
        bench.assert_fails(&format!("a wrong bit in word {word} of {name}"));
        bench.replace(&name, contents);
    }
    bench.assert_passes();
    design.roms.len()
}

/// Returns a word of a ROM whose top bit is seen on the outputs over the bench's stimulus: of those the one that is
/// addressed most often while the microprogram runs.
fn telling_word(core: &Core, id: RomId) -> usize {
    let design: &Design = &core.design;
    let rom = design.rom(id);
    let vectors = core.vectors(POINTS, SEED).expect("vectors");
    assert!(matches!(design.net(rom.data).driver, Driver::Rom(driver) if driver == id));
    let busy = design.register(design.control.run).q;
    let mut reads = vec![0; rom.words.len()];
    let right = outputs(design, &vectors.inputs, |simulator| {
        if simulator.value(busy) == 1 {
            reads[simulator.value(rom.address) as usize] += 1;
        }
    });
    let mut words: Vec<usize> = (0..reads.len()).filter(|&word| reads[word] > 0).collect();
    words.sort_by_key(|&word| std::cmp::Reverse(reads[word]));
    let is_seen = |word: &usize| {
        let mut wrong = design.clone();
        wrong.roms[id.index()].words[*word] ^= 1 << (design.width(rom.data) - 1);
        outputs(&wrong, &vectors.inputs, |_| ()) != right
    };
    words.into_iter().find(is_seen).expect("a word that is seen")
}

/// Returns the outputs after every clock, of which `watch` is told.
fn outputs(design: &Design, inputs: &[Vec<u64>], mut watch: impl FnMut(&Simulator)) -> Vec<u64> {
    let mut simulator: Simulator = Simulator::new(design).expect("a simulator");
    let mut values = Vec::new();
    for inputs in inputs {
        for (at, &bits) in inputs.iter().enumerate() {
            simulator.set(at, bits);
        }
        simulator.clock().expect("a clock");
        watch(&simulator);
        values.extend(design.outputs().map(|port| simulator.value(port.net)));
    }
    values
}

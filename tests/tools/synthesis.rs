//! Tests the synthesis of cores with a microprogram by Yosys for iCE40, ECP5 and Xilinx 7: no latch, no warning, large
//! synchronous ROMs in block RAM with all of their contents, and products in DSP blocks. A run takes some pairs of a
//! configuration and a family.
//!
//! The netlists for iCE40 and ECP5, control ROM included, pass the bench of their core. Yosys 0.23 has no model of Xilinx block
//! RAMs, so the test counts the ones in their initial values. `tests/tools/gate_level.rs` tests that a fault in a netlist is
//! noticed.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::common::Sure;
use crate::common::cores::{Emitted, configuration, configuration_with, configurations, parsed};
use crate::common::files::read;
use crate::common::json::Json;
use crate::common::netlist::{self, POINTS, synthesise};
use crate::common::sample::sampled_by_name;
use crate::common::tools::{LIMIT, tool};
use glint::core::Core;
use glint::hdl::netlist::{Design, Driver, NetlistRom, Op};
use glint::target::{COMPARED, ECP5, Family, ICE40, Kinds};
use glint::tools::gates;
use glint::tools::synthesis::{self, Usage};
use rayon::prelude::*;

/// Returns the prefixes of the names of the initial values of a family's block RAMs, before so many hexadecimal
/// digits.
fn initial(family: &Family) -> (&'static [&'static str], usize) {
    match family.name() {
        "ice40" => (&["INIT_"], 1),
        "ecp5" => (&["INITVAL_"], 2),
        // INIT_A and INIT_B are of the output register.
        _ => (&["INIT_", "INITP_"], 2),
    }
}

#[test]
fn configurations_are_synthesised_whole() {
    let configurations = configurations();
    let pairs = configurations.iter().flat_map(|one| COMPARED.iter().map(move |it| (one, it)));
    let name_of =
        |((path, _), family): &(&(String, Core), &Family)| format!("{path} {}", family.name());
    sampled_by_name("synthesis", pairs, name_of).into_par_iter().for_each(
        |((path, unit), family)| {
            let emitted = Emitted::new(unit, POINTS, 1);
            let netlist = synthesise(&emitted, family);
            let cells = Cells::new(&netlist.json, &emitted.name);
            let what = format!("{path}, {}", family.title);
            memories_are_whole(&unit.design, &cells, family, &what);
            let products = products(&unit.design);
            let blocks = cells.count_all(family.dsps);
            assert!(blocks >= products, "{what}: {products} products in {blocks} DSP blocks");
            println!(
                "{what}: {blocks} DSP blocks, {} block RAMs, {} cells",
                cells.count_all(family.block_rams),
                cells.0.len()
            );
            if gates::is_simulated(family) {
                netlist::bench(&emitted, netlist.verilog, family).assert_passes();
            }
        },
    );
}

/// The flows of Yosys, each with the step behind the mapping of memories.
const FLOWS: [(&str, &str); 8] = [
    ("synth_ice40 -dsp", "map_gates"),
    ("synth_gatemate", "map_gates"),
    ("synth_efinix", "map_gates"),
    ("synth_ecp5", "map_gates"),
    ("synth_xilinx", "fine"),
    ("synth_gowin", "map_gates"),
    ("synth_nexus", "map_gates"),
    ("synth", "check"),
];

/// Every flow maps the memories of a pipeline that is shipped, from its files: delay lines ask for no kind of memory. In ECP5 they
/// are in look-up tables.
#[test]
fn every_flow_takes_the_delay_lines_of_pipelines() {
    let shipped = fs::read_dir("rtl_out").expect("rtl_out");
    let names = shipped.map(|entry| entry.expect("an entry").file_name().into_string());
    let pipelines: Vec<String> =
        names.filter_map(Result::ok).filter(|name| name.ends_with("_pipelined")).collect();
    assert_eq!(pipelines.len(), 12);
    let taken = sampled_by_name("flows of delay lines", pipelines, String::clone);
    taken.par_iter().for_each(|name| {
        let directory = Path::new("rtl_out").join(name);
        let text = read(directory.join(format!("{name}.v")));
        // The pipeline of a short function has no value to hold for long, and iCE40 has no small memories.
        let without = ["rsqrt_pipelined", "lyon_up5k_pipelined", "rough_up5k_pipelined"];
        let delays = text.contains(&format!("{name}_delay #("));
        assert_eq!(delays, !without.contains(&name.as_str()), "{name}");
        let flows = FLOWS.iter().map(|(flow, end)| {
            let memories = if *flow == "synth" { "" } else { "select -assert-none t:$mem*; " };
            let tables = match *flow {
                "synth_ecp5" if delays => "select -assert-min 1 t:TRELLIS_DPR16X4; ",
                _ => "",
            };
            format!("design -load core; {flow} -top {name} -run begin:{end}; {memories}{tables}")
        });
        let modules = ["multiplier", "delay"].map(|module| format!("{name}_{module}.v"));
        let others: Vec<String> =
            modules.into_iter().filter(|file| directory.join(file).exists()).collect();
        let others = others.join(" ");
        let commands = format!(
            "read_verilog {name}.v {others}; hierarchy -top {name}; design -save core; {}",
            flows.collect::<String>()
        );
        tool("yosys").run_to_success(["-q", "-p", &commands], &directory, LIMIT).sure_of(name);
    });
}

/// The usage that the command line states is that of the netlist.
#[test]
fn usage_is_that_of_the_netlist() {
    let unit = configuration("configs/schlick.toml");
    let emitted = Emitted::new(&unit, POINTS, 1);
    COMPARED.par_iter().for_each(|family| {
        let told =
            synthesis::synthesise(&tool("yosys"), &emitted.rtl(), &emitted.name, family, LIMIT)
                .sure()
                .usage;
        let netlist = synthesise(&emitted, family).json;
        let cells = Cells::new(&netlist, &emitted.name);
        let wanted = Usage {
            luts: cells.count_all(family.luts),
            dsps: cells.count_all(family.dsps),
            block_rams: cells.count_all(family.block_rams),
            flip_flops: cells.count_all(family.flip_flops),
        };
        assert_eq!(told, wanted, "{}", family.title);
        assert!(told.luts > 50 && told.dsps > 3, "{told:?}");
    });
}

/// By itself Yosys puts the tables of `quadratic` into block memory of ECP5, and those of `function`, which have few words, into
/// look-up tables.
#[test]
fn memories_are_where_the_key_wants_them() {
    let used = |name: &str, style: &str| {
        let more = format!("\n[package]\nrom_style = \"{style}\"\n");
        let core = configuration_with(&format!("configs/{name}.toml"), &more);
        let emitted = Emitted::new(&core, POINTS, 1);
        let used =
            synthesis::synthesise(&tool("yosys"), &emitted.rtl(), &emitted.name, &ECP5, LIMIT);
        used.sure_of(style).usage
    };
    let [auto, distributed] = ["auto", "distributed"].map(|style| used("quadratic", style));
    assert!(auto.block_rams > 0 && distributed.block_rams == 0, "{auto:?}, {distributed:?}");
    assert!(auto.luts < distributed.luts, "{auto:?}, {distributed:?}");
    let [auto, block] = ["auto", "block"].map(|style| used("function", style));
    assert!(auto.block_rams == 0 && block.block_rams > 0, "{auto:?}, {block:?}");
    assert!(block.luts < auto.luts, "{auto:?}, {block:?}");
}

/// The cells of a flat netlist.
struct Cells<'a>(Vec<&'a serde_json::Value>);

impl<'a> Cells<'a> {
    fn new(netlist: &'a serde_json::Value, top: &str) -> Self {
        let cells = netlist["modules"][top]["cells"].object();
        let all: Vec<_> = cells.values().collect();
        let cells = Self(all);
        for cell in &cells.0 {
            let kind = Cells::kind(cell);
            assert!(!kind.starts_with('$'), "{top}: {kind} was left over");
            assert!(!kind.contains("LATCH") && !kind.starts_with("LD"), "{top}: a latch, {kind}");
        }
        cells
    }

    fn kind(cell: &serde_json::Value) -> &str {
        cell["type"].text()
    }

    fn of<'b>(&'b self, kind: &'b str) -> impl Iterator<Item = &'a serde_json::Value> + 'b {
        self.0.iter().copied().filter(move |cell| Self::kind(cell) == kind)
    }

    /// Returns how many there are of some kinds, each with its weight.
    fn count_all(&self, kinds: Kinds) -> u64 {
        let weighed = kinds.iter().map(|(kind, weight)| self.of(kind).count() as u64 * weight);
        weighed.sum()
    }
}

/// Returns the number of bits from which on a synchronous ROM is in block RAM; a smaller one may well be logic.
fn warrants_block_ram(family: &Family) -> u64 {
    if family.name() == "xilinx7" {
        // A look-up table is a ROM of 64 bits, and a block RAM has 18 432.
        8192
    } else {
        2048
    }
}

/// Synchronous ROMs of some size are in block RAM, with every 1 of their contents.
fn memories_are_whole(design: &Design, cells: &Cells, family: &Family, what: &str) {
    let bits = |rom: &NetlistRom| rom.words.len() as u64 * u64::from(design.width(rom.data));
    let large: Vec<&NetlistRom> = design
        .roms
        .iter()
        // A ROM whose words are all alike is wires.
        .filter(|rom| rom.words.iter().any(|word| *word != rom.words[0]))
        .filter(|rom| rom.synchronous && bits(rom) >= warrants_block_ram(family))
        .collect();
    let rams: Vec<_> = family.block_rams.iter().flat_map(|(kind, _)| cells.of(kind)).collect();
    assert!(rams.len() >= large.len(), "{what}: ROMs are not in block RAM");
    let ones: u64 = rams.iter().map(|cell| ones(cell, initial(family))).sum();
    let ones_of = |rom: &NetlistRom| -> u64 {
        let ones = rom.words.iter().map(|word| u64::from(word.count_ones()));
        ones.sum()
    };
    // With any of the smaller ones, whole.
    let mut wanted = BTreeSet::from([large.iter().map(|rom| ones_of(rom)).sum::<u64>()]);
    let small = |rom: &&NetlistRom| rom.synchronous && bits(rom) < warrants_block_ram(family);
    for rom in design.roms.iter().filter(small) {
        let with: Vec<u64> = wanted.iter().map(|sum| sum + ones_of(rom)).collect();
        wanted.extend(with);
    }
    assert!(
        wanted.contains(&ones),
        "{what}: {ones} ones in block RAM; its ROMs have one of {wanted:?}"
    );
}

/// Returns the ones in the initial values of a block RAM. Bits that are not given are `x` or 0.
fn ones(cell: &serde_json::Value, (prefixes, digits): (&[&str], usize)) -> u64 {
    let is_number =
        |rest: &str| rest.len() == digits && rest.chars().all(|c| c.is_ascii_hexdigit());
    let is_contents =
        |name: &str| prefixes.iter().any(|prefix| name.strip_prefix(prefix).is_some_and(is_number));
    let parameters = cell["parameters"].object();
    let contents = parameters.iter().filter(|(name, _)| is_contents(name));
    let ones = contents.map(|(_, bits)| bits.text().matches('1').count() as u64);
    ones.sum()
}

/// Multiplications in a design.
fn products(design: &Design) -> u64 {
    let is_product = |driver: &Driver| matches!(driver, Driver::Op(Op::Mul(..)));
    design.nets.iter().filter(|net| is_product(&net.driver)).count() as u64
}

/// Yosys moves no table in front of the register of its address: the netlist has no more flip-flops than the schedule has register
/// bits. Without the commands before `synth_ice40`, `pow` has 636 flip-flops for 568 bits.
#[test]
fn tables_stay_behind_the_registers_of_their_addresses() {
    let text = "device = \"expression\"\nname = \"pow\"\narchitecture = \"pipelined\"\n\
                operands.x = { bits = 16, fraction = 16 }\noperands.y = { bits = 16, fraction = 16 }\n\
                results.r = { formula = \"x ^ y\", fraction = 15, error = 1.0, where = \"x > 0\" }\n\
                pipeline = { target = \"ice40\", clock_mhz = 40 }\n";
    let core = parsed("pow.toml", text);
    let pipeline = core.design.pipeline.as_ref().expect("a pipeline");
    let bits: u32 = pipeline.stages.iter().map(|stage| stage.register_bits).sum();
    let emitted = Emitted::new(&core, 1, 1);
    let netlist = synthesise(&emitted, &ICE40).json;
    let flip_flops = Cells::new(&netlist, &emitted.name).count_all(ICE40.flip_flops);
    assert!(flip_flops <= u64::from(bits), "{flip_flops} flip-flops for {bits} bits");
}

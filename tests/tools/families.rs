//! Tests the families iCE40 HX, Gowin, Nexus and GateMate: the netlist of a core after synthesis passes the bench of the core.
//!
//! `synth.rs` tests what `glint synth` measures for them.

use glint::target::{COMPARED, FAMILIES, Family};
use glint::tools::{VerilogSimulator, gates};
use rayon::prelude::*;

use crate::common::Sure;
use crate::common::bench::Bench;
use crate::common::cores::{Emitted, configuration, preset};
use crate::common::netlist::{self, POINTS, synthesise, yosys_of};
use crate::common::tools::LIMIT;

/// The cores: two with a microprogram, one with a block memory, four pipelines with delay memories, registers and products of
/// several widths, and two expressions. Parts of the carry chains of `sincos` have constant inputs.
const CORES: [&str; 9] = [
    "cosine_power",
    "blinn",
    "quadratic",
    "cosine_power_pipelined",
    "blinn_pipelined",
    "schlick_pipelined",
    "rsqrt_pipelined",
    "sincos",
    "divide",
];

fn families() -> impl Iterator<Item = &'static Family> {
    // The other families are in `synthesis.rs`.
    FAMILIES.iter().filter(|family| !COMPARED.iter().any(|it| it.name() == family.name()))
}

fn emitted(core: &str) -> Emitted {
    let configured = match core {
        "sincos" | "divide" => preset(core, "pipelined"),
        "rsqrt_pipelined" => configuration("configs/function_pipelined.toml"),
        _ => configuration(&format!("configs/{core}.toml")),
    };
    Emitted::new(&configured, POINTS, 1)
}

#[test]
fn netlists_of_each_family_pass_the_bench_of_their_source() {
    let mut pairs = Vec::new();
    for family in families() {
        for core in CORES {
            pairs.push((family, core));
        }
    }
    pairs.par_iter().for_each(|(family, core)| {
        let emitted = emitted(core);
        let netlist = synthesise(&emitted, family).verilog;
        println!("{core} for {}", family.title);
        netlist::bench(&emitted, netlist, family).assert_passes();
    });
}

/// A look-up table, a product or a register that computes something else is noticed: the models of the cells are no empty boxes.
#[test]
fn a_wrong_cell_of_each_family_is_noticed() {
    let emitted = emitted("rsqrt_pipelined");
    for family in families() {
        let netlist = synthesise(&emitted, family).verilog;
        let (right, wrong) = match family.name() {
            "nexus" => ("\n  MULT18X18 ", ".SIGNEDA("),
            "gatemate" => ("\n  CC_MULT ", ".A("),
            "ice40-hx" => ("\n  SB_LUT4 ", ".I0("),
            _ => ("\n  MULT18X18 ", ".ASIGN("),
        };
        let cell = netlist.find(right).expect(right);
        let pin = cell + netlist[cell..].find(wrong).expect(wrong) + wrong.len();
        let mut faulty = netlist.clone();
        // An operand is inverted, or an unsigned one becomes signed.
        faulty.insert(pin, '~');
        netlist::bench(&emitted, faulty, family).assert_fails(family.title);
    }
}

/// The models of Gowin's multipliers multiply: every pair of extreme operands, signed and not, against the product of integers.
#[test]
fn models_of_gowin_multiply() {
    let cases: [(i64, i64); 6] = [
        (0, 0),
        (131_071, 131_071),
        (-131_072, 131_071),
        (-131_072, -131_072),
        (-1, 1),
        (262_143, 2),
    ];
    let mut checks = String::new();
    for (first, second) in cases {
        for (first_signed, second_signed) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let read = |value: i64, signed: i64| {
                let unsigned = value & 0x3ffff;
                if signed == 1 && unsigned >= 0x20000 { unsigned - 0x40000 } else { unsigned }
            };
            let product = read(first, first_signed) * read(second, second_signed);
            checks += &format!(
                "        a = 18'h{:x}; b = 18'h{:x}; sa = {first_signed}; sb = {second_signed}; #1;\n\
                 \x20       if (y !== 36'h{:x}) begin $display(\"FAIL %h\", y); $fatal; end\n",
                first & 0x3ffff,
                second & 0x3ffff,
                product & 0xf_ffff_ffff
            );
        }
    }
    let bench = format!(
        "module product_tb;\n    reg [17:0] a, b; reg sa, sb; wire [35:0] y;\n\
         \x20   MULT18X18 dut (.A(a), .B(b), .ASIGN(sa), .BSIGN(sb), .ASEL(1'b0), .BSEL(1'b0), .DOUT(y));\n\
         \x20   initial begin #2;\n{checks}        $display(\"PASS\"); $finish;\n    end\nendmodule\n"
    );
    let model = include_str!("../../generator/tools/gates/gowin.v").to_owned();
    let files = vec![("product_tb.v".to_owned(), bench), ("gowin.v".to_owned(), model)];
    Bench::build_quietly(VerilogSimulator::Icarus, &files, "product_tb").assert_passes();
}

/// The model of Gowin's carry cell adds and subtracts all inputs, also if they are constants.
#[test]
fn the_model_of_gowins_carry_cell_adds_and_subtracts() {
    let mut cells = String::new();
    let mut checks = String::new();
    for inputs in 0..16 {
        let [first, second, is_addition, carry] = [0, 1, 2, 3].map(|bit| inputs >> bit & 1);
        let addend = if is_addition == 1 { second } else { 1 - second };
        let sum = first + addend + carry;
        cells += &format!(
            "    wire sum{inputs}, carry{inputs};\n    ALU #(.ALU_MODE(2)) cell{inputs} (.I0(1'b{first}), \
             .I1(1'b{second}), .I3(1'b{is_addition}), .CIN(1'b{carry}), .SUM(sum{inputs}), .COUT(carry{inputs}));\n"
        );
        checks += &format!(
            "        if ({{carry{inputs}, sum{inputs}}} !== 2'd{sum}) $fatal(1, \"inputs {inputs}\");\n"
        );
    }
    let bench = format!(
        "module carry_tb;\n{cells}    initial begin #2;\n{checks}        $display(\"PASS\"); $finish;\n    \
         end\nendmodule\n"
    );
    let family = FAMILIES.iter().find(|family| family.name() == "gowin").expect("Gowin");
    let mut files = gates::models(&yosys_of(family), family).sure();
    files.push(("carry_tb.v".to_owned(), bench));
    Bench::build_quietly(VerilogSimulator::Icarus, &files, "carry_tb").assert_passes();
}

/// Numbers of words and widths of ROMs: words of 1, 2, 4, 9, 18 and 36 bits, as block memories have them, and words that take
/// several blocks.
const ROMS: [(u32, u32); 7] =
    [(16_384, 1), (8192, 2), (4096, 4), (2048, 9), (1024, 18), (512, 36), (600, 40)];

/// Every word of a ROM is read from the block memories of the families whose models are Glint's. `quadratic` tests the
/// others above.
#[test]
fn models_of_block_memories_have_every_word() {
    let mut pairs = Vec::new();
    for family in families().filter(|family| ["gowin", "nexus"].contains(&family.name())) {
        for rom in ROMS {
            pairs.push((family, rom));
        }
    }
    pairs.par_iter().for_each(|(family, rom)| assert_every_word(family, *rom));
}

/// Synthesises a ROM, and compares each word that its netlist reads with the bits that were written.
fn assert_every_word(family: &Family, (words, width): (u32, u32)) {
    let address = words.next_power_of_two().trailing_zeros();
    let mut memory = String::new();
    for at in 1..=u64::from(words) {
        // The upper bits of these products look random.
        let word = at.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - width);
        memory += &format!("{word:x}\n");
    }
    let rom = format!(
        "module rom(input wire clk, input wire [{address}-1:0] address, output reg [{width}-1:0] word);\n\
         reg [{width}-1:0] words [0:{words}-1];\ninitial $readmemh(\"words.mem\", words);\n\
         always @(posedge clk) word <= words[address];\nendmodule\n"
    );
    let bench = format!(
        "module rom_tb;\n    reg clk = 0;\n    reg [{address}-1:0] address = 0;\n    wire [{width}-1:0] word;\n    \
         reg [{width}-1:0] words [0:{words}-1];\n    integer at;\n    rom dut (.clk(clk), .address(address), .word(word));\n    \
         initial begin\n        $readmemh(\"words.mem\", words);\n        for (at = 0; at < {words}; at = at + 1) begin\n            \
         address = at; #1 clk = 1; #1 clk = 0;\n            \
         if (word !== words[at]) $fatal(1, \"word %0d is %h and not %h\", at, word, words[at]);\n        end\n        \
         $display(\"PASS\"); $finish;\n    end\nendmodule\n"
    );
    let yosys = yosys_of(family);
    let sources = [("rom.v".to_owned(), rom), ("words.mem".to_owned(), memory.clone())];
    let netlist = gates::netlist(&yosys, &sources, "rom", family, LIMIT).sure();
    let mut files = gates::models(&yosys, family).sure();
    files.push(("netlist.v".to_owned(), netlist));
    files.push(("words.mem".to_owned(), memory));
    files.push(("rom_tb.v".to_owned(), bench));
    println!("{words} words of {width} bits for {}", family.title);
    Bench::build_quietly(VerilogSimulator::Icarus, &files, "rom_tb").assert_passes();
}

//! Tests the families Gowin, Nexus and GateMate: the netlist of a core after synthesis passes the bench of the core.
//!
//! `synth.rs` tests what `glint synth` measures for them.

use glint::target::{FAMILIES, Family};
use glint::tools::VerilogSimulator;
use rayon::prelude::*;

use crate::common::bench::Bench;
use crate::common::cores::{Emitted, configuration};
use crate::common::netlist::{self, POINTS, synthesise};

/// The cores: two with a microprogram and without block memory, four pipelines with delay memories, registers and products of
/// several widths. Netlists with block memories of Gowin and Nexus cannot be simulated: Yosys has no models of those.
const CORES: [&str; 6] = [
    "cosine_power",
    "blinn",
    "cosine_power_pipelined",
    "blinn_pipelined",
    "schlick_pipelined",
    "rsqrt_pipelined",
];

fn families() -> impl Iterator<Item = &'static Family> {
    // The other families are in `synthesis.rs`.
    FAMILIES.iter().filter(|family| family.least_yosys > (0, 23))
}

fn emitted(core: &str) -> Emitted {
    // `rsqrt_pipelined` is the core of `function_pipelined.toml`.
    let file = core.replace("rsqrt", "function");
    Emitted::new(&configuration(&format!("configs/{file}.toml")), POINTS, 1)
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

//! Registered multipliers: the file for ECP5 does what the portable one does, which every simulator uses.
//!
//! Both stand side by side at all widths, and whole netlists pass the bench of their source. That a difference is
//! noticed is shown by planting some.

use std::fs;

use crate::common::bench::Bench;
use crate::common::cores::{Emitted, Files, configuration};
use crate::common::netlist::{self, POINTS, synthesise};
use crate::common::tools::{LIMIT, tool};
use glint::tools::synthesis::{FAMILIES, Family};
use glint::tools::{Simulator, gates};
use rayon::prelude::*;

const CONFIGURATION: &str = "configs/studies/threshold_dsp.toml";

/// What can be wrong with the file for ECP5.
const FAULTS: [(&str, &str); 8] = [
    (".SIGNEDA(is_signed)", ".SIGNEDA(1'b0)"),
    (".SIGNEDB(is_signed)", ".SIGNEDB(1'b1)"),
    (".CE0(enable)", ".CE0(1'b1)"),
    (".REG_OUTPUT_CLK(\"CLK0\")", ".REG_OUTPUT_CLK(\"NONE\")"),
    (".A3(a_wide[3])", ".A3(a_wide[2])"),
    (".B17(b_wide[17])", ".B17(1'b0)"),
    (".P20(whole[20])", ".P20(whole[21])"),
    ("is_signed & a[A_WIDTH-1]", "1'b0"),
];

/// The two forms side by side at all widths, with and without a sign, while factors and enable change.
const TWINS: &str = r#"`timescale 1ns / 1ps
module twin #(parameter A = 18, parameter B = 18, parameter SIGNED = 0) (
    input wire clk, input wire enable, input wire [17:0] a, input wire [17:0] b
);
    wire [A+B-1:0] one, other;
    MODULE #(.A_WIDTH(A), .B_WIDTH(B), .SIGNED(SIGNED)) portable (
        .clk(clk), .enable(enable), .a(a[A-1:0]), .b(b[B-1:0]), .product(one));
    MODULE_ecp5 #(.A_WIDTH(A), .B_WIDTH(B), .SIGNED(SIGNED)) own (
        .clk(clk), .enable(enable), .a(a[A-1:0]), .b(b[B-1:0]), .product(other));
    reg loaded = 0;
    always @(posedge clk) begin
        loaded <= loaded | enable;
        if (loaded && one !== other) begin
            $display("FAIL %0d by %0d bits, signed %0d: %h and %h", A, B, SIGNED, one, other);
            $fatal;
        end
    end
endmodule

module twins;
    reg clk = 0, enable = 1;
    reg [17:0] a = 0, b = 0;
    genvar i, j;
    generate
        for (i = 1; i <= 18; i = i + STEP) begin : wide
            for (j = 1; j <= 18; j = j + STEP) begin : narrow
                twin #(.A(i), .B(j), .SIGNED(0)) without_sign (.clk(clk), .enable(enable), .a(a), .b(b));
                twin #(.A(i), .B(j), .SIGNED(1)) with_sign (.clk(clk), .enable(enable), .a(a), .b(b));
            end
        end
    endgenerate
    integer at;
    initial begin
        for (at = 0; at < 200; at = at + 1) begin
            #5 clk = 1;
            #1 enable = at < 3 || ($random & 1) == 1;
            a = at % 7 == 0 ? 18'h3ffff : at % 11 == 0 ? 18'h20000 : $random;
            b = at % 5 == 0 ? 18'h3ffff : at % 13 == 0 ? 18'h20000 : $random;
            #4 clk = 0;
        end
        $display("PASS");
        $finish;
    end
endmodule
"#;

fn ecp5() -> &'static Family {
    FAMILIES.iter().find(|family| family.name == "ecp5").expect("ECP5")
}

/// The files of the configuration, and the text of its multiplier for ECP5.
fn emitted() -> (Emitted, String) {
    let emitted = Emitted::new(&configuration(CONFIGURATION), POINTS, 1);
    let own = emitted.files.iter().find(|file| file.path.contains("/ecp5/")).expect("a file");
    let own = own.contents.clone();
    (emitted, own)
}

/// The bench of both forms, with this text for ECP5, at every so many widths from 1 to 18.
fn twins(emitted: &Emitted, own: &str, step: u32) -> Bench {
    let module = format!("{}_multiplier", emitted.name);
    let file = format!("{module}.v");
    let mut files: Files = emitted.rtl().into_iter().filter(|(name, _)| *name == file).collect();
    assert_eq!(files.len(), 1, "{file}");
    let renamed = own.replace(&format!("module {module}"), &format!("module {module}_ecp5"));
    files.push(("own.v".to_owned(), renamed));
    files.push((
        "twins.v".to_owned(),
        TWINS.replace("MODULE", &module).replace("STEP", &step.to_string()),
    ));
    files.extend(gates::models(&tool("yosys"), ecp5()).expect("models"));
    Bench::build_quietly(Simulator::Icarus, &files, "twins")
}

#[test]
fn both_forms_are_one_at_all_widths_and_a_difference_is_noticed() {
    let (emitted, own) = emitted();
    twins(&emitted, &own, 1).assert_passes();
    FAULTS.into_par_iter().for_each(|(right, wrong)| {
        assert!(own.contains(right), "{right}");
        twins(&emitted, &own.replace(right, wrong), 17).assert_fails(wrong);
    });
}

#[test]
fn a_netlist_has_a_register_in_every_multiplier_and_passes_its_bench() {
    let core = configuration(CONFIGURATION);
    let (emitted, _) = emitted();
    let place = tempfile::tempdir().expect("a directory");
    synthesise(place.path(), &emitted, ecp5());
    let text = fs::read_to_string(place.path().join("netlist.v")).expect("a netlist");
    let pipeline = core.design.pipeline.as_ref().expect("a pipeline");
    assert_eq!(text.matches("MULT18X18D #(").count(), pipeline.registered.len());
    assert_eq!(text.matches(".REG_OUTPUT_CLK(\"CLK0\")").count(), pipeline.registered.len());
    netlist::bench(&emitted, text.clone(), ecp5()).assert_passes();
    let wrong = text.replacen(".REG_OUTPUT_CLK(\"CLK0\")", ".REG_OUTPUT_CLK(\"NONE\")", 1);
    netlist::bench(&emitted, wrong, ecp5()).assert_fails("a product that is not held");
}

/// For another family the portable form is as good: its synthesiser finds multipliers itself.
#[test]
fn another_family_takes_the_portable_form() {
    // It has no memories for delay lines either.
    let text = fs::read_to_string(CONFIGURATION).expect("a configuration");
    let place = tempfile::tempdir().expect("a directory");
    let path = place.path().join("portable.toml");
    fs::write(&path, text + "delays = \"registers\"\n").expect("written");
    let emitted = Emitted::new(&configuration(path.to_str().expect("a path")), POINTS, 1);
    let ice40 = FAMILIES.iter().find(|family| family.name == "ice40").expect("iCE40");
    let place = tempfile::tempdir().expect("a directory");
    synthesise(place.path(), &emitted, ice40);
    let text = fs::read_to_string(place.path().join("netlist.v")).expect("a netlist");
    netlist::bench(&emitted, text, ice40).assert_passes();
}

/// The flow for ECP5 takes the file for ECP5 and no other of that name; a simulation takes the portable one.
#[test]
fn fusesoc_takes_the_file_of_the_target() {
    let (emitted, _) = emitted();
    let place = tempfile::tempdir().expect("a directory");
    for file in &emitted.files {
        let path = place.path().join(&file.path);
        fs::create_dir_all(path.parent().expect("a directory")).expect("a directory");
        fs::write(path, &file.contents).expect("written");
    }
    let core = format!("glint:device:{}", emitted.name);
    for (target, own) in [("ecp5", true), ("sim", false)] {
        let arguments = ["--cores-root", ".", "run", "--setup", "--build-root", target];
        let arguments = arguments.iter().copied().chain(["--target", target, &core]);
        let run = tool("fusesoc").run_to_success(arguments, place.path(), LIMIT);
        run.unwrap_or_else(|error| panic!("{error:#}"));
        let full = format!("glint_device_{}_0.1.0", emitted.name);
        let core = place.path().join(target).join(&full).join(target).join("src").join(&full);
        let file = format!("{}_multiplier.v", emitted.name);
        assert_eq!(core.join("ecp5").join(&file).exists(), own, "{target}");
        assert_eq!(core.join(&file).exists(), !own, "{target}");
    }
}

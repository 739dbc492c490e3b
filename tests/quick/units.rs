//! Tests units: several functions behind one datapath, selected by an opcode.
//!
//! The contract of a unit takes its results from the plan of each function alone, and the exact values from the formulas. Every
//! combination of opcode and operands is simulated, and each result must be the one of the contract.

use std::collections::BTreeSet;

use crate::common::Sure;
use crate::common::cores::{Emitted, assert_agrees, assert_results_as_stated, parsed, preset};
use glint::config::Value;
use glint::core::Core;
use glint::cosim::batch::{Engine, Golden, Points, RustHdl};
use glint::golden::ANY_VALUE;
use glint::hdl::netlist::{Design, Driver, Net, Op, Sequence};

use crate::workspace::Workspace;

/// Five functions with operands of five bits: one and two operands, one and two results, results with and without a sign, shifts
/// by single bits and by pairs of bits, and an operand that is limited to its domain.
const SMALL: &str = "device = \"unit\"\nname = \"few\"
[functions.rcp]
operands.x = { bits = 5, fraction = 2 }
results.r = { formula = \"1 / x\", fraction = 3, where = \"x > 0\" }
[functions.rsqrt]
operands.x = { bits = 5, fraction = 2 }
results.r = { formula = \"1 / sqrt(x)\", fraction = 4, where = \"x > 0\" }
[functions.log2]
operands.x = { from = \"1/2\", to = 4, fraction = 3, outside = \"clamp\" }
results.r = { formula = \"log2(x)\", fraction = 4 }
[functions.divide]
operands.x = { bits = 4, fraction = 4, signed = true }
operands.y = { bits = 4, fraction = 4 }
results.q = { formula = \"x / y\", fraction = 3, where = \"y > 0.2\" }
results.sum = { formula = \"x + y\", fraction = 4 }
[functions.exp2]
operands.x = { bits = 5, fraction = 2, signed = true }
results.r = { formula = \"2^x\", fraction = 4 }
";

#[test]
fn every_opcode_gives_the_results_of_its_function() {
    for architecture in [
        "",
        "architecture = \"pipelined\"\n",
        "architecture = \"pipelined\"\npipeline.interval = 3\n",
    ] {
        let text = SMALL.replacen("[functions", &format!("{architecture}[functions"), 1);
        let core = parsed("few.toml", &text);
        assert_agrees(&core, 3000, 1, architecture);
        assert_results_as_stated(&core, architecture);
    }
}

/// Returns the opcodes for which a design has a wrong result, at every combination of opcode and operands that the contract covers.
fn wrong_opcodes(core: &Core, design: &Design) -> BTreeSet<i64> {
    let contract = core.contract.as_ref();
    let mut points = Points::new(3);
    let mut opcodes = Vec::new();
    for opcode in 0..core.design.functions.len() as i64 {
        for a in 0..32 {
            for b in 0..16 {
                let mut exact = Vec::new();
                contract.exact(&[opcode, a, b], 0, &mut exact);
                if !exact.contains(&ANY_VALUE) {
                    opcodes.push(opcode);
                    points.push([opcode, a, b], 1);
                }
            }
        }
    }
    let expected = Golden(contract).compute(&points).sure();
    let simulated = RustHdl::new(design, contract).and_then(|mut engine| engine.compute(&points));
    // A computation that never ends is wrong, too.
    let Ok(simulated) = simulated else { return opcodes.into_iter().collect() };
    let outputs = contract.outputs().len();
    let rows = simulated.chunks(outputs).zip(expected.chunks(outputs));
    let wrong = rows.zip(opcodes).filter(|((found, expected), _)| found != expected);
    wrong.map(|(_, opcode)| opcode).collect()
}

/// A function that skips its microinstructions has wrong results.
#[test]
fn faults_in_start_addresses_are_noticed() {
    let core = parsed("few.toml", SMALL);
    assert_eq!(wrong_opcodes(&core, &core.design), BTreeSet::new());
    let functions = core.design.functions.len();
    let dispatch = core.design.control.dispatch.expect("a dispatch").index();
    let targets = &core.design.roms[dispatch].words;
    // The microinstruction that loads the results follows all others.
    let last = *targets.iter().max().expect("targets");
    let microprogram = core.design.control.microprogram.iter().enumerate();
    let dispatches =
        microprogram.filter(|(_, it)| matches!(it.sequence, Sequence::Dispatch { .. }));
    let dispatches: Vec<u64> = dispatches.map(|(address, _)| address as u64).collect();
    // The addresses of the words that the functions read. The last address replaces each word in turn.
    let mut faults: Vec<usize> = Vec::new();
    for opcode in 0..functions {
        let mut address = 0;
        for (number, &of_dispatch) in dispatches.iter().enumerate() {
            let at = 8 * number + opcode;
            if address <= of_dispatch {
                address = targets[at];
                faults.extend((address != last).then_some(at));
            }
        }
    }
    for &at in &faults {
        let mut design = core.design.clone();
        design.roms[dispatch].words[at] = last;
        let wrong = wrong_opcodes(&core, &design);
        assert!(wrong.contains(&((at % 8) as i64)), "word {at} of the dispatch");
    }
    assert!(faults.len() > functions, "{} faults", faults.len());
}

/// A function skips the microinstructions that it does not need.
#[test]
fn each_function_of_the_preset_takes_its_own_clocks() {
    let core = preset("unit", "sequential");
    let functions = core.design.functions.iter().enumerate();
    let clocks: Vec<(&str, Option<u32>)> = functions
        .map(|(opcode, it)| (it.name.as_str(), core.design.clocks_of_function(opcode)))
        .collect();
    let expected = [
        ("rcp", 9),
        ("rsqrt", 9),
        ("sqrt", 9),
        ("exp2", 9),
        ("log2", 9),
        ("sincos", 14),
        ("atan2", 16),
        ("divide", 10),
    ];
    assert_eq!(clocks, expected.map(|(name, clocks)| (name, Some(clocks))));
}

/// A value that several functions read has a name without a function, which no other net has.
#[test]
fn shared_values_have_names_of_their_own() {
    let text = r#"
device = "unit"
name = "u"
architecture = "sequential"

[functions.f0]
operands.x = { bits = 11, fraction = 11 }
results.q = { formula = "x^(1/3)", fraction = 6, error = 0.9 }

[functions.f1]
operands.x = { bits = 11, fraction = 10, signed = true }
operands.y = { bits = 11, fraction = 10, signed = true }
results.a = { formula = "atan2(y, x) / pi", fraction = 14, error = 1.5, where = "x^2 + y^2 > 0" }

[functions.f2]
operands.x = { bits = 11, fraction = 9 }
results.q = { formula = "exp(-x^2)", fraction = 4, error = 0.75 }

[functions.f3]
operands.x = { bits = 11, fraction = 11 }
results.q = { formula = "x^2.2", fraction = 4, error = 0.75 }

[functions.f4]
operands.x = { bits = 14, fraction = 13, signed = true }
results.q = { formula = "abs(x)", fraction = 4 }
"#;
    let core = parsed("u.toml", text);
    assert_agrees(&core, 200, 1, "u");
}

/// The logarithm is below 0, and passes the shifter that the reciprocal needs.
#[test]
fn a_negative_value_passes_the_shifter() {
    let text = r#"
device = "unit"
name = "u"

[functions.rcp]
operands.x = { bits = 8, fraction = 4 }
results.r = { formula = "1 / x", fraction = 4, where = "x > 0" }

[functions.opposite]
operands.x = { bits = 8, fraction = 4 }
results.r = { formula = "-log2(x)", fraction = 6, where = "x > 0" }
"#;
    let core = parsed("u.toml", text);
    let is_signed_shift = |net: &Net| net.name.starts_with("shifted_") && net.format.signed;
    assert!(core.design.nets.iter().any(is_signed_shift));
    assert_agrees(&core, 500, 1, "u");
}

#[test]
fn an_opcode_without_a_function_gives_0() {
    let core = parsed("few.toml", SMALL);
    for opcode in 5..8 {
        let mut raw = Vec::new();
        core.contract.results(&[opcode, 7, 9], 0, &mut raw);
        assert_eq!(raw, [0, 0], "opcode {opcode}");
    }
}

/// All eight functions have one multiplier, one normaliser and one table.
#[test]
fn the_functions_of_the_preset_share_the_costly_parts() {
    let core = preset("unit", "sequential");
    let roms = core.design.roms.iter().filter(|rom| !core.design.is_control_memory(rom)).count();
    // The coefficients, the pages of two reads, and the conditions of choices.
    assert_eq!(roms, 4);
    let is_product = |net: &Net| matches!(net.driver, Driver::Op(Op::Mul(..)));
    let products = core.design.nets.iter().filter(|net| is_product(net)).count();
    assert_eq!(products, 1);
    assert_agrees(&core, 1000, 1, "unit");
}

#[test]
fn opcodes_are_constants_in_verilog_and_c() {
    let text = SMALL.replacen("[functions", "package.software = true\n[functions", 1);
    let files = Emitted::new(&parsed("few.toml", &text), 1, 1).files;
    let contents = |end: &str| {
        let file = files.iter().find(|file| file.path.ends_with(end));
        &file.unwrap_or_else(|| panic!("no {end}")).contents
    };
    assert!(contents("few_datapath.v").contains("localparam [2:0] FUNCTION_LOG2 = 3'd2;"));
    assert!(!contents("few_control.v").contains("FUNCTION_"));
    assert!(contents("few_model.h").contains("#define FEW_FUNCTION_LOG2 2\n"));
}

/// The constants of functions differ from the limits of ports, such as `TWO_OPCODE_MAX`.
#[test]
fn functions_may_have_the_names_of_limits() {
    let mut text = "device = \"unit\"\nname = \"two\"\npackage.software = true\n".to_owned();
    for (name, formula) in
        [("max", "x * x"), ("min", "3 * x"), ("width", "x + 1"), ("fraction_bits", "x / 2")]
    {
        text += &format!(
            "functions.{name}.operands.x = {{ bits = 3, fraction = 1 }}\n\
             functions.{name}.results.r = {{ formula = \"{formula}\", fraction = 1 }}\n"
        );
    }
    let files = Emitted::new(&parsed("two.toml", &text), 1, 1).files;
    let header = files.iter().find(|file| file.path.ends_with("two_model.h")).expect("a header");
    let defines = header.contents.lines().filter_map(|line| line.strip_prefix("#define "));
    let mut names: Vec<&str> = defines.filter_map(|line| line.split(' ').next()).collect();
    assert!(names.contains(&"TWO_FUNCTION_MAX") && names.contains(&"TWO_OPCODE_MAX"));
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
}

/// A function can be a configuration of `expression` in a file of its own, whose other keys do not count.
#[test]
fn a_function_can_be_in_a_file() {
    let unit = "device = \"unit\"\n[functions.fog]\nfile = \"fog.toml\"\n";
    let dir = Workspace::with("sfu.toml", unit);
    let fog = "device = \"expression\"\narchitecture = \"pipelined\"
operands.z = { bits = 6, fraction = 6 }\nlet.twice = \"2 * z\"
results.f = { formula = \"1 - twice / 4\", fraction = 6 }\n";
    dir.write("fog.toml", fog);
    let said = dir.done(["eval", "sfu.toml", "opcode=0", "a=32"]);
    assert!(said.contains("| r_out  |    48 |   48.000000000 |"), "{said}");
    // Each with the file of the function, and what the message says.
    let cases = [
        ("device = \"function\"\n", "does not configure the device expression"),
        ("device = \"expression\"\noperands = 3 3\n", "`fog.toml` cannot be read"),
        (
            &fog.replace("bits = 6", "bits = 99"),
            "in `fog.toml`: `operands.z.bits` = 99 is out of range",
        ),
        (&fog.replace("2 * z", "2 * y"), "there is no operand and no earlier part `y`"),
    ];
    for (file, message) in cases {
        dir.write("fog.toml", file);
        dir.glint(["generate", "sfu.toml"]).refused(1, &[message]);
    }
    dir.write("sfu.toml", unit.replace("fog.toml", "haze.toml"));
    dir.glint(["generate", "sfu.toml"]).refused(1, &["`haze.toml` cannot be read"]);
    dir.write("sfu.toml", format!("{unit}operands.z = {{ bits = 6, fraction = 6 }}\n"));
    dir.glint(["generate", "sfu.toml"])
        .refused(1, &["`functions.fog` has `file` and other fields"]);
}

/// A function of a unit has the error that is proved for the function, and the unit has the largest.
#[test]
fn a_unit_has_the_largest_bound_of_its_functions() {
    let core = parsed("few.toml", SMALL);
    let bounds = core.contract.bounds();
    assert_eq!(bounds.outputs.len(), 2);
    assert!(bounds.outputs[0].units < 1.0);
    // A sum is exact.
    assert_eq!(bounds.outputs[1].units, 0.0);
    let Value::Table(functions) = core.config().value("functions") else { panic!("a table") };
    assert_eq!(functions.0.len(), 5);
}

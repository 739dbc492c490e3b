//! Tests that a bench notices at least half of the planted faults in a synthesised netlist, and that netlists of standard cells
//! pass. Without such a test, a bench that passes, or a model of a cell, would mean little.
//!
//! `tests/tools/synthesis.rs` tests that the netlists of iCE40 and ECP5 pass.

use crate::common::Sure;
use crate::common::cores::{Emitted, configuration, configuration_with};
use crate::common::files::replaced;
use crate::common::netlist::{self, POINTS, synthesise};
use crate::common::sample::sampled_by_name;
use crate::common::tools::{LIMIT, benched, tool};
use glint::core::Core;
use glint::target::{COMPARED, ECP5, Family};
use glint::tools::VerilogSimulator;
use glint::tools::gates;
use glint::tools::gates::cells::{self, Start};
use rayon::prelude::*;

fn families() -> impl ParallelIterator<Item = &'static Family> {
    let simulated = |family: &&Family| gates::is_simulated(family);
    COMPARED.par_iter().filter(simulated)
}

/// One bit of a block RAM's initial values: in ROM(n) of `quadratic`, the top bit of a(1), which is often
/// read. Its word is the second of the memory, 20 bits above the first.
#[test]
fn a_bit_of_a_block_ram_is_noticed() {
    const PARAMETER: &str = ".INITVAL_00(320'h";
    const BIT: usize = 20 + 17;
    let emitted = Emitted::new(&configuration("configs/quadratic.toml"), POINTS, 1);
    let netlist = synthesise(&emitted, &ECP5).verilog;
    let at = netlist.find(PARAMETER).expect(PARAMETER) + PARAMETER.len();
    let digits = netlist[at..].find(')').expect("the end of the number");
    let wrong = with_digit(&netlist, at + digits - 1 - BIT / 4, |digit| digit ^ 1 << (BIT % 4));
    netlist::bench(&emitted, wrong, &ECP5).assert_fails("a bit of a block RAM");
}

/// Look-up tables, spread over the netlist, each inverted. Not all of them matter: synthesis leaves tables whose
/// output nobody reads, and low bits of a product that rounding hides. Half of them must be noticed at least.
#[test]
fn bits_of_look_up_tables_are_noticed() {
    const TABLES: usize = 12;
    families().for_each(|family| {
        let emitted = Emitted::new(&configuration("configs/schlick.toml"), POINTS, 1);
        let netlist = synthesise(&emitted, family).verilog;
        let (cell, parameter) = match family.name() {
            "ice40" => ("SB_LUT4 #(", ".LUT_INIT(16'h"),
            _ => ("LUT4 #(", ".INIT(16'h"),
        };
        let tables: Vec<usize> = netlist
            .match_indices(cell)
            .filter_map(|(at, _)| Some(at + netlist[at..].find(parameter)? + parameter.len()))
            .collect();
        assert!(tables.len() > 10 * TABLES, "{}", family.name());
        let step = tables.len() / TABLES;
        let unnoticed: Vec<usize> = (0..TABLES)
            .into_par_iter()
            .map(|number| tables[number * step])
            .filter(|&at| {
                let wrong = (at..at + 4)
                    .fold(netlist.clone(), |text, at| with_digit(&text, at, |digit| !digit & 15));
                let run = netlist::bench(&emitted, wrong, family).run();
                run.status.success()
            })
            .collect();
        assert!(
            unnoticed.len() * 2 <= TABLES,
            "{}: {} of {TABLES} inverted look-up tables are not noticed: those at {unnoticed:?}",
            family.name(),
            unnoticed.len()
        );
    });
}

/// A mode that the models do not know ends the simulation.
#[test]
fn an_unknown_mode_is_refused() {
    let emitted = Emitted::new(&configuration("configs/quadratic.toml"), 1, 1);
    let netlist = synthesise(&emitted, &ECP5).verilog;
    for (right, wrong) in [
        (".REGMODE_A(\"NOREG\")", ".REGMODE_A(\"OUTREG\")"),
        (".DATA_WIDTH_A(32'd18)", ".DATA_WIDTH_A(32'd36)"),
        (".SOURCEA(1'h0)", ".SOURCEA(1'h1)"),
    ] {
        netlist::bench(&emitted, replaced(&netlist, right, wrong), &ECP5).assert_fails(wrong);
    }
}

/// Returns the text with another hexadecimal digit at a place.
fn with_digit(text: &str, at: usize, change: impl Fn(u32) -> u32) -> String {
    let digit = text[at..].chars().next().and_then(|digit| digit.to_digit(16));
    let changed = char::from_digit(change(digit.expect("a digit")), 16).expect("a digit");
    format!("{}{changed}{}", &text[..at], &text[at + 1..])
}

/// The netlist of a configuration in standard cells passes the bench of its source, and a buffer in place of an inverter
/// is noticed: of the pipelines from unknown values in all registers, memories of delay lines among them.
#[test]
fn netlists_of_cells_pass_and_wrong_gates_fail() {
    const GATES: usize = 8;
    let case = configuration_with("configs/threshold.toml", "\n[package]\nmemories = \"case\"\n");
    let of = |path: &str| configuration(&format!("configs/{path}.toml"));
    let cores = [of("cosine_power_pipelined"), of("lyon_pipelined"), of("cosine_power"), case];
    let name_of = |core: &Core| core.config().name.clone();
    sampled_by_name("netlists of cells", cores, name_of).par_iter().for_each(|core| {
        let emitted = Emitted::new(core, POINTS, 1);
        let rtl = emitted.rtl();
        let netlist = cells::netlist(&tool("yosys"), &rtl, &emitted.name, LIMIT).sure();
        let names: Vec<String> = rtl.into_iter().map(|(name, _)| name).collect();
        let passes = |netlist: &str, start: Start| {
            let models = cells::models(start).expect("models");
            let files = gates::around(emitted.simulated(), &names, netlist.to_owned(), models);
            benched(VerilogSimulator::Icarus, &files, &emitted.bench()).passed
        };
        let starts = Start::of(core.design.pipeline.is_some());
        for &start in starts {
            assert!(passes(&netlist, start), "{}, {start:?}", emitted.name);
        }
        let inverter = "  INVX1 ";
        let gates: Vec<usize> = netlist.match_indices(inverter).map(|(at, _)| at).collect();
        let rest = |at: usize| &netlist[at + inverter.len()..];
        let wrong = |at: usize| format!("{}  BUFX2 {}", &netlist[..at], rest(at));
        let noticed = (0..GATES).map(|number| gates[number * gates.len() / GATES]);
        let noticed = noticed.filter(|&at| !passes(&wrong(at), starts[0])).count();
        assert!(noticed * 2 > GATES, "{}: {noticed} of {GATES} buffers", emitted.name);
    });
}

//! Tests registered multipliers: the file for ECP5 computes the same as the portable file, which simulations of the emitted
//! Verilog use.
//!
//! Both files are simulated side by side, with 200 random operands for each pair of widths from 1 to 18 bits. Netlists of one
//! configuration for ECP5 and iCE40 pass the bench of their core. Planted faults must be noticed.

use crate::common::bench::Bench;
use crate::common::cores::{Emitted, Files, configuration, configuration_with};
use crate::common::netlist::{self, POINTS, synthesise};
use crate::common::tools::{ran, tool};
use crate::faults::faults;
use glint::package::FileKind;
use glint::target::{ECP5, ICE40};
use glint::tools::{VerilogSimulator, gates};
use rayon::prelude::*;

const CONFIGURATION: &str = "configs/studies/threshold_dsp.toml";

/// The two forms side by side at all widths, with and without a sign, while factors and enable change.
const TWINS: &str = include_str!("benches/twins.v");

/// Returns the files of the configuration, and the text of its multiplier for ECP5.
fn emitted() -> (Emitted, String) {
    let emitted = Emitted::new(&configuration(CONFIGURATION), POINTS, 1);
    let own = emitted.files.of(&[FileKind::TargetVerilog])[0].contents.clone();
    (emitted, own)
}

/// Returns the bench of both forms, with this text for ECP5, at every so many widths from 1 to 18.
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
    files.extend(gates::models(&tool("yosys"), &ECP5).expect("models"));
    Bench::build_quietly(VerilogSimulator::Icarus, &files, "twins")
}

#[test]
fn both_forms_are_one_at_all_widths_and_a_difference_is_noticed() {
    let (emitted, own) = emitted();
    twins(&emitted, &own, 1).assert_passes();
    faults("multipliers of ECP5").par_iter().for_each(|fault| {
        twins(&emitted, &fault.in_text(&own), 17).assert_fails(&fault.wrong);
    });
}

#[test]
fn a_netlist_has_a_register_in_every_multiplier_and_passes_its_bench() {
    let core = configuration(CONFIGURATION);
    let (emitted, _) = emitted();
    let text = synthesise(&emitted, &ECP5).verilog;
    let pipeline = core.design.pipeline.as_ref().expect("a pipeline");
    assert_eq!(text.matches("MULT18X18D #(").count(), pipeline.registered.len());
    assert_eq!(text.matches(".REG_OUTPUT_CLK(\"CLK0\")").count(), pipeline.registered.len());
    netlist::bench(&emitted, text.clone(), &ECP5).assert_passes();
    let wrong = text.replacen(".REG_OUTPUT_CLK(\"CLK0\")", ".REG_OUTPUT_CLK(\"NONE\")", 1);
    netlist::bench(&emitted, wrong, &ECP5).assert_fails("a product that is not held");
}

/// For another family the portable form is as good: its synthesiser finds multipliers itself.
#[test]
fn another_family_takes_the_portable_form() {
    // It has no memories for delay lines either.
    let core = configuration_with(CONFIGURATION, "[pipeline]\ndelays = \"registers\"\n");
    let emitted = Emitted::new(&core, POINTS, 1);
    let text = synthesise(&emitted, &ICE40).verilog;
    netlist::bench(&emitted, text, &ICE40).assert_passes();
}

/// The flow for ECP5 takes the file for ECP5 and no other of that name; a simulation takes the portable one.
#[test]
fn fusesoc_takes_the_file_of_the_target() {
    let (emitted, _) = emitted();
    let place = emitted.tree();
    let core = format!("glint:device:{}", emitted.name);
    for (target, own) in [("ecp5", true), ("sim", false)] {
        let arguments = ["--cores-root", ".", "run", "--setup", "--build-root", target];
        let arguments = arguments.iter().copied().chain(["--target", target, &core]);
        ran("fusesoc", arguments, place.path());
        let full = format!("glint_device_{}_0.1.0", emitted.name);
        let core = place.path().join(target).join(&full).join(target).join("src").join(&full);
        let file = format!("{}_multiplier.v", emitted.name);
        assert_eq!(core.join("ecp5").join(&file).exists(), own, "{target}");
        assert_eq!(core.join(&file).exists(), !own, "{target}");
    }
}

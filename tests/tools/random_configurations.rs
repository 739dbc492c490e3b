//! Tests random configurations of the devices of `Registry::catalogue`: each agrees with its golden model on every clock and
//! keeps its stated bound. The Verilog of further random configurations has no lint warnings and passes its bench in Icarus
//! Verilog.
//!
//! A run takes some of the configurations, and fewer for the device `function`, whose search takes seconds.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use crate::common::cores::{Emitted, assert_agrees, parsed, random};
use crate::common::sample::sampled_for;
use crate::common::tools::{assert_bench_passes, assert_files_are_clean};
use glint::core::Core;
use glint::keys::presets::FUNCTION;
use glint::registry::Registry;
use glint::tools::VerilogSimulator;
use rayon::prelude::*;

/// Configurations of each device that are simulated inside the program.
const SIMULATED: std::ops::Range<u64> = 0..400;

/// Points of each.
const POINTS: u64 = 150;

/// Seeds of the configurations of each device that outside tools see: others than those above.
const EMITTED: std::ops::Range<u64> = 10_000..10_100;

/// Points of the bench of each.
const BENCH_POINTS: u64 = 20;

#[test]
fn golden_model_and_simulation_agree_and_the_bound_holds() {
    for device in Registry::catalogue().devices() {
        // The search of a function takes seconds.
        let is_function = device.name == FUNCTION;
        let kind = if is_function { "random functions" } else { "random configurations" };
        sampled_for(device.name, kind, SIMULATED).into_par_iter().for_each(|seed| {
            let (toml, core) = random(*device, seed);
            assert_agrees(&core, POINTS, 7, &toml);
        });
    }
}

#[test]
fn the_verilog_is_clean_and_passes_its_bench() {
    for device in Registry::catalogue().devices() {
        let is_function = device.name == FUNCTION;
        let kind = if is_function { "random Verilog of functions" } else { "random Verilog" };
        sampled_for(device.name, kind, EMITTED).into_par_iter().for_each(|seed| {
            let (toml, core) = random(*device, seed);
            passes_outside(&toml, &core, seed);
        });
    }
}

/// Configurations that random draws once found wrong.
const ONCE_WRONG: [&str; 2] = [
    // Nothing but u = 0 remains below the last range of the sine.
    "device = \"rough\"\ncosine.fraction = 14\nproduct.fraction = 14\n[sine]\nfraction = 14\nsegments = [2, 4, 2, 6, 2, 4, 2]\nslope_fraction = 9",
    // One offset bit remains, which is the sign alone.
    "device = \"function\"\n[function]\nformula = \"1 / sqrt(x)\"\nfrom = 1\nto = 4\nto_included = true\noutside = \"anything\"\n\
     [operand]\nfraction = 9\n[result]\nfraction = 4\nerror = 317.89\n[approximation]\ndegree = 2\nsegments = \"halving\"",
];

#[test]
fn what_was_wrong_once_is_right() {
    for (at, text) in ONCE_WRONG.into_iter().enumerate() {
        let core = parsed(&format!("once_wrong_{at}.toml"), text);
        assert_agrees(&core, POINTS, 7, text);
        passes_outside(text, &core, 1);
    }
}

/// Verilator and Icarus Verilog have no remarks on the Verilog, and the bench passes.
fn passes_outside(toml: &str, core: &Core, seed: u64) {
    let check = || {
        let emitted = Emitted::new(core, BENCH_POINTS, seed);
        assert_files_are_clean(&emitted.rtl(), &emitted.name);
        assert_bench_passes(VerilogSimulator::Icarus, &emitted.simulated(), &emitted.bench());
    };
    if let Err(panic) = catch_unwind(AssertUnwindSafe(check)) {
        eprintln!("the configuration was:\n{toml}");
        resume_unwind(panic);
    }
}

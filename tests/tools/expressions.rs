//! Tests the configurations of expressions that `glint new` can print: each agrees with its golden model and passes its bench
//! in Icarus Verilog, as a sequential core, as a pipeline, and as a pipeline with an interval of 2.
//!
//! `tests/kinds.toml` says which of them a run takes.

use crate::common::bench::Bench;
use crate::common::cores::{Emitted, assert_agrees, parsed};
use crate::common::netlist::POINTS;
use crate::common::sample::sampled_by_name;
use glint::keys::presets;
use glint::tools::VerilogSimulator;

/// The names of all configurations of `expression`.
fn names() -> Vec<&'static str> {
    let is_expression =
        |name: &&str| presets::find(name).is_some_and(|it| it.device == "expression");
    presets::names().filter(is_expression).collect()
}

/// Returns the TOML of a configuration, with more lines.
fn text(name: &str, more: &str) -> String {
    let preset = presets::find(name).expect("a configuration");
    let mut text = format!("device = \"expression\"\nname = \"core\"\n{more}\n");
    for (key, value) in &preset.values {
        text += &format!("{key} = {}\n", value.toml());
    }
    text
}

#[test]
fn every_expression_passes_its_bench() {
    for name in sampled_by_name("expressions", names(), |name| (*name).to_owned()) {
        for line in [
            "",
            "architecture = \"pipelined\"",
            "architecture = \"pipelined\"\npipeline.interval = 2",
        ] {
            let core = parsed("core.toml", &text(name, line));
            assert_agrees(&core, 2000, 1, name);
            let emitted = Emitted::new(&core, POINTS, 1);
            Bench::build(VerilogSimulator::Icarus, &emitted.simulated(), &emitted.bench())
                .assert_passes();
        }
    }
}

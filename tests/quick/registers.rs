//! What registers around a device of one's own can be asked for.

use glint::config::Config;
use glint::dsl::{Designer, end, step, valid};
use glint::fixed::Format;
use glint::hdl::netlist::Design;
use glint::package::{EmitInputs, Surroundings, Unfit, emit};
use glint::registry::Registry;

const BYTE: Format = Format::unsigned(0, 8);

/// A device that hands its operand on.
fn device(operand: &str, result: &str) -> Design {
    let d = Designer::new("device");
    let x = d.operand(operand, BYTE);
    let y = d.register("y", BYTE);
    y.takes(x.q());
    d.output(result, y.q());
    d.microprogram([step("idle", []), step("load", [y.load()]), step("result", [valid(), end()])]);
    d.finish().expect("a design")
}

fn on_wishbone(design: &Design) -> anyhow::Result<usize> {
    let text = "device = \"cosine-power\"\n[interface]\nregisters = \"wishbone\"\n";
    let config: Config = glint::config::parse("x.toml", text, &Registry::catalogue().schemas())?;
    let around = Surroundings::new(&config, None);
    Ok(emit(design, &EmitInputs { around, ..EmitInputs::default() })?.len())
}

#[test]
fn names_that_collide_in_the_map() {
    assert!(on_wishbone(&device("x", "y_out")).expect("registers") > 0);
    for name in ["status", "id", "interrupt_enable"] {
        let error = on_wishbone(&device(name, "y_out")).expect_err("two of that name");
        let unfit = error.downcast_ref::<Unfit>().expect("a key");
        assert_eq!(unfit.key, "interface.registers");
        assert_eq!(unfit.message, format!("two registers of `device` are named `{name}`"));
        assert!(unfit.remedy.contains("another one in the description"), "{unfit}");
    }
}

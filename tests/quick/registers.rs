//! Tests keys that add registers to a core, with devices that are defined in this file: names that collide in a register map,
//! pipelines, and golden models that cannot predict the added registers.

use std::sync::Arc;

use glint::base::config_error::ConfigError;
use glint::config::{self, Config};
use glint::devices;
use glint::dsl::{Designer, end, step, valid};
use glint::fixed::Format;
use glint::golden::{self, Model};
use glint::hdl::netlist::Design;
use glint::package::{EmitInputs, Surroundings, emit};
use glint::registry::{Device, KeyParts, Registry};

use crate::common::cores::{self, with_keys};

const BYTE: Format = Format::unsigned(0, 8);

/// Returns a device that hands its operand on.
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
    let config: Config = config::parse("x.toml", text, &Registry::catalogue().schemas())?;
    let around = Surroundings::new(&config, None);
    Ok(emit(design, &EmitInputs { around, ..EmitInputs::default() })?.len())
}

#[test]
fn colliding_names_in_the_map_are_refused() {
    assert!(on_wishbone(&device("x", "y_out")).expect("registers") > 0);
    for name in ["status", "id", "interrupt_enable"] {
        let error = on_wishbone(&device(name, "y_out")).expect_err("two of that name");
        let error: ConfigError = error.downcast().expect("a key");
        assert_eq!(error.key, "interface.registers");
        assert_eq!(error.message, format!("two registers of `device` are named `{name}`"));
        assert!(error.remedy.contains("rename the operand or the result"), "{error}");
    }
}

/// Keys of registers that sequential cores alone have, and TOML that asks for them.
const KEYS: [(&str, &str); 2] = [
    ("output.registered", "[output]\nregistered = true\n"),
    ("operands.buffered", "[operands]\nbuffered = true\n"),
];

#[test]
fn a_pipeline_refuses_registers_of_sequential_cores() {
    for (key, toml) in KEYS {
        let text = format!("device = \"lyon\"\narchitecture = \"pipelined\"\n{toml}");
        let problems = config::parse("both.toml", &text, &Registry::catalogue().schemas())
            .expect_err("a key of sequential cores")
            .to_string();
        assert!(problems.contains(key), "{problems}");
        assert!(problems.contains("architecture = \"sequential\""), "{problems}");
    }
}

/// A golden model that was written by hand, and does not say what registers do that a key asks for.
#[derive(Clone)]
struct ByHand;

impl Model for ByHand {
    fn inputs(&self) -> &[String] {
        &[]
    }

    fn signals(&self) -> &[String] {
        &[]
    }

    fn clock(&mut self, _: &[u64]) {}

    fn values(&self) -> &[u64] {
        &[]
    }
}

#[test]
fn a_model_that_does_not_know_the_registers_is_refused() {
    let by_hand = Device {
        parts: |_| {
            Ok(Arc::new(KeyParts {
                describe: devices::threshold::describe,
                model: |_| Box::new(ByHand),
                contract: golden::threshold::contract,
            }))
        },
        ..cores::device("threshold")
    };
    assert!(with_keys(by_hand, "").is_ok());
    for (key, toml) in KEYS {
        let error = with_keys(by_hand, toml).err().expect("no model").to_string();
        let remedy = format!("remove {key}");
        assert!(error.contains("`threshold`") && error.contains(&remedy), "{error}");
    }
}

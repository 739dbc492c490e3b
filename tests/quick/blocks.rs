//! Tests the blocks of a block diagram: every register, ROM and operator of the datapath is in exactly one block, and the block
//! has the inputs that the operator reads. Exceptions are the handshake of a pipeline, and the registers that hold its
//! operands.
//!
//! `tests/kinds.toml` says which configurations a run takes. Each run also checks the devices of `examples/` and devices that are
//! composed of others.

#[allow(dead_code)]
#[path = "../../examples/fresnel/main.rs"]
mod fresnel;
#[allow(dead_code)]
#[path = "../../examples/smoothstep/main.rs"]
mod smoothstep;

use crate::common::Sure;
use crate::common::cores::all_configurations;
use crate::common::sample::sampled_by_name;
use glint::config::{Config, parse};
use glint::core::Core;
use glint::hdl::netlist::{Design, Driver, Net, NetId, Op, Partition};
use glint::pages::account::blocks::{BlockKind, Blocks};
use glint::registry::Registry;

#[test]
fn every_operator_is_in_one_block_with_its_inputs() {
    for (path, core) in sampled_by_name("blocks", all_configurations(), |(path, _)| path.clone()) {
        check(&path, &core.design);
    }
}

#[test]
fn so_is_every_operator_of_the_examples_and_of_composed_devices() {
    let devices = [fresnel::FRESNEL, smoothstep::SMOOTHSTEP];
    let composed = Registry::shipped();
    let composed = composed.devices().iter().rev().take(3);
    for device in composed.copied().chain(devices) {
        let schema = (device.schema)();
        let pipelined = format!(
            "device = \"{}\"\nname = \"core\"\narchitecture = \"pipelined\"\n",
            device.name
        );
        let pipelined = parse("core.toml", &pipelined, std::slice::from_ref(&schema));
        for config in [Config::defaults(&schema, "core"), pipelined.expect("a configuration")] {
            let core = Core::new(device, config).sure();
            check(device.name, &core.design);
        }
    }
}

fn operator(design: &Design, net: NetId) -> Option<&Op> {
    match &design.net(net).driver {
        Driver::Op(op) => {
            let counts = ["mul", "add", "sub", "less", "equal", "mux"].contains(&op.mnemonic());
            counts.then_some(op)
        }
        _ => None,
    }
}

fn check(path: &str, design: &Design) {
    let blocks = Blocks::new(design, true);
    let all = blocks.all();
    let mut found: Vec<NetId> = all.iter().flat_map(|block| block.cells.clone()).collect();
    // What holds an operand of a pipeline goes with its port.
    found.extend(design.inputs().flat_map(|port| blocks.held(port.net)));
    found.sort_unstable();
    let count = found.len();
    found.dedup();
    assert_eq!(found.len(), count, "{path}: something is in two blocks");
    // The slot counter of a longer interval, and the register behind `in_valid`, belong to the handshake, which is not drawn.
    let is_handshake = |id: NetId| {
        design.pipeline.as_ref().is_some_and(|pipeline| {
            let counts = pipeline.slot == Some(id) || pipeline.valid.first() == Some(&id);
            pipeline.interval > 1 && (counts || pipeline.handshake.contains(&id))
        })
    };
    let drawn = |id: NetId, net: &Net| net.partition == Partition::Datapath && !is_handshake(id);
    for (id, net) in design.iter().filter(|&(id, net)| drawn(id, net)) {
        let hardware = matches!(net.driver, Driver::Register(_) | Driver::Rom(_));
        let inside = found.binary_search(&id).is_ok();
        assert!(inside || !hardware && operator(design, id).is_none(), "{path}: `{}`", net.name);
    }
    for block in &all {
        let operators = block.cells.iter().filter_map(|&it| operator(design, it));
        let operators: Vec<&Op> = operators.collect();
        let wanted = match (&operators[..], block.kind) {
            (_, BlockKind::Limiter | BlockKind::Rounding | BlockKind::RoundingLimiter) => 1,
            ([Op::Mux { inputs, .. }], _) => inputs.len(),
            ([op], _) => op.operands().len(),
            (all, _) if all.iter().any(|it| matches!(it, Op::Mul(..))) => 2,
            ([], BlockKind::Register | BlockKind::Operand) => 1,
            _ => block.inputs.len(),
        };
        let (name, kind) = (&block.name, block.kind);
        let inputs: Vec<String> = block.inputs.iter().map(|it| blocks.name(*it)).collect();
        // What a pipeline makes of a limit of one bit are gates of the statement, each of which brings its signal along.
        let is_gate = |net: &Net| {
            matches!(net.driver, Driver::Op(Op::And(..) | Op::Or(..)))
                && block.cells.iter().any(|it| std::ptr::eq(design.net(*it).location, net.location))
        };
        let gates = match operators[..] {
            [_] if design.pipeline.is_some() => {
                design.iter().filter(|(_, net)| is_gate(net)).count()
            }
            _ => 0,
        };
        let found = inputs.len();
        assert!(
            found == wanted || found == wanted + gates,
            "{path}: `{name}`, {kind}, of {inputs:?} and not {wanted}"
        );
    }
}

/// Arithmetic that the source does not document was no block: two subtractors, an adder and two muxes, so that the multiplier had four inputs.
#[test]
fn fresnel_has_its_arithmetic() {
    let config = Config::defaults(&(fresnel::FRESNEL.schema)(), "core");
    let core = Core::new(fresnel::FRESNEL, config).expect("the defaults work");
    let blocks = Blocks::new(&core.design, true);
    let all = blocks.all();
    let block = |name: &str| {
        let block = all.iter().find(|block| block.name == name);
        let block = block.unwrap_or_else(|| panic!("no `{name}`"));
        let inputs: Vec<String> = block.inputs.iter().map(|it| blocks.name(*it)).collect();
        (block.kind, inputs.join(" "))
    };
    assert_eq!(block("product"), (BlockKind::Multiplier(13, 13), "first second".to_owned()));
    assert_eq!(block("first"), (BlockKind::Mux(2), "power grazing".to_owned()));
    assert_eq!(block("second"), (BlockKind::Mux(3), "power grazing absorbed".to_owned()));
    assert_eq!(block("grazing"), (BlockKind::Subtractor, "1 cos_half_reg".to_owned()));
    assert_eq!(block("absorbed"), (BlockKind::Subtractor, "1 f0_reg".to_owned()));
    assert_eq!(block("blend"), (BlockKind::Adder, "product f0_reg".to_owned()));
}

//! Tests the key `output.registered`: results that are combinational logic get registers and come one clock later.
//!
//! Results that are registers already get no second register and come no later.

use glint::core::Core;
use glint::dsl::{Designer, Step, end, loop_while, step, valid};
use glint::fixed::{Format, Overflow, Rounding};
use glint::hdl::netlist::{Design, Driver, NetId, Op, Role};
use glint::registry::Registry;

use crate::common::cores::{assert_agrees, computations, device, with_keys as core};

/// Results that golden model and simulation are compared on.
const POINTS: u64 = 2000;

const REGISTERED: &str = "[output]\nregistered = true\n";

/// Returns whether a port shows a register, whatever it is called on the way.
fn shows_register(design: &Design, mut net: NetId) -> bool {
    while let Driver::Op(Op::Relabel(of)) = design.net(net).driver {
        net = of;
    }
    matches!(design.net(net).driver, Driver::Register(_))
}

#[test]
fn every_device_has_its_results_in_registers_a_clock_later() {
    for device in Registry::catalogue().devices() {
        let [plain, registered] =
            ["", REGISTERED].map(|more| core(*device, more).expect("a design"));
        let design = &registered.design;
        let results = design.ports.iter().filter(|port| port.role == Role::Result);
        let mut before = plain.design.ports.iter().filter(|port| port.role == Role::Result);
        // A result that is a register anyway comes no later.
        let more = u32::from(!before.all(|port| shows_register(&plain.design, port.net)));
        for port in results {
            assert!(shows_register(design, port.net), "{}", design.net(port.net).name);
        }
        for (one, other) in computations(&registered).iter().zip(computations(&plain)) {
            assert_eq!(one.operands, other.operands);
            assert_eq!(one.done, other.done + more, "{}", device.name);
            let clocks: Vec<u32> = one.results.iter().map(|it| it.clock).collect();
            let before: Vec<u32> = other.results.iter().map(|it| it.clock + more).collect();
            assert_eq!(clocks, before, "{}", device.name);
            let outputs = one.results.iter().map(|it| &it.outputs);
            assert!(outputs.eq(other.results.iter().map(|it| &it.outputs)), "{}", device.name);
        }
        assert_agrees(&registered, POINTS, 1, device.name);
    }
}

/// Results that are registers already get no other, and no clock.
#[test]
fn registers_are_left_alone() {
    let shared = "[colour]\nmultipliers = 1\n";
    let [one, other] = [shared.to_owned(), format!("{shared}{REGISTERED}")]
        .map(|more| core(device("lyon"), &more).expect("a design"));
    let clocks = |core: &Core| core.design.control.microprogram.len();
    assert_eq!(clocks(&one), clocks(&other));
    assert_eq!(one.design.registers.len(), other.design.registers.len());
}

/// Behind the registers of `line.stages` they are one more.
#[test]
fn lines_with_stages_have_them_too() {
    for (name, stages) in [("quad-cosine", 7), ("cosine-squared", 5)] {
        let keys = format!("[line]\nstages = {stages}\n{REGISTERED}");
        let core = core(device(name), &keys).expect("a design");
        let mut results = core.design.ports.iter().filter(|port| port.role == Role::Result);
        assert!(results.all(|port| shows_register(&core.design, port.net)), "{name}");
        assert_agrees(&core, POINTS, 1, name);
    }
}

/// Returns the squarer of the builder's documentation with this program's last microinstructions.
fn squarer(last: impl Fn(glint::dsl::Signal<'_>) -> Vec<Step>) -> Result<Design, String> {
    let d = Designer::new("squarer");
    let x = d.operand("x", Format::unsigned(0, 8));
    let y = d.register("y", Format::unsigned(0, 8));
    let square = d.mul("square", x.q(), x.q());
    y.takes(d.narrow("cut", square, y.format(), Rounding::Truncate, Overflow::Saturate));
    let odd = y.q().bit(0).named("odd");
    d.output("y_out", d.not("inverse", y.q()));
    let mut steps = vec![step("idle", []), step("square", [y.load()])];
    steps.extend(last(odd));
    d.register_outputs();
    d.microprogram(steps);
    d.finish().map_err(|mistakes| mistakes.to_string())
}

#[test]
fn a_result_that_decides_is_refused_with_its_place() {
    let design = squarer(|_| vec![step("result", [valid(), end()])]).expect("a design");
    let names: Vec<&str> = design.control.microprogram.iter().map(|it| it.name.as_str()).collect();
    assert_eq!(names, ["idle", "square", "result", "result, in output registers"]);
    let mistakes = squarer(|odd| {
        vec![step("result", [valid(), loop_while(odd, "square")]), step("last", [end()])]
    })
    .expect_err("it goes on by a condition");
    assert!(
        mistakes.contains("microinstruction `result` sets `valid` and decides on a condition"),
        "{mistakes}"
    );
    assert!(mistakes.contains("output_registers.rs"), "{mistakes}");
}

//! Describes the hardware of the device: blocks, wires and the microprogram. Glint emits Verilog from this description and
//! simulates it.

use super::Keys;
use glint::config::Config;
use glint::dsl::{About, Designer, end, step, valid};
use glint::fixed::{Format, Overflow, Rounding};

/// Describes the hardware of a configuration.
pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    // u1.F holds 1, to which the largest square may be rounded up.
    let result = Format::unsigned(1, keys.result as i32);

    d.about(About {
        device: "parabola".into(),
        title: "The square of a fraction".into(),
        formula: "x^2".into(),
        source: "this crate".into(),
        notes: Vec::new(),
    });

    // An operand is a port, a write strobe and a register.
    let x = d.operand("x", Format::unsigned(0, keys.operand as i32)).doc("the operand");

    // A product is exact: u0.12 times u0.12 is u0.24. Only `narrow` drops bits.
    let product = d.mul("product", x.q(), x.q());
    let square = d.register("square", result).doc("x^2, rounded");
    square.takes(d.narrow("rounded", product, result, Rounding::Nearest, Overflow::Saturate));
    d.output("square_out", square.q());

    // A microinstruction is a clock. A register that a microinstruction loads has its value in the next one.
    d.microprogram([
        step("idle", []),
        step("square", [square.load()]),
        step("result", [valid(), end()]),
    ]);
}

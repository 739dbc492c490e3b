//! The description: a multiplier, an adder, and what comes between 0 and 1.

use crate::base::fixed::{Format, Overflow, Rounding};
use crate::config::Config;
use crate::hdl::dsl::{About, Designer, end, step, valid};
use crate::keys::dot_product::Keys;

/// The device.
pub fn describe(d: &Designer, config: &Config) {
    d.about(About {
        device: "dot-product".into(),
        title: "The cosine between two unit vectors".into(),
        formula: "min(1, max(0, nx*hx + ny*hy + nz*hz))".into(),
        source: "J. F. Blinn, Models of Light Reflection for Computer Synthesized Pictures, SIGGRAPH 1977".into(),
        notes: vec![
            "Unit vectors that were rounded may have a product above 1: it becomes 1.".into(),
            "Components beyond -1 and 1 are taken for these.".into(),
        ],
    });
    let Keys { fraction, other, kept, rounding } = Keys::of(config);
    let [fraction, other, kept] = [fraction, other, kept].map(|bits| bits as i32);
    let component = |name: &str, fraction: i32, vector: &str| {
        let axis = &name[1..];
        d.operand_clamped(name, Format::signed(1, fraction), -1.0, 1.0)
            .doc(&format!("{axis} of the {vector}"))
    };
    let normal = ["nx", "ny", "nz"].map(|name| component(name, fraction, "normal"));
    let half = ["hx", "hy", "hz"].map(|name| component(name, other, "half vector"));

    let first = d.mux("first", normal.map(|it| it.q()));
    let second = d.mux("second", half.map(|it| it.q()));
    let product = d.mul("product", first.out(), second.out());

    // Three products of at most 1.0: from -3.0 to 3.0. The adder could reach 5.0, but the program does not.
    let sums = Format::signed(2, fraction + other);
    let sum = d.register("sum", sums).doc("the products so far");
    let zero = d.constant("nothing", 0.0, sums);
    let so_far = d.mux("so_far", [sum.q(), zero]);
    let added = d.add("added", so_far.out(), product);
    sum.takes(d.narrow("added_kept", added, sums, Rounding::Truncate, Overflow::Saturate));

    let rounded =
        d.narrow("rounded", sum.q(), Format::unsigned(2, kept), rounding, Overflow::Saturate);
    let one = d.constant("one", 1.0, Format::unsigned(2, kept));
    let over = d.less("over", one, rounded);
    let limited = d.choose("limited", over, [rounded, one]);
    let cosine = d.register("cosine", Format::unsigned(1, kept)).doc("the result");
    let format = cosine.format();
    cosine.takes(d.narrow("limited_kept", limited, format, Rounding::Truncate, Overflow::Saturate));
    d.output("cosine_out", cosine.q());

    let pair = |at: usize| [first.pick(normal[at].q()), second.pick(half[at].q()), sum.load()];
    let [fx, sx, lx] = pair(0);
    d.microprogram([
        step("idle", []),
        step("x", [fx, sx, lx, so_far.pick(zero)]),
        step("y", pair(1)),
        step("z", pair(2)),
        step("round", [cosine.load()]),
        step("result", [valid(), end()]),
    ]);
}

//! Describes the hardware of the device: blocks, wires and the microprogram.
//!
//! Every signal knows its format and the interval of its values, from which the DSL computes the widths. In this description
//! only `narrow` and the outputs drop bits; their arguments state the rounding, and those of `narrow` the overflow.

use super::Keys;
use glint::config::Config;
use glint::dsl::{About, Designer, end, step, valid};
use glint::fixed::{Format, Overflow};
use glint::hdl::blocks::colour::Colours;

pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    let powers = Format::unsigned(0, keys.power as i32);

    d.about(About {
        device: "fresnel".into(),
        title: "Schlick's Fresnel factor".into(),
        formula: "f0 + (1 - f0)*(1 - c)^5".into(),
        source: "C. Schlick, Computer Graphics Forum 13(3), 1994".into(),
        notes: vec!["c = 1 is normal incidence, where f = f0; c = 0 grazes the surface.".into()],
    });

    // An operand is a port, a write strobe and a register. u1.F could hold almost 2; a cosine beyond 1
    // is taken for 1, so that 1 − c below cannot be negative. The DSL knows that from here on.
    let c = d
        .operand_clamped("cos_half", Format::unsigned(1, keys.cosine as i32), 0.0, 1.0)
        .doc("cosine between the light and the half vector");
    let f0 = d
        .operand("f0", Format::unsigned(0, keys.reflectance as i32))
        .doc("reflectance at normal incidence");
    let colours = Colours::new(d, keys.colour_bits as i32, None);

    let power = d.register("power", powers).doc("(1 - c)^2, then ^4, then ^5");
    let f = d.register("f", powers).doc("the Fresnel factor");

    // 1 − x, with as many fraction bits as the powers: the muxes want their points in one place.
    let complement = |name: &str, x| {
        let one = d.constant("one", 1.0, Format::unsigned(1, 0));
        d.sub(name, one, x).with_fraction(powers.frac)
    };
    let grazing = complement("grazing", c.q());
    let absorbed = complement("absorbed", f0.q());

    // The one multiplier, and what it multiplies. A word that does not control a mux leaves it at its first
    // input, so that comes first which most words want.
    let first = d.mux("first", [power.q(), grazing]);
    let second = d.mux("second", [power.q(), grazing, absorbed]);
    let product = d.mul("product", first.out(), second.out());

    // 1.0 is no value of u0.F: it becomes the largest, one last place below. Elsewhere the ranges leave
    // saturation something to do, but the values do not; the proof is at the bound.
    let narrow = |name, x| d.narrow(name, x, powers, keys.rounding, Overflow::Saturate);
    power.takes(narrow("power_rounded", product));
    f.takes(narrow("f_rounded", d.add("blend", product, f0.q())));
    colours.outputs(f.q(), keys.output_rounding);

    // A word is a clock. What a register loads in a word is there in the next.
    d.microprogram([
        step("idle", []),
        step("square", [first.pick(grazing), second.pick(grazing), power.load()]),
        step("fourth", [power.load()]),
        step("fifth", [second.pick(grazing), power.load()]),
        step("blend", [second.pick(absorbed), f.load()]),
        step("result", [valid(), end()]),
    ]);
}

//! The hardware description of the device `cosine-power`, which computes f = (n/m·(c − 1) + 1)^m ([symbols](crate#symbols)).
//!
//! The configuration chooses m = 2, 4, 8 or 16. Seed 002 has the formula, but no circuit. The sequential core computes f with
//! one multiplier and one accumulator, and the base as 1 − n/m·(1 − c). The division by m is a shift by wiring. The product
//! saturates just below 1, so that a negative base becomes 0. For c ≤ 0 the result is 0 too.

use glint_base::fixed::{Format, Overflow};
use glint_config::Config;
use glint_keys::cosine_power::Keys;
use glint_rtl::blocks::squaring::Squarings;
use glint_rtl::dsl::{Designer, Signal, step};
use glint_rtl::netlist::{About, Topic};

use super::common::{self, ColourProducts};

pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    let count = keys.power.ilog2();
    let f = keys.f.format();
    d.about(about(&keys));

    let cos_gamma = common::cosine(d, &keys.operands.cosine).q();
    let exponent = common::exponent(d, keys.operands.exponent_bits).q();
    let colours = ColourProducts::new(d, &keys.operands.colours, None);

    // With power = 2 there is no power to square again.
    let operand_select = d.select("operand_select", &["distance", "base", "power"]).partly_used();
    let accumulator =
        d.register("accumulator", f).doc("n/m*(1 - cos gamma), later the powers of the base of W");
    let squarings = Squarings::new(d, count);

    let one = d.constant("one", 1.0, Format::unsigned(1, keys.operands.cosine.fraction as i32));
    let complement = d.sub("complement", one, cos_gamma).doc("1.0 - cos gamma");
    let zeta = exponent.shift_right(count as i32).named("zeta").doc("n/m, by wiring");
    let base = base(d, cos_gamma, accumulator.q());

    let first = d
        .bus("first", operand_select, [complement, base, accumulator.q()])
        .doc("first operand of the multiplier");
    let second = d
        .bus("second", operand_select, [zeta, base, accumulator.q()])
        .doc("second operand of the multiplier");
    let product = d.shared_mul("product", &first, &second).doc_on(
        Topic::Microprogram,
        "the shared product; its number of fraction bits depends on the operands",
    );
    let rounding_f = keys.f.rounding;
    let distance =
        d.narrow("distance", product.of(complement, zeta), f, rounding_f, Overflow::Saturate);
    let square = product.of_any(&[(base, base), (accumulator.q(), accumulator.q())]);
    let square = d.narrow("square", square, f, rounding_f, Overflow::Saturate);
    let next = d.mux_on("accumulator_next", operand_select, [distance, square, square]);
    accumulator.takes(next.out());
    let outputs = colours.results(accumulator.q(), keys.f.output_rounding);

    let mut steps = vec![
        step("operands 1 - cos gamma, n/m", []),
        step(
            "accumulator <- n/m * (1 - cos gamma)",
            [accumulator.load()].into_iter().chain(squarings.load()),
        ),
    ];
    steps.extend(squarings.steps(
        accumulator,
        [first.pick(base), second.pick(base)],
        [first.pick(accumulator.q()), second.pick(accumulator.q())],
    ));
    d.microprogram(steps.into_iter().chain(outputs));
}

/// Returns the base as the complement of the accumulator. The base is one unit in the last place (an ulp) too small, and
/// therefore always below 1. If cos γ ≤ 0, the base is 0.
fn base<'d>(d: &'d Designer, cos_gamma: Signal<'d>, accumulator: Signal<'d>) -> Signal<'d> {
    let facing = d.any("facing", cos_gamma).doc("1 if the surface faces the half vector");
    let inverse = d.not("inverse", accumulator).doc("1.0 - accumulator - 1 ulp");
    let zero = d.raw_constant("zero", 0, accumulator.format());
    d.choose("base", facing, [zero, inverse]).doc("base of the power")
}

fn about(keys: &Keys) -> About {
    let m = keys.power;
    About {
        device: "cosine-power".to_owned(),
        title: format!("Specular intensity by the cosine-power function, m = {m}"),
        formula: format!("out = colour * (n/{m} * (cos(gamma) - 1) + 1)^{m}"),
        source: "Seed 002, the paper's W(n, gamma) with zeta = n/m".to_owned(),
        notes: vec![
            "The paper gives no circuit. The quotient n/m is a shift by wiring.".into(),
            Topic::Microprogram.note(
                "The circuit is the smallest for the formula: one multiplier and one accumulator.",
            ),
            "The sum is computed as the complement 1 - n/m * (1 - cos gamma). So every number is a fraction \
             from 0 to 1, and the saturation of the first product clamps the result to 0 beyond the zero of W. \
             Inverting the accumulator gives the complement minus 1 ulp; the error bound includes this ulp."
                .into(),
            "Cosines are clamped to 0 ... 1.0 when they are written. The result is 0 for cos gamma <= 0, and \
             for cos gamma <= (n - m)/n, where W has its zero."
                .into(),
            common::outputs_note(&keys.operands.colours, "the accumulator", "begins"),
        ],
    }
}

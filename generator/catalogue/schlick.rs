//! The hardware description of the device `schlick`, which computes f = c / (n − n·c + c) ([symbols](crate#symbols)).
//!
//! Seed 002 says that the division makes this function of Schlick hard to build, and gives no circuit. The sequential core has
//! one multiplier for the divisor, n·(1 − c) + c, and a divider that computes one bit of the quotient a clock. For c ≤ 0 the
//! result is 0, also for n = 0; a quotient of 1.0 becomes the largest value below 1.

use glint_base::fixed::{Format, Overflow, Rounding};
use glint_config::Config;
use glint_keys::schlick::Keys;
use glint_rtl::blocks::divider::Divider;
use glint_rtl::dsl::{Designer, Signal, loop_while, step};
use glint_rtl::netlist::{About, Topic};

use super::common::{self, ColourProducts};

pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    d.about(about(&keys));

    let cos_gamma = common::cosine(d, &keys.operands.cosine).q();
    let exponent = common::exponent(d, keys.operands.exponent_bits).q();
    let colours = ColourProducts::new(d, &keys.operands.colours, None);

    let divisor = divisor(d, cos_gamma, exponent);
    let quotient = Divider::new(d, "quotient", cos_gamma, divisor, keys.fraction as i32);
    let outputs = colours.results(quotient.quotient(), keys.output_rounding);

    let steps = vec![
        step("operands <- cos gamma, n", []),
        step("quotient <- cos gamma / (n*(1 - cos gamma) + cos gamma)", quotient.load()),
        step(
            "next bit of the quotient",
            quotient
                .step()
                .into_iter()
                .chain([loop_while(quotient.more(), "next bit of the quotient")]),
        ),
    ];
    d.microprogram(steps.into_iter().chain(outputs));
}

/// Builds the exact divisor. If cos γ = 0, the divisor is larger by one unit in the last place, and so not 0 for n = 0. The
/// quotient is then 0, whatever the divisor is.
fn divisor<'d>(d: &'d Designer, cos_gamma: Signal<'d>, exponent: Signal<'d>) -> Signal<'d> {
    let (c, n) = (cos_gamma.format(), exponent.format());
    let one = d.constant("one", 1.0, Format::unsigned(1, c.frac));
    let complement = d.sub("complement", one, cos_gamma).doc("1.0 - cos gamma");
    let scaled = d.mul("scaled", complement, exponent).doc("n*(1 - cos gamma)");
    let facing = d.any("facing", cos_gamma).doc("1 if the surface faces the half vector");
    let dark = d.not("dark", facing).doc("1 ulp, which keeps the divisor above 0 for n = 0");
    let sum = d.add_carry("denominator", scaled, cos_gamma, dark);
    // The divisor lies between cos γ and n, or is at most 1.0; its largest value is n plus one unit in the last place.
    let format = Format::unsigned(n.int, c.frac);
    let divisor = d.narrow("divisor", sum, format, Rounding::Truncate, Overflow::Wrap);
    divisor.doc("n - n*cos gamma + cos gamma, never 0")
}

fn about(keys: &Keys) -> About {
    let bits = keys.fraction;
    About {
        device: "schlick".to_owned(),
        title: "Specular intensity by Schlick's function".to_owned(),
        formula: "out = colour * cos(gamma) / (n - n * cos(gamma) + cos(gamma))".to_owned(),
        source: "Seed 002, Schlick's function, with which the paper compares its own".to_owned(),
        notes: vec![
            format!(
                "The quotient is truncated to {bits} bits, and all of these bits are exact, because the \
                 divider keeps the whole remainder. A quotient of 1.0, for cos gamma = 1.0 or n = 0, becomes \
                 the largest fraction, 1.0 - 1 ulp."
            )
            .into(),
            Topic::Microprogram.note("Each bit of the quotient takes one clock."),
            "Cosines are clamped to 0 ... 1.0 when they are written. The result is 0 for cos gamma <= 0. A \
             division by zero cannot occur: the divisor would be 0 only for cos gamma = 0 and n = 0, and cos \
             gamma = 0 adds 1 ulp to it, so the result is 0 there too."
                .into(),
            "The source prints the fraction as cos/n - n*cos + cos, without the fraction bar. The denominator \
             is n - n*cos + cos."
                .into(),
            common::outputs_note(&keys.operands.colours, "the quotient", "begins"),
        ],
    }
}

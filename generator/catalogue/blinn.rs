//! `blinn` — cⁿ itself for run-time n (seeds 000–002: the function that all the others approximate).
//!
//! The seeds give no circuit. This is the one that a table logarithm, a product and a table exponential
//! make: cⁿ = 2^(−n·decay) with the decay −log₂ c, an octave number before what the table holds.

use glint_base::fixed::{Format, exp2};
use glint_config::Config;
use glint_keys::blinn::Keys;
use glint_rtl::blocks::shift;
use glint_rtl::dsl::Designer;
use glint_rtl::netlist::About;

use super::common;
use super::decay::{self, Curve};

/// The device.
pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    d.about(about(&keys));
    let cos_gamma = common::cosine(d, &keys.operands.cosine).q();
    let bits = keys.operands.cosine.fraction;
    let fraction = cos_gamma.bits(0, Format::unsigned(0, bits as i32));
    let normalised = shift::normalise(d, "octave", fraction);
    let octave = normalised.zeros.named("octave").doc("leading zeros of cos gamma");
    let mantissa = normalised.word.bits(0, Format::unsigned(bits as i32 - 1, 0));
    let u = d
        .not("distance", mantissa)
        .doc("1.0 - cos gamma * 2^octave, less an ulp, from 0 to one half");
    let table = move |u: f64| -libm::log2(1.0 - (u + 1.0) * exp2(-(bits as i32)));
    decay::describe(
        d,
        &keys,
        cos_gamma,
        &Curve {
            u,
            operand_bits: bits - 1,
            table: &table,
            octave: Some(octave),
            scale: 0,
            doc: "-log2(cos gamma * 2^octave)",
        },
    );
}

fn about(keys: &Keys) -> About {
    let mut notes = vec![
        "The seeds hold every device against this function and give no circuit for it; structure and formats \
         are Glint's own."
            .into(),
        "Phong's function is this device with cos psi = V.R at the input in place of N.H.".into(),
    ];
    notes.extend(decay::notes(keys));
    About {
        device: "blinn".to_owned(),
        title: "Specular intensity by Blinn's function itself".to_owned(),
        formula: "out = colour * cos(gamma)^n".to_owned(),
        source: "Seeds 000 to 002, the function that all devices approximate".to_owned(),
        notes,
    }
}

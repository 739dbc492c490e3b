//! The hardware description of the device `blinn`, which computes f = cⁿ for a run-time exponent n ([symbols](crate#symbols)).
//!
//! The seeds start from this formula of Blinn, but give no circuit for it. This circuit computes cⁿ = 2^(−n·decay) with the
//! decay −log₂ c: a logarithm, a product and an exponential. If c is 2^−k·m for a mantissa m from 1/2 to 1, the decay is k plus
//! the decay of m. For example, c = 0.15 is 2^−2·0.6, with the decay 2 − log₂ 0.6. For c ≤ 0 the result is 0, also for n = 0;
//! for c = 1.0 it is the largest value below 1.

use glint_base::fixed::Format;
use glint_config::Config;
use glint_keys::decay::{Decay, Keys};
use glint_rtl::blocks::shift;
use glint_rtl::dsl::Designer;
use glint_rtl::netlist::About;

use super::common;
use super::decay::{self, Distance};

/// Builds the hardware. Panics if the schema's check does not accept the configuration.
pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    d.about(about(&keys));
    let cos_gamma = common::cosine(d, &keys.operands.cosine).q();
    let bits = keys.operands.cosine.fraction;
    let fraction = cos_gamma.bits(0, Format::unsigned(0, bits as i32));
    let normalised = shift::normalise(d, "octave", fraction);
    // The normaliser has a long delay, so a pipeline register follows it.
    let octave = d.pipeline("octave", normalised.zeros).doc("number of leading zeros of cos gamma");
    let mantissa = normalised.word.bits(0, Format::unsigned(bits as i32 - 1, 0));
    let u = d.not("distance_next", mantissa);
    let u = d.pipeline("distance", u).doc("1.0 - cos gamma * 2^octave - 1 ulp, from 0 to one half");
    decay::describe(d, config, cos_gamma, Decay::Logarithm, Distance { u, octave: Some(octave) });
}

fn about(keys: &Keys) -> About {
    let mut notes = vec![
        "The sources compare every device with this function and give no circuit for it. Structure and formats \
         are Glint's own."
            .into(),
        "For Phong's function, apply cos psi = V.R to the input in place of N.H.".into(),
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

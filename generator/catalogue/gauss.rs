//! The hardware description of the device `gauss`, which computes f = exp(−n·γ²/2) with γ = arccos c ([symbols](crate#symbols)).
//!
//! Seed 002 compares this function with others, and gives no circuit. The paper prints the angle as ∠(H,L), but its formulas
//! use ∠(N,H), and so does this device. The device computes exp(−n·γ²/2) as 2^(−n·decay). The decay γ²/(2 ln 2) is 1 − c times
//! a smooth function of 1 − c. For c ≤ 0 the result is 0, also for n = 0.

use glint_base::fixed::Format;
use glint_config::Config;
use glint_keys::decay::{Decay, Keys};
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
    let fraction = cos_gamma.bits(0, Format::unsigned(bits as i32, 0));
    let u = d.not("distance", fraction).doc("1.0 - cos gamma - 1 ulp");
    decay::describe(d, config, cos_gamma, Decay::Angle, Distance { u, octave: None });
}

fn about(keys: &Keys) -> About {
    let mut notes = vec![
        "The source gives no circuit. It defines gamma as the angle between H and L. Here gamma is the angle \
         between N and H, because only then can the function be compared with cos^n."
            .into(),
    ];
    notes.extend(decay::notes(keys));
    About {
        device: "gauss".to_owned(),
        title: "Specular intensity by a Gaussian of the angle".to_owned(),
        formula: "out = colour * exp(-n * gamma^2 / 2)".to_owned(),
        source: "Seed 002, the fourth function that the paper considers".to_owned(),
        notes,
    }
}

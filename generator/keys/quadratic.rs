//! Declares the configuration keys of the device `quadratic`, which computes f = max(0, c + a(n)·(c² − c)) with c = cos γ. A
//! table gives the coefficient a(n) for the specular exponent n.

use super::common::{self, Domain, Intensity, Operands};
use glint_base::fixed::Rounding;
use glint_config::{Config, Key, Problems, Schema};

glint_config::choices! {
    /// The coefficients a(n) in the table ROM(n).
    pub enum Scheme {
        /// a(n) = n − 1, and 0 for n = 0. For n ≥ 1, f agrees with cosⁿγ in value and slope at the peak.
        Taylor = "taylor",
        /// The a(n) with the smallest largest error of f; 0 for n = 0, as for n = 1.
        Minimax = "minimax",
    }
}

glint_config::keys! {
    pub struct Keys {
        scheme: Scheme = Key::choice("coefficient.scheme", "minimax", Scheme::WORDS,
            "The contents of ROM(n). taylor: a(n) = n - 1, with which f has the slope of cos^n at its peak. \
             minimax: the a(n) with the smallest maximum error."),
        fraction: u32 = Key::integer("coefficient.fraction", 8, 0..=12, "Number of fraction bits of a(n).")
            .only_when("coefficient.scheme", "minimax"),
        operands: Operands = Operands::keys(),
        difference_fraction: u32 = Key::integer("difference.fraction", 19, 8..=28,
            "Number of fraction bits of c^2 - c, which a(n) multiplies."),
        difference_rounding: Rounding = Key::rounding("difference.rounding", "truncate",
            "Rounding mode of the register with c^2 - c."),
        f: Intensity = Intensity::keys(),
        domain: Domain = Domain::keys(),
    }
}

impl Keys {
    /// Returns the number of fraction bits of a(n): 0 for the scheme `Taylor`, whose coefficients are integers.
    pub fn coefficient_fraction(&self) -> u32 {
        if self.scheme == Scheme::Minimax { self.fraction } else { 0 }
    }
}

pub fn schema() -> Schema {
    Schema { device: "quadratic", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.operands.exponent_bits, problems);
    let (difference, cosine) = (keys.difference_fraction, keys.operands.cosine.fraction);
    if difference > 2 * cosine {
        let message =
            format!("c^2 - c has {difference} fraction bits, more than the square of the cosine c");
        let remedy = format!(
            "set difference.fraction to at most {}, or set a larger cosine.fraction",
            2 * cosine
        );
        problems.push("difference.fraction", message, remedy);
    }
}

//! Declares the configuration keys of the device `lyon`, which computes f = max(0, 1 − β·D²)^m. D is the difference between
//! normal and half vector, and β depends on the specular exponent. The key `power` sets m.

use super::common::{self, ColourKeys, Domain, Intensity};
use glint_base::fixed::Rounding;
use glint_config::{Config, Key, Problems, Schema};

glint_config::choices! {
    /// Where the factor β = n/(2·m) of the formula comes from.
    pub enum Scale {
        /// β = `2^shift/(2·m)` with an operand `shift`, which is log₂ n, rounded.
        Shift = "shift",
        /// β = `n/(2·m)` with an operand `exponent`, which is n.
        Multiplier = "multiplier",
    }
}

glint_config::keys! {
    pub struct Keys {
        power: u32 = common::power(),
        scale: Scale = Key::choice("scale", "shift", Scale::WORDS,
            "shift: as in the patent, beta is a power of two, and the operand is shift = log2 n, rounded. \
             multiplier: a fifth multiplier gives beta = n/(2*power) for every n."),
        vector_fraction: u32 = Key::integer("vector.fraction", 16, 4..=20,
            "Number of fraction bits of the components of D = N - H, which are from -2.0 to 2.0."),
        distance_fraction: u32 = Key::integer("distance.fraction", 20, 8..=28,
            "Number of fraction bits of D^2, which n multiplies."),
        distance_rounding: Rounding = Key::rounding("distance.rounding", "truncate",
            "Rounding mode of the register with D^2."),
        distance_multipliers: u32 = Key::choice("distance.multipliers", "3", &["1", "3"],
            "Number of multipliers for the squares of the components of D: one for each component, or one for \
             all. One multiplier saves DSP blocks and takes two more clocks for each point. A pipeline has one \
             for each component.")
            .only_when("architecture", "sequential").joined_later(),
        exponent_bits: u32 = common::exponent_bits(),
        colours: ColourKeys = ColourKeys::keys(),
        f: Intensity = Intensity::keys(),
        domain: Domain = Domain::keys(),
    }
}

impl Keys {
    /// Returns the s of m = 2^s: the power 16 takes 4 squarings.
    pub fn squarings(&self) -> u32 {
        self.power.ilog2()
    }

    /// Returns whether one multiplier squares the three components of D one after the other. In every pipeline, each component
    /// has its own.
    pub fn squares_in_turn(&self) -> bool {
        self.distance_multipliers == 1
    }
}

pub fn schema() -> Schema {
    Schema { device: "lyon", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.exponent_bits, problems);
    let (distance, vector) = (keys.distance_fraction, keys.vector_fraction);
    if distance > 2 * vector {
        let message =
            format!("D^2 has {distance} fraction bits, more than the squares of the components");
        let remedy = format!(
            "set distance.fraction to at most {}, or set a larger vector.fraction",
            2 * vector
        );
        problems.push("distance.fraction", message, remedy);
    }
}

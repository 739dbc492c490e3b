//! Declares the configuration keys of the device `threshold`, which computes f = (n/2·(cos γ − 1) + 1)². The result is 0 if f is
//! below a level of visibility, if cos γ ≤ 0, or if the base of the square is negative.

use super::common::{self, Domain, Intensity, Operands};
use glint_config::{Config, Key, Problems, Schema};

glint_config::keys! {
    pub struct Keys {
        operands: Operands = Operands::keys(),
        f: Intensity = Intensity::keys(),
        levels: Vec<u32> = Key::integers("visibility.levels", &[50], 0..=10_000, 1..=12,
            "The levels of visibility in ROM(n), in hundredths of an output unit. There is one level for each \
             octave of n (0 to 1, 2 to 3, 4 to 7, ...); the last level is for all larger n. An f below its \
             level gives 0."),
        domain: Domain = Domain::keys(),
    }
}

pub fn schema() -> Schema {
    Schema { device: "threshold", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.operands.exponent_bits, problems);
    let most = 100 * ((1 << keys.operands.colours.bits) - 1);
    if let Some(level) = keys.levels.iter().find(|&&level| level >= most) {
        let message = format!(
            "a level of {level} hundredths is as large as the largest output, so nothing would be visible"
        );
        let remedy = format!("set levels of at most {}, or set a larger colour.bits", most - 1);
        problems.push("visibility.levels", message, remedy);
    }
}

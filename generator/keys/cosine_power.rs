//! Declares the configuration keys of the device `cosine-power`, which computes f = (n/m·(cos γ − 1) + 1)^m, an
//! approximation of cosⁿγ. The key `power` sets m.

use super::common::{self, Domain, Intensity, Operands};
use glint_config::{Config, Problems, Schema};

glint_config::keys! {
    pub struct Keys {
        power: u32 = common::power(),
        operands: Operands = Operands::keys(),
        f: Intensity = Intensity::keys(),
        domain: Domain = Domain::keys(),
    }
}

pub fn schema() -> Schema {
    Schema { device: "cosine-power", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.operands.exponent_bits, problems);
}

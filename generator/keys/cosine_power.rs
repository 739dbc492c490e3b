//! Declares the configuration keys of `cosine-power`, and checks that their values make a device.

use super::common::{self, Domain, Intensity, Operands};
use glint_config::{Config, Problems, Schema};

glint_config::keys! {
    /// The keys of a configuration.
    pub struct Keys {
        power: u32 = common::power(),
        operands: Operands = Operands::keys(),
        f: Intensity = Intensity::keys(),
        domain: Domain = Domain::keys(),
    }
}

/// Returns the keys of the device.
pub fn schema() -> Schema {
    Schema { device: "cosine-power", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.operands.exponent_bits, problems);
}

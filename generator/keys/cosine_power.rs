//! Declares the configuration keys of the device `cosine-power`, and checks that their values are valid together.
//!
//! `cosine-power` computes f = (n/m·(cos γ − 1) + 1)^m, an approximation of cosⁿγ. For example, the key `power` sets m.

use super::common::{self, Domain, Intensity, Operands};
use glint_config::{Config, Problems, Schema};

glint_config::keys! {
    /// The values of a configuration of the device `cosine-power`, one field for each of its keys.
    pub struct Keys {
        power: u32 = common::power(),
        operands: Operands = Operands::keys(),
        f: Intensity = Intensity::keys(),
        domain: Domain = Domain::keys(),
    }
}

/// Returns the schema of the device `cosine-power`: its configuration keys, and the check of their combinations.
pub fn schema() -> Schema {
    Schema { device: "cosine-power", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.operands.exponent_bits, problems);
}

//! Declares the configuration keys of `schlick`, and checks that their values make a device.

use super::common::{self, Domain, Operands};
use glint_base::fixed::{Format, Rounding};
use glint_config::{Config, Key, Problems, Schema};

glint_config::keys! {
    /// The keys of a configuration.
    pub struct Keys {
        operands: Operands = Operands::keys(),
        fraction: u32 = Key {
            doc: "Fraction bits of the reflectance f, the quotient; each takes a clock. It is truncated: \
                  one bit more is as near as rounding.",
            ..common::intensity_fraction(10)
        },
        output_rounding: Rounding = common::output_rounding(),
        domain: Domain = Domain::keys(),
    }
}

impl Keys {
    /// Returns the format of f.
    pub fn f_format(&self) -> Format {
        Format::unsigned(0, self.fraction as i32)
    }
}

/// Returns the keys of the device.
pub fn schema() -> Schema {
    Schema { device: "schlick", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.operands.exponent_bits, problems);
}

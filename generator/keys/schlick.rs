//! Declares the configuration keys of the device `schlick`. It computes f = c / (n − n·c + c) with c = cos γ and
//! the specular exponent n.

use super::common::{self, Domain, Operands};
use glint_base::fixed::{Format, Rounding};
use glint_config::{Config, Key, Problems, Schema};

glint_config::keys! {
    pub struct Keys {
        operands: Operands = Operands::keys(),
        fraction: u32 = Key {
            doc: "Number of fraction bits of the reflectance f, the quotient. Each bit takes one clock. The \
                  quotient is truncated; one more bit is as accurate as rounding.",
            ..common::intensity_fraction(10)
        },
        output_rounding: Rounding = common::output_rounding(),
        domain: Domain = Domain::keys(),
    }
}

impl Keys {
    /// Returns the format of f: `u0.10` by default.
    pub fn f_format(&self) -> Format {
        Format::unsigned(0, self.fraction as i32)
    }
}

pub fn schema() -> Schema {
    Schema { device: "schlick", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.operands.exponent_bits, problems);
}

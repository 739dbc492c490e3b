//! The keys of `dot-product`.

use crate::base::fixed::Rounding;
use crate::config::{Config, Key, Problems, Schema};

keys! {
    /// The keys of a configuration.
    pub struct Keys {
        fraction: u32 = Key::integer("vector.fraction", 14, 2..=20,
            "Fraction bits of a component, s1.F."),
        kept: u32 = Key::integer("output.fraction", 14, 2..=20,
            "Fraction bits of the cosine, u1.C."),
        rounding: Rounding = Key::rounding("output.rounding", "nearest",
            "How the cosine is rounded."),
    }
}

/// The keys of the device.
pub fn schema() -> Schema {
    Schema { device: "dot-product", keys: Keys::keys(), check }
}

/// The sum of products has twice the fraction bits of a component, and the cosine is rounded from it.
fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    let most = 2 * keys.fraction;
    if keys.kept > most {
        problems.push(
            "output.fraction",
            format!("more fraction bits than the {most} of a product of components"),
            format!("at most {most}, or a larger vector.fraction"),
        );
    }
}

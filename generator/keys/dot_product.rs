//! The keys of `dot-product`.

use glint_base::fixed::Rounding;
use glint_config::{Config, Key, Problems, Schema};

glint_config::keys! {
    /// The keys of a configuration.
    pub struct Keys {
        fraction: u32 = Key::integer("vector.fraction", 14, 2..=20,
            "Fraction bits of a component of the normal, s1.F."),
        other: u32 = Key::integer("half.fraction", 14, 2..=20,
            "Fraction bits of a component of the half vector, s1.F."),
        kept: u32 = Key::integer("output.fraction", 14, 2..=20,
            "Fraction bits of the cosine, u1.C."),
        rounding: Rounding = Key::rounding("output.rounding", "nearest",
            "How the cosine is rounded."),
    }
}

impl Keys {
    /// Fraction bits of a product of components.
    pub fn products(&self) -> u32 {
        self.fraction + self.other
    }
}

/// The keys of the device.
pub fn schema() -> Schema {
    Schema { device: "dot-product", keys: Keys::keys(), check }
}

/// The sum of products has the fraction bits of both components, and the cosine is rounded from it.
fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    let most = keys.products();
    if keys.kept > most {
        problems.push(
            "output.fraction",
            format!("more fraction bits than the {most} of a product of components"),
            format!("at most {most}, or a larger vector.fraction or half.fraction"),
        );
    }
}

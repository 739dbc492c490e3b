//! Declares the configuration keys of the device `dot-product`, which computes the cosine of the angle γ between a vector N of
//! any length and a unit vector H. A negative cosine becomes 0. With the key `two_sided` it computes |cos γ|.

use super::normaliser;
use glint_base::fixed::{Format, Rounding};
use glint_config::{Config, Key, Problems, Schema};

glint_config::keys! {
    pub struct Keys {
        fraction: u32 = Key::integer("vector.fraction", 14, 2..=14,
            "Number of fraction bits F of the components of the normal, whose format is s1.F. The normal may \
             have any length."),
        other: u32 = Key::integer("half.fraction", 14, 2..=14,
            "Number of fraction bits F of the components of the half vector, a unit vector, whose format is \
             s1.F."),
        two_sided: bool = two_sided(),
        address: u32 = normaliser::address(),
        inverse: u32 = normaliser::inverse(),
        factor: u32 = Key::integer("factor.bits", 18, 6..=24,
            "Width of both factors of the last product: the cosine times the length of the normal, and the \
             inverse of the length."),
        kept: u32 = Key::integer("output.fraction", 14, 2..=20,
            "Number of fraction bits C of the cosine, whose format is u1.C."),
        rounding: Rounding = Key::rounding("output.rounding", "nearest",
            "Rounding mode of the cosine."),
    }
}

/// Makes the key `two_sided`, which lights both sides of a surface by the absolute value of a cosine.
pub(super) fn two_sided() -> Key {
    let doc = "Lights both sides of a surface: the device uses the absolute value of cosines.";
    Key::flag("two_sided", false, doc).joined_later()
}

impl Keys {
    /// Returns the number of fraction bits of the product of two vector components.
    pub fn products(&self) -> u32 {
        self.fraction + self.other
    }

    /// Returns the format of N·H, where N is shifted so that its length lies between 1 and 2: `u1.17` for `factor.bits = 18`.
    /// It has no sign, because a negative product becomes 0, or loses its sign with `two_sided`.
    pub fn distance(&self) -> Format {
        Format::unsigned(1, self.factor as i32 - 1)
    }

    /// Returns the format of 1/|N|, with N shifted to a length between 1 and 2: `u0.18` for `factor.bits = 18`.
    pub fn shortened(&self) -> Format {
        Format::unsigned(0, self.factor as i32)
    }
}

pub fn schema() -> Schema {
    Schema { device: "dot-product", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let Keys { fraction, address, inverse, factor, kept, .. } = Keys::of(config);
    normaliser::check_root(fraction, address, inverse, problems);
    if kept >= 2 * factor {
        let message = format!(
            "the cosine has more fraction bits than the last product, which has {}",
            2 * factor - 1
        );
        problems.push(
            "output.fraction",
            message,
            "set a smaller output.fraction or a larger factor.bits".to_owned(),
        );
    }
}
